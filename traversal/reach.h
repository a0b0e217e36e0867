/* The longest side of any primitive below each node, for trees whose leaves contain parts of
 * primitives (kernels/reach.cl). */
#ifndef BB_REACH_H
#define BB_REACH_H

#include "framework/builder/tree.h"
#include "framework/scene/scene.h"

typedef struct bb_reach bb_reach;

/* Compiles. Scratch is booked on `account`. The caller owns *out. */
bb_status bb_reach_create(bb_device *device, bb_account *account, bb_reach **out);
void bb_reach_destroy(bb_reach *reach); /* NULL is allowed */

/* Computes one float per node of `tree`, which is on the device, in the scene's units. Enqueued,
 * not waited for. The object owns *out. */
bb_status bb_reach_make(bb_reach *reach, const bb_scene *scene, const bb_tree *tree,
                        const bb_buffer **out);

#endif
