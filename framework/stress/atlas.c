/* The atlas as text and as JSON. */
#include "framework/stress/stress.h"

#include "framework/record/put.h"
#include "framework/record/record.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { COLUMNS = 100, INDENT = 27 };

/* ---- as text ---- */

/* Words with commas between them, in lines that begin at INDENT. */
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

/* Sorted by where they begin to fail: the first comes first. */
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

/* Whether the entries from `first` on are all methods of a part, which begin at one value. */
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

/* "all 9 kernels (from 464, 4.7x to 9.9x)" */
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

/* The reason of the first refusal, which is what the user would see. */
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

/* ---- as JSON ---- */

static bool put_threshold(cJSON *list, uint32_t method, uint32_t manner, const bb_threshold *t)
{
    cJSON *entry = cJSON_CreateObject();
    return cJSON_AddItemToArray(list, entry) && bb_put_number(entry, "method", method) &&
           bb_put_text(entry, "manner", bb_manners[manner].name) &&
           bb_put_text(entry, "word", bb_manners[manner].word) &&
           cJSON_AddBoolToObject(entry, "from_start", t->from_start) != NULL &&
           cJSON_AddBoolToObject(entry, "timed", bb_manners[manner].timed) != NULL &&
           bb_put_number(entry, "below", t->below) && bb_put_number(entry, "at", t->at) &&
           bb_put_number(entry, "ratio", t->ratio) &&
           cJSON_AddBoolToObject(entry, "returns", t->returns) != NULL;
}

static bool put_values(cJSON *axis, const bb_stress *s, const bb_search *search)
{
    cJSON *values = cJSON_AddArrayToObject(axis, "values");
    bool ok = values != NULL;
    for (uint32_t i = 0; i < search->probe_count && ok; i++) {
        cJSON *value = cJSON_CreateObject();
        ok = cJSON_AddItemToArray(values, value) && bb_put_number(value, "x", search->probes[i].x);
        cJSON *methods = cJSON_AddArrayToObject(value, "methods");
        for (uint32_t m = 0; m < s->request->method_count && ok; m++) {
            const bb_point_figures *f = &search->probes[i].figures[m];
            ok = cJSON_AddItemToArray(methods, f->outcome == BB_NOT_MEASURED ? cJSON_CreateNull()
                                                                             : bb_figures_json(f));
        }
    }
    return ok;
}

static bool put_axis(cJSON *list, const bb_stress *s, const bb_stress_axis *a)
{
    static const char *const steps[] = {"log", "linear", "whole", "count"};
    const bb_axis *axis = &a->axis;
    cJSON *entry = cJSON_CreateObject();
    bool ok =
        cJSON_AddItemToArray(list, entry) && bb_put_text(entry, "name", axis->name) &&
        bb_put_text(entry, "title", axis->title) &&
        bb_put_text(entry, "parameter", axis->parameter) && bb_put_text(entry, "why", axis->why) &&
        bb_put_text(entry, "known", axis->known) && bb_put_text(entry, "scene", axis->scene) &&
        bb_put_text(entry, "builder", axis->builder) &&
        bb_put_text(entry, "kernel", axis->kernel) && bb_put_number(entry, "from", axis->from) &&
        bb_put_number(entry, "to", axis->to) && bb_put_number(entry, "n", (double)a->n) &&
        bb_put_number(entry, "frames", axis->frames) &&
        bb_put_text(entry, "steps", steps[axis->steps]) &&
        bb_put_text(entry, "picture", a->picture) &&
        bb_put_number(entry, "picture_at", a->picture_at) &&
        cJSON_AddBoolToObject(entry, "complete", a->complete) != NULL;
    cJSON *rays = cJSON_AddArrayToObject(entry, "rays");
    for (uint32_t i = 0; i < axis->ray_count && ok; i++)
        ok = cJSON_AddItemToArray(rays, cJSON_CreateString(axis->rays[i]));
    ok = ok && put_values(entry, s, &a->search);
    cJSON *thresholds = cJSON_AddArrayToObject(entry, "thresholds");
    for (uint32_t m = 0; m < s->request->method_count && ok; m++)
        for (uint32_t f = 0; f < BB_MANNERS && ok; f++)
            if (a->search.thresholds[m][f].found)
                ok = put_threshold(thresholds, m, f, &a->search.thresholds[m][f]);
    return ok;
}

/* The metric that figures have as `metric`. */
static bool put_metric(cJSON *root)
{
    const bb_metric *metric = bb_metrics[bb_metric_of_layouts()];
    cJSON *entry = cJSON_AddObjectToObject(root, "metric");
    return bb_put_text(entry, "name", metric->name) && bb_put_text(entry, "title", metric->title);
}

static bool put_methods(cJSON *root, const bb_stress *s)
{
    cJSON *methods = cJSON_AddArrayToObject(root, "methods");
    bool ok = methods != NULL;
    for (uint32_t m = 0; m < s->request->method_count && ok; m++) {
        const bb_method *method = &s->request->methods[m];
        cJSON *entry = cJSON_CreateObject();
        ok = cJSON_AddItemToArray(methods, entry) &&
             bb_put_text(entry, "part", bb_method_part_word(method->part)) &&
             bb_put_text(entry, "name", method->text) &&
             cJSON_AddBoolToObject(entry, "exact", method->exact) != NULL;
    }
    return ok;
}

/* That of a result file, with the device as the points' children saw it. */
static bool put_context(cJSON *root, const bb_stress *s, const char *command)
{
    bb_results *results = NULL;
    if (bb_results_create(&(bb_context){NULL, s->request->seed, command}, &results) != BB_OK)
        return false;
    cJSON *context = cJSON_DetachItemFromObject(bb_results_json(results), "context");
    bb_results_destroy(results);
    cJSON_DeleteItemFromObject(context, "device");
    cJSON_DeleteItemFromObject(context, "driver");
    return bb_put(root, "context", context) && bb_put_text(context, "device", s->device) &&
           bb_put_text(context, "driver", s->driver);
}

cJSON *bb_atlas_json(const bb_stress *s, const char *command)
{
    cJSON *root = cJSON_CreateObject();
    bool ok = bb_put_text(root, "schema", "bvhbench-stress/1") && put_context(root, s, command) &&
              cJSON_AddBoolToObject(root, "quick", s->request->quick) != NULL &&
              bb_put_number(root, "rays_per_set", s->max_rays) &&
              bb_put_number(root, "rounds", s->repeats) && bb_put_number(root, "ms", s->ms) &&
              bb_put_number(root, "factor", BB_STRESS_FACTOR) &&
              bb_put_number(root, "bugs", bb_stress_blame(s, NULL)) && put_metric(root) &&
              put_methods(root, s);
    cJSON *axes = cJSON_AddArrayToObject(root, "axes");
    for (uint32_t i = 0; i < s->axis_count && ok; i++)
        ok = put_axis(axes, s, &s->axes[i]);
    if (ok)
        return root;
    cJSON_Delete(root);
    return NULL;
}
