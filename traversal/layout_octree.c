/* The `octree` layout (kernels/layout_octree.cl) of trees with cells, for queries that go to one
 * cell. */
#include "traversal/traversal.h"

#include "kernels/cell_grid_shared.h"
#include "traversal/leaf_prims.h"

#include <stdlib.h>

enum { GROUP_SIZE = 64 };

typedef struct octree_layout {
    bb_device *device;
    bb_account *account;
    cl_program program;
    cl_kernel nodes, grid;
    bb_leaf_prims *leaf_prims;
} octree_layout;

static void destroy(void *opaque)
{
    octree_layout *self = opaque;
    if (self == NULL)
        return;
    bb_leaf_prims_destroy(self->leaf_prims);
    bb_kernel_release(self->nodes);
    bb_kernel_release(self->grid);
    bb_program_release(self->program);
    free(self);
}

static bb_status create(bb_device *device, bb_account *account, void **out)
{
    octree_layout *self = calloc(1, sizeof *self);
    if (self == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    *out = self;
    self->device = device;
    self->account = account;
    BB_TRY(bb_program_build(device, bb_source_find("layout_octree.cl"), "", &self->program));
    BB_TRY(bb_kernel_get(self->program, "octree_nodes", &self->nodes));
    BB_TRY(bb_kernel_get(self->program, "octree_grid", &self->grid));
    return bb_leaf_prims_create(device, account, &self->leaf_prims);
}

static bb_status make(void *opaque, const bb_layout_source *source, bb_layout_data *data)
{
    octree_layout *self = opaque;
    bb_device *device = self->device;
    const bb_tree *tree = source->tree;
    const uint32_t count = tree->info.node_count, bits = tree->info.depth;
    const size_t bytes = (size_t)count * 2 * sizeof(uint32_t);
    data->buffer_count = 3;
    data->root = tree->info.root;
    data->stack_need = 0;
    data->levels = bits;
    data->keeps_shape = true;
    BB_TRY(bb_buffer_reserve(device, self->account, bytes, "octree: nodes", &data->buffers[0]));
    BB_TRY(bb_buffer_reserve(device, self->account, sizeof(bb_cell_grid), "octree: grid",
                             &data->buffers[2]));
    data->bytes += bytes + sizeof(bb_cell_grid);
    BB_TRY(bb_launch(device, self->nodes, count, GROUP_SIZE, BB_MEM(tree->d_nodes),
                     BB_MEM(*source->array), BB_VALUE(count), BB_MEM(data->buffers[0])));
    BB_TRY(bb_launch(device, self->grid, 1, 1, BB_MEM(tree->d_nodes), BB_VALUE(data->root),
                     BB_VALUE(bits), BB_MEM(data->buffers[2])));
    return bb_leaf_prims_make(self->leaf_prims, source, &tree->d_refs, data->format, false,
                              &data->buffers[1], &data->prims_bytes);
}

const bb_layout bb_layout_octree = {
    .name = "octree",
    .summary = "an octree's cells by their octants, without boxes; for queries at points",
    .width = 8,
    .block = 1,
    .node_bytes = 2 * sizeof(uint32_t),
    .search = BB_SEARCH_OCTREE,
    .array = {.name = "cells", .stride = sizeof(uint32_t)},
    .create = create,
    .make = make,
    .destroy = destroy,
};
