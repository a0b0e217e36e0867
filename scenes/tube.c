/* Vertices: a ring of corners * across points at each of along + 1 heights, then the centre of
 * either end. */
#include "scenes/tube.h"

static uint32_t ring_of(const bb_tube *tube)
{
    return tube->corners * tube->across;
}

static uint64_t triangles_of(const bb_tube *tube)
{
    return 2ull * ring_of(tube) * tube->along + 2ull * ring_of(tube);
}

static uint32_t *put(uint32_t *to, uint32_t a, uint32_t b, uint32_t c)
{
    to[0] = a;
    to[1] = b;
    to[2] = c;
    return to + 3;
}

bb_status bb_tube_reserve(const bb_tube *tube, bb_scene *scene)
{
    uint32_t ring = ring_of(tube);
    BB_TRY(bb_scene_reserve_mesh(scene, ring * (tube->along + 1ull) + 2, triangles_of(tube)));
    uint32_t *to = bb_scene_indices(scene), top = ring * tube->along, bottom_middle = top + ring;
    for (uint32_t j = 0; j < tube->along; j++)
        for (uint32_t i = 0; i < ring; i++) {
            uint32_t a = j * ring + i, b = j * ring + (i + 1) % ring;
            to = put(to, a, b, b + ring);
            to = put(to, a, b + ring, a + ring);
        }
    for (uint32_t i = 0; i < ring; i++) {
        to = put(to, (i + 1) % ring, i, bottom_middle);
        to = put(to, top + i, top + (i + 1) % ring, bottom_middle + 1);
    }
    return BB_OK;
}

/* Gets point i of the ring, of `ring`. */
static void section_point(const bb_tube *tube, uint32_t i, double p[3])
{
    uint32_t corner = i / tube->across;
    const double *from = tube->section[corner], *to = tube->section[(corner + 1) % tube->corners];
    double part = (double)(i % tube->across) / tube->across;
    for (int axis = 0; axis < 2; axis++)
        p[axis] = from[axis] + part * (to[axis] - from[axis]);
}

void bb_tube_place(const bb_tube *tube, const bb_motion *motion,
                   void (*bend)(const void *user, double p[3]), const void *user, bb_scene *scene)
{
    float *to = scene->vertices;
    for (uint32_t j = 0; j <= tube->along; j++)
        for (uint32_t i = 0; i < ring_of(tube); i++) {
            double p[3] = {0, 0, tube->length * j / tube->along};
            section_point(tube, i, p);
            bend(user, p);
            to = bb_motion_put(motion, p, to);
        }
    for (int end = 0; end < 2; end++) {
        double p[3] = {0, 0, end * tube->length};
        bend(user, p);
        to = bb_motion_put(motion, p, to);
    }
}
