/* Which tetrahedron of a scene holds a point: kernels/locate.clh. */
#ifndef BB_LOCATE_H
#define BB_LOCATE_H

#include "framework/scene/tets.h"
#include "traversal/traversal.h"

typedef struct bb_locator bb_locator;

/* For a scene with tetrahedra, which is on the device and outlives it. Owned by the caller. */
bb_status bb_locator_create(const bb_scene *scene, bb_locator **out);
void bb_locator_destroy(bb_locator *locator); /* NULL is allowed */

/* From now on as on a device that has no doubles. Before the first search. */
void bb_locator_take_floats(bb_locator *locator);

/* Whether the tree of such a layout can be searched: "skip" and "octree". */
bool bb_locator_takes(const bb_layout *layout);

/* What kernels/locate.clh is told of such a layout of the scene, and whether the device has
 * doubles. */
bb_locate_args bb_locate_args_of(const bb_scene *scene, const bb_layout_data *data);
bool bb_locate_has_doubles(const bb_device *device);

/* Enqueues the search for `count` points (float[3] each, in scene units) by the layout, which was
 * made of the scene; does not wait. `results` gets bb_located, `counts`, if not NULL, bb_count.
 * BB_UNSUPPORTED for other layouts. */
bb_status bb_locate_points(bb_locator *locator, const bb_layout *layout, const bb_layout_data *data,
                           const bb_buffer *points, uint32_t count, bb_buffer *results,
                           bb_buffer *counts);

/* The tetrahedra that hold the point, by exact arithmetic and one after the other: their number,
 * and the first `capacity` of them, as primitives in ascending order. */
uint32_t bb_locate_all(const bb_scene *scene, const double point[3], uint32_t *prims,
                       uint32_t capacity);

#endif
