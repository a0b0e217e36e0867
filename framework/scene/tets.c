/* Tetrahedra: sides, and what they hold. */
#include "framework/scene/tets.h"

#include "framework/scene/exact.h"

const int bb_tet_faces[4][3] = {{1, 2, 3}, {0, 2, 3}, {0, 1, 3}, {0, 1, 2}};

static void corners_of(const bb_scene *scene, uint32_t i, const float *v[4])
{
    for (int c = 0; c < 4; c++)
        v[c] = scene->vertices + 3 * (size_t)bb_scene_tet(scene, i)[c];
}

int bb_tet_side(const float *const v[4])
{
    const double last[3] = {v[3][0], v[3][1], v[3][2]};
    return bb_exact_side(last, v[0], v[1], v[2]);
}

bool bb_tet_holds(const bb_scene *scene, uint32_t i, const double point[3])
{
    const float *v[4];
    corners_of(scene, i, v);
    if (bb_tet_side(v) == 0)
        return false;
    for (int f = 0; f < 4; f++) {
        const int *face = bb_tet_faces[f];
        const float *a = v[face[0]], *b = v[face[1]], *c = v[face[2]];
        const double opposite[3] = {v[f][0], v[f][1], v[f][2]};
        if (bb_exact_side(point, a, b, c) == -bb_exact_side(opposite, a, b, c))
            return false;
    }
    return true;
}
