/* Which tetrahedra of one mesh meet another mesh: kernels/overlap_tets.cl. */
#ifndef BB_OVERLAP_H
#define BB_OVERLAP_H

#include "framework/bench/tet_search.h"

/* Variants of the kernels: `bb_overlapper_init` begins one, which is to be released. */
typedef struct bb_overlapper {
    bb_tet_kernels overlap, cells_inside, leaves_inside;
} bb_overlapper;

extern const bb_overlapper bb_overlapper_init;
void bb_overlapper_release(bb_overlapper *overlapper);

/* Whether lengths of `scene` can be put beside those of `other`: BB_UNSUPPORTED, with one line, if
 * they are too large in the unit of the other's layouts. */
bb_status bb_overlap_check(const bb_overlapper *overlapper, const bb_scene *scene,
                           const bb_scene *other);

/* Enqueues the question which tetrahedra of `scene` meet one of those that `search` finds, in
 * another scene or the same; does not wait. Both are on the device. `by_flags`: cells that are all
 * inside or all outside of the other mesh spare tests; they are found out first, and written down
 * in the layout; BB_UNSUPPORTED without cells. `results` gets 1 or 0, a uint32_t for each;
 * `counts`, if not NULL, bb_count. */
bb_status bb_overlap(bb_overlapper *overlapper, const bb_scene *scene, const bb_tet_search *search,
                     bool by_flags, bb_buffer *results, bb_buffer *counts);

#endif
