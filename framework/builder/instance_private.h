/* Shared by the parts of an instance: instance.c, instance_build.c. */
#ifndef BB_INSTANCE_PRIVATE_H
#define BB_INSTANCE_PRIVATE_H

#include "framework/builder/guard.h"
#include "framework/builder/instance.h"
#include "framework/builder/terms.h"

/* Whether a splitter comes before stage `i`. */
bool bb_stage_is_fed_with_references(const bb_instance *instance, uint32_t i);

/* The scene as stage `i` gets it: without the inputs that it did not declare, and with the
 * references of the last split in place of the primitives if a splitter comes before it. */
bb_scene bb_stage_part(const bb_instance *instance, uint32_t i, const bb_scene *scene);

/* Whose hooks are called: what would be missing without the instance. */
static inline bb_guarded bb_instance_guarded(const bb_instance *instance)
{
    return (bb_guarded){instance->scene, instance->pipeline.text};
}

#endif
