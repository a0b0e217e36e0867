/* Makes the rows of a summary and their order: geometric means of ratios over scenes and ray sets,
 * and ties. */
#include "framework/compare/summary_private.h"

#include "framework/builder/tracers.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const double bb_summary_counts[BB_SUMMARY_COUNTS] = {1e5, 1e6, 1e7, 1e8, 1e9, 1e10};

double bb_summary_curve_count(uint32_t i)
{
    return pow(10, 0.25 * i);
}

bool bb_choice_takes(const bb_summary_choice *choice, const char *scene, const char *rays)
{
    return (choice->scene == NULL || strcmp(choice->scene, scene) == 0) &&
           (choice->rays == NULL || strcmp(choice->rays, rays) == 0);
}

/* ---- rows ---- */

/* Returns the row's cost divided by the best builder's, and whether the row is the best or tied
 * with it. */
static bb_standing stand(const bb_summary_view *v, uint32_t e, uint32_t best, const bb_measure *m)
{
    bb_standing s = {NAN, NAN, NAN, false, false};
    if (best == BB_NOBODY)
        return s;
    bb_mean ratio = bb_mean_ratio(v, e, best, m);
    s.value = ratio.value;
    s.low = ratio.rounds.low;
    s.high = ratio.rounds.high;
    s.best = e == best;
    s.tied = !s.best && !v->n->entrants[e].reference && v->whole[e] && !bb_leaves_out(v, e, m) &&
             bb_is_tie(&ratio);
    return s;
}

/* Returns the same as a speed in millions per second, from costs in ms. */
static bb_standing stand_as_rate(const bb_summary_view *v, uint32_t e, uint32_t best,
                                 const bb_measure *m)
{
    bb_standing s = stand(v, e, best, m);
    s.value = 1e-3 / bb_mean_ratio(v, e, BB_NOBODY, m).value;
    s.low = s.high = NAN;
    return s;
}

/* Shortens "name:key=value,key=value" for tables: drops the keys, and cuts the rest if need be. */
static void shorten(const char *text, double run, char name[BB_SUMMARY_NAME])
{
    enum { ROOM = 32 }; /* "embree-native:high,fast,packet16" */
    char whole[BB_SUMMARY_NAME * 4];
    size_t length = 0;
    snprintf(whole, sizeof whole, "%.240s", text);
    if (strlen(whole) > ROOM) {
        for (const char *at = text; *at != '\0' && length + 1 < sizeof whole;) {
            const char *key = at;
            while ((*key >= 'a' && *key <= 'z') || *key == '-' || *key == '_' ||
                   (*key >= '0' && *key <= '9'))
                key++;
            bool starts = at != text && (at[-1] == ':' || at[-1] == ',');
            if (starts && *key == '=')
                at = key + 1;
            else
                whole[length++] = *at++;
        }
        whole[length] = '\0';
    }
    char number[24] = "";
    if (run > 0)
        snprintf(number, sizeof number, run < 1e4 ? " #%.0f" : " #...", run + 1);
    int room = ROOM - (int)strlen(number), size = (int)strlen(whole), start = room - 10;
    if (size <= room) {
        snprintf(name, BB_SUMMARY_NAME, "%s%s", whole, number);
        return;
    }
    int end = size - 8; /* where the omission ends; no UTF-8 character is cut */
    while (start > 0 && ((unsigned char)whole[start] & 0xC0) == 0x80)
        start--;
    while (((unsigned char)whole[end] & 0xC0) == 0x80)
        end++;
    snprintf(name, BB_SUMMARY_NAME, "%.*s..%s%s", start, whole, whole + end, number);
}

/* Returns the kernel that is this entrant's fastest on most ray sets. */
static const char *find_favourite(const bb_summary_view *v, uint32_t e)
{
    const char *best = NULL;
    uint32_t most = 0;
    for (uint32_t s = 0; s < v->n->set_count; s++) {
        const bb_candidate *c = v->sets[s] ? bb_fastest(v, e, s, 0) : NULL;
        uint32_t times = 0;
        for (uint32_t t = 0; c != NULL && t < v->n->set_count; t++) {
            const bb_candidate *other = v->sets[t] ? bb_fastest(v, e, t, 0) : NULL;
            times += other != NULL && strcmp(other->kernel, c->kernel) == 0;
        }
        if (times > most) {
            most = times;
            best = c->kernel;
        }
    }
    return best;
}

static void add_bytes(const bb_summary_view *v, uint32_t e, bb_summary_row *row)
{
    row->tree = row->peak = NAN;
    for (uint32_t s = 0; s < v->n->scene_count; s++)
        if (v->scenes[s] && bb_built_of(v, e, s)->ok) {
            row->tree = fmax(row->tree, bb_built_of(v, e, s)->tree);
            row->peak = fmax(row->peak, bb_built_of(v, e, s)->peak);
        }
}

/* The best builder of each column. */
typedef struct best {
    uint32_t build, ready, quality, overlap, work, image[BB_SUMMARY_COUNTS],
        curve[BB_SUMMARY_CURVE];
    uint32_t base; /* what traces are divided by: a builder or BB_FASTEST_REFERENCE */
} best;

static void fill_row(const bb_summary_view *v, uint32_t e, const best *of, bb_summary_row *row)
{
    const bb_measure trace = {BB_OF_TRACE, 0}, build = {BB_OF_BUILD, 0}, ready = {BB_OF_READY, 0},
                     quality = {BB_OF_QUALITY, 0}, work = {BB_OF_WORK, 0},
                     overlap = {BB_OF_OVERLAP, 0};
    const bb_entrant_row *entrant = &v->n->entrants[e];
    *row = (bb_summary_row){.builder = entrant->builder,
                            .run = entrant->run,
                            .reference = entrant->reference,
                            .group = UINT32_MAX,
                            .wrong = NAN};
    shorten(entrant->builder, entrant->run, row->name);
    if (v->favourites[e] != NULL)
        snprintf(row->kernel, sizeof row->kernel, "%s", v->favourites[e]);
    bb_mean own = bb_mean_ratio(v, e, BB_NOBODY, &trace),
            speed = {.value = NAN, .rounds = bb_not_measured};
    row->sets = own.units;
    for (uint32_t i = 0; entrant->reference && i < v->n->set_count; i++) {
        const bb_candidate *fastest = v->sets[i] ? bb_fastest_reference(v, i, entrant->run) : NULL;
        row->yardstick += fastest != NULL && fastest->entrant == e;
    }
    row->mrays_s = 1e3 / own.value;
    if (of->base != BB_NOBODY)
        speed = bb_mean_ratio(v, of->base, e, &trace);
    row->trace = (bb_standing){speed.value, speed.rounds.low, speed.rounds.high, false, false};
    row->partial = !v->whole[e];
    row->untimed = v->untimed[e];
    row->leaves_out = bb_leaves_out(v, e, &build);
    row->build = stand_as_rate(v, e, of->build, &build);
    row->ready = stand_as_rate(v, e, of->ready, &ready);
    row->quality = stand(v, e, of->quality, &quality);
    row->overlap = stand(v, e, of->overlap, &overlap);
    row->work = stand(v, e, of->work, &work);
    for (uint32_t k = 0; k < BB_SUMMARY_COUNTS; k++)
        row->image[k] = stand(v, e, of->image[k], &(bb_measure){BB_OF_IMAGE, bb_summary_counts[k]});
    for (uint32_t i = 0; i < BB_SUMMARY_CURVE; i++) {
        const bb_measure image = {BB_OF_IMAGE, bb_summary_curve_count(i)};
        const bb_standing standing = stand(v, e, of->curve[i], &image);
        row->curve[i] = standing.value;
        row->curve_first[i] = standing.best || standing.tied;
    }
    add_bytes(v, e, row);
}

/* Sorts by merit: references last, rows that are partial or lack figures after complete ones. */
static int by_merit(const void *a, const void *b)
{
    const bb_summary_row *x = a, *y = b;
    if (x->reference != y->reference)
        return x->reference ? 1 : -1;
    if (x->partial != y->partial)
        return x->partial ? 1 : -1;
    double p = isfinite(x->trace.value) ? x->trace.value : -1;
    double q = isfinite(y->trace.value) ? y->trace.value : -1;
    if (p != q)
        return p > q ? -1 : 1;
    p = isfinite(x->build.value) ? x->build.value : -1;
    q = isfinite(y->build.value) ? y->build.value : -1;
    if (p != q)
        return p > q ? -1 : 1;
    int order = strcmp(x->builder, y->builder);
    return order != 0 ? order : (x->run > y->run) - (x->run < y->run);
}

static uint32_t entrant_of(const bb_summary_view *v, const bb_summary_row *row)
{
    for (uint32_t e = 0; e < v->n->entrant_count; e++)
        if (v->n->entrants[e].builder == row->builder && v->n->entrants[e].run == row->run)
            return e;
    return BB_NOBODY;
}

/* Groups builders that this run cannot tell from the first, fastest one of their group. */
static void group_rows(const bb_summary_view *v, bb_summary *s)
{
    const bb_measure trace = {BB_OF_TRACE, 0};
    uint32_t first = BB_NOBODY, group = 0;
    for (uint32_t i = 0; i < s->builder_count; i++) {
        bb_summary_row *row = &s->rows[i];
        if (!isfinite(row->trace.value) || row->partial)
            break;
        uint32_t e = entrant_of(v, row);
        bb_mean ratio = bb_mean_ratio(v, e, first != BB_NOBODY ? first : e, &trace);
        if (first == BB_NOBODY || !bb_is_tie(&ratio)) {
            group += first != BB_NOBODY;
            first = e;
        }
        row->group = group;
        row->trace.best = i == 0;
        row->trace.tied = i > 0 && group == 0;
    }
}

/* ---- what was wrong, and how sure it is ---- */

static bb_summary_row *find_row(bb_summary *s, const bb_entry *entry, bb_field_id builder)
{
    for (uint32_t i = 0; i < s->row_count; i++)
        if (s->rows[i].run == bb_run_of(entry) &&
            strcmp(s->rows[i].builder, bb_get_text(entry, builder)) == 0)
            return &s->rows[i];
    return NULL;
}

static void count_wrong(const bb_numbers *n, const bb_summary_choice *choice, bb_summary *s)
{
    bb_each(entry, bb_results_section(n->results, BB_TRACES))
    {
        bb_summary_row *row = find_row(s, entry, BB_F_TRACE_BUILDER);
        bool ours = bb_get_true(entry, BB_F_TRACE_COUNTS);
        if (row == NULL || !bb_choice_takes(choice, bb_get_text(entry, BB_F_TRACE_SCENE),
                                            bb_get_text(entry, BB_F_TRACE_RAYS)))
            continue;
        row->failed += !bb_is_ok(entry);
        double checked = bb_get_number(entry, BB_F_ACCURACY_CHECKED);
        double ppm = bb_get_number(entry, BB_F_ACCURACY_WRONG_PPM);
        double unlike = fmax(0, bb_get_number(entry, BB_F_TRACE_UNLIKE));
        bool judged = checked > 0 && isfinite(ppm);
        if (!(ours || row->reference) || !(judged || unlike > 0))
            continue;
        checked = judged ? checked : 0;
        double wrong = (judged ? round(ppm * checked / 1e6) : 0) + unlike;
        row->wrong = (isfinite(row->wrong) ? row->wrong : 0) + wrong;
        row->checked += checked;
        s->checked += row->reference ? 0 : checked;
        s->wrong += row->reference ? 0 : wrong;
    }
    for (uint32_t i = 0; i < n->set_count; i++)
        if (bb_choice_takes(choice, n->scenes[n->sets[i].scene], n->sets[i].rays))
            s->distinct += n->sets[i].judged;
    bb_each(entry, bb_results_section(n->results, BB_BUILDS))
    {
        bb_summary_row *row = find_row(s, entry, BB_F_BUILD_BUILDER);
        if (row != NULL && !bb_is_ok(entry) &&
            (choice->scene == NULL ||
             strcmp(choice->scene, bb_get_text(entry, BB_F_BUILD_SCENE)) == 0))
            row->failed++;
    }
}

static int by_value(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Sets median and worst tenth of the intervals' widths, and the fewest rounds. */
static bb_status find_noise(const bb_summary_view *v, bb_summary *s)
{
    double *widths = calloc(v->n->candidate_count + 1, sizeof *widths);
    uint32_t count = 0;
    if (widths == NULL)
        return bb_fail(BB_FAILED, "summary: no memory");
    s->noise = s->noise_worst = NAN;
    s->rounds = UINT32_MAX;
    for (uint32_t i = 0; i < v->n->candidate_count; i++) {
        const bb_candidate *c = &v->n->candidates[i];
        uint32_t rounds = c->ns_all.count > 1 ? c->ns_all.count - 1 : c->ns_all.count;
        if (!v->sets[c->set])
            continue;
        s->rounds = rounds < s->rounds ? rounds : s->rounds;
        if (isfinite(c->low) && isfinite(c->high))
            widths[count++] = 0.5 * (c->high - c->low) * c->ns * 1e-3;
    }
    if (s->rounds == UINT32_MAX)
        s->rounds = 0;
    qsort(widths, count, sizeof *widths, by_value);
    if (count > 0) {
        s->noise = widths[count / 2];
        s->noise_worst = widths[(uint64_t)count * 9 / 10];
    }
    free(widths);
    return BB_OK;
}

/* ---- a summary ---- */

/* Chooses the ray sets that at least half of the builders traced, scenes likewise, and the entrants
 * that take part. */
static void choose_sets(bb_summary_view *v, const bb_summary_choice *choice, bool *enters,
                        bb_summary *s)
{
    const bb_numbers *n = v->n;
    uint32_t builders = 0;
    for (uint32_t c = 0; c < n->scene_count; c++) {
        bool chosen = choice->scene == NULL || strcmp(choice->scene, n->scenes[c]) == 0;
        for (uint32_t e = 0; chosen && e < n->entrant_count; e++)
            enters[e] = enters[e] || bb_built_of(v, e, c)->there;
    }
    for (uint32_t e = 0; e < n->entrant_count; e++)
        builders += enters[e] && !n->entrants[e].reference;
    for (uint32_t i = 0; i < n->set_count; i++) {
        uint32_t traced = 0;
        if (!bb_choice_takes(choice, n->scenes[n->sets[i].scene], n->sets[i].rays))
            continue;
        for (uint32_t e = 0; e < n->entrant_count; e++)
            traced += !n->entrants[e].reference && bb_fastest(v, e, i, 0) != NULL;
        v->sets[i] = 2 * traced >= builders;
        s->sets += v->sets[i];
        s->sets_aside += !v->sets[i];
    }
    for (uint32_t c = 0; c < n->scene_count; c++) {
        uint32_t built = 0;
        bool chosen = choice->scene == NULL || strcmp(choice->scene, n->scenes[c]) == 0;
        for (uint32_t e = 0; e < n->entrant_count; e++)
            built += !n->entrants[e].reference && bb_built_of(v, e, c)->ok;
        v->scenes[c] = chosen && s->sets == 0 && 2 * built >= builders;
        for (uint32_t i = 0; i < n->set_count; i++)
            v->scenes[c] = v->scenes[c] || (v->sets[i] && n->sets[i].scene == c);
        s->scenes += v->scenes[c];
    }
}

/* Whether two chosen sets are of one view and kind, so that only size or seed tells them apart. */
static bool any_differ(const bb_summary_view *v)
{
    const bb_summary_set *sets = v->n->sets;
    for (uint32_t i = 0; i < v->n->set_count; i++)
        for (uint32_t k = 0; k < i; k++)
            if (v->sets[i] && v->sets[k] && sets[i].scene == sets[k].scene &&
                strcmp(sets[i].rays, sets[k].rays) == 0 && strcmp(sets[i].view, sets[k].view) == 0)
                return true;
    return false;
}

/* Finds the entrants that have all ray sets and scenes: one that lacks hard scenes would look
 * better than it is. */
static void find_whole(bb_summary_view *v, const bool *enters)
{
    for (uint32_t e = 0; e < v->n->entrant_count; e++) {
        v->whole[e] = enters[e];
        for (uint32_t i = 0; i < v->n->set_count; i++)
            v->whole[e] = v->whole[e] && (!v->sets[i] || bb_fastest(v, e, i, 0) != NULL);
        for (uint32_t c = 0; c < v->n->scene_count; c++)
            v->whole[e] = v->whole[e] && (!v->scenes[c] || bb_built_of(v, e, c)->ok);
    }
}

static void find_untimed(bb_summary_view *v)
{
    for (uint32_t e = 0; e < v->n->entrant_count; e++)
        for (uint32_t c = 0; c < v->n->scene_count; c++) {
            const bb_built *build = bb_built_of(v, e, c);
            if (v->scenes[c] && build->ok && build->untimed_ms > BB_UNTIMED_LEAST_MS)
                v->untimed[e] = fmax(v->untimed[e], build->untimed_ms / build->build_ms);
        }
}

static void find_best(const bb_summary_view *v, bool referenced, best *of)
{
    of->build = bb_best_builder(v, &(bb_measure){BB_OF_BUILD, 0});
    of->ready = bb_best_builder(v, &(bb_measure){BB_OF_READY, 0});
    of->quality = bb_best_builder(v, &(bb_measure){BB_OF_QUALITY, 0});
    of->overlap = bb_best_builder(v, &(bb_measure){BB_OF_OVERLAP, 0});
    of->work = bb_best_builder(v, &(bb_measure){BB_OF_WORK, 0});
    for (uint32_t k = 0; k < BB_SUMMARY_COUNTS; k++)
        of->image[k] = bb_best_builder(v, &(bb_measure){BB_OF_IMAGE, bb_summary_counts[k]});
    for (uint32_t i = 0; i < BB_SUMMARY_CURVE; i++)
        of->curve[i] = bb_best_builder(v, &(bb_measure){BB_OF_IMAGE, bb_summary_curve_count(i)});
    of->base =
        referenced ? BB_FASTEST_REFERENCE : bb_best_builder(v, &(bb_measure){BB_OF_TRACE, 0});
}

/* Whether the entrant traced ray sets, and none of those that are compared. */
static bool is_aside(const bb_summary_view *v, uint32_t e)
{
    bool aside = false;
    for (uint32_t i = 0; i < v->n->set_count; i++) {
        const bool traced = bb_fastest(v, e, i, 0) != NULL;
        if (traced && v->sets[i])
            return false;
        aside = aside || traced;
    }
    return aside;
}

/* Leaves out the rows of such entrants, unless something was wrong with them. */
static void drop_aside(const bb_summary_view *v, bb_summary *s)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < s->row_count; i++) {
        const bb_summary_row *row = &s->rows[i];
        const bool well = row->failed == 0 && !(row->wrong > 0);
        if (well && s->sets > 0 && is_aside(v, entrant_of(v, row)))
            s->builder_count -= !row->reference;
        else
            s->rows[kept++] = *row;
    }
    s->row_count = kept;
}

static bb_status make_rows(bb_summary_view *v, const bb_summary_choice *choice, bool *enters,
                           bb_summary *s)
{
    best of;
    const char *reference = bb_results_reference(v->n->results);
    choose_sets(v, choice, enters, s);
    s->sets_differ = any_differ(v);
    find_whole(v, enters);
    find_untimed(v);
    for (uint32_t i = 0; i < v->n->set_count; i++)
        for (uint32_t e = 0; e < v->n->entrant_count; e++)
            if (v->sets[i] && bb_is_reference(v->n->entrants[e].builder) &&
                bb_fastest(v, e, i, 0) != NULL)
                s->reference = reference;
    for (uint32_t e = 0; e < v->n->entrant_count; e++)
        v->favourites[e] = find_favourite(v, e);
    find_best(v, s->reference != NULL, &of);
    for (uint32_t e = 0; e < v->n->entrant_count; e++) {
        if (!enters[e])
            continue;
        s->builder_count += !v->n->entrants[e].reference;
        fill_row(v, e, &of, &s->rows[s->row_count++]);
    }
    qsort(s->rows, s->row_count, sizeof *s->rows, by_merit);
    group_rows(v, s);
    count_wrong(v->n, choice, s);
    drop_aside(v, s);
    return find_noise(v, s);
}

bb_status bb_summary_of(const bb_numbers *numbers, const bb_summary_choice *choice,
                        bb_summary *summary)
{
    memset(summary, 0, sizeof *summary);
    bb_summary_view v = {.n = numbers};
    v.sets = calloc(numbers->set_count + 1, sizeof *v.sets);
    v.scenes = calloc(numbers->scene_count + 1, sizeof *v.scenes);
    v.favourites = calloc(numbers->entrant_count + 1, sizeof *v.favourites);
    v.whole = calloc(numbers->entrant_count + 1, sizeof *v.whole);
    v.untimed = calloc(numbers->entrant_count + 1, sizeof *v.untimed);
    bool *enters = calloc(numbers->entrant_count + 1, sizeof *enters);
    summary->rows = calloc(numbers->entrant_count + 1, sizeof *summary->rows);
    bb_status status = BB_OK;
    if (v.sets == NULL || v.scenes == NULL || v.favourites == NULL || v.whole == NULL ||
        v.untimed == NULL || enters == NULL || summary->rows == NULL)
        status = bb_fail(BB_FAILED, "summary: no memory");
    if (status == BB_OK)
        status = make_rows(&v, choice, enters, summary);
    if (status == BB_OK)
        status = bb_summary_accuracies(numbers->results, choice, summary);
    if (status == BB_OK)
        status = bb_summary_simulations(numbers->results, choice, summary);
    if (status == BB_OK) {
        bb_summary_say(summary);
        status = bb_summary_say_predictions(numbers->results, choice, summary);
    }
    if (status != BB_OK)
        bb_summary_free(summary);
    free(v.sets);
    free(v.scenes);
    free(v.favourites);
    free(v.whole);
    free(v.untimed);
    free(enters);
    return status;
}

bb_status bb_summary_make(const bb_results *results, const bb_summary_choice *choice,
                          bb_summary *summary)
{
    bb_numbers numbers;
    BB_TRY(bb_numbers_read(results, &numbers));
    bb_status status = bb_summary_of(&numbers, choice, summary);
    bb_numbers_free(&numbers);
    return status;
}

void bb_summary_free(bb_summary *summary)
{
    free(summary->rows);
    free(summary->accuracy);
    for (uint32_t i = 0; i < summary->simulation_count; i++) {
        free(summary->simulations[i].mrays_s);
        free(summary->simulations[i].binds);
    }
    memset(summary, 0, sizeof *summary);
}
