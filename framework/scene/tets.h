/* What a scene of tetrahedra has beside them: which lie on the boundary, and a scalar field. */
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
    uint32_t boundary_count, flat_count, negative_count; /* tetrahedra with such a flag */
    float *field;                                        /* per vertex; finite */
    float field_lo, field_hi;
    char field_name[64]; /* as the file has it; "made": it had none */
} bb_tets;

/* Face f has these three corners: all but the f-th. */
extern const int bb_tet_faces[4][3];

/* The four indices of tetrahedron i. */
static inline const uint32_t *bb_scene_tet(const bb_scene *scene, uint32_t i)
{
    return (const uint32_t *)scene->prims[BB_TETRAHEDRON].data + 4 * (size_t)i;
}

/* The sign of its volume, exactly; above 0 if corner 3 lies where the right hand's thumb points as
 * its fingers go from corner 0 to 1 to 2. */
int bb_tet_side(const float *const corners[4]);

/* Whether the closed tetrahedron holds the point, exactly. One without a volume holds none. */
bool bb_tet_holds(const bb_scene *scene, uint32_t i, const double point[3]);

/* For loaders: the scene's own field, to be filled with a value per vertex; bb_scene_finish() makes
 * one if there is none. */
bb_status bb_scene_reserve_field(bb_scene *scene, const char *name, float **field);

/* Flags and field: part of bb_scene_finish(). */
bb_status bb_scene_finish_tets(bb_scene *scene);
void bb_tets_free(bb_tets *tets); /* NULL is allowed */

#ifdef __cplusplus
}
#endif
#pragma GCC visibility pop

#endif
