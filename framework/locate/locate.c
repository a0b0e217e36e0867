#include "framework/locate/locate.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { GROUP_SIZE = 64, WAYS = 2 };

struct bb_locator {
    const bb_scene *scene;
    bb_device *device;
    bool floats;
    cl_program programs[WAYS][2]; /* skip, octree; not counting, counting */
    cl_kernel kernels[WAYS][2];
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
    return BB_OK;
}

void bb_locator_destroy(bb_locator *locator)
{
    if (locator == NULL)
        return;
    for (int way = 0; way < WAYS; way++)
        for (int counting = 0; counting < 2; counting++) {
            bb_kernel_release(locator->kernels[way][counting]);
            bb_program_release(locator->programs[way][counting]);
        }
    free(locator);
}

void bb_locator_take_floats(bb_locator *locator)
{
    locator->floats = true;
}

static int way_of(const bb_layout *layout)
{
    return strcmp(layout->name, "skip") == 0 ? 0 : strcmp(layout->name, "octree") == 0 ? 1 : -1;
}

bool bb_locator_takes(const bb_layout *layout)
{
    return way_of(layout) >= 0;
}

bool bb_locate_has_doubles(const bb_device *device)
{
    cl_device_fp_config config = 0;
    return clGetDeviceInfo(device->id, CL_DEVICE_DOUBLE_FP_CONFIG, sizeof config, &config, NULL) ==
               CL_SUCCESS &&
           config != 0;
}

static bb_status compile(bb_locator *locator, int way, int counting)
{
    char defines[96];
    if (locator->kernels[way][counting] != NULL)
        return BB_OK;
    snprintf(defines, sizeof defines, "-DBB_LOCATE_OCTREE=%d -DBB_COUNTING=%d -DBB_HAS_DOUBLES=%d",
             way, counting, !locator->floats && bb_locate_has_doubles(locator->device));
    BB_TRY(bb_program_build(locator->device, bb_source_find("locate_points.cl"), defines,
                            &locator->programs[way][counting]));
    return bb_kernel_get(locator->programs[way][counting], "locate_points",
                         &locator->kernels[way][counting]);
}

bb_locate_args bb_locate_args_of(const bb_scene *scene, const bb_layout_data *data)
{
    return (bb_locate_args){
        .root = data->root,
        .first = scene->prims[BB_TETRAHEDRON].first,
        .words = bb_leaf_prim_words(data->kinds, data->format),
        .id_word = bb_leaf_prim_payload(data->kinds, data->format),
        .scale = data->scale,
    };
}

bb_status bb_locate_points(bb_locator *locator, const bb_layout *layout, const bb_layout_data *data,
                           const bb_buffer *points, uint32_t count, bb_buffer *results,
                           bb_buffer *counts)
{
    const bb_scene *scene = locator->scene;
    const bb_scene_device *there = &scene->on_device;
    const int way = way_of(layout), counting = counts != NULL;
    if (way < 0)
        return bb_fail(BB_UNSUPPORTED,
                       "layout %s cannot be searched for points: take skip or octree",
                       layout->name);
    BB_TRY(compile(locator, way, counting));
    const bb_locate_args search = bb_locate_args_of(scene, data);
    bb_arg args[12];
    uint32_t n = 0;
    for (uint32_t i = 0; i < data->buffer_count; i++)
        args[n++] = BB_MEM(data->buffers[i]);
    args[n++] = BB_VALUE(search);
    args[n++] = BB_MEM(there->tet_flags);
    args[n++] = BB_MEM(there->prims);
    args[n++] = BB_VALUE(data->ends);
    args[n++] = BB_MEM(there->field);
    args[n++] = BB_MEM(*points);
    args[n++] = BB_VALUE(count);
    args[n++] = BB_MEM(*results);
    if (counting)
        args[n++] = BB_MEM(*counts);
    return bb_launch_args(locator->device, locator->kernels[way][counting], count, GROUP_SIZE, args,
                          n);
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
