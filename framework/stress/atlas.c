/* Prints the atlas. */
#include "framework/stress/stress.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { COLUMNS = 100, INDENT = 27 };

/* Writes items with commas, in lines that begin at INDENT. */
typedef struct writer {
    FILE *out;
    int column;
    bool first;
} writer;

static void write_item(writer *w, const char *item)
{
    int length = (int)strlen(item);
    if (!w->first && w->column + 2 + length > COLUMNS - 1) {
        fprintf(w->out, ",\n%*s", INDENT, "");
        w->column = INDENT;
    } else if (!w->first) {
        fputs(", ", w->out);
        w->column += 2;
    }
    fputs(item, w->out);
    w->column += length;
    w->first = false;
}

static void write_lines(FILE *out, const char *text, int indent)
{
    int column = indent;
    fprintf(out, "%*s", indent, "");
    while (*text != '\0') {
        int length = (int)strcspn(text, " ");
        if (column > indent && column + 1 + length > COLUMNS - 1) {
            fprintf(out, "\n%*s", indent, "");
            column = indent;
        } else if (column > indent) {
            fputc(' ', out);
            column++;
        }
        fprintf(out, "%.*s", length, text);
        column += length;
        text += length + (text[length] == ' ');
    }
    fputc('\n', out);
}

static void item_of(const bb_threshold *t, const char *name, const bb_point_figures *f, bool wrong,
                    char *out, size_t capacity)
{
    char from[48], much[48] = "";
    if (t->from_start)
        snprintf(from, sizeof from, "from the first value");
    else
        snprintf(from, sizeof from, "from %.3g", t->at);
    if (isfinite(t->ratio) && !t->from_start)
        snprintf(much, sizeof much, ", %.2gx", t->ratio);
    else if (wrong && f != NULL && f->checked > 0)
        snprintf(much, sizeof much, ", %.3g ppm", 1e6 * f->wrong / f->checked);
    snprintf(out, capacity, "%s (%s%s%s)", name, from, much, t->returns ? ", not throughout" : "");
}

/* Sorted by the value at which they begin to fail. */
typedef struct entry {
    uint32_t method;
    const bb_threshold *t;
    double order;
} entry;

static int compare_entries(const void *a, const void *b)
{
    const entry *p = a, *q = b;
    return p->order != q->order ? (p->order > q->order) - (p->order < q->order)
                                : (p->method > q->method) - (p->method < q->method);
}

static uint32_t size_of_part(const bb_stress *s, bb_method_part part)
{
    uint32_t size = 0;
    for (uint32_t m = 0; m < s->request->method_count; m++)
        size += s->request->methods[m].part == part;
    return size;
}

/* Returns whether the entries from `first` on are all methods of a part, failing from one value. */
static bool is_whole_part(const bb_stress *s, const entry *entries, uint32_t count, uint32_t first)
{
    const bb_method_part part = s->request->methods[entries[first].method].part;
    const uint32_t size = size_of_part(s, part);
    for (uint32_t i = first; i < first + size; i++)
        if (i >= count || s->request->methods[entries[i].method].part != part ||
            entries[i].order != entries[first].order)
            return false;
    return size > 2;
}

/* Writes "all 9 kernels (from 464, 4.7x to 9.9x)". */
static void item_of_part(const bb_stress *s, const entry *entries, uint32_t first, char *out,
                         size_t capacity)
{
    const bb_method_part part = s->request->methods[entries[first].method].part;
    const uint32_t size = size_of_part(s, part);
    double least = INFINITY, most = 0;
    char from[48] = "from the first value", much[64] = "";
    for (uint32_t i = first; i < first + size; i++) {
        least = fmin(least, entries[i].t->ratio);
        most = fmax(most, entries[i].t->ratio);
    }
    if (!entries[first].t->from_start)
        snprintf(from, sizeof from, "from %.3g", entries[first].t->at);
    if (most > 0 && isfinite(least))
        snprintf(much, sizeof much, ", %.2gx to %.2gx", least, most);
    snprintf(out, capacity, "all %u %ss (%s%s)", size, bb_method_part_word(part), from, much);
}

static void print_manner(const bb_stress *s, const bb_stress_axis *a, bb_manner manner, FILE *out)
{
    entry entries[BB_METHODS_MAX];
    uint32_t count = 0;
    for (uint32_t m = 0; m < s->request->method_count; m++) {
        const bb_threshold *t = &a->search.thresholds[m][manner];
        double sign = a->axis.from > a->axis.to ? -1 : 1;
        if (t->found)
            entries[count++] = (entry){m, t, t->from_start ? -INFINITY : sign * t->at};
    }
    if (count == 0)
        return;
    qsort(entries, count, sizeof *entries, compare_entries);
    fprintf(out, "  %-*s", INDENT - 2, bb_manners[manner].word);
    writer w = {.out = out, .column = INDENT, .first = true};
    for (uint32_t i = 0; i < count; i++) {
        char text[512];
        const uint32_t m = entries[i].method;
        if (is_whole_part(s, entries, count, i)) {
            item_of_part(s, entries, i, text, sizeof text);
            i += size_of_part(s, s->request->methods[m].part) - 1;
        } else {
            item_of(entries[i].t, s->request->methods[m].text,
                    bb_search_figures(&a->search, entries[i].t->at, m), manner == BB_MANNER_WRONG,
                    text, sizeof text);
        }
        write_item(&w, text);
    }
    fputc('\n', out);
}

static bool fails_anyhow(const bb_stress_axis *a, uint32_t m)
{
    for (uint32_t f = 0; f < BB_MANNERS; f++)
        if (a->search.thresholds[m][f].found)
            return true;
    return false;
}

/* Returns the reason of the first refusal; NULL: none. */
static const char *first_reason(const bb_stress *s, const bb_stress_axis *a)
{
    for (uint32_t i = 0; i < a->search.probe_count; i++)
        for (uint32_t m = 0; m < s->request->method_count; m++)
            if (a->search.probes[i].figures[m].outcome == BB_OUT_REFUSED)
                return a->search.probes[i].figures[m].reason;
    return NULL;
}

static void print_axis(const bb_stress *s, const bb_stress_axis *a, FILE *out)
{
    uint32_t hold = 0;
    fprintf(out, "\n%s: %s, %.3g to %.3g%s\n", a->axis.name, a->axis.parameter, a->axis.from,
            a->axis.also_count > 0 ? a->axis.also[a->axis.also_count - 1] : a->axis.to,
            a->complete ? "" : " (interrupted)");
    for (uint32_t f = 0; f < BB_MANNERS; f++)
        print_manner(s, a, (bb_manner)f, out);
    for (uint32_t m = 0; m < s->request->method_count; m++)
        hold += !fails_anyhow(a, m);
    if (first_reason(s, a) != NULL) {
        write_lines(out, first_reason(s, a), INDENT);
    }
    fprintf(out, "  %-*s%u of %u methods\n", INDENT - 2, "no failure", hold,
            s->request->method_count);
    if (a->axis.known[0] != '\0')
        write_lines(out, a->axis.known, INDENT);
}

bb_status bb_atlas_print(const bb_stress *s, FILE *out)
{
    fprintf(out,
            "%s\nWhere %u methods fail on %u axes: %u points in %.0f s%s%s\n"
            "slower, bigger: than twice their own at the beginning of the axis; wrong: the first "
            "wrong answer\nof up to %u rays a set\n",
            s->device, s->request->method_count, s->axis_count, s->measured + s->taken_over,
            s->ms / 1e3, s->taken_over > 0 ? ", some of an earlier run" : "",
            s->request->quick ? " (--quick: few values, small scenes, times not judged)" : "",
            s->max_rays);
    for (uint32_t i = 0; i < s->axis_count; i++)
        print_axis(s, &s->axes[i], out);
    return BB_OK;
}
