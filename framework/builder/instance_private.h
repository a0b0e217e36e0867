/* Shared by the parts of an instance: instance.c, instance_build.c. */
#ifndef BB_INSTANCE_PRIVATE_H
#define BB_INSTANCE_PRIVATE_H

#include "framework/builder/hook.h"
#include "framework/builder/instance.h"

/* Whether a splitter comes before stage `i`. */
bool bb_stage_is_fed_with_references(const bb_instance *instance, uint32_t i);

/* The scene as stage `i` gets it: without the inputs that it did not declare, and with the
 * references of the last split in place of the primitives if a splitter comes before it. */
bb_scene bb_stage_part(const bb_instance *instance, uint32_t i, const bb_scene *scene);

/* Stage `i` is about to be called: bb_hook_begin(). */
static inline void bb_stage_begin(bb_instance *instance, uint32_t i, const char *name,
                                  const bb_scene *scene, bb_hook *hook)
{
    bb_hook_begin(hook, (bb_guarded){instance->scene, instance->pipeline.text},
                  instance->pipeline.stages[i].label, name, scene, &instance->footprint);
}

#endif
