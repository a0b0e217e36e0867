#include "framework/overlap/overlap.h"

#include "kernels/cell_grid_shared.h"

#include <math.h>
#include <stdlib.h>

enum {
    GROUP_SIZE = 64,
    INSIDE_BITS = 4, /* cells of that level, in all 4,096, are looked at in parallel */
};

struct bb_overlapper {
    bb_device *device;
    bb_tet_kernels overlap, inside;
};

bb_status bb_overlapper_create(bb_device *device, bb_overlapper **out)
{
    *out = calloc(1, sizeof **out);
    if (*out == NULL)
        return bb_fail(BB_REFUSED, "no memory for overlaps");
    (*out)->device = device;
    (*out)->overlap = (bb_tet_kernels){
        .source = "overlap_tets.cl", .name = "overlap_tets", .option = "BB_OVERLAP_FLAGS"};
    (*out)->inside = (bb_tet_kernels){.source = "octree_inside.cl", .name = "octree_inside"};
    return BB_OK;
}

void bb_overlapper_destroy(bb_overlapper *overlapper)
{
    if (overlapper == NULL)
        return;
    bb_tet_kernels_release(&overlapper->overlap);
    bb_tet_kernels_release(&overlapper->inside);
    free(overlapper);
}

void bb_overlapper_take_floats(bb_overlapper *overlapper)
{
    overlapper->overlap.floats = overlapper->inside.floats = true;
}

bb_status bb_overlap_check(const bb_overlapper *overlapper, const bb_scene *scene,
                           const bb_scene *other)
{
    const bool doubles = !overlapper->overlap.floats && bb_device_has_doubles(overlapper->device);
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
    bb_arg args[BB_TET_SEARCH_ARGS + 1];
    cl_kernel kernel;
    BB_TRY(bb_tet_kernels_get(&overlapper->inside, overlapper->device, search->way, false, false,
                              &kernel));
    uint32_t n = bb_tet_search_args(search, args);
    args[n++] = BB_VALUE(bits);
    return bb_launch_args(overlapper->device, kernel, (size_t)1 << 3 * bits, GROUP_SIZE, args, n);
}

bb_status bb_overlap(bb_overlapper *overlapper, const bb_scene *scene, const bb_tet_search *search,
                     bool by_flags, bb_buffer *results, bb_buffer *counts)
{
    const bb_scene_device *there = &scene->on_device;
    const bb_prims *own = &scene->prims[BB_TETRAHEDRON];
    const bb_prim_ends ends = bb_scene_ends(scene);
    const uint32_t first = own->first, count = own->count;
    bb_arg args[BB_TET_SEARCH_ARGS + 8];
    cl_kernel kernel;
    BB_TRY(bb_overlap_check(overlapper, scene, search->scene));
    if (by_flags && search->way != BB_SEARCH_OCTREE)
        return bb_fail(BB_UNSUPPORTED,
                       "there are no cells with flags of the boundary to find the inside by");
    if (by_flags)
        BB_TRY(find_inside(overlapper, search));
    BB_TRY(bb_tet_kernels_get(&overlapper->overlap, overlapper->device, search->way, by_flags,
                              counts != NULL, &kernel));
    uint32_t n = bb_tet_search_args(search, args);
    args[n++] = BB_MEM(there->tet_flags);
    args[n++] = BB_MEM(there->prims);
    args[n++] = BB_VALUE(ends);
    args[n++] = BB_MEM(there->vertices);
    args[n++] = BB_VALUE(first);
    args[n++] = BB_VALUE(count);
    args[n++] = BB_MEM(*results);
    if (counts != NULL)
        args[n++] = BB_MEM(*counts);
    return bb_launch_args(overlapper->device, kernel, count, GROUP_SIZE, args, n);
}
