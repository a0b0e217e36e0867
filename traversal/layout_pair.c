/* The `pair` layout: both children's boxes in the parent (kernels/layout_pair.cl). Binary trees
 * keep their shape; wider nodes become binary trees over their children in order. */
#include "traversal/leaf_prims.h"
#include "traversal/pairs.h"

#include <stdlib.h>

typedef struct pair_layout {
    bb_pairs pairs;
    bb_leaf_prims *leaf_prims;
} pair_layout;

static void destroy(void *opaque)
{
    pair_layout *self = opaque;
    if (self == NULL)
        return;
    bb_pairs_destroy(&self->pairs);
    bb_leaf_prims_destroy(self->leaf_prims);
    free(self);
}

static bb_status create(bb_device *device, bb_account *account, void **out)
{
    pair_layout *self = calloc(1, sizeof *self);
    if (self == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    *out = self;
    BB_TRY(bb_pairs_create(device, account, &self->pairs));
    return bb_leaf_prims_create(device, account, &self->leaf_prims);
}

static bb_status make(void *opaque, const bb_layout_source *source, bb_layout_data *data)
{
    pair_layout *self = opaque;
    const bb_tree *tree = source->tree;
    uint32_t count;
    data->buffer_count = 2;
    data->levels = bb_pairs_stack_need(&tree->info);
    data->stack_need = data->levels; /* one per pair node on the path */
    data->keeps_shape = bb_pairs_keep_shape(&tree->info);
    BB_TRY(bb_pairs_make(&self->pairs, source, &data->buffers[0], &count, &data->root));
    data->bytes += count * sizeof(bb_pair);
    return bb_leaf_prims_make(self->leaf_prims, source, &tree->d_refs, data->format, false,
                              &data->buffers[1], &data->prims_bytes);
}

const bb_layout bb_layout_pair = {
    .name = "pair",
    .summary = "binary, both children's boxes in the parent; primitives expanded in leaf order",
    .node_bytes = sizeof(bb_pair),
    .width = 2,
    .block = 1,
    .create = create,
    .make = make,
    .destroy = destroy,
};
