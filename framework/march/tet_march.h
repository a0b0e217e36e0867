/* Pictures of tetrahedra with a scalar field: the march along rays, which asks a tree at each
 * sample for the tetrahedron that holds it (kernels/tet_march.cl). */
#ifndef BB_TET_MARCH_H
#define BB_TET_MARCH_H

#include "framework/locate/tet_search.h"
#include "framework/march/march.h"

typedef struct bb_tet_marcher bb_tet_marcher;

/* For a scene with tetrahedra, which is on the device and outlives it. Scratch is booked on
 * `account`. Owned by the caller. */
bb_status bb_tet_marcher_create(const bb_scene *scene, bb_account *account, bb_tet_marcher **out);
void bb_tet_marcher_destroy(bb_tet_marcher *marcher); /* NULL is allowed */

/* The length that a transfer function's ALPHA is for: 1/128 of the scene's longest side. Its VALUE
 * goes from the least of the field to the largest. */
double bb_tet_march_width(const bb_scene *scene);

bb_status bb_tet_marcher_set(bb_tet_marcher *marcher, const bb_march_settings *settings,
                             const bb_transfer *transfer);

/* Enqueues the rays; does not wait. `interval`: only where cells of the boundary say that a ray may
 * be inside, BB_UNSUPPORTED without cells. `lights` gets bb_light; `counts`, if not NULL, nodes
 * that were visited, and as primitives the samples that are in a tetrahedron. */
bb_status bb_tet_march(bb_tet_marcher *marcher, const bb_tet_search *search, bool interval,
                       const bb_buffer *rays, uint32_t count, bb_buffer *lights, bb_buffer *counts);

#endif
