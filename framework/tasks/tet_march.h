/* Renders tetrahedra with a scalar field by marching along rays. Each sample searches a tree for
 * the tetrahedron around it (kernels/tet_march.cl). */
#ifndef BB_TET_MARCH_H
#define BB_TET_MARCH_H

#include "framework/bench/tet_search.h"
#include "framework/tasks/march.h"

typedef struct bb_tet_marcher bb_tet_marcher;

/* Creates a marcher for a scene with tetrahedra, which must be on the device and outlive the
 * marcher. Scratch is booked on `account`. The caller owns the marcher. */
bb_status bb_tet_marcher_create(const bb_scene *scene, bb_account *account, bb_tet_marcher **out);
void bb_tet_marcher_destroy(bb_tet_marcher *marcher); /* NULL is allowed */

/* Returns the length to which a transfer function's ALPHA applies: 1/128 of the scene's longest
 * side. VALUE covers the range of the field. */
double bb_tet_march_width(const bb_scene *scene);

bb_status bb_tet_marcher_set(bb_tet_marcher *marcher, const bb_march_settings *settings,
                             const bb_transfer *transfer);

/* Enqueues the rays and does not wait. `interval`: skips the parts of a ray that are outside by the
 * boundary's cells; BB_UNSUPPORTED without cells. `lights` gets bb_light; `counts`, if not NULL,
 * gets visited nodes, and as primitives the samples inside a tetrahedron. */
bb_status bb_tet_march(bb_tet_marcher *marcher, const bb_tet_search *search, bool interval,
                       const bb_buffer *rays, uint32_t count, bb_buffer *lights, bb_buffer *counts);

#endif
