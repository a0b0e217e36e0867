/* Tetrahedra of several scenes, or some of them, as one scene. */
#ifndef BB_TETS_GATHER_H
#define BB_TETS_GATHER_H

#include "framework/scene/tets.h"

typedef struct bb_tets_part {
    const bb_scene *scene;
    const uint32_t *left_out; /* per tetrahedron: other than 0, it is not taken; NULL: all are */
    double scale, shift[3];   /* vertices are multiplied, then moved */
} bb_tets_part;

/* A finished scene with views of its own; tetrahedra in the order of the parts. BB_INVALID if none
 * are taken, or a vertex is moved beyond floats. Owned by the caller: bb_scene_free(). */
bb_status bb_tets_gather(const char *name, const bb_tets_part *parts, uint32_t count,
                         bb_scene **out);

/* `mesh` in the middle of another's box, its own box's longest side `times` as long. Owned by the
 * caller. */
bb_status bb_tets_fit(const bb_scene *mesh, const bb_scene *into, double times, bb_scene **out);

#endif
