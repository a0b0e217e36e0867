/* Leaf primitives in the order of the leaves: host side of kernels/leaf_prims.cl. */
#include "traversal/leaf_prims.h"

#include <stdlib.h>

enum { GROUP_SIZE = 64 };

struct bb_leaf_prims {
    bb_device *device;
    bb_account *account;
    cl_program program;
    cl_kernel kernel;
};

bb_status bb_leaf_prims_create(bb_device *device, bb_account *account, bb_leaf_prims **out)
{
    bb_leaf_prims *leaf_prims = calloc(1, sizeof *leaf_prims);
    if (leaf_prims == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    leaf_prims->device = device;
    leaf_prims->account = account;
    bb_status status =
        bb_program_build(device, bb_source_find("leaf_prims.cl"), "", &leaf_prims->program);
    if (status == BB_OK)
        status = bb_kernel_get(leaf_prims->program, "make_leaf_prims", &leaf_prims->kernel);
    if (status != BB_OK) {
        bb_leaf_prims_destroy(leaf_prims);
        return status;
    }
    *out = leaf_prims;
    return BB_OK;
}

void bb_leaf_prims_destroy(bb_leaf_prims *leaf_prims)
{
    if (leaf_prims == NULL)
        return;
    bb_kernel_release(leaf_prims->kernel);
    bb_program_release(leaf_prims->program);
    free(leaf_prims);
}

bb_status bb_leaf_prims_make(bb_leaf_prims *leaf_prims, const bb_layout_source *source,
                             const bb_buffer *refs, uint32_t format, bool closed, bb_buffer *out,
                             uint64_t *bytes)
{
    const bb_scene *scene = source->scene;
    const bb_scene_device *geometry = &scene->on_device;
    const bb_prim_ends ends = bb_scene_ends(scene);
    uint32_t words = bb_leaf_prim_words(source->kinds, format);
    uint32_t id_word = bb_leaf_prim_payload(source->kinds, format);
    uint32_t count = source->tree->info.ref_count, more = closed ? 1 : 0;
    size_t records = (size_t)count + more, size = records * words * sizeof(uint32_t);
    BB_TRY(
        bb_buffer_reserve(leaf_prims->device, leaf_prims->account, size, "leaf primitives", out));
    *bytes += size;
    return bb_launch(leaf_prims->device, leaf_prims->kernel, records, GROUP_SIZE, BB_MEM(*refs),
                     BB_VALUE(count), BB_MEM(geometry->vertices), BB_MEM(geometry->prims),
                     BB_VALUE(ends), BB_VALUE(scene->scale), BB_VALUE(format), BB_VALUE(words),
                     BB_VALUE(id_word), BB_VALUE(more), BB_MEM(*out));
}
