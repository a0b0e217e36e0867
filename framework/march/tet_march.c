#include "framework/march/tet_march.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { GROUP_SIZE = 64, WIDTHS = 128, WAYS = 3 }; /* skip; octree; octree by intervals */

struct bb_tet_marcher {
    const bb_scene *scene;
    bb_device *device;
    bb_tet_march_args args;
    bb_buffer table;
    cl_program programs[WAYS][2]; /* not counting, counting */
    cl_kernel kernels[WAYS][2];
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
    for (int way = 0; way < WAYS; way++)
        for (int counting = 0; counting < 2; counting++) {
            bb_kernel_release(marcher->kernels[way][counting]);
            bb_program_release(marcher->programs[way][counting]);
        }
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

static bb_status compile(bb_tet_marcher *marcher, int way, int counting)
{
    char defines[128];
    if (marcher->kernels[way][counting] != NULL)
        return BB_OK;
    snprintf(defines, sizeof defines,
             "-DBB_LOCATE_OCTREE=%d -DBB_TET_INTERVAL=%d -DBB_COUNTING=%d -DBB_HAS_DOUBLES=%d",
             way > 0, way == 2, counting, bb_locate_has_doubles(marcher->device));
    BB_TRY(bb_program_build(marcher->device, bb_source_find("tet_march.cl"), defines,
                            &marcher->programs[way][counting]));
    return bb_kernel_get(marcher->programs[way][counting], "tet_march",
                         &marcher->kernels[way][counting]);
}

bb_status bb_tet_march(bb_tet_marcher *marcher, const bb_tet_way *way, const bb_buffer *rays,
                       uint32_t count, bb_buffer *lights, bb_buffer *counts)
{
    const bb_scene_device *there = &marcher->scene->on_device;
    const bool octree = strcmp(way->layout->name, "octree") == 0;
    const int number = octree ? 1 + way->interval : 0, counting = counts != NULL;
    if (!bb_locator_takes(way->layout) || (way->interval && !octree))
        return bb_fail(BB_UNSUPPORTED, "layout %s cannot be marched through%s", way->layout->name,
                       way->interval ? " by intervals: it has no flags of the boundary" : "");
    BB_TRY(compile(marcher, number, counting));
    const bb_locate_args search = bb_locate_args_of(marcher->scene, way->data);
    bb_arg args[14];
    uint32_t n = 0;
    for (uint32_t i = 0; i < way->data->buffer_count; i++)
        args[n++] = BB_MEM(way->data->buffers[i]);
    args[n++] = BB_VALUE(search);
    args[n++] = BB_MEM(there->tet_flags);
    args[n++] = BB_MEM(there->prims);
    args[n++] = BB_VALUE(way->data->ends);
    args[n++] = BB_MEM(there->field);
    args[n++] = BB_MEM(marcher->table);
    args[n++] = BB_VALUE(marcher->args);
    args[n++] = BB_MEM(*rays);
    args[n++] = BB_VALUE(count);
    args[n++] = BB_MEM(*lights);
    if (counting)
        args[n++] = BB_MEM(*counts);
    return bb_launch_args(marcher->device, marcher->kernels[number][counting], count, GROUP_SIZE,
                          args, n);
}
