/* Pair nodes of a tree: host side of kernels/layout_pair.cl. */
#include "traversal/pairs.h"

enum {
    GROUP_SIZE = 64,
    ARITY_MAX = 4096, /* one work-item handles all children of a node */
};

bb_status bb_pairs_create(bb_device *device, bb_account *account, bb_pairs *pairs)
{
    pairs->device = device;
    pairs->account = account;
    BB_TRY(bb_program_build(device, bb_source_find("layout_pair.cl"), "", &pairs->program));
    BB_TRY(bb_kernel_get(pairs->program, "pair_extra", &pairs->extra));
    BB_TRY(bb_kernel_get(pairs->program, "pair_nodes", &pairs->nodes));
    BB_TRY(bb_kernel_get(pairs->program, "pair_sides", &pairs->sides));
    BB_TRY(bb_kernel_get(pairs->program, "pair_root", &pairs->root));
    BB_TRY(bb_primitives_create(device, account, &pairs->primitives));
    return bb_buffer_reserve(device, account, 2 * sizeof(uint32_t), "pairs: root", &pairs->found);
}

void bb_pairs_destroy(bb_pairs *pairs)
{
    bb_buffer_release(&pairs->base);
    bb_buffer_release(&pairs->found);
    bb_primitives_destroy(pairs->primitives);
    bb_kernel_release(pairs->extra);
    bb_kernel_release(pairs->nodes);
    bb_kernel_release(pairs->sides);
    bb_kernel_release(pairs->root);
    bb_program_release(pairs->program);
}

/* Finds the number of each node's first pair, the number of pairs, and the root. */
static bb_status number_pairs(bb_pairs *pairs, const bb_tree *tree)
{
    bb_device *device = pairs->device;
    uint32_t node_count = tree->info.node_count;
    if (tree->info.arity > ARITY_MAX)
        return bb_fail(BB_UNSUPPORTED, "layouts take nodes of up to %d children, not %u", ARITY_MAX,
                       tree->info.arity);
    BB_TRY(bb_buffer_reserve(device, pairs->account, ((size_t)node_count + 1) * sizeof(uint32_t),
                             "pairs: numbering", &pairs->base));
    BB_TRY(bb_launch(device, pairs->extra, (size_t)node_count + 1, GROUP_SIZE,
                     BB_MEM(tree->d_nodes), BB_VALUE(node_count), BB_MEM(pairs->base)));
    BB_TRY(bb_scan_u32(pairs->primitives, &pairs->base, &pairs->base, node_count + 1, NULL));
    BB_TRY(bb_launch(device, pairs->root, 1, 1, BB_MEM(tree->d_nodes), BB_VALUE(node_count),
                     BB_VALUE(tree->info.root), BB_MEM(pairs->base), BB_MEM(pairs->found)));
    return bb_buffer_read(&pairs->found, 0, sizeof pairs->made, pairs->made);
}

bb_status bb_pairs_make(bb_pairs *pairs, const bb_layout_source *source, bb_buffer *nodes,
                        uint32_t *count, uint32_t *root)
{
    bb_device *device = pairs->device;
    const bb_tree *tree = source->tree;
    const bb_buffer *reach = source->reach != NULL ? source->reach : &pairs->found;
    uint32_t node_count = tree->info.node_count, has_reach = source->reach != NULL;
    float scale = source->scene->scale;
    if (!source->same_links)
        BB_TRY(number_pairs(pairs, tree));
    *root = pairs->made[0];
    *count = pairs->made[1];
    BB_TRY(
        bb_buffer_reserve(device, pairs->account, *count * sizeof(bb_pair), "pair nodes", nodes));
    return bb_launch(device, pairs->nodes, node_count, GROUP_SIZE, BB_MEM(tree->d_nodes),
                     BB_VALUE(node_count), BB_MEM(pairs->base), BB_VALUE(scale), BB_MEM(*reach),
                     BB_VALUE(has_reach), BB_MEM(*nodes));
}

bb_status bb_pairs_sides(const bb_pairs *pairs, const bb_tree *tree, bb_buffer *sides)
{
    uint32_t node_count = tree->info.node_count;
    BB_TRY(bb_buffer_reserve(pairs->device, pairs->account,
                             (size_t)pairs->made[1] * 4 * sizeof(uint32_t), "pairs: sides", sides));
    return bb_launch(pairs->device, pairs->sides, node_count, GROUP_SIZE, BB_MEM(tree->d_nodes),
                     BB_VALUE(node_count), BB_MEM(pairs->base), BB_MEM(*sides));
}

/* Returns the levels of a balanced binary tree over up to `arity` children at each of `depth`
 * levels: an upper bound that needs no walk. */
uint64_t bb_pairs_levels(const bb_tree_info *info)
{
    uint64_t levels = 0;
    while ((UINT64_C(1) << levels) < info->arity)
        levels++;
    return info->depth * levels;
}

uint32_t bb_pairs_stack_need(const bb_tree_info *info)
{
    uint64_t need = bb_pairs_levels(info);
    return need < UINT32_MAX ? (uint32_t)need : UINT32_MAX;
}

bool bb_pairs_keep_shape(const bb_tree_info *info)
{
    return info->arity <= 2 && info->node_count == 2 * info->leaf_count - 1;
}
