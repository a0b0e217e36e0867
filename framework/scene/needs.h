/* What a scene needs of any method, derived from its profile: length of a code, bits for sizes,
 * depth of an octree, kinds of primitives, width of an index. Options with `auto` are resolved by
 * these functions; values given by hand are not affected.
 */
#ifndef BB_NEEDS_H
#define BB_NEEDS_H

#include "framework/base/decision.h"
#include "framework/scene/scene.h"

#pragma GCC visibility push(default) /* what a plug-in may call */
#ifdef __cplusplus
extern "C" {
#endif

/* BB_FAILED if the profile was withheld: the caller must declare BB_INPUT_PROFILE. `what`, such as
 * "builder lbvh: bits=auto", starts the message. */
bb_status bb_needs_check(const bb_scene *scene, const char *what);

/* Returns the bits of a Morton code, 3 to 64, beyond which the cost of a tree hardly falls. */
uint32_t bb_need_code_bits(const bb_scene *scene);

/* Returns how often the scene's diagonal must be halved, 0 to 24, to reach the size of the median
 * primitive: the number of bits for sizes above it, one per octave. 0 if 98 % of the sizes are
 * within one octave: then size bits distinguish nothing. */
uint32_t bb_need_size_octaves(const bb_scene *scene);

/* Reports all of these as decisions about the scene, in words. */
void bb_scene_needs(const bb_scene *scene, bb_decisions *needs);

#ifdef __cplusplus
}
#endif
#pragma GCC visibility pop

#endif
