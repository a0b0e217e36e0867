/* Shared by the files of the comparison: bench.c, and above it bench_builds.c and
 * bench_traces.c. */
#ifndef BB_BENCH_PRIVATE_H
#define BB_BENCH_PRIVATE_H

#include "framework/base/interrupt.h"
#include "framework/base/progress.h"
#include "framework/bench/bench.h"
#include "framework/bench/count.h"
#include "framework/bench/launches.h"
#include "framework/bench/resident.h"
#include "framework/bench/turns.h"
#include "framework/builder/tracing.h"
#include "framework/judge/judge.h"
#include "framework/judge/rays.h"
#include "framework/scene/disguise.h"
#include "framework/workload/workload.h"
#include "traversal/traversal.h"

enum {
    BB_ENTRANTS_MAX = 64,
    BB_KERNELS_MAX =
        BB_LAYOUTS_MAX / BB_FORMAT_COUNT, /* the layouts of so many fit into a build's record */
    /* rays per launch: buffers stay small beside trees, and sets of any size can be traced */
    BB_BATCH = 1 << 22,
    /* on the host, of a ray set: its rays, two sets of answers, the oracle's, what is judged */
    BB_BYTES_PER_RAY = sizeof(bb_ray) + 2 * BB_RESULT_BYTES_MAX + 64,
    /* rays that the counting variant traces: the mean over so many is accurate to half a percent */
    BB_COUNTED_RAYS = 1 << 14,
};

/* A kernel that was asked for. */
typedef struct bb_kernel_choice {
    const bb_kernel *kernel;
    bb_spec spec;
    uint32_t leaf;
    /* for each format of triangles, the index in bb_bench.residency.layouts of what it reads */
    uint32_t layouts[BB_FORMAT_COUNT];
    uint32_t simulated[BB_FORMAT_COUNT]; /* likewise, of the tree in preorder: for simulations */
    bool noted, capped;                  /* notes that the user has been given */
    char unsimulated[128];               /* likewise, the beginning of the last; "": none */
    bool native_only; /* not asked for; only for trees whose shape no requested kernel keeps */
} bb_kernel_choice;

/* A builder on the current scene: what it has in memory now, and its record. */
typedef struct bb_entrant {
    const char *text;
    const bb_tracer *tracer; /* NULL: a builder */
    bb_spec spec;            /* of a single builder or a tracer; of a pipeline only the text */
    bb_pipeline pipeline;    /* of a builder */
    bb_resident *resident;
    bb_tracing *tracing;        /* of a tracer's row, which owns it unless: */
    struct bb_entrant *tree_of; /* the row that builds the same tree; NULL: none before it */
    bb_build_record record;
    uint32_t layouts[BB_LAYOUTS_MAX]; /* of the residency: those in the record */
    bb_samples phase_samples[BB_RECORD_PHASES_MAX];
} bb_entrant;

/* The share of a scene that belongs to this shard. */
typedef struct bb_scene_part {
    uint32_t first, sets; /* first number and count of the scene's ray sets; without rays 1 */
    uint32_t own;         /* how many of them belong to this shard */
} bb_scene_part;

typedef struct bb_bench {
    const bb_bench_request *request;
    bb_device *device;
    bb_results *results;
    bb_scene *scene;
    bb_scene *first;      /* loaded before its turn, or NULL; not freed if the request owns it */
    uint32_t sets;        /* planned ray sets of all scenes */
    bb_scene_part *parts; /* one for each scene */
    const bb_scene_part *part; /* of the current scene */
    uint32_t set;              /* number of its next ray set */
    bb_bystanders bystanders;  /* watched since the start */
    const char *scene_text;    /* as asked for; scene->name may be its end only */
    bb_oracle *oracle;
    bb_kernel_choice kernels[BB_KERNELS_MAX];
    uint32_t kernel_count;
    bb_intersector *intersectors; /* as many as were asked for */
    bb_simt simts[BB_SIMT_MAX];
    uint32_t simt_count;
    bb_residency residency; /* of the current scene: an item for each entrant */
    bb_entrant *entrants;
    uint32_t entrant_count;
    bool *built;          /* for each requested builder: it has built some scene */
    uint32_t judged;      /* judged cells of the current scene */
    uint32_t traced_sets; /* of it */
    bb_samples boxes_ms;  /* of it */
    bb_random random;     /* of the orders of rounds */
    bb_random unseen;     /* of disguises: another one in each run */
    bb_disguise disguise; /* of the current scene */
    bb_progress *progress;
    uint32_t batch;   /* rays per launch */
    bool asks_oracle; /* it is not given up just now */
    bool traces;      /* layouts are measured: trees are freed as soon as they have served */
    bool apart;       /* layouts are measured entrant by entrant: bb_bench_is_apart() */
    /* bytes booked while no ray set is on the host, so that there is room for a launch's rays */
    uint64_t kept_for_rays;
    bb_bench_outcome *outcome;
    double start;
    double steps_ms; /* booked so far */
    /* of it, what booking the last step took, which the results get with the next */
    double booking_ms;
    bb_buffer rays;
    bb_buffer answers; /* whatever the query */
    bb_counter counter;
    bb_account account; /* of the buffers above and of the rays */
} bb_bench;

/* A step is the time from begin to end, less the time that inner steps, builds and traces booked
 * meanwhile: no millisecond is booked twice. */
typedef struct bb_step {
    double start;
    double booked; /* bench->steps_ms when the step began */
} bb_step;

bb_step bb_bench_begin(const bb_bench *bench);

/* Books the step, also after a failure, and what booking takes. Returns `status`. */
bb_status bb_bench_end(bb_bench *bench, bb_step step, const char *name, bb_status status);

/* Shows that a turn was taken. A terminal may keep it waiting, which is booked. */
void bb_bench_show_progress(bb_bench *bench);

/* Runs a scene from loading, unless it is bench->first, to pictures (bench_scene.c). */
bb_status bb_bench_scene(bb_bench *bench, const char *name);

/* Measures the builds of all entrants, interleaved, and fills their records. */
bb_status bb_bench_builds(bb_bench *bench);

/* Records a failure, unless it failed because the run was interrupted. */
void bb_bench_note_failure(bb_entrant *entrant, bb_status status);

/* ---- trees and layouts ---- */

/* Measures the tree, `own`: with its transfers (bench_measure.c). Where memory is short, others are
 * evicted, then its own builder: the tree is built again when somebody asks for it. */
bb_status bb_bench_measure_tree(bb_bench *bench, bb_entrant *entrant, bool own);

/* Makes the layouts (bench_layouts.c). A refused layout is a failure of the trace, not of the
 * build: bb_bench_layout() reports it again. */
void bb_bench_make_layouts(bb_bench *bench, bb_entrant *entrant);
/* Times them in rounds, unless they are measured apart. */
bb_status bb_bench_measure_layouts(bb_bench *bench);
/* Times an entrant's layouts in one go, and frees its tree, so that no more than one stands beside
 * all layouts. */
void bb_bench_measure_layouts_apart(bb_bench *bench, bb_entrant *entrant);

/* ---- room (bench_room.c) ---- */

/* For a builder, or the oracle, that was refused memory of the host: frees what the oracle needs,
 * until it is asked, else the trees of all tracers if they hold what was missing; their rows are
 * refused then. Returns whether anything was freed. `whom` is the bench. */
bool bb_bench_give_up(void *whom);

/* Makes sure that the oracle has all that it needs and that so many bytes fit beside it. If memory
 * is short, trees and layouts are evicted, which may have been made in the oracle's room. */
bb_status bb_bench_ready_oracle(bb_bench *bench, uint64_t beside);

/* ---- inputs that no builder has seen (bench_unseen.c) ---- */

/* Draws the round before which all builders build such an input; BB_NONE: there are too few. */
uint32_t bb_bench_draw_unseen(bb_bench *bench, uint32_t rounds);

/* Has each builder build the disguised scene once, timed and checked. Whoever gives a wrong tree
 * fails. The trees are then those of the disguised scene: another round must follow. */
bb_status bb_bench_unseen_round(bb_bench *bench);

/* After all rounds: tries again whoever took more than 1.5 times its median then. It fails
 * ("remembers inputs") if each of four such inputs took it more than 1.5 times its slowest other
 * build. */
bb_status bb_bench_judge_unseen(bb_bench *bench);

/* ---- what was asked for (bench_request.c) ---- */

bb_status bb_bench_parse_kernel(const char *text, bb_kernel_choice *choice);

/* Returns the most cells that a ray set can have. */
uint32_t bb_bench_cells_of_set(const bb_bench *bench);

/* Returns the rays of the largest set. */
uint64_t bb_bench_most_rays(const bb_bench_request *request);

/* Returns whether trees and layouts of so many primitives are too large to stand beside each other:
 * then all layouts of an entrant are measured in one go, and its tree is freed, before the next
 * entrant's turn. */
bool bb_bench_is_apart(const bb_bench_request *request, uint32_t prims);

/* Returns the index of the layout that the kernel reads with this intersector. */
uint32_t bb_bench_layout_of(const bb_bench *bench, uint32_t kernel,
                            const bb_intersector *intersector);

/* Simulates the entrant's build, if the request asks for simulations (bench_simulated.c). What
 * cannot be simulated is noted, and has no figures. */
bb_status bb_bench_simulate_build(bb_bench *bench, bb_entrant *entrant);

/* Returns whether traces by this kernel are simulated, and the index of the layout for that. */
bool bb_bench_simulates(const bb_bench *bench, uint32_t kernel, const bb_intersector *intersector,
                        uint32_t *layout);

/* Returns whether the kernel traces this entrant. This is known once the entrant's layouts for the
 * requested kernels were made. */
bool bb_bench_takes(const bb_bench *bench, const bb_entrant *entrant, uint32_t kernel);

/* Returns the parts that all cells of the current scene share, from the request. */
bb_cell_parts bb_bench_cell(const bb_bench *bench);
/* Writes the canonical key of `cell`; "" if it has none. */
void bb_bench_key(const bb_cell_parts *cell, char key[BB_CELL_KEY]);
/* Returns whether a cell with these parts is to be measured. "" stands for any. */
bool bb_bench_wants(const bb_bench *bench, const bb_cell_parts *parts);

/* BB_INVALID if a requested cell names a view that `scene` lacks. `text` is the scene as requested.
 */
bb_status bb_bench_check_views(const bb_bench *bench, const bb_scene *scene, const char *text);

/* ---- shards (bench_shard.c) ---- */

/* Returns the ray sets of the scene, requested as `text`, and how many belong to this shard. */
bb_scene_part bb_bench_part_of(bb_bench *bench, const bb_scene *scene, const char *text);
/* Returns whether ray set `number` belongs to this shard. */
bool bb_bench_owns(const bb_bench *bench, uint32_t number);
/* Returns whether this shard measures the builds of the current scene. */
bool bb_bench_owns_builds(const bb_bench *bench);

/* Measures all cells of one ray set, interleaved, and adds their records. */
bb_status bb_bench_traces(bb_bench *bench, bb_rays *rays);

/* ---- what is on the device (framework/bench/resident.h), with its steps booked ---- */

bb_status bb_bench_tree(bb_bench *bench, bb_entrant *entrant);
bb_status bb_bench_layout(bb_bench *bench, bb_entrant *entrant, uint32_t layout);

#endif
