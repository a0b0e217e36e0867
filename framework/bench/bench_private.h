/* What the parts of the comparison share: bench.c, resident.c, and above them bench_builds.c and
 * bench_traces.c. */
#ifndef BB_BENCH_PRIVATE_H
#define BB_BENCH_PRIVATE_H

#include "framework/base/bystanders.h"
#include "framework/base/interrupt.h"
#include "framework/base/progress.h"
#include "framework/bench/bench.h"
#include "framework/bench/launches.h"
#include "framework/builder/instance.h"
#include "framework/embree/embree.h"
#include "framework/judge/judge.h"
#include "framework/rays/rays.h"
#include "framework/workload/workload.h"
#include "traversal/traversal.h"

enum {
    BB_ENTRANTS_MAX = 64,
    BB_KERNELS_MAX =
        BB_LAYOUTS_MAX / BB_FORMAT_COUNT, /* a build's record has room for their layouts */
    /* rays per launch: their buffers stay small beside trees, and a set of any size can be
     * traced */
    BB_BATCH = 1 << 22,
    /* rays that the counting variant traces: a mean over so many is sure to half a percent */
    BB_COUNTED_RAYS = 1 << 14,
};

/* A kernel that was asked for. */
typedef struct bb_kernel_choice {
    const bb_kernel *kernel;
    bb_spec spec;
    uint32_t leaf;
    uint32_t layouts
        [BB_FORMAT_COUNT]; /* what it reads, in bb_bench.layouts, with triangles in each format */
    bool noted, capped;    /* what the user is to know of it has been said */
    bool native_only; /* not asked for: for trees whose shape no kernel that was asked for keeps */
} bb_kernel_choice;

/* A layout of leaves with up to `leaf` references and triangles in one form; all kernels and
 * intersectors that read the same share it. */
typedef struct bb_layout_choice {
    bb_layout_maker maker;
    uint32_t leaf;
    uint32_t format; /* BB_FORMAT_... */
} bb_layout_choice;

/* A builder on the scene: what it has in memory at present, and its record. */
typedef struct bb_entrant {
    const char *text;
    bool reference;
    bb_spec spec;         /* of one builder alone and of references; else only its text */
    bb_pipeline pipeline; /* of a builder */
    bb_instance instance; /* alive while instance.pipeline.count > 0 */
    bool built;           /* instance.tree holds a tree */
    bool compiled;        /* its kernels have run before */
    bb_layout_data layouts[BB_LAYOUTS_MAX];
    bool has_layout[BB_LAYOUTS_MAX];
    bool keeps_shape
        [BB_LAYOUTS_MAX]; /* the layout of its tree does; known since it was first made */
    bb_embree *embree;    /* of a reference row */
    bb_build_record record;
    bb_samples phase_samples[BB_RECORD_PHASES_MAX];
} bb_entrant;

/* What a shard has of a scene. */
typedef struct bb_scene_part {
    uint32_t first, sets; /* numbers of the scene's ray sets; one without rays counts as one */
    uint32_t own;         /* how many of them are of this shard */
} bb_scene_part;

typedef struct bb_bench {
    const bb_bench_request *request;
    bb_device *device;
    bb_results *results;
    bb_scene *scene;
    bb_scene *first;           /* loaded before its turn, or NULL; the request's is not freed */
    uint32_t sets;             /* ray sets of all scenes, planned */
    bb_scene_part *parts;      /* of each scene */
    const bb_scene_part *part; /* of the scene at hand */
    uint32_t set;              /* number of its next ray set */
    bb_bystanders bystanders;  /* since the start */
    bool warned;               /* of them, if there was need */
    const char *scene_text;    /* as asked for; scene->name may be its end only */
    bb_oracle *oracle;
    bb_kernel_choice kernels[BB_KERNELS_MAX];
    uint32_t kernel_count;
    bb_intersector *intersectors; /* as many as were asked for */
    bb_layout_choice layouts[BB_LAYOUTS_MAX];
    uint32_t layout_count;
    bb_entrant *entrants;
    uint32_t entrant_count;
    bool *built;          /* of each builder that was asked for: on some scene so far */
    uint32_t next_id;     /* of builds, over all scenes */
    uint32_t judged;      /* cells of the scene at hand */
    uint32_t traced_sets; /* of it */
    bb_samples boxes_ms;  /* of it */
    uint64_t random;      /* state of the shuffles */
    bb_progress *progress;
    uint32_t batch; /* rays per launch */
    bb_bench_outcome *outcome;
    double start;
    double steps_ms; /* booked so far */
    bb_buffer rays;
    bb_buffer answers; /* whatever the query */
    bb_buffer counts;
    bb_buffer sample;   /* rays for the counting variant */
    bb_account account; /* of the buffers above and of the rays */
} bb_bench;

/* A step: the time from begin to end, less what was booked meanwhile (by steps within it, builds
 * and traces), so that no millisecond is booked twice. */
typedef struct bb_step {
    double start;
    double booked; /* when it began */
} bb_step;

bb_step bb_bench_begin(const bb_bench *bench);

/* Books the step, also where `status`, which is returned, is that of a failure. */
bb_status bb_bench_end(bb_bench *bench, bb_step step, const char *name, bb_status status);

/* order[0..count) = a random permutation of 0..count-1. */
void bb_bench_shuffle(bb_bench *bench, uint32_t *order, uint32_t count);

/* A scene from loading it, unless it is bench->first, to its pictures (bench_scene.c). */
bb_status bb_bench_scene(bb_bench *bench, const char *name);

/* Builds of all entrants, interleaved; fills their records. */
bb_status bb_bench_builds(bb_bench *bench);

/* Says so if the clocks did not settle before `what` was measured. */
void bb_bench_note_warming(bb_bench *bench, const char *what, const bb_warming *warming);

/* ---- what was asked for (bench_request.c) ---- */

bb_status bb_bench_parse_reference(const char *text, bb_spec *spec);
bb_status bb_bench_parse_kernel(const char *text, bb_kernel_choice *choice);

/* Ray sets of a scene with so many views. */
uint32_t bb_bench_sets_of(const bb_bench *bench, uint32_t views);
/* Cells that a ray set has, at most. */
uint32_t bb_bench_cells_of_set(const bb_bench *bench);

/* The layout that the kernel reads with this intersector. */
uint32_t bb_bench_layout_of(const bb_bench *bench, uint32_t kernel,
                            const bb_intersector *intersector);

/* Is this entrant traced by this kernel? Known once its layouts for the kernels that were asked for
 * have been made. */
bool bb_bench_takes(const bb_bench *bench, const bb_entrant *entrant, uint32_t kernel);

/* The parts of cells that all of the scene at hand share, made by the request. */
bb_cell_parts bb_bench_cell(const bb_bench *bench);
/* Into `key` the canonical key of `cell`; "" if it has none. */
void bb_bench_key(const bb_cell_parts *cell, char key[BB_CELL_KEY]);
/* Is a cell with these parts among those that are to be measured? "" stands for any. */
bool bb_bench_wants(const bb_bench *bench, const bb_cell_parts *parts);

/* BB_INVALID if cells that are to be measured name a view that `scene`, asked for as `text`,
 * lacks. */
bb_status bb_bench_check_views(const bb_bench *bench, const bb_scene *scene, const char *text);

/* ---- shards (bench_shard.c) ---- */

/* Which ray sets the scene, asked for as `text`, has, and which of them are of this shard. */
bb_scene_part bb_bench_part_of(bb_bench *bench, const bb_scene *scene, const char *text);
/* Whether ray set `number` is of this shard. */
bool bb_bench_owns(const bb_bench *bench, uint32_t number);
/* Whether builds of the scene at hand are measured here. */
bool bb_bench_owns_builds(const bb_bench *bench);

/* All cells of one ray set, interleaved; adds their records. */
bb_status bb_bench_traces(bb_bench *bench, bb_rays *rays);

/* ---- what is on the device (resident.c) ---- */

/* Makes sure that the entrant's tree exists: builds it, untimed but for the first, cold time; in
 * the others' place where it does not fit beside them. */
bb_status bb_resident_tree(bb_bench *bench, bb_entrant *entrant);

/* Makes sure that layout `layout` of the entrant is on the device; evicts other entrants and builds
 * again, untimed, where memory asks for it. BB_FAILED if what was built again has another shape
 * than what was recorded. */
bb_status bb_resident_layout(bb_bench *bench, bb_entrant *entrant, uint32_t layout);

/* Makes a layout that is there once more, in its place; if that fails, it is gone. */
bb_status bb_resident_layout_again(bb_bench *bench, bb_entrant *entrant, uint32_t layout);

/* Notes what all entrants hold at present, or held since their accounts were marked, as held. */
void bb_resident_note(bb_bench *bench);

/* Frees what the entrant has in memory; its record stays. */
void bb_resident_evict(bb_entrant *entrant);

#endif
