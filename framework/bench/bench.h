/* The comparison: every builder on every scene, traced by every kernel with the same rays, judged,
 * recorded. */
#ifndef BB_BENCH_H
#define BB_BENCH_H

#include "framework/bench/audit_results.h"
#include "framework/device/device.h"
#include "framework/judge/oracle.h"
#include "framework/record/record.h"

#include <stdbool.h>
#include <string.h>

/* A part of the cells. Ray sets are dealt out as a whole, so that cells that are interleaved and
 * compared by ratios stay together. Ray sets are numbered scene by scene, in the order of the rays;
 * a scene without rays counts as one set. Set k belongs to part k modulo `count`. The builds of a
 * scene belong to the part of its first set; other parts build the trees for their traces, but do
 * not measure them. */
typedef struct bb_shard {
    uint32_t index, count; /* from 1 */
    uint32_t next;         /* number of the next set; counts on over all comparisons of a run */
} bb_shard;

typedef struct bb_bench_request {
    bb_device *device;
    char *const *scenes;
    uint32_t scene_count;
    char *const *builders; /* specifications; embree-native:... are reference rows */
    uint32_t builder_count;
    char *const *kernels;
    uint32_t kernel_count;
    /* for trees whose shape no kernel of `kernels` keeps, also trace with the kernels that keep any
     * shape */
    bool native;
    char *const *intersectors;
    uint32_t intersector_count;
    char *const *workloads;
    uint32_t workload_count;
    uint32_t width, height; /* of primary rays */
    uint32_t max_rays;      /* most rays per scene, for workloads that sample */
    uint32_t max_views;     /* most views per scene for rays that are made per view; 0: all */
    uint32_t repeats;       /* counting rounds, after a discarded one */
    bool apart;             /* as bb_bench_is_apart() says, on any scene */
    uint64_t seed;
    char *const *metrics; /* names of metrics of trees, besides those that are always measured */
    uint32_t metric_count;
    double max_wrong_ppm;
    const bb_cell_parts *cells; /* canonical; only these of all combinations are measured */
    uint32_t cell_count;        /* 0: all */
    bb_shard *shard;            /* NULL: all cells */
    /* Decides which combinations are measured; NULL: all. It gets texts as above, or NULL, which
     * stands for any. */
    bool (*takes)(const void *user, const char *builder, const char *kernel,
                  const char *intersector);
    const void *user;
    /* The only scene of `scenes` and its oracle, if the caller has made them; the caller owns both.
     * NULL: the run makes them. */
    bb_scene *scene;
    bb_oracle *oracle;
    /* Measures only what a time to image needs: no tests per ray, no phase times, no sampled
     * metrics; simulates what `metrics` ask for. */
    bool lean;
    /* Called now and then with the share of the work that is done; may be NULL. */
    void (*tell)(void *whom, double share);
    void *whom;
    const char *picture_folder; /* NULL: no pictures */
    bool quiet;                 /* no progress on standard error */
} bb_bench_request;

/* Returns whether `asked` is this text, or NULL, which stands for any. For takes() and for readers
 * of the record. */
static inline bool bb_bench_fits(const char *asked, const char *text)
{
    return asked == NULL || strcmp(asked, text) == 0;
}

/* Wall times of a comparison: timed builds, timed traces, the whole. */
typedef struct bb_bench_times {
    double build_ms, trace_ms, total_ms;
} bb_bench_times;

typedef struct bb_bench_outcome {
    /* builds that failed, and cells of ours with the intersector `exact` that failed, have more
     * wrong answers than max_wrong_ppm, or differ from other such cells in their answers */
    uint32_t wrong;
    uint32_t sets, cells; /* planned: ray sets, and cells of those that were begun */
    uint32_t unbuilt;     /* builders that built no tree of any scene */
    uint32_t unjudged;    /* scenes of which no answer was judged */
    /* most bytes of trees, scratch and layouts that were held at a time, by their accounts */
    uint64_t bytes_held;
    bb_bench_times times;
    bb_audit audit;
} bb_bench_outcome;

/* Runs the comparison and adds its records to `results`. A cell that fails becomes a record with
 * status and reason. The comparison ends early only if it cannot go on (a scene cannot be loaded,
 * the device fails); `results` then has what was measured before. */
bb_status bb_bench_run(const bb_bench_request *request, bb_results *results,
                       bb_bench_outcome *outcome);

/* sum += more. */
void bb_bench_outcome_add(bb_bench_outcome *sum, const bb_bench_outcome *more);

/* Checks the names and parameters of a request before anything is loaded. */
bb_status bb_bench_check(const bb_bench_request *request);

/* Returns a hash of all that decides which cells are measured and how, except the shard. `hash` is
 * that of earlier requests, or 0. */
uint64_t bb_bench_request_hash(const bb_bench_request *request, uint64_t hash);

#endif
