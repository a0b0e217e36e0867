/* A pipeline at work on a scene: a builder, with a splitter before it or optimisers after it; their
 * objects, their account, their trees, and what was measured of their builds.
 */
#ifndef BB_INSTANCE_H
#define BB_INSTANCE_H

#include "framework/builder/pipeline.h"
#include "framework/device/stopwatch.h"

/* Of a pipeline's build: its stages, the mapping of references to primitives, and an update that
 * was given up before. */
enum { BB_STEPS_MAX = BB_STAGES_MAX + 2 };

/* What was measured of one build, or of one step of it. Times in ms. */
typedef struct bb_build_timing {
    bb_timing timing;  /* ms: without what the builder did in phases outside its time */
    double restore_ms; /* before the clock started */
    double outside_ms; /* in phases outside its time */
} bb_build_timing;

typedef struct bb_build_step {
    const char *label; /* the stage's, or "map" */
    uint32_t stage;    /* its number; BB_NONE: of none */
    uint64_t bytes;    /* of the tree, or of the references, that it made */
    uint64_t peak;     /* of these, its scratch and its copy of the stage before, at most */
    bb_build_timing timing;
    bb_phases phases;
} bb_build_step;

/* A stage at work. */
typedef struct bb_stage {
    const bb_builder *builder;
    bb_builder_context context;
    void *self;
    bb_tree own;              /* what it makes, unless it is the last */
    bb_tree *tree;            /* the same, or the instance's; a splitter's stays empty */
    const bb_scene *prepared; /* the scene that prepare() was called for; NULL: none yet */
    uint32_t prepared_count;  /* primitives or references then */
    double prepare_ms;        /* of that call */
    uint64_t bytes;           /* that it holds of the instance's account */
} bb_stage;

/* It must not move while it lives: the account is in it. */
typedef struct bb_instance {
    bb_pipeline pipeline; /* its count is 0 when there is nothing to destroy */
    bb_device *device;
    bb_account account; /* of all stages */
    bb_stage stages[BB_STAGES_MAX];
    bb_references references; /* a splitter's */
    cl_program program;       /* of the mapping of references */
    cl_kernel map;
    bb_tree tree;          /* what the last stage made */
    const bb_scene *built; /* what the tree is of; NULL: there is none, or a build failed */
    uint64_t built_hash;   /* of that scene then */
    uint32_t step_count;   /* of the last build or update */
    bb_build_step steps[BB_STEPS_MAX];
} bb_instance;

/* Parses `text`, checks that each stage takes the scene's kinds (BB_UNSUPPORTED; a scene of NULL is
 * none, and not checked), and creates them. On failure there is nothing to destroy. */
bb_status bb_instance_create(bb_device *device, const char *text, const bb_scene *scene,
                             uint64_t seed, bb_instance *instance);
/* Whether the stages take their parameters, before any scene is there: BB_INVALID for what create()
 * finds out of range. Whatever else it fails of is for bb_instance_create() to tell. */
bb_status bb_instance_try(bb_device *device, const char *text, uint64_t seed);
void bb_instance_destroy(bb_instance *instance); /* a zeroed instance is allowed */

/* One build. Each stage is timed from a finished queue to a finished queue, and gets what it
 * declares of the scene and nothing else; `timing` (may be NULL) gets the sums, instance->steps
 * each by itself. Not in these times: what is copied between stages on the host and on the device,
 * see bb_instance_transfer(). Restores a stage's input before its clock starts and reads it once,
 * so that all builders find theirs equally warm; fetches tree.info after it has stopped.
 * `exact_phases`: see bb_phases. */
bb_status bb_instance_build(bb_instance *instance, const bb_scene *scene, bool exact_phases,
                            bb_build_timing *timing);

/* What bb_instance_update() did. */
typedef enum bb_update_way { BB_KEPT, BB_UPDATED, BB_REBUILT } bb_update_way;

/* As words: "kept", "updated", "rebuilt". */
const char *bb_update_word(bb_update_way way);

/* Brings the tree up to date after `changed` (BB_CHANGED_...) of `scene`, by the builder's update()
 * if it has one that can follow, else by a build; `way` says which. Positions that changed since
 * this tree was made are found out by the scene's hash as well, so that several instances may
 * follow one scene. Nothing is done if nothing changed.
 * Timed and booked like a build: bb_instance_build(). What has not been built for this scene, with
 * as many primitives, is built. Of a pipeline the last stage is asked, whose tree it is; one with a
 * splitter is always built: its pieces would have to follow as well, and no hook says how. */
bb_status bb_instance_update(bb_instance *instance, const bb_scene *scene, uint32_t changed,
                             bool exact_phases, bb_update_way *way, bb_build_timing *timing);

/* Moves once again what stages on the host need moved: what they declare of the scene down, what
 * one hands to the next across, the tree up; 0 for a pipeline on the device. `ms` gets the time.
 * After a build. */
bb_status bb_instance_transfer(bb_instance *instance, const bb_scene *scene, double *ms);

/* SAH of the tree that stage `i` made in the last build, which stages after it may have changed
 * into another; NAN for a splitter. Costs a download of that tree, and no build. */
bb_status bb_instance_stage_sah(bb_instance *instance, uint32_t i, double *sah);

/* The stages' words on the last build, each after its label if there are several; "" if they have
 * none. */
bb_status bb_instance_describe(bb_instance *instance, const bb_scene *scene, char *text,
                               size_t capacity);

/* What the stages decided for the last build. */
void bb_instance_decisions(bb_instance *instance, const bb_scene *scene, bb_decisions *decisions);

/* What all its stages declare together. */
uint32_t bb_instance_inputs(const bb_instance *instance);   /* BB_INPUT_... of the scene */
double bb_instance_prepare_ms(const bb_instance *instance); /* sum of the last calls */
bool bb_instance_is_deterministic(const bb_instance *instance);

/* Checks a text without creating anything: the builders exist and take these parameters, in this
 * order. */
bb_status bb_instance_check(const char *text);

#endif
