/* Costs of builders on scenes and ray sets, their geometric means, and whether rounds tell two
 * apart. */
#include "framework/compare/summary_private.h"

#include "framework/builder/tracers.h"

#include <string.h>

typedef struct cost {
    double median; /* NAN: none */
    bb_samples all;
} cost;

const bb_built *bb_built_of(const bb_summary_view *v, uint32_t e, uint32_t scene)
{
    return &v->n->builds[(size_t)e * v->n->scene_count + scene];
}

/* Returns the time of build and layout in ms; NAN if one is not known. *all gets the same for each
 * round, with the medians of what was not timed in rounds, such as the layout. */
static double ready_ms(const bb_summary_view *v, const bb_candidate *c, bb_samples *all)
{
    const bb_built *b = bb_built_of(v, c->entrant, c->scene);
    if (!b->ok)
        return NAN;
    if (all != NULL) {
        *all = b->fixed_all;
        for (uint32_t i = 0; i < all->count; i++)
            all->values[i] += c->layout_ms;
    }
    return b->fixed_ms + c->layout_ms;
}

/* Returns a + factor * b for each round; empty if the numbers of rounds differ. */
static bb_samples sum(const bb_samples *a, double factor, const bb_samples *b)
{
    bb_samples all = {0};
    for (uint32_t i = 0; i < a->count && a->count == b->count; i++)
        bb_samples_add(&all, a->values[i] + factor * b->values[i]);
    return all;
}

static double image_ms(const bb_summary_view *v, const bb_candidate *c, double rays)
{
    return ready_ms(v, c, NULL) + rays * c->ns * 1e-6;
}

/* The entrant's candidate of least cost for `rays` rays (0: by the trace alone); NULL if it has
 * none. */
const bb_candidate *bb_fastest(const bb_summary_view *v, uint32_t e, uint32_t set, double rays)
{
    const bb_candidate *best = NULL;
    const uint32_t *start = &v->n->starts[(size_t)e * v->n->set_count + set];
    for (uint32_t i = start[0]; i < start[1]; i++) {
        const bb_candidate *c = &v->n->candidates[i];
        if (rays == 0 ? best == NULL || c->ns < best->ns
                      : isfinite(image_ms(v, c, rays)) &&
                            (best == NULL || image_ms(v, c, rays) < image_ms(v, best, rays)))
            best = c;
    }
    return best;
}

const bb_candidate *bb_fastest_reference(const bb_summary_view *v, uint32_t set, double run)
{
    const bb_candidate *best = NULL;
    for (uint32_t e = 0; e < v->n->entrant_count; e++) {
        const bb_entrant_row *entrant = &v->n->entrants[e];
        bool takes_part = bb_is_reference(entrant->builder) && entrant->run == run;
        const bb_candidate *c = takes_part ? bb_fastest(v, e, set, 0) : NULL;
        if (c != NULL && (best == NULL || c->ns < best->ns))
            best = c;
    }
    return best;
}

/* Returns a candidate of the kernel that is most often the builder's fastest. */
static const bb_candidate *favourite(const bb_summary_view *v, uint32_t e, uint32_t scene)
{
    for (uint32_t i = 0; i < v->n->candidate_count; i++) {
        const bb_candidate *c = &v->n->candidates[i];
        if (c->entrant == e && c->scene == scene && v->favourites[e] != NULL &&
            strcmp(c->kernel, v->favourites[e]) == 0)
            return c;
    }
    return NULL;
}

static bool per_scene(const bb_measure *m)
{
    return m->quantity == BB_OF_BUILD || m->quantity == BB_OF_READY ||
           m->quantity == BB_OF_QUALITY || m->quantity == BB_OF_OVERLAP;
}

/* Returns the cost of an entrant on a scene. */
static cost cost_on_scene(const bb_summary_view *v, uint32_t e, uint32_t scene, const bb_measure *m)
{
    const bb_built *b = bb_built_of(v, e, scene);
    cost found = {.median = NAN};
    if (!b->ok)
        return found;
    if (m->quantity == BB_OF_QUALITY || m->quantity == BB_OF_OVERLAP) {
        found.median = m->quantity == BB_OF_QUALITY ? b->quality : b->overlap;
        return found;
    }
    found.median = b->build_ms;
    found.all = b->build_all;
    if (m->quantity == BB_OF_READY) {
        const bb_candidate *c = favourite(v, e, scene);
        found.median = c != NULL ? ready_ms(v, c, &found.all) : NAN;
    }
    found.median /= b->prims;
    for (uint32_t i = 0; i < found.all.count; i++)
        found.all.values[i] /= b->prims;
    return found;
}

static double least_work(const bb_summary_view *v, uint32_t e, uint32_t set)
{
    const uint32_t *start = &v->n->starts[(size_t)e * v->n->set_count + set];
    double least = NAN;
    for (uint32_t i = start[0]; i < start[1]; i++)
        least = fmin(least, v->n->candidates[i].work);
    return least;
}

static cost cost_on_rays(const bb_summary_view *v, uint32_t e, uint32_t set, const bb_measure *m,
                         double run)
{
    cost found = {.median = NAN};
    if (m->quantity == BB_OF_WORK) {
        found.median = least_work(v, e, set);
        return found;
    }
    const bb_candidate *c = e == BB_FASTEST_REFERENCE
                                ? bb_fastest_reference(v, set, run)
                                : bb_fastest(v, e, set, m->quantity == BB_OF_IMAGE ? m->rays : 0);
    if (c == NULL)
        return found;
    if (m->quantity == BB_OF_TRACE) {
        found.median = c->ns;
        found.all = c->ns_all;
        return found;
    }
    bb_samples ready = {0};
    found.median = ready_ms(v, c, &ready) + m->rays * c->ns * 1e-6;
    found.all = sum(&ready, m->rays * 1e-6, &c->ns_all);
    return found;
}

static uint32_t unit_count(const bb_summary_view *v, const bb_measure *m)
{
    return per_scene(m) ? v->n->scene_count : v->n->set_count;
}

/* Returns the cost of an entrant on a unit, a scene or a ray set. `run`: whose fastest
 * reference is meant. */
static cost cost_of(const bb_summary_view *v, uint32_t e, uint32_t unit, const bb_measure *m,
                    double run)
{
    bool enters = per_scene(m) ? v->scenes[unit] : v->sets[unit];
    if (!enters)
        return (cost){.median = NAN};
    return per_scene(m) ? cost_on_scene(v, e, unit, m) : cost_on_rays(v, e, unit, m, run);
}

/* ---- means ---- */

bb_mean bb_mean_ratio(const bb_summary_view *v, uint32_t a, uint32_t b, const bb_measure *m)
{
    bb_mean result = {.value = 0, .rounds = bb_not_measured};
    bb_samples logs = {0};
    /* rounds of different runs cannot be paired */
    bool rounds = a == BB_FASTEST_REFERENCE || b == BB_NOBODY ||
                  v->n->entrants[a].run == v->n->entrants[b].run;
    const double run = v->n->entrants[a == BB_FASTEST_REFERENCE ? b : a].run;
    for (uint32_t u = 0; u < unit_count(v, m); u++) {
        cost x = cost_of(v, a, u, m, run), y = {.median = 1};
        if (b != BB_NOBODY)
            y = cost_of(v, b, u, m, run);
        if (!(x.median > 0) || !(y.median > 0))
            continue;
        result.value += log(x.median / y.median);
        bb_samples ratios = b != BB_NOBODY ? bb_samples_ratio(&x.all, &y.all) : x.all;
        if (result.units++ == 0)
            logs.count = ratios.count;
        rounds = rounds && ratios.count == logs.count && ratios.count > 0;
        for (uint32_t i = 0; rounds && i < ratios.count; i++)
            logs.values[i] += log(ratios.values[i]);
    }
    if (result.units == 0)
        result.value = NAN;
    else
        result.value = exp(result.value / result.units);
    if (!rounds || result.units == 0)
        return result;
    for (uint32_t i = 0; i < logs.count; i++)
        logs.values[i] = exp(logs.values[i] / result.units);
    result.rounds = bb_samples_estimate(&logs);
    return result;
}

bool bb_is_tie(const bb_mean *ratio)
{
    return isfinite(ratio->rounds.low) && ratio->rounds.low <= 1 && ratio->rounds.high >= 1;
}

bool bb_leaves_out(const bb_summary_view *v, uint32_t e, const bb_measure *m)
{
    return v->untimed[e] > BB_UNTIMED_MOST &&
           (m->quantity == BB_OF_BUILD || m->quantity == BB_OF_READY || m->quantity == BB_OF_IMAGE);
}

uint32_t bb_best_builder(const bb_summary_view *v, const bb_measure *m)
{
    uint32_t best = BB_NOBODY;
    double least = INFINITY;
    for (uint32_t e = 0; e < v->n->entrant_count; e++) {
        if (!v->whole[e] || v->n->entrants[e].reference || bb_leaves_out(v, e, m))
            continue;
        bb_mean own = bb_mean_ratio(v, e, BB_NOBODY, m);
        if (own.value < least) {
            best = e;
            least = own.value;
        }
    }
    return best;
}
