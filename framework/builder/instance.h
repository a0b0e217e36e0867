/* A pipeline that works on a scene: a builder, with a splitter before it or optimisers after it. It
 * holds their objects, account and trees, and the measurements of their builds.
 */
#ifndef BB_INSTANCE_H
#define BB_INSTANCE_H

#include "framework/builder/phases.h"
#include "framework/builder/pipeline.h"
#include "framework/device/stopwatch.h"

/* Steps of a pipeline's build: its stages, the mapping of references to primitives, and an update
 * that was given up before. */
enum { BB_STEPS_MAX = BB_STAGES_MAX + 2 };

/* The measurements of one build, or of one step of it. Times in ms. */
typedef struct bb_build_timing {
    bb_timing timing;  /* ms: without phases outside the builder's time */
    double restore_ms; /* before the clock started */
    double outside_ms; /* phases outside the builder's time */
} bb_build_timing;

typedef struct bb_build_step {
    const char *label; /* the stage's label, or "map" */
    uint32_t stage;    /* index of the stage; BB_NONE for "map" */
    uint64_t bytes;    /* size of the tree or the references that it made */
    uint64_t peak;     /* peak of these, its scratch and its copy of the previous stage's output */
    bb_build_timing timing;
    bb_phases phases;
} bb_build_step;

/* A stage in use. */
typedef struct bb_stage {
    const bb_builder *builder;
    bb_builder_context context;
    void *self;
    bb_tree own;              /* its output, unless it is the last stage */
    bb_tree *tree;            /* `own` or the instance's tree; a splitter's stays empty */
    const bb_scene *prepared; /* the scene that prepare() was called for; NULL: none yet */
    uint32_t prepared_count;  /* primitives or references then */
    double prepare_ms;        /* time of that call */
    uint64_t bytes;           /* its share of the instance's account */
} bb_stage;

/* It must not move while it is in use: pointers to its account are kept. */
typedef struct bb_instance {
    bb_pipeline pipeline; /* count is 0 when there is nothing to destroy */
    char scene[256];      /* name of the scene that it was created for; "": none */
    bb_device *device;
    bb_account account; /* of all stages together */
    /* What its hooks have added, on a device that shares the host's memory too. Less than what is
     * booked where pages were not touched. */
    bb_footprint footprint;
    /* Builds check their tree as soon as the hook has returned; not after a splitter, whose
     * references are still to be mapped. */
    bool check_at_once;
    bb_stage stages[BB_STAGES_MAX];
    bb_references references; /* output of the splitter */
    cl_program program;       /* maps references to primitives */
    cl_kernel map;
    bb_tree tree;          /* output of the last stage */
    const bb_scene *built; /* the tree's scene; NULL: there is no tree, or a build failed */
    uint64_t built_hash;   /* hash of that scene at the build */
    uint32_t step_count;   /* steps of the last build or update */
    bb_build_step steps[BB_STEPS_MAX];
} bb_instance;

/* Parses `text`, checks that each stage takes the scene's kinds (BB_UNSUPPORTED), and creates the
 * stages. If scene is NULL, kinds are not checked. On failure there is nothing to destroy. */
bb_status bb_instance_create(bb_device *device, const char *text, const bb_scene *scene,
                             uint64_t seed, bb_instance *instance);
/* Checks the stages' parameters before there is a scene: BB_INVALID if create() finds them out of
 * range. Other failures are not reported here but by bb_instance_create(). */
bb_status bb_instance_try(bb_device *device, const char *text, uint64_t seed);
void bb_instance_destroy(bb_instance *instance); /* a zeroed instance is allowed */

/* Makes one build. Each stage is timed from a finished queue to a finished queue, and gets only the
 * parts of the scene that it declares. `timing` (may be NULL) gets the sums, instance->steps the
 * times of each step. Copies between stages on the host and on the device are not in these times:
 * see bb_instance_transfer(). Before a stage's clock starts, its input is restored and read once,
 * so that all builders find theirs equally warm. tree.info is fetched after the clock has stopped.
 * `exact_phases`: see phases.h. */
bb_status bb_instance_build(bb_instance *instance, const bb_scene *scene, bool exact_phases,
                            bb_build_timing *timing);

/* The way in which bb_instance_update() updated the tree. */
typedef enum bb_update_way { BB_KEPT, BB_UPDATED, BB_REBUILT } bb_update_way;

/* "kept", "updated" or "rebuilt". */
const char *bb_update_word(bb_update_way way);

/* Brings the tree up to date after `changed` (BB_CHANGED_...) of `scene`: by the builder's update()
 * if it has one that can follow, else by a build; `way` says which. The scene's hash shows as well
 * whether positions changed since this tree was made, so several instances may follow one scene. If
 * nothing changed, nothing is done. Times and memory are recorded as by bb_instance_build(). A tree
 * that has not been built for this scene, with the same number of primitives, is built. In a
 * pipeline the last stage, which owns the tree, is asked for the update. A pipeline with a splitter
 * is always built: no hook updates its references. */
bb_status bb_instance_update(bb_instance *instance, const bb_scene *scene, uint32_t changed,
                             bool exact_phases, bb_update_way *way, bb_build_timing *timing);

/* Repeats the copies that stages on the host need: inputs from the scene, trees and references from
 * stage to stage, and the tree to the device. `ms` gets the time, 0 for a pipeline on the device.
 * To be called after a build. */
bb_status bb_instance_transfer(bb_instance *instance, const bb_scene *scene, double *ms);

/* SAH of the tree that stage `i` made in the last build, before later stages changed it; NAN for a
 * splitter. Costs a download of that tree, but no build. */
bb_status bb_instance_stage_sah(bb_instance *instance, uint32_t i, double *sah);

/* The stages' descriptions of the last build, each after its label if there are several; "" if
 * there are none. */
bb_status bb_instance_describe(bb_instance *instance, const bb_scene *scene, char *text,
                               size_t capacity);

/* The stages' decisions for the last build. */
bb_status bb_instance_decisions(bb_instance *instance, const bb_scene *scene,
                                bb_decisions *decisions);

/* Properties of all stages together. */
uint32_t bb_instance_inputs(const bb_instance *instance);   /* BB_INPUT_... of the scene */
double bb_instance_prepare_ms(const bb_instance *instance); /* sum of the last calls */
bool bb_instance_is_deterministic(const bb_instance *instance);

/* Checks a text without creating anything: the builders must exist and take these parameters, in
 * this order. */
bb_status bb_instance_check(const char *text);

#endif
