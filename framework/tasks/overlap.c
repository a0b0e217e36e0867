#include "framework/tasks/overlap.h"

#include "kernels/cell_grid_shared.h"

#include <math.h>

enum {
    INSIDE_BITS = 4, /* cells of that level, in all 4,096, are looked at in parallel */
};

const bb_overlapper bb_overlapper_init = {
    .overlap = {.source = "overlap_tets.cl", .name = "overlap_tets", .option = "BB_OVERLAP_FLAGS"},
    .cells_inside = {.source = "octree_inside.cl", .name = "octree_inside"},
    .leaves_inside = {.source = "olbvh_inside.cl", .name = "olbvh_inside"}};

void bb_overlapper_release(bb_overlapper *overlapper)
{
    bb_tet_kernels_release(&overlapper->overlap);
    bb_tet_kernels_release(&overlapper->cells_inside);
    bb_tet_kernels_release(&overlapper->leaves_inside);
}

bb_status bb_overlap_check(const bb_overlapper *overlapper, const bb_scene *scene,
                           const bb_scene *other)
{
    const bool doubles =
        !overlapper->overlap.floats && bb_device_has_doubles(other->on_device.device);
    double largest = 0;
    for (int k = 0; k < 3; k++)
        largest = fmax(largest,
                       fmax(fabs((double)scene->bounds.lo[k]), fabs((double)scene->bounds.hi[k])));
    return largest * (double)other->scale < (doubles ? 0x1p120 : 0x1p59)
               ? BB_OK
               : bb_fail(BB_UNSUPPORTED,
                         "%s reaches to %g, which is too far beside %s: move or scale one of them",
                         scene->name, largest, other->name);
}

static bb_status find_inside(bb_overlapper *overlapper, const bb_tet_search *search)
{
    const uint32_t bits = INSIDE_BITS;
    const bool of_cells = search->way == BB_SEARCH_OCTREE;
    bb_device *device = search->scene->on_device.device;
    bb_arg args[BB_TET_SEARCH_ARGS + 1];
    cl_kernel kernel;
    BB_TRY(bb_tet_kernels_get(of_cells ? &overlapper->cells_inside : &overlapper->leaves_inside,
                              device, search->way, false, BB_TET_PLAIN, &kernel));
    uint32_t n = bb_tet_search_args(search, args);
    if (!of_cells)
        return bb_launch_args(device, kernel, search->data->leaves, BB_TET_GROUP, args, n);
    args[n++] = BB_VALUE(bits);
    return bb_launch_args(device, kernel, (size_t)1 << 3 * bits, BB_TET_GROUP, args, n);
}

bb_status bb_overlap(bb_overlapper *overlapper, const bb_scene *scene, const bb_tet_search *search,
                     bool by_flags, bb_buffer *results, bb_buffer *counts)
{
    const bb_scene_device *there = &scene->on_device;
    const bb_prims *own = &scene->prims[BB_TETRAHEDRON];
    const bb_prim_ends ends = bb_scene_ends(scene);
    const uint32_t first = own->first, count = own->count;
    bb_arg args[BB_TET_SEARCH_ARGS + 7 + BB_TET_COUNT_ARGS];
    cl_kernel kernel;
    BB_TRY(bb_overlap_check(overlapper, scene, search->scene));
    if (by_flags && !bb_tet_search_has_boundary(search->way))
        return bb_fail(BB_UNSUPPORTED,
                       "there are no cells with flags of the boundary to find the inside by");
    if (by_flags)
        BB_TRY(find_inside(overlapper, search));
    BB_TRY(bb_tet_kernels_get(&overlapper->overlap, search->scene->on_device.device, search->way,
                              by_flags, bb_tet_counting_for(search, counts), &kernel));
    uint32_t n = bb_tet_search_args(search, args);
    args[n++] = BB_MEM(there->tet_flags);
    args[n++] = BB_MEM(there->prims);
    args[n++] = BB_VALUE(ends);
    args[n++] = BB_MEM(there->vertices);
    args[n++] = BB_VALUE(first);
    args[n++] = BB_VALUE(count);
    args[n++] = BB_MEM(*results);
    n += bb_tet_count_args(search, counts, args + n);
    return bb_launch_args(search->scene->on_device.device, kernel, count, BB_TET_GROUP, args, n);
}
