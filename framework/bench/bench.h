/* The comparison: every builder on every scene, traced by every kernel with the same rays, judged,
 * recorded. */
#ifndef BB_BENCH_H
#define BB_BENCH_H

#include "framework/bench/audit.h"
#include "framework/device/device.h"
#include "framework/judge/oracle.h"
#include "framework/record/record.h"

#include <stdbool.h>
#include <string.h>

/* A part of the cells. They are dealt out by ray set, so that all cells that are interleaved, and
 * compared by ratios, stay together: set k of the comparison (scene by scene, each with its rays in
 * order, and one of its own for a scene without rays) is of part k modulo `count`. A scene's builds
 * are of the part of its first set; the parts of the others build too, for their traces, but
 * measure nothing of it. */
typedef struct bb_shard {
    uint32_t index, count; /* from 1 */
    uint32_t next;         /* number of the next set; goes on from one comparison to the next */
} bb_shard;

enum { BB_LAYOUT_REPEATS = 5 }; /* of transfers and of layouts, after the first */

typedef struct bb_bench_request {
    bb_device *device;
    char *const *scenes;
    uint32_t scene_count;
    char *const *builders; /* specifications; embree-native:... are reference rows */
    uint32_t builder_count;
    char *const *kernels;
    uint32_t kernel_count;
    /* with trees whose shape none of `kernels` keeps, also those that keep any tree's */
    bool native;
    char *const *intersectors;
    uint32_t intersector_count;
    char *const *workloads;
    uint32_t workload_count;
    uint32_t width, height; /* of primary rays */
    uint32_t max_rays;      /* per scene and workload, for the sampled ones */
    uint32_t max_views;     /* of a scene that per-view rays are made for; 0: all */
    uint32_t repeats;       /* rounds that count; one more comes first */
    uint64_t seed;
    char *const *metrics; /* names of metrics of trees, besides those that are always measured */
    uint32_t metric_count;
    double max_wrong_ppm;
    const bb_cell_parts *cells; /* canonical: of all combinations only these cells are measured */
    uint32_t cell_count;        /* 0: all */
    bb_shard *shard;            /* NULL: all cells */
    /* Of all combinations only those that this says are measured, with texts as above, NULL for
     * any; NULL: all. */
    bool (*takes)(const void *user, const char *builder, const char *kernel,
                  const char *intersector);
    const void *user;
    /* The one scene of `scenes` and its oracle, where they are there already; the caller's. NULL:
     * both are made here. */
    bb_scene *scene;
    bb_oracle *oracle;
    /* Only what a time to image is made of: no tests per ray, no builds for the times of phases, no
     * sampled metrics. */
    bool lean;
    /* Told now and then which share of the work is done; NULL: nobody. */
    void (*tell)(void *whom, double share);
    void *whom;
    const char *picture_folder; /* NULL: no pictures */
    bool quiet;                 /* no progress on standard error */
} bb_bench_request;

/* For takes(), and for reading the record: whether what is asked for, NULL for any, is this. */
static inline bool bb_bench_fits(const char *asked, const char *text)
{
    return asked == NULL || strcmp(asked, text) == 0;
}

/* Wall times of a comparison: timed builds, timed traces, all of it. */
typedef struct bb_bench_times {
    double build_ms, trace_ms, total_ms;
} bb_bench_times;

typedef struct bb_bench_outcome {
    /* cells of ours with the intersector `exact` that have more wrong answers than max_wrong_ppm,
     * or answers unlike those of other such cells, or failed; builds that failed */
    uint32_t wrong;
    uint32_t unbuilt;  /* builders of which there is no tree of any scene */
    uint32_t unjudged; /* scenes of which not a single answer was judged */
    /* of trees, scratch and layouts, by their accounts: the most that was held at a time */
    uint64_t bytes_held;
    bb_bench_times times;
    bb_audit audit;
} bb_bench_outcome;

/* Runs the comparison into `results`, which may hold others already. A cell that fails becomes a
 * record with status and reason; only what makes the whole comparison impossible (a scene that
 * can't be loaded, a device that fails) ends it; what was measured until then is in `results`. */
bb_status bb_bench_run(const bb_bench_request *request, bb_results *results,
                       bb_bench_outcome *outcome);

/* sum += more. */
void bb_bench_outcome_add(bb_bench_outcome *sum, const bb_bench_outcome *more);

/* Checks the names and parameters of a request before anything is loaded. */
bb_status bb_bench_check(const bb_bench_request *request);

/* Of all that decides which cells are measured, and how; not of the shard. `hash`: what comes
 * before, 0 if nothing does. */
uint64_t bb_bench_request_hash(const bb_bench_request *request, uint64_t hash);

#endif
