#include "framework/compare/compare.h"

#include "framework/compare/family.h"
#include "framework/compare/figures.h"
#include "framework/device/bystanders.h"
#include "framework/record/schema.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *bb_change_word(bb_change_verdict verdict)
{
    static const char *const words[] = {[BB_WORSE] = "worse",
                                        [BB_BETTER] = "better",
                                        [BB_UNDECIDED] = "undecided",
                                        [BB_CHANGED] = "changed"};
    return words[verdict];
}

static bool is_ok(const bb_measured *cell)
{
    return strcmp(cell->status, "ok") == 0;
}

static bb_status add_move(bb_comparison_result *result, const bb_change *move)
{
    if (result->move_count == result->move_capacity) {
        uint32_t capacity = 2 * result->move_capacity + 64;
        bb_change *grown = realloc(result->moves, capacity * sizeof *grown);
        if (grown == NULL)
            return bb_fail(BB_FAILED, "comparison: no memory");
        result->moves = grown;
        result->move_capacity = capacity;
    }
    result->moves[result->move_count++] = *move;
    result->worse += move->verdict == BB_WORSE && move->counts;
    return BB_OK;
}

static bb_change start_move(const bb_measured *before, const bb_measured *after, const char *what)
{
    bb_change move = {.before = before,
                      .after = after,
                      .from = NAN,
                      .to = NAN,
                      .effect = {NAN, NAN, NAN},
                      .p = NAN,
                      .counts = !before->reference && !after->reference};
    snprintf(move.what, sizeof move.what, "%s", what);
    return move;
}

/* ---- exact figures ---- */

typedef struct range {
    double low, high; /* NAN: no set has the figure */
} range;

/* Returns the range of an exact figure over the counting runs of a side. It has more than one value
 * only if a builder is not deterministic. */
static range range_of(const bb_side *side, const char *key, const char *name)
{
    range r = {NAN, NAN};
    for (uint32_t i = bb_side_first(side); i < side->count; i++) {
        const bb_measured *cell = bb_cell_set_find(&side->sets[i], key);
        double value = cell != NULL ? bb_measured_figure(cell, name) : (double)NAN;
        r.low = fmin(r.low, value); /* fmin() ignores a NAN */
        r.high = fmax(r.high, value);
    }
    return r;
}

/* Handles a figure that only one side has. It is named if it is gone; if answers are not judged any
 * more, that is worse. `was`: NAN if the figure is new. */
static bb_status compare_one_sided(bb_comparison_result *result, const bb_measured *before,
                                   const bb_measured *after, const char *name, double was)
{
    result->one_sided++;
    if (isnan(was))
        return BB_OK;
    bb_change move = start_move(before, after, name);
    move.from = was;
    move.verdict = bb_figure_is_judgement(name) ? BB_WORSE : BB_CHANGED;
    return add_move(result, &move);
}

/* Returns false for two simulations of different numbers of rays: their figures do not say which is
 * better. */
static bool is_same_sample(const bb_measured *before, const bb_measured *after)
{
    const char *name = bb_fields[BB_F_SIMT_RAYS].name;
    const double a = bb_measured_figure(before, name), b = bb_measured_figure(after, name);
    return isnan(a) || isnan(b) || a == b;
}

static bb_status compare_figure(bb_comparison_result *result, const bb_measured *before,
                                const bb_measured *after, const char *name)
{
    range a = range_of(&result->before, before->key, name);
    range b = range_of(&result->after, before->key, name);
    if (isnan(a.low) || isnan(b.low))
        return compare_one_sided(result, before, after, name, a.high);
    if (bb_figure_is_wrong(name)) { /* of wrong answers the worst run counts */
        a.low = a.high;
        b.low = b.high;
    }
    if (!(b.low > a.high) && !(b.high < a.low))
        return BB_OK;
    bool more = b.low > a.high;
    bb_change move = start_move(before, after, name);
    move.from = more ? a.high : a.low; /* the smallest change that both ranges allow */
    move.to = more ? b.low : b.high;
    move.effect.ratio = move.from != 0 ? move.to / move.from : (double)NAN;
    const bb_better better = bb_measured_better(after, name);
    move.verdict = better == BB_BETTER_NEITHER || !is_same_sample(before, after) ? BB_CHANGED
                   : more == (better == BB_BETTER_LESS)                          ? BB_WORSE
                                                                                 : BB_BETTER;
    if (bb_figure_is_judged(name) && move.to == 0)
        move.verdict = BB_WORSE;
    return add_move(result, &move);
}

static bb_status compare_figures(bb_comparison_result *result, const bb_measured *before,
                                 const bb_measured *after)
{
    for (uint32_t i = 0; i < before->figure_count; i++)
        BB_TRY(compare_figure(result, before, after, before->figures[i].name));
    for (uint32_t i = 0; i < after->figure_count; i++)
        if (isnan(bb_measured_figure(before, after->figures[i].name)))
            BB_TRY(compare_figure(result, before, after, after->figures[i].name));
    return BB_OK;
}

/* Returns false if the cell failed or was refused on one side or on both. */
static bb_status compare_status(bb_comparison_result *result, const bb_measured *before,
                                const bb_measured *after, bool *both_ok)
{
    *both_ok = is_ok(before) && is_ok(after);
    result->faulty += !*both_ok;
    if (strcmp(before->status, after->status) == 0)
        return BB_OK;
    bb_change move = start_move(before, after, "status");
    move.verdict = is_ok(before) ? BB_WORSE : is_ok(after) ? BB_BETTER : BB_CHANGED;
    return add_move(result, &move);
}

/* ---- times ---- */

/* A cell whose times are compared. */
typedef struct timing {
    const bb_measured *before, *after;
    double from, to;
    bb_effect effect;
    double own; /* the cell's effect against itself; NAN: not known or not needed */
} timing;

/* Takes the logarithms of all times but the discarded one. */
static void take_logarithms(const bb_samples *ms, bb_samples *out)
{
    for (uint32_t i = ms->count > 1 ? 1 : 0; i < ms->count; i++)
        bb_samples_add(out, log(ms->values[i]));
}

static void time_runs(const bb_comparison_result *result, timing *t, bb_family_row *row)
{
    t->own = bb_floor_own(&result->floor, t->before->key);
    t->effect = bb_effect_of_runs(&t->before->ms, &t->after->ms);
    t->from = bb_samples_median(&t->before->ms);
    t->to = bb_samples_median(&t->after->ms);
    take_logarithms(&t->before->ms, &row->before);
    take_logarithms(&t->after->ms, &row->after);
}

static void time_pairs(const bb_comparison_result *result, timing *t, bb_family_row *row)
{
    bb_samples from = {0}, to = {0}, ratios = {0};
    for (uint32_t i = 0; i < result->before.count; i++) {
        const bb_measured *a = bb_cell_set_find(&result->before.sets[i], t->before->key);
        const bb_measured *b = bb_cell_set_find(&result->after.sets[i], t->before->key);
        double ratio = bb_ratio_of_pair(a, b);
        if (i > 0)
            bb_samples_add(&row->before, log(ratio)); /* NAN stands for a missing value */
        if (!isfinite(ratio) && i > 0)
            continue;
        bb_samples_add(&ratios, isfinite(ratio) ? ratio : 1);
        bb_samples_add(&from, isfinite(ratio) ? bb_time_of_pair(a) : 1);
        bb_samples_add(&to, isfinite(ratio) ? bb_time_of_pair(b) : 1);
    }
    t->own = result->given ? (double)NAN
                           : bb_floor_of_cell(&result->before, &result->after, t->before->key);
    t->effect = bb_effect_of_pairs(&ratios);
    t->from = bb_samples_median(&from);
    t->to = bb_samples_median(&to);
}

/* Returns the effect that a time has against itself: of the typical cell, or its own if it is
 * more. */
static double floor_of(const bb_comparison_result *result, const timing *t)
{
    const bb_floor *floor = &result->floor;
    return fmax(bb_is_clock(t->before->key) ? floor->clocks : floor->share, t->own); /* NAN: none */
}

/* Decides by the rule of README.md whether the time moved. */
static bb_status judge_time(bb_comparison_result *result, const timing *t, const bb_family_row *row)
{
    const bb_effect *e = &t->effect;
    bool slower = e->ratio > 1;
    if (!isfinite(e->low)) {
        result->untold++;
        return BB_OK;
    }
    double p = slower ? row->p_up : row->p_down;
    double floor = floor_of(result, t);
    if (!bb_effect_excludes_one(e) || !(expm1(fabs(log(e->ratio))) > floor) || p > BB_COMPARE_LEVEL)
        return BB_OK;
    bb_change move = start_move(t->before, t->after, t->before->time);
    move.timed = true;
    move.from = t->from;
    move.to = t->to;
    move.effect = *e;
    move.p = p;
    move.verdict = slower ? BB_WORSE : result->busy ? BB_UNDECIDED : BB_BETTER;
    return add_move(result, &move);
}

/* ---- what could have been seen ---- */

/* The three conditions of the rule, each by itself: the largest of what they need. */
static double least_seen(const bb_comparison_result *result, const timing *t, double shift)
{
    const bb_effect *e = &t->effect;
    const double interval = e->ratio / e->low; /* of an effect of 1, the interval is as wide */
    if (!isfinite(e->low))
        return INFINITY;
    return fmax(floor_of(result, t), fmax(interval - 1, expm1(shift)));
}

static bb_status take_sights(bb_comparison_result *result, const timing *timings,
                             const bb_family_row *rows, uint32_t count)
{
    double *shifts = calloc(count + 1, sizeof *shifts);
    result->sights = calloc(count + 1, sizeof *result->sights);
    bb_status status = shifts != NULL && result->sights != NULL
                           ? bb_family_found(rows, count, result->pairs, BB_COMPARE_LEVEL, shifts)
                           : bb_fail(BB_FAILED, "comparison: no memory");
    for (uint32_t i = 0; i < count && status == BB_OK; i++)
        if (!timings[i].before->reference && !timings[i].after->reference)
            result->sights[result->sight_count++] =
                (bb_sight){timings[i].before, least_seen(result, &timings[i], shifts[i])};
    if (status == BB_OK)
        bb_compare_sort_sights(result);
    free(shifts);
    return status;
}

static int rising(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static bb_status compare_times(bb_comparison_result *result, timing *timings, uint32_t count)
{
    bb_family_row *rows = calloc(count + 1, sizeof *rows);
    result->ratios = calloc(count + 1, sizeof *result->ratios);
    bb_status status = BB_OK;
    if (rows == NULL || result->ratios == NULL)
        status = bb_fail(BB_FAILED, "comparison: no memory");
    for (uint32_t i = 0; i < count && status == BB_OK; i++) {
        if (result->pairs)
            time_pairs(result, &timings[i], &rows[i]);
        else
            time_runs(result, &timings[i], &rows[i]);
        if (!isfinite(timings[i].effect.low)) /* judge_time() has nothing to say of it */
            rows[i].before.count = rows[i].after.count = 0;
        if (isfinite(timings[i].effect.ratio))
            result->ratios[result->ratio_count++] = timings[i].effect.ratio;
    }
    if (status == BB_OK)
        qsort(result->ratios, result->ratio_count, sizeof *result->ratios, rising);
    if (status == BB_OK)
        status = result->pairs ? bb_family_of_pairs(rows, count) : bb_family_of_runs(rows, count);
    for (uint32_t i = 0; i < count && status == BB_OK; i++)
        status = judge_time(result, &timings[i], &rows[i]);
    if (status == BB_OK)
        status = take_sights(result, timings, rows, count);
    for (uint32_t i = 0; i < count; i++)
        *(bb_is_clock(timings[i].before->key) ? &result->clocks : &result->timed) += 1;
    free(rows);
    return status;
}

/* ---- all of it ---- */

static bb_status set_floor(bb_comparison_result *result, double threshold, const bb_floor *known)
{
    bb_floor *floor = &result->floor;
    if (isfinite(threshold)) {
        *floor = (bb_floor){.share = threshold, .clocks = threshold, .from = "--threshold"};
        result->given = true;
        return BB_OK;
    }
    if (result->pairs)
        BB_TRY(bb_floor_of_pairs(&result->before, &result->after, floor));
    else if (known != NULL)
        *floor = *known;
    else
        floor->share = NAN;
    if (floor->share > BB_COMPARE_FLOOR_MOST)
        return bb_fail(BB_INVALID,
                       "comparison: a program differs from itself by %.0f %% here (%s): nothing "
                       "can be told: measure on a quiet machine, with more --rounds or --repeats, "
                       "or say what counts with --threshold",
                       100 * floor->share, floor->from);
    if (!isfinite(floor->clocks))
        floor->clocks = isfinite(floor->share) ? floor->share : BB_COMPARE_FLOOR_UNKNOWN;
    if (isfinite(floor->share))
        return BB_OK;
    floor->share = BB_COMPARE_FLOOR_UNKNOWN;
    snprintf(floor->from, sizeof floor->from,
             "assumed: no run of one program against itself (A/A) is known of this machine");
    return BB_OK;
}

/* Which layouts a build has follows from what traces it, and that is missing itself, or has failed,
 * if a layout should be there and is not. */
bool bb_counts_as_missing(const bb_measured *cell)
{
    return !cell->reference && is_ok(cell) && strstr(cell->key, BB_KEY_OF_LAYOUT) == NULL;
}

static void count_only(bb_comparison_result *result)
{
    const bb_side *a = &result->before, *b = &result->after;
    bb_side_place place = {0, 0};
    for (const char *key; (key = bb_side_next(a, &place)) != NULL;) {
        if (bb_is_clock(key))
            continue;
        bool both = bb_side_find(b, key) != NULL;
        const bb_measured *old = bb_side_find(a, key);
        result->missing += !both && bb_counts_as_missing(old);
        result->common += both;
        result->only_before += !both;
        result->lacking += both && bb_side_lacks(a, key) + bb_side_lacks(b, key) > 0;
    }
    place = (bb_side_place){0, 0};
    for (const char *key; (key = bb_side_next(b, &place)) != NULL;)
        result->only_after += !bb_is_clock(key) && bb_side_find(a, key) == NULL;
}

/* Returns whether all counting runs had the same scene and rays. */
static bool same_inputs(const bb_comparison_result *result, const bb_measured *like)
{
    const bb_side *sides[] = {&result->before, &result->after};
    for (uint32_t s = 0; s < 2; s++)
        for (uint32_t i = bb_side_first(sides[s]); i < sides[s]->count; i++) {
            const bb_measured *cell = bb_cell_set_find(&sides[s]->sets[i], like->key);
            if (cell != NULL && !bb_same_input(cell, like))
                return false;
        }
    return true;
}

/* Returns whether the cell whose processor time it is has not failed in any run. If it has, that is
 * said of the cell itself. */
static bool may_be_timed(const bb_comparison_result *result, const char *key)
{
    char wall[BB_CELL_KEY];
    bb_wall_key(key, wall);
    const bb_measured *before = bb_side_find(&result->before, wall);
    const bb_measured *after = bb_side_find(&result->after, wall);
    return before != NULL && after != NULL && is_ok(before) && is_ok(after);
}

static bb_status compare_cell(bb_comparison_result *result, const bb_measured *before,
                              const bb_measured *after, timing *timings, uint32_t *count)
{
    bool both_ok;
    if (bb_is_clock(before->key) && !may_be_timed(result, before->key))
        return BB_OK;
    if (!same_inputs(result, before)) {
        result->unlike += !bb_is_clock(before->key);
        return BB_OK;
    }
    BB_TRY(compare_status(result, before, after, &both_ok));
    if (!both_ok)
        return BB_OK;
    BB_TRY(compare_figures(result, before, after));
    if (!result->machines_differ && before->ms.count > 0 && after->ms.count > 0)
        timings[(*count)++] = (timing){.before = before, .after = after};
    return BB_OK;
}

static bb_status compare_cells(bb_comparison_result *result)
{
    timing *timings = calloc(2 * (size_t)result->common + 1, sizeof *timings); /* and clocks */
    uint32_t count = 0;
    bb_side_place place = {0, 0};
    bb_status status = timings != NULL ? BB_OK : bb_fail(BB_FAILED, "comparison: no memory");
    for (const char *key; status == BB_OK && (key = bb_side_next(&result->before, &place));) {
        const bb_measured *before = bb_side_find(&result->before, key);
        const bb_measured *after = bb_side_find(&result->after, key);
        if (after != NULL)
            status = compare_cell(result, before, after, timings, &count);
    }
    if (status == BB_OK)
        status = compare_times(result, timings, count);
    free(timings);
    return status;
}

static double size_of(const bb_change *move)
{
    return isfinite(move->effect.ratio) && move->effect.ratio > 0 ? fabs(log(move->effect.ratio))
                                                                  : INFINITY;
}

/* Sorts: worse and counting, worse references, the other verdicts. */
static int worst_first(const void *left, const void *right)
{
    const bb_change *a = left, *b = right;
    int ranks[] = {2 * (int)a->verdict + !a->counts, 2 * (int)b->verdict + !b->counts};
    double sizes[] = {size_of(a), size_of(b)};
    if (ranks[0] != ranks[1])
        return ranks[0] < ranks[1] ? -1 : 1;
    if (sizes[0] != sizes[1])
        return sizes[0] > sizes[1] ? -1 : 1;
    int order = strcmp(a->before->key, b->before->key);
    return order != 0 ? order : strcmp(a->what, b->what);
}

static bool several(const char *text)
{
    return strcmp(text, BB_SEVERAL) == 0;
}

/* Several machines of one side need not be those of the other. */
static void compare_machines(const bb_origin *a, const bb_origin *b, bb_comparison_result *result)
{
    bool host;
    result->machines_differ = !bb_same_machine(a, b, &host) || several(a->cpu) ||
                              several(a->device) || several(a->driver);
    result->hosts_differ = !host || several(a->host);
}

bb_status bb_compare(const bb_side *before, const bb_side *after, double threshold,
                     const bb_floor *floor, bb_comparison_result *result)
{
    *result = (bb_comparison_result){.before = *before, .after = *after};
    const bb_origin *a = &before->sets[0].origin, *b = &after->sets[0].origin;
    BB_TRY(bb_side_check(before));
    BB_TRY(bb_side_check(after));
    const char *nameless = "a device without a name";
    if (!bb_same_device(a, b))
        return bb_fail(BB_INVALID,
                       "%s was measured on %s, %s on %s: cells of two devices are not compared: "
                       "measure both on one (--device)",
                       a->what, a->device[0] != '\0' ? a->device : nameless, b->what,
                       b->device[0] != '\0' ? b->device : nameless);
    result->pairs = before->count > 1;
    result->busy = !result->pairs && fmax(a->busy, b->busy) > BB_BUSY_SHARE;
    compare_machines(a, b, result);
    count_only(result);
    if (result->common == 0)
        return bb_fail(BB_INVALID, "%s and %s have no cell in common: nothing to compare", a->what,
                       b->what);
    BB_TRY(set_floor(result, threshold, floor));
    BB_TRY(compare_cells(result));
    if (result->move_count > 0)
        qsort(result->moves, result->move_count, sizeof *result->moves, worst_first);
    return BB_OK;
}

double bb_compare_typical(const bb_comparison_result *result)
{
    return result->ratio_count > 0 ? result->ratios[result->ratio_count / 2] : (double)NAN;
}

void bb_compare_free(bb_comparison_result *result)
{
    free(result->moves);
    free(result->sights);
    free(result->ratios);
    memset(result, 0, sizeof *result);
}
