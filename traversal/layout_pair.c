/* The `pair` layout: both children's boxes in the parent (kernels/layout_pair.cl). Binary trees keep their shape; wider ones
 * are made binary over the order of their children. */
#include "traversal/traversal.h"

#include "framework/primitives.h"
#include "traversal/records.h"

#include <stdlib.h>

enum {
    GROUP_SIZE = 64,
    ARITY_MAX = 4096, /* one work-item does all the children of a node */
};

typedef struct pair_layout {
    bb_device *device;
    bb_account *account;
    cl_program program;
    cl_kernel extra, nodes, root;
    bb_primitives *primitives;
    bb_records *records;
    bb_buffer base; /* u32 per node, and the total */
    bb_buffer found;
} pair_layout;

static void destroy(void *opaque)
{
    pair_layout *self = opaque;
    if (self == NULL)
        return;
    bb_buffer_release(&self->base);
    bb_buffer_release(&self->found);
    bb_primitives_destroy(self->primitives);
    bb_records_destroy(self->records);
    bb_kernel_release(self->extra);
    bb_kernel_release(self->nodes);
    bb_kernel_release(self->root);
    bb_program_release(self->program);
    free(self);
}

static bb_status create(bb_device *device, bb_account *account, void **out)
{
    pair_layout *self = calloc(1, sizeof *self);
    if (self == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    *out = self;
    self->device = device;
    self->account = account;
    BB_TRY(bb_program_build(device, bb_source_find("layout_pair.cl"), "", &self->program));
    BB_TRY(bb_kernel_get(self->program, "pair_extra", &self->extra));
    BB_TRY(bb_kernel_get(self->program, "pair_nodes", &self->nodes));
    BB_TRY(bb_kernel_get(self->program, "pair_root", &self->root));
    BB_TRY(bb_primitives_create(device, account, &self->primitives));
    BB_TRY(bb_records_create(device, account, &self->records));
    return bb_buffer_reserve(device, account, 2 * sizeof(uint32_t), "pair: root", &self->found);
}

static bb_status make_nodes(pair_layout *self, const bb_tree *tree, bb_layout_data *data)
{
    bb_device *device = self->device;
    uint32_t count = tree->info.node_count;
    BB_TRY(bb_buffer_reserve(device, self->account, ((size_t)count + 1) * sizeof(uint32_t),
                             "pair: numbering", &self->base));
    BB_TRY(bb_launch(device, self->extra, (size_t)count + 1, GROUP_SIZE, BB_MEM(tree->d_nodes),
                     BB_VALUE(count), BB_MEM(self->base)));
    BB_TRY(bb_scan_u32(self->primitives, &self->base, &self->base, count + 1, NULL));
    BB_TRY(bb_launch(device, self->root, 1, 1, BB_MEM(tree->d_nodes), BB_VALUE(count),
                     BB_VALUE(tree->info.root), BB_MEM(self->base), BB_MEM(self->found)));
    uint32_t found[2];
    BB_TRY(bb_buffer_read(&self->found, 0, sizeof found, found));
    data->root = found[0];
    size_t bytes = found[1] * sizeof(bb_pair);
    BB_TRY(bb_buffer_reserve(device, self->account, bytes, "pair: nodes", &data->buffers[0]));
    data->bytes += bytes;
    return bb_launch(device, self->nodes, count, GROUP_SIZE, BB_MEM(tree->d_nodes), BB_VALUE(count),
                     BB_MEM(self->base), BB_MEM(data->buffers[0]));
}

/* Those of a balanced binary tree over up to `arity` children at each of `depth` levels: an upper bound that needs no walk. */
static uint32_t levels(const bb_tree_info *info)
{
    uint64_t each = 0;
    while ((UINT64_C(1) << each) < info->arity)
        each++;
    uint64_t all = info->depth * each;
    return all < UINT32_MAX ? (uint32_t)all : UINT32_MAX;
}

/* No wide nodes, and none with one child. */
static bool is_binary(const bb_tree_info *info)
{
    return info->arity <= 2 && info->node_count == 2 * info->leaf_count - 1;
}

static bb_status make(void *opaque, const bb_scene *scene, const bb_tree *tree,
                      bb_layout_data *data)
{
    pair_layout *self = opaque;
    if (tree->info.arity > ARITY_MAX)
        return bb_fail(BB_UNSUPPORTED, "layout pair takes nodes of up to %d children, not %u",
                       ARITY_MAX, tree->info.arity);
    data->buffer_count = 2;
    data->levels = levels(&tree->info);
    data->stack_need = data->levels; /* one per pair node on the way */
    data->keeps_shape = is_binary(&tree->info);
    BB_TRY(make_nodes(self, tree, data));
    return bb_records_make(self->records, scene, tree, &data->buffers[1], &data->bytes);
}

const bb_layout bb_layout_pair = {
    .name = "pair",
    .summary = "binary, both children's boxes in the parent; primitives expanded in leaf order",
    .create = create,
    .make = make,
    .destroy = destroy,
};
