/* Reads the numbers of results once: entrants, ray sets and times. */
#include "framework/compare/prediction.h"
#include "framework/compare/summary_private.h"

#include <stdlib.h>
#include <string.h>

static uint32_t find_scene(const bb_numbers *n, const char *name)
{
    for (uint32_t s = 0; s < n->scene_count; s++)
        if (strcmp(n->scenes[s], name) == 0)
            return s;
    return UINT32_MAX;
}

static uint32_t find_entrant(const bb_numbers *n, const char *builder, double run)
{
    for (uint32_t e = 0; e < n->entrant_count; e++)
        if (n->entrants[e].run == run && strcmp(n->entrants[e].builder, builder) == 0)
            return e;
    return UINT32_MAX;
}

static uint32_t find_set(const bb_numbers *n, uint32_t scene, const char *rays, const char *view,
                         const char *hash)
{
    for (uint32_t s = 0; s < n->set_count; s++)
        if (n->sets[s].scene == scene && strcmp(n->sets[s].rays, rays) == 0 &&
            strcmp(n->sets[s].view, view) == 0 && strcmp(n->sets[s].hash, hash) == 0)
            return s;
    return UINT32_MAX;
}

static bb_samples scaled(const bb_samples *samples, double factor)
{
    bb_samples all = {0};
    for (uint32_t i = 0; i < samples->count; i++)
        bb_samples_add(&all, samples->values[i] * factor);
    return all;
}

static bb_samples samples_of(const bb_entry *entry, bb_field_id field)
{
    bb_samples samples = {0};
    if (!bb_get_samples(entry, field, &samples))
        samples.count = 0;
    return samples;
}

static double or_zero(double value)
{
    return isfinite(value) ? value : 0;
}

/* Reads a build. Times of steps that it does not need count as 0: a reference makes its boxes
 * inside its build and needs no transfer. */
static void read_build(const bb_results *results, const bb_entry *build, bb_built *b)
{
    const bb_entry *scene = bb_results_scene(results, bb_get_text(build, BB_F_BUILD_SCENE));
    double native = bb_get_number(build, BB_F_BUILD_BYTES_NATIVE);
    b->build_ms = bb_get_number(build, BB_F_BUILD_MS_MEDIAN);
    b->untimed_ms = or_zero(bb_get_number(build, BB_F_BUILD_UNTIMED));
    b->there = true;
    b->ok = bb_is_ok(build) && b->build_ms > 0;
    b->build_all = samples_of(build, BB_F_BUILD_MS);
    double more = or_zero(bb_get_number(build, BB_F_BUILD_BOXES_MS)) +
                  or_zero(bb_get_number(build, BB_F_BUILD_TRANSFER_MS));
    b->fixed_ms = b->build_ms + more;
    b->fixed_all = b->build_all;
    for (uint32_t i = 0; i < b->fixed_all.count; i++)
        b->fixed_all.values[i] += more;
    double prims = bb_get_number(scene, BB_F_SCENE_PRIMS);
    b->prims = prims > 0 ? prims : (double)NAN;
    b->quality = bb_get_metric(build, bb_metrics[bb_metric_of_layouts()]);
    b->overlap = bb_prediction_overlap(build);
    b->tree = isfinite(native) ? native : bb_get_number(build, BB_F_TREE_BYTES);
    b->peak = isfinite(native) ? native : bb_get_number(build, BB_F_TREE_BYTES_PEAK);
}

/* Returns whether a trace may rank: the answers must be right. Tracers may lose some rays, but one
 * that loses most is fast for that reason. */
static bool may_rank(const bb_entry *trace)
{
    const double most_wrong_ppm = 10000;
    double rate = bb_get_number(trace, BB_F_TRACE_RATE);
    if (!bb_is_ok(trace) || !(rate > 0) || !(bb_get_number(trace, BB_F_TRACE_COUNT) > 0))
        return false;
    if (bb_get_true(trace, BB_F_TRACE_REFERENCE))
        return !(bb_get_number(trace, BB_F_ACCURACY_WRONG_PPM) > most_wrong_ppm);
    return bb_get_true(trace, BB_F_TRACE_COUNTS) && !bb_get_true(trace, BB_F_TRACE_WRONG) &&
           isfinite(bb_get_number(trace, BB_F_ACCURACY_WRONG_PPM)) &&
           !(bb_get_number(trace, BB_F_TRACE_UNLIKE) > 0);
}

static void read_trace(const bb_entry *trace, const bb_entry *build, bb_candidate *c)
{
    const char *layout = bb_get_text(trace, BB_F_TRACE_LAYOUT);
    bb_samples ms = samples_of(trace, BB_F_TRACE_MS);
    c->ns = 1e3 / bb_get_number(trace, BB_F_TRACE_RATE);
    c->ns_all = scaled(&ms, 1e6 / bb_get_number(trace, BB_F_TRACE_COUNT));
    c->low = bb_get_number(trace, BB_F_TRACE_RATE_LO);
    c->high = bb_get_number(trace, BB_F_TRACE_RATE_HI);
    c->kernel = bb_get_text(trace, BB_F_TRACE_KERNEL);
    c->work = bb_get_number(trace, BB_F_TRACE_WORK);
    if (bb_get_true(trace, BB_F_TRACE_REFERENCE))
        return;
    c->layout_ms = bb_get_named(build, BB_F_BUILD_LAYOUTS_MS, layout);
}

static bb_status read_builds(bb_numbers *n, const bb_section *builds)
{
    bb_each(build, builds)
    {
        const char *name = bb_get_text(build, BB_F_BUILD_BUILDER);
        const char *scene = bb_get_text(build, BB_F_BUILD_SCENE);
        double run = bb_run_of(build);
        if (find_scene(n, scene) == UINT32_MAX)
            n->scenes[n->scene_count++] = scene;
        if (find_entrant(n, name, run) == UINT32_MAX)
            n->entrants[n->entrant_count++] =
                (bb_entrant_row){name, run, bb_get_true(build, BB_F_BUILD_REFERENCE)};
    }
    size_t cells = (size_t)n->entrant_count * n->scene_count;
    n->builds = calloc(cells + 1, sizeof *n->builds);
    if (n->builds == NULL)
        return bb_fail(BB_FAILED, "summary: no memory");
    bb_each(build, builds)
    {
        uint32_t e = find_entrant(n, bb_get_text(build, BB_F_BUILD_BUILDER), bb_run_of(build));
        uint32_t s = find_scene(n, bb_get_text(build, BB_F_BUILD_SCENE));
        read_build(n->results, build, &n->builds[(size_t)e * n->scene_count + s]);
    }
    return BB_OK;
}

static void read_traces(bb_numbers *n, const bb_section *traces)
{
    bb_each(trace, traces)
    {
        const char *rays = bb_get_text(trace, BB_F_TRACE_RAYS);
        const char *view = bb_get_text(trace, BB_F_TRACE_VIEW);
        const char *hash = bb_get_text(trace, BB_F_TRACE_RAYS_HASH);
        uint32_t scene = find_scene(n, bb_get_text(trace, BB_F_TRACE_SCENE));
        uint32_t entrant =
            find_entrant(n, bb_get_text(trace, BB_F_TRACE_BUILDER), bb_run_of(trace));
        if (scene == UINT32_MAX || entrant == UINT32_MAX || !may_rank(trace))
            continue;
        uint32_t set = find_set(n, scene, rays, view, hash);
        if (set == UINT32_MAX) {
            set = n->set_count++;
            n->sets[set] = (bb_summary_set){rays, view, hash, scene, 0};
        }
        if (!n->entrants[entrant].reference)
            n->sets[set].judged =
                fmax(n->sets[set].judged, bb_get_number(trace, BB_F_ACCURACY_CHECKED));
        bb_candidate *c = &n->candidates[n->candidate_count++];
        *c = (bb_candidate){.entrant = entrant, .set = set, .scene = scene};
        read_trace(trace, bb_build_of(trace), c);
    }
}

static int by_entrant_and_set(const void *a, const void *b)
{
    const bb_candidate *x = a, *y = b;
    if (x->entrant != y->entrant)
        return x->entrant < y->entrant ? -1 : 1;
    return (x->set > y->set) - (x->set < y->set);
}

/* Sorts the candidates. Those of entrant e and set s are from starts[e * set_count + s] to the next
 * start. */
static bb_status sort_candidates(bb_numbers *n)
{
    size_t cells = (size_t)n->entrant_count * n->set_count;
    n->starts = calloc(cells + 1, sizeof *n->starts);
    if (n->starts == NULL)
        return bb_fail(BB_FAILED, "summary: no memory");
    qsort(n->candidates, n->candidate_count, sizeof *n->candidates, by_entrant_and_set);
    for (uint32_t i = 0; i < n->candidate_count; i++)
        n->starts[(size_t)n->candidates[i].entrant * n->set_count + n->candidates[i].set + 1]++;
    for (size_t i = 0; i < cells; i++)
        n->starts[i + 1] += n->starts[i];
    return BB_OK;
}

bb_status bb_numbers_read(const bb_results *results, bb_numbers *numbers)
{
    const bb_section *builds = bb_results_section(results, BB_BUILDS);
    const bb_section *traces = bb_results_section(results, BB_TRACES);
    size_t build_count = (size_t)bb_section_count(builds) + 1;
    size_t trace_count = (size_t)bb_section_count(traces) + 1;
    *numbers = (bb_numbers){.results = results};
    numbers->entrants = calloc(build_count, sizeof *numbers->entrants);
    numbers->scenes = calloc(build_count, sizeof *numbers->scenes);
    numbers->sets = calloc(trace_count, sizeof *numbers->sets);
    numbers->candidates = calloc(trace_count, sizeof *numbers->candidates);
    bb_status status = BB_OK;
    if (numbers->entrants == NULL || numbers->scenes == NULL || numbers->sets == NULL ||
        numbers->candidates == NULL)
        status = bb_fail(BB_FAILED, "summary: no memory");
    if (status == BB_OK)
        status = read_builds(numbers, builds);
    if (status == BB_OK) {
        read_traces(numbers, traces);
        status = sort_candidates(numbers);
    }
    if (status != BB_OK)
        bb_numbers_free(numbers);
    return status;
}

void bb_numbers_free(bb_numbers *numbers)
{
    free(numbers->entrants);
    free(numbers->scenes);
    free(numbers->sets);
    free(numbers->candidates);
    free(numbers->builds);
    free(numbers->starts);
    memset(numbers, 0, sizeof *numbers);
}
