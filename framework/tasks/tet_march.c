#include "framework/tasks/tet_march.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTHS = 128 };

struct bb_tet_marcher {
    const bb_scene *scene;
    bb_device *device;
    bb_tet_march_args args;
    bb_buffer table;
    bb_tet_kernels kernels;
};

bb_status bb_tet_marcher_create(const bb_scene *scene, bb_account *account, bb_tet_marcher **out)
{
    *out = NULL;
    if (scene->tets == NULL)
        return bb_fail(BB_INVALID, "%s: has no tetrahedra to march through", scene->name);
    bb_tet_marcher *marcher = calloc(1, sizeof *marcher);
    if (marcher == NULL)
        return bb_fail(BB_REFUSED, "no memory for a march");
    marcher->scene = scene;
    marcher->device = scene->on_device.device;
    marcher->kernels = (bb_tet_kernels){
        .source = "tet_march.cl", .name = "tet_march", .option = "BB_TET_INTERVAL"};
    bb_status status =
        bb_buffer_reserve(marcher->device, account, BB_TRANSFER_STEPS * sizeof(bb_transfer_entry),
                          "table of a transfer function", &marcher->table);
    if (status != BB_OK) {
        bb_tet_marcher_destroy(marcher);
        return status;
    }
    *out = marcher;
    return BB_OK;
}

void bb_tet_marcher_destroy(bb_tet_marcher *marcher)
{
    if (marcher == NULL)
        return;
    bb_buffer_release(&marcher->table);
    bb_tet_kernels_release(&marcher->kernels);
    free(marcher);
}

double bb_tet_march_width(const bb_scene *scene)
{
    double longest = 0;
    for (int k = 0; k < 3; k++)
        longest = fmax(longest, (double)scene->bounds.hi[k] - (double)scene->bounds.lo[k]);
    return longest / WIDTHS;
}

bb_status bb_tet_marcher_set(bb_tet_marcher *marcher, const bb_march_settings *settings,
                             const bb_transfer *transfer)
{
    const bb_scene *scene = marcher->scene;
    const double range = (double)scene->tets->field_hi - (double)scene->tets->field_lo;
    bb_transfer_entry table[BB_TRANSFER_STEPS];
    BB_TRY(bb_march_check_settings(settings));
    marcher->args = (bb_tet_march_args){
        .field_lo = scene->tets->field_lo,
        .per_field = range > 0 ? (float)((BB_TRANSFER_STEPS - 1) / range) : 0,
        .step = settings->step,
        .cutoff = settings->cutoff,
    };
    memcpy(marcher->args.lo, scene->bounds.lo, sizeof marcher->args.lo);
    memcpy(marcher->args.hi, scene->bounds.hi, sizeof marcher->args.hi);
    bb_transfer_table(transfer, bb_tet_march_width(scene), table);
    return bb_buffer_write(&marcher->table, 0, sizeof table, table);
}

bb_status bb_tet_march(bb_tet_marcher *marcher, const bb_tet_search *search, bool interval,
                       const bb_buffer *rays, uint32_t count, bb_buffer *lights, bb_buffer *counts)
{
    const bb_scene_device *there = &marcher->scene->on_device;
    const bb_prim_ends ends = bb_scene_ends(marcher->scene);
    bb_arg args[BB_TET_SEARCH_ARGS + 8 + BB_TET_COUNT_ARGS];
    cl_kernel kernel;
    if (interval && !bb_tet_search_has_boundary(search->way))
        return bb_fail(BB_UNSUPPORTED,
                       "there are no cells with flags of the boundary to find intervals by");
    BB_TRY(bb_tet_kernels_get(&marcher->kernels, marcher->device, search->way, interval,
                              bb_tet_counting_for(search, counts), &kernel));
    uint32_t n = bb_tet_search_args(search, args);
    args[n++] = BB_MEM(there->prims);
    args[n++] = BB_VALUE(ends);
    args[n++] = BB_MEM(there->field);
    args[n++] = BB_MEM(marcher->table);
    args[n++] = BB_VALUE(marcher->args);
    args[n++] = BB_MEM(*rays);
    args[n++] = BB_VALUE(count);
    args[n++] = BB_MEM(*lights);
    n += bb_tet_count_args(search, counts, args + n);
    return bb_launch_args(marcher->device, kernel, count, BB_TET_GROUP, args, n);
}
