/* Estimates what rays cost on a tree before all of them are traced: some trees are too bad for
 * that. */
#ifndef BB_COST_H
#define BB_COST_H

#include "framework/judge/rays.h"
#include "traversal/traversal.h"

/* Counts tests of boxes and primitives per ray of each set, with 256 evenly spaced rays. The first
 * kernel whose layout keeps the shape of any tree counts them; it is not the fastest, so the
 * figures are upper bounds. The tree must be on the device. For a tree of one leaf the figures are
 * known without tracing. */
bb_status bb_tests_per_ray(bb_device *device, const bb_scene *scene, bb_tree *tree,
                           const bb_rays *const *sets, uint32_t set_count, double *tests);

#endif
