/* Predicts time and memory of a comparison from a small one. */
#include "framework/bench/forecast.h"

#include "framework/base/interrupt.h"
#include "framework/base/memory.h"
#include "framework/bench/bench_private.h"
#include "framework/simulate/simulate.h"
#include "framework/workload/workload.h"

#include <math.h>
#include <string.h>

enum {
    SIDE = 8,        /* the small pictures have one pixel for so many by so many */
    SIDE_LEAST = 16, /* but at least these sides */
    RAYS_LEAST = 512,
};

/* ---- time ---- */

/* What the time of a step grows with. Of rays it also grows with the depth of trees. */
typedef enum growth {
    WITH_PRIMS = 1,
    WITH_ROUNDS = 2,
    WITH_RAYS = 4,       /* of all ray sets */
    WITH_COUNTED = 8,    /* the rays that are counted of each set */
    WITH_SIMULATED = 16, /* the rays that are simulated of each set */
    WITH_PIXELS = 32,
} growth;

/* All others take as long as in the small comparison, as those of growth 0 do. */
static const struct {
    const char *step;
    unsigned growth;
} steps[] = {
    {"compile builders", 0}, /* by then the driver's cache has the programs */
    {"compile kernels", 0},
    {"upload scenes", WITH_PRIMS},
    {"oracle: build", WITH_PRIMS},
    {"make boxes", WITH_PRIMS},
    {"compile, allocate, first builds", WITH_PRIMS},
    {"prepare, restore, warm up", WITH_PRIMS | WITH_ROUNDS},
    {"unseen inputs", WITH_PRIMS},
    {"unseen rays", WITH_RAYS},
    {"builds for phase times", WITH_PRIMS},
    {"check trees, SAH", WITH_PRIMS},
    {"transfers", WITH_PRIMS},
    {"layouts", WITH_PRIMS | WITH_ROUNDS},
    {"oracle: prepare", WITH_PRIMS},
    {"make rays", WITH_RAYS},
    {"oracle: trace", WITH_RAYS},
    {"oracle: arbitrate", WITH_RAYS},
    {"poison and copy answers", WITH_RAYS | WITH_ROUNDS},
    {"judge answers", WITH_RAYS},
    {"count tests", WITH_COUNTED},
    {"simulate", WITH_SIMULATED},
    {"simulate builds", WITH_PRIMS},
    {"pictures", WITH_PIXELS},
};

bool bb_bench_knows_growth(const char *step)
{
    bool known = false;
    for (size_t i = 0; i < sizeof steps / sizeof steps[0]; i++)
        known = known || strcmp(steps[i].step, step) == 0;
    return known;
}

/* How many times as much there is of everything. */
typedef struct scale {
    double prims, rounds, rays, counted, simulated;
    double pixels; /* of pictures */
} scale;

static double grown(double ms, unsigned growth, const scale *by)
{
    if (!isfinite(ms))
        return 0;
    ms *= (growth & WITH_PRIMS) != 0 ? by->prims : 1;
    ms *= (growth & WITH_ROUNDS) != 0 ? by->rounds : 1;
    ms *= (growth & WITH_RAYS) != 0 ? by->rays : 1;
    ms *= (growth & WITH_SIMULATED) != 0 ? by->simulated : 1;
    ms *= (growth & WITH_PIXELS) != 0 ? by->pixels : 1;
    return ms * ((growth & WITH_COUNTED) != 0 ? by->counted : 1);
}

static double foretell_ms(const bb_results *small, const bb_bench_times *times, const scale *by)
{
    double ms = grown(times->build_ms, WITH_PRIMS | WITH_ROUNDS, by) +
                grown(times->trace_ms, WITH_RAYS | WITH_ROUNDS, by);
    double listed = 0;
    for (size_t i = 0; i < sizeof steps / sizeof steps[0]; i++) {
        const double step = bb_results_step_ms(small, steps[i].step);
        ms += grown(step, steps[i].growth, by);
        listed += isfinite(step) ? step : 0;
    }
    return ms + times->total_ms - times->build_ms - times->trace_ms - listed;
}

/* ---- requests that take less time ---- */

static uint32_t at_least(uint32_t small, uint32_t least, uint32_t all)
{
    return small > least ? small : least < all ? least : all;
}

bb_bench_request bb_bench_thrifty(const bb_bench_request *request, uint32_t thrift)
{
    static const struct {
        uint32_t side, repeats; /* side: of pictures, a part of it; 0 repeats: all */
        bool one_view;
    } thrifts[BB_THRIFTS] = {{1, 0, false}, {2, 0, false}, {4, 0, false},
                             {4, 0, true},  {8, 0, true},  {8, 2, true}};
    const uint32_t side = thrifts[thrift].side, repeats = thrifts[thrift].repeats;
    bb_bench_request less = *request;
    less.width = at_least(request->width / side, SIDE_LEAST, request->width);
    less.height = at_least(request->height / side, SIDE_LEAST, request->height);
    less.max_rays = at_least(request->max_rays / (side * side), RAYS_LEAST, request->max_rays);
    if (thrifts[thrift].one_view)
        less.max_views = 1;
    if (repeats > 0 && repeats < less.repeats)
        less.repeats = repeats;
    return less;
}

/* ---- the small comparison ---- */

static bb_bench_request small_request(const bb_bench_request *of, const bb_scene *scene,
                                      bb_scene *sample, char *const *text)
{
    bb_bench_request small = *of;
    small.apart = bb_bench_is_apart(of, scene->prim_count);
    small.scenes = text;
    small.scene_count = 1;
    small.scene = sample;
    small.oracle = NULL;
    small.width = at_least(of->width / SIDE, SIDE_LEAST, of->width);
    small.height = at_least(of->height / SIDE, SIDE_LEAST, of->height);
    small.max_rays = at_least(of->max_rays / (SIDE * SIDE), RAYS_LEAST, of->max_rays);
    small.max_views = 1;
    small.repeats = 1;
    small.shard = NULL;
    small.tell = NULL;
    small.quiet = true;
    return small;
}

/* Returns the rays of each set of a workload, and in *sets how many there are. */
static double rays_of_set(const bb_bench_request *request, uint32_t w, const bb_scene *scene,
                          uint32_t *sets)
{
    bb_spec spec;
    const bb_workload *workload;
    uint64_t rays;
    *sets = 0;
    if (bb_workload_parse(request->workloads[w], &spec, &workload) != BB_OK ||
        bb_workload_most(request->workloads[w], request->width, request->height, request->max_rays,
                         &rays) != BB_OK)
        return 0; /* bb_bench_check() refuses it */
    const uint32_t most = request->max_views, all = scene->view_count;
    *sets = !workload->per_view ? 1 : most > 0 && most < all ? most : all;
    return (double)rays;
}

/* Returns the rays of all sets of the scene, of each set at most `most`. */
static double rays_of(const bb_bench_request *request, const bb_scene *scene, double most)
{
    double all = 0;
    uint32_t sets;
    for (uint32_t w = 0; w < request->workload_count; w++) {
        const double rays = rays_of_set(request, w, scene, &sets);
        all += sets * fmin(rays, most);
    }
    return request->shard != NULL ? all / request->shard->count : all;
}

static double ratio(double whole, double small)
{
    return small > 0 ? whole / small : 0;
}

/* How many times as many rays there are of all sets, of each at most `most`. */
static double more_of(const bb_bench_request *whole, const bb_bench_request *small,
                      const bb_scene *scene, double most)
{
    return ratio(rays_of(whole, scene, most), rays_of(small, scene, most));
}

static scale scale_of(const bb_bench_request *whole, const bb_bench_request *small,
                      const bb_scene *scene, double sample_prims)
{
    const double prims = scene->prim_count;
    const double deeper = prims > sample_prims ? log2(prims) / log2(sample_prims) : 1;
    const double pixels = (double)whole->width * whole->height;
    return (scale){.prims = prims / sample_prims,
                   .rounds = (whole->repeats + 1.0) / (small->repeats + 1.0),
                   .rays = deeper * more_of(whole, small, scene, INFINITY),
                   .counted = deeper * more_of(whole, small, scene, BB_COUNTED_RAYS),
                   .simulated = deeper * more_of(whole, small, scene, BB_SIMT_SAMPLE.most),
                   .pixels = ratio(pixels, (double)small->width * small->height)};
}

/* Where programs had to be compiled, it is in these steps. */
static double compile_ms(const bb_results *results)
{
    return bb_results_step_ms(results, "compile builders") +
           bb_results_step_ms(results, "compile kernels") +
           bb_results_step_ms(results, "compile, allocate, first builds");
}

/* Runs it twice where its programs had to be compiled: the first time then says nothing. *bytes:
 * the most that was booked beyond what was before. The caller destroys *results, also after a
 * failure. */
static bb_status run_small(const bb_bench_request *small, bb_results **results,
                           bb_bench_outcome *outcome, double *bytes)
{
    bb_account *all = bb_host_account();
    const bb_context context = {small->device, small->seed, ""};
    const uint64_t before = all->bytes;
    for (int i = 0; i < 2; i++) {
        bb_results_destroy(*results);
        *results = NULL;
        BB_TRY(bb_results_create(&context, results));
        bb_account_mark(all);
        BB_TRY(bb_bench_run(small, *results, outcome));
        *bytes = (double)(all->peak - before);
        if (bb_interrupted() || !(compile_ms(*results) > outcome->times.total_ms / 2))
            break;
    }
    return BB_OK;
}

/* Returns the bytes of the largest set's rays and answers, on the host and on the device. */
static double ray_bytes(const bb_bench_request *request)
{
    const double rays = (double)bb_bench_most_rays(request);
    return fmin(rays, BB_BATCH) * (BB_BYTES_PER_RAY + sizeof(bb_ray) + BB_RESULT_BYTES_MAX);
}

bool bb_bench_can_be_foretold(const bb_scene *scene)
{
    return scene->volume == NULL && scene->motion == NULL;
}

bb_status bb_bench_forecast(const bb_bench_request *request, const bb_scene *scene,
                            const char *text, bb_forecast *forecast)
{
    bb_scene *sample = NULL;
    bb_results *results = NULL;
    bb_bench_outcome outcome;
    char *name = (char *)text; /* which nobody writes to */
    const double resident = (double)bb_host_resident();
    const uint32_t share = scene->prim_count / BB_FORECAST_SHARE;
    const uint32_t most = at_least(share, BB_FORECAST_PRIMS, scene->prim_count);
    *forecast = (bb_forecast){.bytes = NAN};
    for (uint32_t t = 0; t < BB_THRIFTS; t++)
        forecast->seconds[t] = NAN;
    BB_TRY(bb_scene_sample(scene, most, &sample));
    const bb_bench_request small = small_request(request, scene, sample, &name);
    double bytes = 0;
    bb_status status = run_small(&small, &results, &outcome, &bytes);
    if (status == BB_OK && !bb_interrupted()) {
        for (uint32_t t = 0; t < BB_THRIFTS; t++) {
            const bb_bench_request less = bb_bench_thrifty(request, t);
            const scale by = scale_of(&less, &small, scene, sample->prim_count);
            forecast->seconds[t] = foretell_ms(results, &outcome.times, &by) / 1e3;
        }
        const double prims = (double)scene->prim_count / sample->prim_count;
        forecast->bytes = resident + prims * (bytes - ray_bytes(&small)) + ray_bytes(request);
    }
    bb_results_destroy(results);
    bb_scene_free(sample);
    return status;
}
