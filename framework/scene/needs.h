/* What a scene needs of any method, taken from its profile: how long a code, how many bits for
 * sizes, how deep an octree, which kinds of primitives, how wide an index. Options that take `auto`
 * are resolved by these functions; a value given by hand asks none of them.
 */
#ifndef BB_NEEDS_H
#define BB_NEEDS_H

#include "framework/base/decision.h"
#include "framework/scene/scene.h"

#pragma GCC visibility push(default) /* what a plug-in may call */
#ifdef __cplusplus
extern "C" {
#endif

/* BB_FAILED if the profile was withheld: whoever asks must declare BB_INPUT_PROFILE. `what`, such
 * as "builder lbvh: bits=auto", starts the message. */
bb_status bb_needs_check(const bb_scene *scene, const char *what);

/* Bits of a Morton code, 3 to 64: a longer one hardly lowers the cost of a tree. */
uint32_t bb_need_code_bits(const bb_scene *scene);

/* How often the scene's diagonal must be halved, 0 to 24, to come down to the size of the median
 * primitive: the bits that tell sizes above it, one per octave. 0 where 98 % of the sizes lie
 * within one octave: then there is nothing to tell apart. */
uint32_t bb_need_size_octaves(const bb_scene *scene);

/* All of it as decisions about the scene, in words. */
void bb_scene_needs(const bb_scene *scene, bb_decisions *needs);

#ifdef __cplusplus
}
#endif
#pragma GCC visibility pop

#endif
