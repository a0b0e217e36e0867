/* The `skip` layout: the tree's own nodes of any arity in preorder (kernels/layout_skip.cl). */
#include "traversal/traversal.h"

#include "traversal/leaf_prims.h"

#include <stdlib.h>

enum {
    GROUP_SIZE = 64,
    SPLITTERS = 1 << 14, /* approximate number; one work-item goes through them all */
    STRIDE_MIN = 32,
};

typedef struct skip_layout {
    bb_device *device;
    bb_account *account;
    cl_program program;
    cl_kernel walk, rank, place, nodes;
    bb_leaf_prims *leaf_prims;
    bb_buffer lengths, after; /* u32 per splitter */
    bb_buffer positions;      /* u32 per node */
} skip_layout;

static void destroy(void *opaque)
{
    skip_layout *self = opaque;
    if (self == NULL)
        return;
    bb_buffer_release(&self->lengths);
    bb_buffer_release(&self->after);
    bb_buffer_release(&self->positions);
    bb_leaf_prims_destroy(self->leaf_prims);
    bb_kernel_release(self->walk);
    bb_kernel_release(self->rank);
    bb_kernel_release(self->place);
    bb_kernel_release(self->nodes);
    bb_program_release(self->program);
    free(self);
}

static bb_status create(bb_device *device, bb_account *account, void **out)
{
    skip_layout *self = calloc(1, sizeof *self);
    if (self == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    *out = self;
    self->device = device;
    self->account = account;
    BB_TRY(bb_program_build(device, bb_source_find("layout_skip.cl"), "", &self->program));
    BB_TRY(bb_kernel_get(self->program, "skip_walk", &self->walk));
    BB_TRY(bb_kernel_get(self->program, "skip_rank", &self->rank));
    BB_TRY(bb_kernel_get(self->program, "skip_place", &self->place));
    BB_TRY(bb_kernel_get(self->program, "skip_nodes", &self->nodes));
    return bb_leaf_prims_create(device, account, &self->leaf_prims);
}

static bb_status number_nodes(skip_layout *self, const bb_tree *tree)
{
    bb_device *device = self->device;
    uint32_t count = tree->info.node_count, root = tree->info.root, stride = STRIDE_MIN;
    while (count / stride > SPLITTERS)
        stride *= 2;
    uint32_t splitters = (count - 1) / stride + 2; /* plus the root's */
    size_t bytes = splitters * sizeof(uint32_t);
    BB_TRY(bb_buffer_reserve(device, self->account, bytes, "skip: lengths", &self->lengths));
    BB_TRY(bb_buffer_reserve(device, self->account, bytes, "skip: links", &self->after));
    BB_TRY(bb_buffer_reserve(device, self->account, count * sizeof(uint32_t), "skip: numbering",
                             &self->positions));
    BB_TRY(bb_launch(device, self->walk, splitters, GROUP_SIZE, BB_MEM(tree->d_nodes),
                     BB_VALUE(root), BB_VALUE(stride), BB_VALUE(splitters), BB_MEM(self->lengths),
                     BB_MEM(self->after)));
    BB_TRY(bb_launch(device, self->rank, 1, 1, BB_VALUE(splitters), BB_MEM(self->lengths),
                     BB_MEM(self->after)));
    return bb_launch(device, self->place, splitters, GROUP_SIZE, BB_MEM(tree->d_nodes),
                     BB_VALUE(root), BB_VALUE(stride), BB_VALUE(splitters), BB_MEM(self->lengths),
                     BB_MEM(self->positions));
}

static bb_status make(void *opaque, const bb_layout_source *source, bb_layout_data *data)
{
    skip_layout *self = opaque;
    bb_device *device = self->device;
    const bb_tree *tree = source->tree;
    uint32_t count = tree->info.node_count, has_reach = source->reach != NULL;
    size_t bytes = count * sizeof(bb_node);
    data->buffer_count = 2;
    data->root = 0;
    data->stack_need = 0;
    data->levels = tree->info.depth;
    data->keeps_shape = true;
    if (!source->same_links)
        BB_TRY(number_nodes(self, tree));
    BB_TRY(bb_buffer_reserve(device, self->account, bytes, "skip: nodes", &data->buffers[0]));
    data->bytes += bytes;
    BB_TRY(bb_launch(device, self->nodes, count, GROUP_SIZE, BB_MEM(tree->d_nodes), BB_VALUE(count),
                     BB_MEM(self->positions), BB_VALUE(data->scale),
                     BB_MEM(*(has_reach ? source->reach : &self->positions)), BB_VALUE(has_reach),
                     BB_MEM(data->buffers[0])));
    return bb_leaf_prims_make(self->leaf_prims, source, &tree->d_refs, data->format, false,
                              &data->buffers[1], &data->prims_bytes);
}

const bb_layout bb_layout_skip = {
    .name = "skip",
    .summary = "the tree's own nodes, of any arity, in preorder; primitives expanded in leaf order",
    .node_bytes = sizeof(bb_node),
    .width = 2,
    .block = 1,
    .search = BB_SEARCH_SKIP,
    .create = create,
    .make = make,
    .destroy = destroy,
};
