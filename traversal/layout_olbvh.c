/* The `olbvh` layout (kernels/layout_olbvh.cl): the arrays of an OLBVH as published, for its
 * published traversal. */
#include "kernels/tet_shared.h"
#include "traversal/traversal.h"

#include <stdlib.h>

enum { GROUP_SIZE = 64 };

typedef struct olbvh_layout {
    bb_device *device;
    bb_account *account;
    cl_program program;
    cl_kernel nodes, refs, levels;
} olbvh_layout;

static void destroy(void *opaque)
{
    olbvh_layout *self = opaque;
    if (self == NULL)
        return;
    bb_kernel_release(self->nodes);
    bb_kernel_release(self->refs);
    bb_kernel_release(self->levels);
    bb_program_release(self->program);
    free(self);
}

static bb_status create(bb_device *device, bb_account *account, void **out)
{
    olbvh_layout *self = calloc(1, sizeof *self);
    if (self == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    *out = self;
    self->device = device;
    self->account = account;
    BB_TRY(bb_program_build(device, bb_source_find("layout_olbvh.cl"), "", &self->program));
    BB_TRY(bb_kernel_get(self->program, "olbvh_layout_nodes", &self->nodes));
    BB_TRY(bb_kernel_get(self->program, "olbvh_layout_refs", &self->refs));
    return bb_kernel_get(self->program, "olbvh_layout_levels", &self->levels);
}

static bb_status reserve(olbvh_layout *self, const bb_tree_info *info, bb_layout_data *data)
{
    const size_t nodes = info->node_count, inner = nodes - info->leaf_count;
    const struct {
        const char *what;
        size_t bytes;
    } arrays[BB_OLBVH_ARRAYS] = {
        [BB_OLBVH_BV] = {"six arrays: BV", nodes * 6 * sizeof(float)},
        [BB_OLBVH_P] = {"six arrays: P", info->ref_count * sizeof(uint32_t)},
        [BB_OLBVH_CO] = {"six arrays: CO", (inner + 1) * sizeof(uint32_t)},
        [BB_OLBVH_PO] = {"six arrays: PO", (nodes + 1) * sizeof(uint32_t)},
        [BB_OLBVH_BF] = {"six arrays: BF", nodes},
        [BB_OLBVH_NO] = {"six arrays: NO", (info->depth + 1) * sizeof(uint32_t)},
    };
    for (int i = 0; i < BB_OLBVH_ARRAYS; i++) {
        BB_TRY(bb_buffer_reserve(self->device, self->account, arrays[i].bytes, arrays[i].what,
                                 &data->buffers[i]));
        data->bytes += arrays[i].bytes;
    }
    return BB_OK;
}

static bb_status make(void *opaque, const bb_layout_source *source, bb_layout_data *data)
{
    olbvh_layout *self = opaque;
    bb_device *device = self->device;
    const bb_tree *tree = source->tree;
    const bb_tree_array *cells = bb_tree_find_array(tree, "cells");
    const bb_tree_array *co = bb_tree_find_array(tree, "co");
    const uint32_t count = tree->info.node_count, refs = tree->info.ref_count;
    const uint32_t levels = tree->info.depth + 1;
    if (cells == NULL || co == NULL)
        return bb_fail(BB_UNSUPPORTED, "layout olbvh reads the side arrays 'cells' and 'co', which "
                                       "this tree does not have");
    data->buffer_count = BB_OLBVH_ARRAYS;
    data->root = tree->info.root;
    data->stack_need = 0;
    data->levels = tree->info.depth;
    data->leaves = tree->info.leaf_count;
    data->keeps_shape = true;
    BB_TRY(reserve(self, &tree->info, data));
    BB_TRY(bb_launch(device, self->nodes, count, GROUP_SIZE, BB_MEM(tree->d_nodes),
                     BB_MEM(cells->buffer), BB_MEM(co->buffer), BB_MEM(*source->array),
                     BB_VALUE(count), BB_VALUE(refs), BB_MEM(data->buffers[BB_OLBVH_BV]),
                     BB_MEM(data->buffers[BB_OLBVH_CO]), BB_MEM(data->buffers[BB_OLBVH_PO]),
                     BB_MEM(data->buffers[BB_OLBVH_BF])));
    BB_TRY(bb_launch(device, self->refs, refs, GROUP_SIZE, BB_MEM(tree->d_refs), BB_VALUE(refs),
                     BB_MEM(data->buffers[BB_OLBVH_P])));
    return bb_launch(device, self->levels, 1, 1, BB_MEM(data->buffers[BB_OLBVH_CO]),
                     BB_VALUE(levels), BB_MEM(data->buffers[BB_OLBVH_NO]));
}

const bb_layout bb_layout_olbvh = {
    .name = "olbvh",
    .summary = "the six arrays of an OLBVH as published; for queries at points",
    .width = 8,
    .block = 1,
    .search = BB_SEARCH_OLBVH,
    .array = {.name = "po", .stride = sizeof(uint32_t)},
    .create = create,
    .make = make,
    .destroy = destroy,
};
