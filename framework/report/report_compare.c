#include "framework/report/report_compare.h"

#include "framework/report/columns.h"

#include <math.h>
#include <string.h>

enum {
    ROWS_MAX = 100, /* cells that are worse, better or changed */
    KEYS_MAX = 20,  /* cells on one side only */
};

/* The output and its form. */
typedef struct page {
    FILE *out;
    bool github;
} page;

/* Letters of links, images, mentions, references, emphasis, HTML and formulas in Markdown. */
static bool is_markup(const char *text)
{
    return strpbrk(text, "[]!@*_<>~#&$\\|`") != NULL || strstr(text, "://") != NULL ||
           strstr(text, "www.") != NULL;
}

/* Letters that end a span of code or a table's cell. */
static void print_code(const page *p, const char *text)
{
    char plain[2 * BB_CELL_KEY];
    snprintf(plain, sizeof plain, "%s", text);
    for (char *at = plain; *at != '\0'; at++)
        *at = strchr("|`", *at) != NULL ? '?' : *at;
    fputc('`', p->out);
    bb_print_text(p->out, plain, 0);
    fputc('`', p->out);
}

/* Writes a text of a file so that it steers neither the terminal nor Markdown. */
static void print_text(const page *p, const char *text)
{
    if (p->github && is_markup(text))
        print_code(p, text);
    else
        bb_print_text(p->out, text, 0);
}

/* Begins a note, which is a list item in Markdown. */
static void note(const page *p, const char *text)
{
    fputs(p->github ? "- " : " ", p->out);
    print_text(p, text);
    fputc('\n', p->out);
}

#define NOTE(p, ...)                                                                               \
    do {                                                                                           \
        char note_[1024];                                                                          \
        snprintf(note_, sizeof note_, __VA_ARGS__);                                                \
        note(p, note_);                                                                            \
    } while (0)

/* Writes a key without parameters at their defaults. Unknown keys are written unchanged. */
static void print_key(const page *p, const char *key)
{
    bb_cell_parts cell;
    char brief[BB_CELL_KEY];
    snprintf(brief, sizeof brief, "%s", key);
    if (bb_cell_key_parse(key, &cell) == BB_OK) {
        bb_cell_short(&cell);
        if (bb_cell_key_format(&cell, brief) != BB_OK)
            snprintf(brief, sizeof brief, "%s", key);
    }
    if (p->github)
        print_code(p, brief);
    else
        print_text(p, brief);
}

static void figure(double value, char *text, size_t capacity)
{
    if (!isfinite(value))
        snprintf(text, capacity, "-");
    else if (value == floor(value) && fabs(value) < 1e15)
        snprintf(text, capacity, "%.0f", value);
    else
        snprintf(text, capacity, "%.4g", value);
}

/* Writes both values with four digits, or with more if they would look equal. */
static void figures(double from, double to, char texts[2][40])
{
    figure(from, texts[0], sizeof texts[0]);
    figure(to, texts[1], sizeof texts[1]);
    for (int digits = 5; digits <= 17 && from != to && strcmp(texts[0], texts[1]) == 0; digits++) {
        snprintf(texts[0], sizeof texts[0], "%.*g", digits, from);
        snprintf(texts[1], sizeof texts[1], "%.*g", digits, to);
    }
}

/* ---- head ---- */

static void print_side(const page *p, const char *name, const bb_side *side)
{
    const bb_origin *o = &side->sets[0].origin;
    NOTE(p, "%s  %s: revision %s, %s, %s%s%s%s", name, o->what, o->revision, o->date, o->host,
         o->interrupted ? ", INTERRUPTED" : "", o->shard[0] != '\0' ? ", shard " : "", o->shard);
}

static void print_rule(const page *p, const bb_comparison_result *r)
{
    char typical[80] = "";
    double ratio = bb_compare_typical(r);
    if (isfinite(ratio))
        snprintf(typical, sizeof typical, "; the median of all ratios is %.4f", ratio);
    NOTE(p, "%u cells in both; times of %u compared, %s%s", r->common, r->timed,
         r->pairs ? "in pairs" : "of two runs by themselves", typical);
    NOTE(p,
         "a time moved if its ratio is beyond 1 \xc2\xb1 %.2f %%, its 95 %% interval excludes 1, "
         "and p "
         "for all cells together is at most %.1f %%",
         100 * r->floor.share, 100 * BB_COMPARE_LEVEL);
    if (r->pairs)
        NOTE(p, "of pairs the least times are compared, run by run: noise only lengthens");
    NOTE(p, "the %.2f %%: %s", 100 * r->floor.share, r->floor.from);
}

static void print_differences(const page *p, const bb_comparison_result *r)
{
    const bb_origin *a = &r->before.sets[0].origin, *b = &r->after.sets[0].origin;
    const struct {
        const char *name, *before, *after;
    } members[] = {{"host", a->host, b->host},       {"processor", a->cpu, b->cpu},
                   {"device", a->device, b->device}, {"driver", a->driver, b->driver},
                   {"Embree", a->embree, b->embree}, {"seed", a->seed, b->seed}};
    for (size_t i = 0; i < sizeof members / sizeof members[0]; i++)
        if (strcmp(members[i].before, members[i].after) != 0)
            NOTE(p, "another %s: %.200s, %.200s", members[i].name, members[i].before,
                 members[i].after);
    if (r->machines_differ)
        note(p, "WARNING: other machines: no times are compared");
    else if (r->hosts_differ)
        note(p,
             "WARNING: other hosts: times are compared only because processor, device and driver "
             "have the same names");
}

static void print_gaps(const page *p, const bb_comparison_result *r)
{
    const bb_cell_set *a = &r->before.sets[bb_side_first(&r->before)];
    const bb_cell_set *b = &r->after.sets[bb_side_first(&r->after)];
    if (r->lacking > 0)
        NOTE(p, "WARNING: %u cells are not in all pairs that count", r->lacking);
    if (r->unlike > 0)
        NOTE(p, "WARNING: %u cells are not compared: their scene or their rays are not the same",
             r->unlike);
    if (r->faulty > 0)
        NOTE(p,
             "%u cells failed, or were refused, on one side or both: nothing else of them is "
             "compared",
             r->faulty);
    if (r->untold > 0)
        NOTE(p, "WARNING: %u times cannot be told: fewer than %d rounds have no interval",
             r->untold, BB_INTERVAL_ROUNDS);
    if (r->one_sided > 0)
        NOTE(p, "%u figures are in one of the two only", r->one_sided);
    if (a->duplicates + b->duplicates > 0)
        NOTE(p, "WARNING: %u cells are left out: their keys occur twice",
             a->duplicates + b->duplicates);
}

/* ---- what moved ---- */

static void print_row(const page *p, const bb_change *m)
{
    char texts[2][40], ratio[16] = "-", interval[40] = "";
    figures(m->from, m->to, texts);
    if (isfinite(m->effect.ratio))
        snprintf(ratio, sizeof ratio, "%.4g", m->effect.ratio);
    if (m->timed)
        snprintf(interval, sizeof interval, "%.3f to %.3f", m->effect.low, m->effect.high);
    if (strcmp(m->what, "status") == 0) {
        snprintf(texts[0], sizeof texts[0], "%.15s", m->before->status);
        snprintf(texts[1], sizeof texts[1], "%.15s", m->after->status);
    }
    if (p->github)
        fprintf(p->out, "| %s | %s | ", ratio, interval);
    else
        fprintf(p->out, "  %8s  %-16s  ", ratio, interval);
    print_text(p, m->what);
    if (p->github)
        fputs(" | ", p->out);
    else
        fprintf(p->out, "%*s", strlen(m->what) < 20 ? (int)(21 - strlen(m->what)) : 1, "");
    print_text(p, texts[0]);
    fputs(p->github ? " | " : " -> ", p->out);
    print_text(p, texts[1]);
    fputs(p->github ? " | " : "  ", p->out);
    print_key(p, m->before->key);
    fputs(m->counts ? "" : " (reference: does not count)", p->out);
    fputs(p->github ? " |\n" : "\n", p->out);
}

static uint32_t count_of(const bb_comparison_result *r, bb_change_verdict verdict)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < r->move_count; i++)
        count += r->moves[i].verdict == verdict;
    return count;
}

static void print_moves(const page *p, const bb_comparison_result *r, bb_change_verdict verdict,
                        const char *title)
{
    uint32_t count = count_of(r, verdict), shown = 0;
    if (count == 0)
        return;
    if (p->github)
        fprintf(p->out,
                "\n%s<summary>%s: %u</summary>\n\n| ratio | 95 %% | | before | after | cell |\n"
                "|---:|---|---|---:|---:|---|\n",
                verdict == BB_WORSE ? "<details open>" : "<details>", title, count);
    else
        fprintf(p->out, "\n %s: %u\n     ratio  95 %%\n", title, count);
    for (uint32_t i = 0; i < r->move_count && shown < ROWS_MAX; i++)
        if (r->moves[i].verdict == verdict) {
            print_row(p, &r->moves[i]);
            shown++;
        }
    if (p->github)
        fputs("\n", p->out);
    if (shown < count)
        NOTE(p, "and %u more", count - shown);
    if (p->github)
        fputs("</details>\n", p->out);
}

static void print_only(const page *p, const bb_side *in, const bb_side *other, uint32_t count)
{
    uint32_t shown = 0;
    bb_side_place place = {0, 0};
    if (count == 0)
        return;
    fprintf(p->out, "\n%s%u cells are in ", p->github ? "" : " ", count);
    print_text(p, in->sets[0].origin.what);
    fputs(p->github ? " only:\n\n" : " only:\n", p->out);
    for (const char *key; shown < KEYS_MAX && (key = bb_side_next(in, &place)) != NULL;)
        if (bb_side_find(other, key) == NULL) {
            fputs(p->github ? "- " : "  ", p->out);
            print_key(p, key);
            fputc('\n', p->out);
            shown++;
        }
    if (shown < count)
        NOTE(p, "and %u more", count - shown);
}

bb_status bb_report_compare(const bb_comparison_result *r, bool github, FILE *out)
{
    const page p = {out, github};
    char answer[120];
    if (r->worse > 0)
        snprintf(answer, sizeof answer, "%u figures are worse", r->worse);
    else
        snprintf(answer, sizeof answer, "nothing is worse");
    if (github)
        fprintf(out, "### bvhbench compare: %s\n\n", answer);
    print_side(&p, "before", &r->before);
    print_side(&p, "after ", &r->after);
    print_rule(&p, r);
    print_differences(&p, r);
    print_gaps(&p, r);
    print_moves(&p, r, BB_WORSE, "worse");
    print_moves(&p, r, BB_BETTER, "better");
    print_moves(&p, r, BB_CHANGED, "changed");
    print_only(&p, &r->before, &r->after, r->only_before);
    print_only(&p, &r->after, &r->before, r->only_after);
    if (!github)
        fprintf(out, "\n %s\n", answer);
    return ferror(out) ? bb_fail(BB_FAILED, "comparison: cannot be written") : BB_OK;
}
