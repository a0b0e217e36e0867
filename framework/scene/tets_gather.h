/* Combines the tetrahedra of several scenes, or some of them, into one scene. */
#ifndef BB_TETS_GATHER_H
#define BB_TETS_GATHER_H

#include "framework/scene/tets.h"

typedef struct bb_tets_part {
    const bb_scene *scene;
    const uint32_t *left_out; /* per tetrahedron: leave it out if not 0; NULL: take all */
    double scale, shift[3];   /* applied to the vertices: scale first, then shift */
} bb_tets_part;

/* Makes a finished scene with its own views; tetrahedra are in the order of the parts. BB_INVALID
 * if none are taken, or a vertex leaves the range of floats. The caller owns *out:
 * bb_scene_free(). */
bb_status bb_tets_gather(const char *name, const bb_tets_part *parts, uint32_t count,
                         bb_scene **out);

/* Places `mesh` in the middle of another's box, scaled so that its box's longest side is `times` as
 * long. The caller owns *out. */
bb_status bb_tets_fit(const bb_scene *mesh, const bb_scene *into, double times, bb_scene **out);

#endif
