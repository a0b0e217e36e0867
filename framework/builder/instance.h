/* A builder at work on a scene: its object, its account, its tree, and what was measured of its builds. */
#ifndef BB_INSTANCE_H
#define BB_INSTANCE_H

#include "framework/builder/builder.h"
#include "framework/device/stopwatch.h"

typedef struct bb_instance {
    const bb_builder *builder;
    bb_spec spec;
    bb_builder_context context;
    bb_account account;
    void *self;
    bb_tree tree;
    const bb_scene *prepared; /* the scene that prepare() was called for; NULL: none yet */
    double prepare_ms;        /* of that call */
} bb_instance;

/* What was measured of one build. Times in ms. */
typedef struct bb_build_timing {
    bb_timing timing;  /* ms: without what the builder did in phases outside its time */
    double restore_ms; /* before the clock started */
    double outside_ms; /* in phases outside its time */
} bb_build_timing;

/* Parses `text`, finds the builder, checks the parameters and that it takes the scene's kinds (BB_UNSUPPORTED), and creates
 * it. On failure there is nothing to destroy. */
bb_status bb_instance_create(bb_device *device, const char *text, const bb_scene *scene,
                             uint64_t seed, bb_instance *instance);
void bb_instance_destroy(bb_instance *instance); /* a zeroed instance is allowed */

/* One build, from a finished queue to a finished queue. The builder gets what it declares of the scene,
 * and nothing else. `exact_phases`: see bb_phases; `phases` may be NULL. Restores the input before the
 * clock starts and reads it once, so that all builders find theirs equally warm; fetches tree.info
 * after it has stopped. */
bb_status bb_instance_build(bb_instance *instance, const bb_scene *scene, bool exact_phases,
                            bb_phases *phases, bb_build_timing *timing);

/* The builder's words on its last build; "" if it has none. */
bb_status bb_instance_describe(bb_instance *instance, const bb_scene *scene, char *text,
                               size_t capacity);

/* Checks a text without creating anything: the builder exists and takes these parameters. */
bb_status bb_instance_check(const char *text);

#endif
