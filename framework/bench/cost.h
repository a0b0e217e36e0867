/* What rays cost on a tree, before they are traced: some trees are too bad for all of them. */
#ifndef BB_COST_H
#define BB_COST_H

#include "framework/rays/rays.h"
#include "traversal/traversal.h"

/* Tests of boxes and primitives per ray of each set, counted with 256 of its rays, evenly spaced,
 * by the first kernel whose layout keeps the shape of any tree (which is not the fastest: the
 * figures are upper bounds). The tree is on the device. Of a tree that is one leaf they are known
 * without. */
bb_status bb_tests_per_ray(bb_device *device, const bb_scene *scene, bb_tree *tree,
                           const bb_rays *const *sets, uint32_t set_count, double *tests);

#endif
