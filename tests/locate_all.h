/* The tetrahedra that hold a point, by exact arithmetic and one after the other: what trees are
 * compared with. */
#ifndef BB_TEST_LOCATE_ALL_H
#define BB_TEST_LOCATE_ALL_H

#include "framework/scene/scene.h"

static inline bool is_in_box(const bb_box *box, const double point[3])
{
    bool in = true;
    for (int k = 0; k < 3; k++)
        in = in && point[k] >= (double)box->lo[k] && point[k] <= (double)box->hi[k];
    return in;
}

/* Their number, and the first `capacity` of them, as primitives in ascending order. */
static inline uint32_t locate_all(const bb_scene *scene, const double point[3], uint32_t *prims,
                                  uint32_t capacity)
{
    const bb_prims *tets = &scene->prims[BB_TETRAHEDRON];
    uint32_t found = 0;
    for (uint32_t i = 0; i < tets->count; i++) {
        if (!is_in_box(&scene->boxes[tets->first + i], point) || !bb_tet_holds(scene, i, point))
            continue;
        if (found < capacity)
            prims[found] = tets->first + i;
        found++;
    }
    return found;
}

#endif
