/* What the parts of an instance share: instance.c, instance_build.c. */
#ifndef BB_INSTANCE_PRIVATE_H
#define BB_INSTANCE_PRIVATE_H

#include "framework/builder/instance.h"

/* Does a splitter come before stage `i`? */
bool bb_stage_is_fed_with_references(const bb_instance *instance, uint32_t i);

/* The scene as stage `i` gets it: with all taken out that it did not declare, and references, those
 * of the last split, in the primitives' place if it is fed with them. */
bb_scene bb_stage_part(const bb_instance *instance, uint32_t i, const bb_scene *scene);

#endif
