/* Coverage: with duplicated references, the leaves that list a primitive must contain all of it
 * together. */
#ifndef BB_TREE_COVER_H
#define BB_TREE_COVER_H

#include "framework/builder/tree_walk.h"

/* Compares each primitive with the boxes of its leaves; uses[prim] is their number. BB_FAILED names
 * the first primitive that is not covered, and where. */
bb_status bb_tree_check_cover(const bb_tree *tree, const bb_scene *scene, const bb_walk *walk,
                              const uint32_t *uses);

/* Sets *covered to whether boxes[0..count) together cover the surface of primitive `prim`; if not,
 * `point` is a point of the uncovered part. Exact except for parts thinner than 2^-40 of the
 * primitive's largest coordinate. */
bb_status bb_cover_primitive(const bb_scene *scene, uint32_t prim, const bb_box *boxes,
                             uint32_t count, bool *covered, double point[3]);

#endif
