/* Additional data of a scene of tetrahedra: which are on the boundary, and a scalar field. */
#ifndef BB_TETS_H
#define BB_TETS_H

#include "framework/scene/scene.h"
#include "kernels/tet_shared.h"

#pragma GCC visibility push(default) /* what a plug-in may call */
#ifdef __cplusplus
extern "C" {
#endif

typedef struct bb_tets {
    uint32_t *flags;                                     /* per tetrahedron: BB_TET_... */
    uint32_t boundary_count, flat_count, negative_count; /* tetrahedra with a flag */
    float *field;                                        /* per vertex; finite */
    float field_lo, field_hi;
    char field_name[64]; /* as in the file; "made": the file had none */
} bb_tets;

/* Face f has these three corners: all but the f-th. */
extern const int bb_tet_faces[4][3];

/* Returns the four indices of tetrahedron i. */
static inline const uint32_t *bb_scene_tet(const bb_scene *scene, uint32_t i)
{
    return (const uint32_t *)scene->prims[BB_TETRAHEDRON].data + 4 * (size_t)i;
}

/* Returns the sign of its volume, exactly; above 0 if corner 3 is where the right hand's thumb
 * points when its fingers go from corner 0 to 1 to 2. */
int bb_tet_side(const float *const corners[4]);

/* Returns whether the closed tetrahedron contains the point, exactly. One without a volume contains
 * none. */
bool bb_tet_holds(const bb_scene *scene, uint32_t i, const double point[3]);

/* For loaders: allocates the scene's own field, to be filled with a value per vertex; without it
 * bb_scene_finish() makes one. */
bb_status bb_scene_reserve_field(bb_scene *scene, const char *name, float **field);

/* Computes flags and field: part of bb_scene_finish(). */
bb_status bb_scene_finish_tets(bb_scene *scene);
void bb_tets_free(bb_tets *tets); /* NULL is allowed */

#ifdef __cplusplus
}
#endif
#pragma GCC visibility pop

#endif
