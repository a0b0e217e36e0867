/* Faces of tetrahedra. */
#ifndef BB_TETS_FACES_H
#define BB_TETS_FACES_H

#include "framework/scene/tets.h"

/* A tetrahedron at a face. */
typedef struct bb_face_use {
    uint32_t corners[3]; /* of the face, in ascending order */
    uint32_t tet : 30;
    uint32_t face : 2; /* of the tetrahedron */
    int side;          /* of the face, on which it lies; 0: it has no volume */
} bb_face_use;

/* Calls visit() for each face, with all tetrahedra at it in ascending order. Faces are in ascending
 * order of their corners, which are the same for all of `uses`. BB_REFUSED without memory. */
bb_status bb_tets_visit_faces(const bb_scene *scene,
                              void (*visit)(void *self, const bb_face_use *uses, uint32_t count),
                              void *self);

/* Makes a scene of the mesh's faces: one triangle each, with the mesh's vertices; none of faces
 * that only tetrahedra without a volume have. sides[i]: which tetrahedra are at triangle i. The
 * caller owns both: bb_scene_free(), bb_host_free(). */
bb_status bb_tets_faces(const bb_scene *mesh, bb_scene **faces, bb_face_sides **sides);

#endif
