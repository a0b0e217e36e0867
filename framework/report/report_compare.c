#include "framework/report/report_compare.h"

#include "framework/device/bystanders.h"
#include "framework/table/page.h"

#include <math.h>
#include <string.h>

enum {
    ROWS_MAX = 100, /* cells that are worse, better or changed */
    KEYS_MAX = 20,  /* cells on one side only */
    SIGHTS_MAX = 5, /* blindest cells */
};

void bb_compare_figures(double from, double to, char texts[2][40])
{
    const double values[] = {from, to};
    for (int i = 0; i < 2; i++)
        if (!isfinite(values[i]))
            strcpy(texts[i], "-");
        else if (values[i] == floor(values[i]) && fabs(values[i]) < 1e15)
            snprintf(texts[i], 40, "%.0f", values[i]);
        else
            snprintf(texts[i], 40, "%.4g", values[i]);
    for (int digits = 5; digits <= 17 && from != to && strcmp(texts[0], texts[1]) == 0; digits++) {
        snprintf(texts[0], 40, "%.*g", digits, from);
        snprintf(texts[1], 40, "%.*g", digits, to);
    }
}

/* ---- head ---- */

static void add_side(bb_page *page, const char *name, const bb_side *side)
{
    const bb_origin *o = &side->sets[0].origin;
    bb_page_note(page, "%s  %s: revision %s, %s, %s%s%s%s", name, o->what, o->revision, o->date,
                 o->host, o->interrupted ? ", INTERRUPTED" : "",
                 o->shard[0] != '\0' ? ", shard " : "", o->shard);
}

static void add_rule(bb_page *page, const bb_comparison_result *r)
{
    char typical[80] = "", clocks[64] = "", of_clocks[64] = "";
    double ratio = bb_compare_typical(r);
    if (r->clocks > 0) {
        snprintf(clocks, sizeof clocks, " and processor times of %u", r->clocks);
        snprintf(of_clocks, sizeof of_clocks, " (processor time: %.2f %%)", 100 * r->floor.clocks);
    }
    if (isfinite(ratio))
        snprintf(typical, sizeof typical, "; the median of all ratios is %.4f", ratio);
    bb_page_note(page, "%u cells in both; times of %u%s compared, %s%s", r->common, r->timed,
                 clocks, r->pairs ? "in pairs" : "of two runs by themselves", typical);
    bb_page_note(page,
                 "a time moved if its ratio is beyond 1 \xc2\xb1 %.2f %%%s, its 95 %% interval "
                 "excludes 1, and p for all cells together is at most %.1f %%",
                 100 * r->floor.share, of_clocks, 100 * BB_COMPARE_LEVEL);
    if (r->pairs)
        bb_page_note(page,
                     "of pairs the least times are compared, run by run: noise only lengthens; of "
                     "processor time, the medians");
    bb_page_note(page, "the %.2f %%: %s", 100 * r->floor.share, r->floor.from);
}

typedef struct difference {
    const char *name, *before, *after;
} difference;

static void add_differences(bb_page *page, const bb_comparison_result *r)
{
    const bb_origin *a = &r->before.sets[0].origin, *b = &r->after.sets[0].origin;
    const difference members[] = {
        {"host", a->host, b->host},       {"processor", a->cpu, b->cpu},
        {"device", a->device, b->device}, {"driver", a->driver, b->driver},
        {"Embree", a->embree, b->embree}, {"seed", a->seed, b->seed}};
    for (size_t i = 0; i < sizeof members / sizeof members[0]; i++)
        if (strcmp(members[i].before, members[i].after) != 0)
            bb_page_note(page, "another %s: %.200s, %.200s", members[i].name, members[i].before,
                         members[i].after);
    if (a->has_reduced_to && b->has_reduced_to && strcmp(a->reduced_to, b->reduced_to) != 0)
        bb_page_note(page, "WARNING: to keep a time (--time), %s had %s, and %s %s", a->what,
                     a->reduced_to[0] != '\0' ? a->reduced_to : "all", b->what,
                     b->reduced_to[0] != '\0' ? b->reduced_to : "all");
    if (r->machines_differ)
        bb_page_note(page, "WARNING: other machines: no times are compared");
    else if (r->hosts_differ)
        bb_page_note(page, "WARNING: other hosts: times are compared only because processor, "
                           "device and driver have the same names");
}

/* What a machine does not say is no difference. */
static void add_processors(bb_page *page, const bb_comparison_result *r)
{
    const bb_origin *a = &r->before.sets[0].origin, *b = &r->after.sets[0].origin;
    const difference terms[] = {{"governor", a->governor, b->governor},
                                {"SMT", a->smt, b->smt},
                                {"boost", a->boost, b->boost},
                                {"processors used", a->processors, b->processors}};
    for (size_t i = 0; i < sizeof terms / sizeof terms[0]; i++)
        if (terms[i].before[0] != '\0' && terms[i].after[0] != '\0' &&
            (strcmp(terms[i].before, terms[i].after) != 0 ||
             strcmp(terms[i].before, BB_SEVERAL) == 0))
            bb_page_note(page, "WARNING: %s: %.200s, then %.200s: times may differ by that alone",
                         terms[i].name, terms[i].before, terms[i].after);
}

static void add_busy(bb_page *page, const bb_comparison_result *r)
{
    const bb_origin *sides[] = {&r->before.sets[0].origin, &r->after.sets[0].origin};
    for (int i = 0; i < 2 && r->busy; i++)
        if (sides[i]->busy > BB_BUSY_SHARE)
            bb_page_note(page,
                         "WARNING: the machine was busy: other programs kept %.0f %% of its "
                         "processors at work while %s was measured: no time is called better, and "
                         "what is worse may be so by that: run `compare --run`",
                         100 * sides[i]->busy, sides[i]->what);
}

static void add_gaps(bb_page *page, const bb_comparison_result *r)
{
    const bb_cell_set *a = &r->before.sets[bb_side_first(&r->before)];
    const bb_cell_set *b = &r->after.sets[bb_side_first(&r->after)];
    if (r->lacking > 0)
        bb_page_note(page, "WARNING: %u cells are not in all pairs that count", r->lacking);
    if (r->unlike > 0)
        bb_page_note(page,
                     "WARNING: %u cells are not compared: their scene or their rays are not the "
                     "same",
                     r->unlike);
    if (r->faulty > 0)
        bb_page_note(page,
                     "%u cells failed, or were refused, on one side or both: nothing else of them "
                     "is compared",
                     r->faulty);
    if (r->untold > 0)
        bb_page_note(page,
                     "WARNING: %u times cannot be told: fewer than %d rounds have no interval",
                     r->untold, BB_INTERVAL_ROUNDS);
    if (r->one_sided > 0)
        bb_page_note(page, "%u figures are in one of the two only", r->one_sided);
    if (a->duplicates + b->duplicates > 0)
        bb_page_note(page, "WARNING: %u cells are left out: their keys occur twice",
                     a->duplicates + b->duplicates);
}

/* ---- what moved ---- */

static void add_move(bb_page *page, const bb_change *m)
{
    char texts[2][40], cell[BB_CELL_KEY + 40];
    const bb_estimate ratio = {.value = m->effect.ratio,
                               .low = m->timed ? m->effect.low : (double)NAN,
                               .high = m->timed ? m->effect.high : (double)NAN};
    const bool status = strcmp(m->what, "status") == 0;
    bb_compare_figures(m->from, m->to, texts);
    bb_cell_key_short(m->before->key, cell);
    strcat(cell, m->counts ? "" : " (reference: does not count)");
    bb_page_put_text(page, cell);
    bb_page_put_text(page, m->what);
    bb_page_put_text(page, status ? m->before->status : texts[0]);
    bb_page_put_text(page, status ? m->after->status : texts[1]);
    bb_page_put_figure(page, ratio, 0);
}

static void add_moves(bb_page *page, const bb_comparison_result *r, bb_change_verdict verdict)
{
    static const char *const headings[] = {"cell", "figure", "before", "after", "ratio [95 %]"};
    uint32_t count = 0, shown = 0;
    char title[40];
    for (uint32_t i = 0; i < r->move_count; i++)
        count += r->moves[i].verdict == verdict;
    if (count == 0)
        return;
    snprintf(title, sizeof title, "%s%s: %u", verdict == BB_UNDECIDED ? "less, but " : "",
             bb_change_word(verdict), count);
    bb_page_heading(page, title);
    bb_page_grid(page, "");
    for (int i = 0; i < 5; i++)
        bb_page_column(page, headings[i], "", "", 3);
    for (uint32_t i = 0; i < r->move_count && shown < ROWS_MAX; i++)
        if (r->moves[i].verdict == verdict) {
            add_move(page, &r->moves[i]);
            shown++;
        }
    if (shown < count)
        bb_page_say(page, "and %u more", count - shown);
}

/* The least slowing that would have been found: over all, and of the blindest cells. */
static const char *share_text(double share, char text[24])
{
    if (isfinite(share))
        snprintf(text, 24, "by %.3g %%", 100 * share);
    return isfinite(share) ? text : "of no size";
}

static void add_sights(bb_page *page, const bb_comparison_result *r)
{
    char brief[BB_CELL_KEY], texts[2][24];
    if (r->sight_count == 0)
        return;
    bb_page_say(page,
                "of the %u cells that count, half could have shown a slowing %s, nine of ten one "
                "%s; the blindest:",
                r->sight_count, share_text(r->sights[r->sight_count / 2].least, texts[0]),
                share_text(r->sights[r->sight_count / 10].least, texts[1]));
    bb_page_grid(page, "");
    bb_page_column(page, "cell", "", "", 0);
    bb_page_column(page, "time", "", "", 0);
    bb_page_column(page, "least found", "%", "", -1);
    for (uint32_t i = 0; i < r->sight_count && i < SIGHTS_MAX; i++) {
        bb_cell_key_short(r->sights[i].cell->key, brief);
        bb_page_put_text(page, brief);
        bb_page_put_text(page, r->sights[i].cell->time);
        bb_page_put_figure(
            page, (bb_estimate){.value = 100 * r->sights[i].least, .low = NAN, .high = NAN}, 0);
    }
}

static void add_only(bb_page *page, const bb_side *in, const bb_side *other, uint32_t count)
{
    uint32_t shown = 0;
    bb_side_place place = {0, 0};
    char brief[BB_CELL_KEY];
    if (count == 0)
        return;
    bb_page_say(page, "%u cells are in %s only:", count, in->sets[0].origin.what);
    for (const char *key; shown < KEYS_MAX && (key = bb_side_next(in, &place)) != NULL;)
        if (!bb_is_clock(key) && bb_side_find(other, key) == NULL) {
            bb_cell_key_short(key, brief);
            bb_page_note(page, "%s", brief);
            shown++;
        }
    if (shown < count)
        bb_page_note(page, "and %u more", count - shown);
}

bb_status bb_report_compare(const bb_comparison_result *r, bool github, FILE *out)
{
    bb_page *page;
    char answer[80] = "nothing is worse", title[120], missing[40] = "";
    if (r->missing > 0)
        snprintf(missing, sizeof missing, "%u cells are missing", r->missing);
    if (r->worse > 0)
        snprintf(answer, sizeof answer, "%u figures are worse%s%s", r->worse,
                 r->missing > 0 ? ", " : "", missing);
    else if (r->missing > 0)
        snprintf(answer, sizeof answer, "%s", missing);
    snprintf(title, sizeof title, "bvhbench compare: %s", answer);
    BB_TRY(bb_page_create(title, &page));
    add_side(page, "before", &r->before);
    add_side(page, "after ", &r->after);
    add_rule(page, r);
    add_differences(page, r);
    add_processors(page, r);
    add_busy(page, r);
    add_gaps(page, r);
    for (int verdict = BB_WORSE; verdict <= BB_CHANGED; verdict++)
        add_moves(page, r, verdict);
    add_sights(page, r);
    add_only(page, &r->before, &r->after, r->only_before);
    add_only(page, &r->after, &r->before, r->only_after);
    bb_page_verdict(page, r->worse + r->missing == 0, "%s", answer);
    return bb_page_end(page, github ? bb_page_markdown : bb_page_print, out);
}
