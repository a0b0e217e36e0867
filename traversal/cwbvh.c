/* Compressed nodes: host side of kernels/layout_cwbvh.cl. */
#include "traversal/cwbvh.h"

#include <assert.h>

enum { GROUP_SIZE = 64 };

bb_status bb_cwbvh_create(bb_device *device, bb_account *account, bb_primitives *primitives,
                          const char *defines, bb_cwbvh_maker *maker)
{
    *maker = (bb_cwbvh_maker){.device = device, .account = account, .primitives = primitives};
    BB_TRY(bb_program_build(device, bb_source_find("layout_cwbvh.cl"), defines, &maker->program));
    BB_TRY(bb_kernel_get(maker->program, "cwbvh_count", &maker->count));
    BB_TRY(bb_kernel_get(maker->program, "cwbvh_place", &maker->place));
    return bb_kernel_get(maker->program, "cwbvh_nodes", &maker->nodes);
}

void bb_cwbvh_release(bb_cwbvh_maker *maker)
{
    bb_buffer_release(&maker->own_nodes);
    bb_buffer_release(&maker->own_prims);
    bb_buffer_release(&maker->pair_of);
    bb_buffer_release(&maker->order);
    bb_kernel_release(maker->count);
    bb_kernel_release(maker->place);
    bb_kernel_release(maker->nodes);
    bb_program_release(maker->program);
    *maker = (bb_cwbvh_maker){.device = NULL};
}

static bb_status reserve(bb_cwbvh_maker *maker, size_t count, bb_buffer *buffer)
{
    return bb_buffer_reserve(maker->device, maker->account, count * sizeof(uint32_t),
                             "cwbvh: numbering", buffer);
}

bb_status bb_cwbvh_number(bb_cwbvh_maker *maker, const bb_tree *tree, const bb_opened *opened)
{
    bb_device *device = maker->device;
    uint32_t pairs = opened->pair_count, below;
    size_t scan = (size_t)pairs + 1;
    BB_TRY(reserve(maker, scan, &maker->own_nodes));
    BB_TRY(reserve(maker, scan, &maker->own_prims));
    BB_TRY(bb_launch(device, maker->count, scan, GROUP_SIZE, BB_MEM(*opened->pairs),
                     BB_VALUE(pairs), BB_MEM(*opened->sides), BB_MEM(*opened->marks),
                     BB_MEM(tree->d_refs), BB_MEM(maker->own_nodes), BB_MEM(maker->own_prims)));
    BB_TRY(bb_scan_u32(maker->primitives, &maker->own_nodes, &maker->own_nodes, pairs + 1, NULL));
    BB_TRY(bb_scan_u32(maker->primitives, &maker->own_prims, &maker->own_prims, pairs + 1, NULL));
    BB_TRY(bb_buffer_read(&maker->own_nodes, pairs * sizeof below, sizeof below, &below));
    maker->node_count = 1 + below;
    BB_TRY(reserve(maker, maker->node_count, &maker->pair_of));
    BB_TRY(reserve(maker, tree->info.ref_count, &maker->order));
    return bb_launch(device, maker->place, pairs, GROUP_SIZE, BB_MEM(*opened->pairs),
                     BB_VALUE(pairs), BB_VALUE(opened->root), BB_MEM(*opened->sides),
                     BB_MEM(*opened->marks), BB_MEM(tree->d_refs), BB_MEM(maker->own_nodes),
                     BB_MEM(maker->own_prims), BB_MEM(maker->pair_of), BB_MEM(maker->order));
}

bb_status bb_cwbvh_order_leaf(bb_cwbvh_maker *maker, const bb_tree *tree)
{
    uint32_t refs[BB_CWBVH_LEAF_MAX], count = tree->info.ref_count;
    assert(count <= BB_CWBVH_LEAF_MAX);
    BB_TRY(bb_buffer_read(&tree->d_refs, 0, count * sizeof *refs, refs));
    for (uint32_t i = 0; i < count; i++)
        refs[i] |= BB_LAST_BIT;
    BB_TRY(reserve(maker, count, &maker->order));
    return bb_buffer_write(&maker->order, 0, count * sizeof *refs, refs);
}

bb_status bb_cwbvh_nodes(bb_cwbvh_maker *maker, const bb_tree *tree, const bb_opened *opened,
                         const bb_buffer *nodes, const bb_buffer *sides)
{
    return bb_launch(maker->device, maker->nodes, maker->node_count, GROUP_SIZE,
                     BB_MEM(*opened->pairs), BB_VALUE(maker->node_count), BB_MEM(maker->pair_of),
                     BB_MEM(*opened->sides), BB_MEM(tree->d_refs), BB_MEM(maker->own_nodes),
                     BB_MEM(maker->own_prims), BB_MEM(*nodes), BB_MEM(*sides));
}
