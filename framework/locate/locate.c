#include "framework/locate/locate.h"

#include <stdlib.h>

enum { GROUP_SIZE = 64 };

struct bb_locator {
    const bb_scene *scene;
    bb_device *device;
    bb_tet_kernels kernels;
};

bb_status bb_locator_create(const bb_scene *scene, bb_locator **out)
{
    *out = NULL;
    if (scene->tets == NULL)
        return bb_fail(BB_UNSUPPORTED, "%s: has no tetrahedra that could hold a point",
                       scene->name);
    *out = calloc(1, sizeof **out);
    if (*out == NULL)
        return bb_fail(BB_REFUSED, "no memory to look for points");
    (*out)->scene = scene;
    (*out)->device = scene->on_device.device;
    (*out)->kernels = (bb_tet_kernels){.source = "locate_points.cl", .name = "locate_points"};
    return BB_OK;
}

void bb_locator_destroy(bb_locator *locator)
{
    if (locator == NULL)
        return;
    bb_tet_kernels_release(&locator->kernels);
    free(locator);
}

void bb_locator_take_floats(bb_locator *locator)
{
    locator->kernels.floats = true;
}

bb_status bb_locate_points(bb_locator *locator, const bb_tet_search *search,
                           const bb_buffer *points, uint32_t count, bb_buffer *results,
                           bb_buffer *counts)
{
    const bb_scene_device *there = &locator->scene->on_device;
    const bb_prim_ends ends = bb_scene_ends(locator->scene);
    bb_arg args[BB_TET_SEARCH_ARGS + 7];
    cl_kernel kernel;
    BB_TRY(bb_tet_kernels_get(&locator->kernels, locator->device, search->way, false,
                              counts != NULL, &kernel));
    uint32_t n = bb_tet_search_args(search, args);
    args[n++] = BB_MEM(there->prims);
    args[n++] = BB_VALUE(ends);
    args[n++] = BB_MEM(there->field);
    args[n++] = BB_MEM(*points);
    args[n++] = BB_VALUE(count);
    args[n++] = BB_MEM(*results);
    if (counts != NULL)
        args[n++] = BB_MEM(*counts);
    return bb_launch_args(locator->device, kernel, count, GROUP_SIZE, args, n);
}

static bool in_box(const bb_box *box, const double point[3])
{
    bool in = true;
    for (int k = 0; k < 3; k++)
        in = in && point[k] >= (double)box->lo[k] && point[k] <= (double)box->hi[k];
    return in;
}

uint32_t bb_locate_all(const bb_scene *scene, const double point[3], uint32_t *prims,
                       uint32_t capacity)
{
    const bb_prims *tets = &scene->prims[BB_TETRAHEDRON];
    uint32_t found = 0;
    for (uint32_t i = 0; i < tets->count; i++) {
        if (!in_box(&scene->boxes[tets->first + i], point) || !bb_tet_holds(scene, i, point))
            continue;
        if (found < capacity)
            prims[found] = tets->first + i;
        found++;
    }
    return found;
}
