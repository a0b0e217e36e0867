#include "framework/bench/tet_search.h"

#include "framework/base/memory.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const bb_option bb_tet_search_options[] = {
    {"boundary", "yes", "yes|no", "use what cells say of the mesh's boundary"},
    {.name = NULL},
};

bool bb_tet_search_has_boundary(bb_tet_search_way way)
{
    return way == BB_SEARCH_OCTREE || way == BB_SEARCH_OLBVH;
}

/* NULL: no such layout can be searched. */
static const bb_layout *find_layout(const char *name)
{
    const bb_layout *layout = bb_layout_find(name);
    return layout != NULL && layout->search != BB_SEARCH_NONE ? layout : NULL;
}

/* Names those that can be searched. */
static bb_status no_such_search(bb_status status, const char *what, const char *name)
{
    char there[128] = "";
    size_t length = 0;
    for (const bb_layout *const *layout = bb_layouts; *layout != NULL; layout++)
        if ((*layout)->search != BB_SEARCH_NONE && length < sizeof there)
            length += (size_t)snprintf(there + length, sizeof there - length, "%s%s",
                                       length > 0 ? ", " : "", (*layout)->name);
    return bb_fail(status, "%s '%s': there are %s", what, name, there);
}

bb_status bb_tet_search_parse(const char *text, bb_spec *spec)
{
    BB_TRY(bb_spec_parse(text, spec));
    const bb_layout *layout = find_layout(spec->name);
    char what[96];
    if (layout == NULL)
        return no_such_search(BB_INVALID, "there is no search", spec->name);
    snprintf(what, sizeof what, "search %s", spec->name);
    return bb_spec_validate(
        spec, bb_tet_search_has_boundary(layout->search) ? bb_tet_search_options : NULL, what);
}

bool bb_tet_search_by_boundary(const bb_spec *spec)
{
    const bb_layout *layout = find_layout(spec->name);
    return layout != NULL && bb_tet_search_has_boundary(layout->search) &&
           bb_spec_is(spec, bb_tet_search_options, "boundary", "yes");
}

bb_status bb_tet_search_by(const bb_scene *scene, const bb_layout *layout,
                           const bb_layout_data *data, bb_tet_search *search)
{
    if (layout->search == BB_SEARCH_NONE)
        return no_such_search(BB_UNSUPPORTED, "tetrahedra cannot be searched by layout",
                              layout->name);
    *search = (bb_tet_search){
        .way = layout->search,
        .scene = scene,
        .layout = layout,
        .data = data,
        .ends = bb_scene_ends(scene),
        .args = {.root = data->root,
                 .first = scene->prims[BB_TETRAHEDRON].first,
                 .words = bb_leaf_prim_words(data->kinds, data->format),
                 .id_word = bb_leaf_prim_payload(data->kinds, data->format),
                 .levels = data->levels,
                 .scale = data->scale},
    };
    return BB_OK;
}

enum { LIST_WORDS = 13 }; /* corners and number, as in a leaf */

static void list_tet(const bb_scene *scene, uint32_t i, float *words)
{
    const bb_prims *tets = &scene->prims[BB_TETRAHEDRON];
    const uint32_t *corners = bb_scene_tet(scene, i);
    uint32_t number = tets->first + i;
    for (uint32_t c = 0; c < 4; c++)
        for (uint32_t k = 0; k < 3; k++)
            words[3 * c + k] = scene->vertices[3 * (size_t)corners[c] + k] * scene->scale;
    if (i + 1 == tets->count)
        number |= BB_LAST_BIT;
    memcpy(&words[LIST_WORDS - 1], &number, sizeof number);
}

bb_status bb_tet_list_make(const bb_scene *scene, bb_buffer *list)
{
    const uint32_t count = scene->prims[BB_TETRAHEDRON].count;
    const size_t bytes = (size_t)count * LIST_WORDS * sizeof(float);
    float *words = NULL;
    BB_TRY(bb_host_alloc(NULL, bytes, "list of tetrahedra", &words));
    for (uint32_t i = 0; i < count; i++)
        list_tet(scene, i, words + (size_t)LIST_WORDS * i);
    bb_status status =
        bb_buffer_reserve(scene->on_device.device, NULL, bytes, "list of tetrahedra", list);
    if (status == BB_OK)
        status = bb_buffer_write(list, 0, bytes, words);
    bb_host_free(words);
    return status;
}

void bb_tet_search_all(const bb_scene *scene, const bb_buffer *list, bb_tet_search *search)
{
    *search = (bb_tet_search){
        .way = BB_SEARCH_ALL,
        .scene = scene,
        .list = list,
        .args = {.root = 0,
                 .first = scene->prims[BB_TETRAHEDRON].first,
                 .words = LIST_WORDS,
                 .id_word = LIST_WORDS - 1,
                 .scale = scene->scale},
    };
}

uint32_t bb_tet_search_args(const bb_tet_search *search, bb_arg args[BB_TET_SEARCH_ARGS])
{
    uint32_t n = 0;
    if (search->way == BB_SEARCH_ALL) {
        args[n++] = BB_MEM(*search->list); /* in place of nodes, which are not read */
        args[n++] = BB_MEM(*search->list);
    }
    for (uint32_t i = 0; search->way != BB_SEARCH_ALL && i < search->data->buffer_count; i++)
        args[n++] = BB_MEM(search->data->buffers[i]);
    if (search->way == BB_SEARCH_OLBVH) {
        args[n++] = BB_MEM(search->scene->on_device.prims);
        args[n++] = BB_VALUE(search->ends);
        args[n++] = BB_MEM(search->scene->on_device.vertices);
    }
    args[n++] = BB_VALUE(search->args);
    args[n++] = BB_MEM(search->scene->on_device.tet_flags);
    return n;
}

uint32_t bb_tet_count_args(const bb_tet_search *search, const bb_buffer *counts,
                           bb_arg args[BB_TET_COUNT_ARGS])
{
    uint32_t n = 0;
    if (counts != NULL)
        args[n++] = BB_MEM(*counts);
    if (search->recording != NULL) {
        args[n++] = BB_MEM(search->recording->ends);
        args[n++] = BB_MEM(search->recording->steps);
        args[n++] = BB_MEM(search->recording->counts);
    }
    return n;
}

bb_tet_counting bb_tet_counting_for(const bb_tet_search *search, const bb_buffer *counts)
{
    return search->recording != NULL ? BB_TET_RECORDING
           : counts != NULL          ? BB_TET_COUNTING
                                     : BB_TET_PLAIN;
}

bool bb_device_has_doubles(const bb_device *device)
{
    cl_device_fp_config config = 0;
    return clGetDeviceInfo(device->id, CL_DEVICE_DOUBLE_FP_CONFIG, sizeof config, &config, NULL) ==
               CL_SUCCESS &&
           config != 0;
}

bb_status bb_tet_kernels_get(bb_tet_kernels *kernels, bb_device *device, bb_tet_search_way way,
                             bool option, bb_tet_counting counting, cl_kernel *kernel)
{
    cl_kernel *slot = &kernels->kernels[way][option][counting];
    cl_program *program = &kernels->programs[way][option][counting];
    char defines[192], own[64] = "";
    *kernel = *slot;
    if (*slot != NULL)
        return BB_OK;
    if (kernels->option != NULL)
        snprintf(own, sizeof own, " -D%s=%d", kernels->option, option);
    snprintf(defines, sizeof defines,
             "-DBB_LOCATE_OCTREE=%d -DBB_LOCATE_OLBVH=%d -DBB_LOCATE_ALL=%d -DBB_COUNTING=%d "
             "-DBB_HAS_DOUBLES=%d%s%s",
             way == BB_SEARCH_OCTREE, way == BB_SEARCH_OLBVH, way == BB_SEARCH_ALL,
             counting != BB_TET_PLAIN, !kernels->floats && bb_device_has_doubles(device), own,
             counting == BB_TET_RECORDING ? " -DBB_RECORDING=1" : "");
    BB_TRY(bb_program_build(device, bb_source_find(kernels->source), defines, program));
    BB_TRY(bb_kernel_get(*program, kernels->name, slot));
    *kernel = *slot;
    return BB_OK;
}

void bb_tet_kernels_release(bb_tet_kernels *kernels)
{
    for (int way = 0; way < BB_SEARCH_WAYS; way++)
        for (int i = 0; i < 2 * BB_TET_VARIANTS; i++) {
            bb_kernel_release(kernels->kernels[way][i / BB_TET_VARIANTS][i % BB_TET_VARIANTS]);
            bb_program_release(kernels->programs[way][i / BB_TET_VARIANTS][i % BB_TET_VARIANTS]);
        }
}
