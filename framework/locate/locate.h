/* Which tetrahedron of a scene holds a point: kernels/locate.clh. */
#ifndef BB_LOCATE_H
#define BB_LOCATE_H

#include "framework/locate/tet_search.h"

typedef struct bb_locator bb_locator;

/* For a scene with tetrahedra, which is on the device and outlives it. Owned by the caller. */
bb_status bb_locator_create(const bb_scene *scene, bb_locator **out);
void bb_locator_destroy(bb_locator *locator); /* NULL is allowed */

/* From now on as on a device that has no doubles. Before the first search. */
void bb_locator_take_floats(bb_locator *locator);

/* Enqueues the search for `count` points (float[3] each, in scene units) in the locator's scene;
 * does not wait. `results` gets bb_located, `counts`, if not NULL, bb_count. */
bb_status bb_locate_points(bb_locator *locator, const bb_tet_search *search,
                           const bb_buffer *points, uint32_t count, bb_buffer *results,
                           bb_buffer *counts);

/* The tetrahedra that hold the point, by exact arithmetic and one after the other: their number,
 * and the first `capacity` of them, as primitives in ascending order. */
uint32_t bb_locate_all(const bb_scene *scene, const double point[3], uint32_t *prims,
                       uint32_t capacity);

#endif
