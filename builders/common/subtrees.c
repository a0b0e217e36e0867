/* Host side of subtrees.cl. */
#include "builders/common/subtrees.h"

#include <stdio.h>

enum {
    GROUP_SIZE = 64,
    SUBTREE_CPU = 256, /* most nodes of a subtree that one work-item does */
    SUBTREE_GPU = 15,
};

static bool by_levels(const bb_subtrees *subtrees)
{
    return subtrees->device->handover == BB_HANDOVER_LEVELS;
}

static uint32_t most_nodes(const bb_device *device)
{
    return device->is_cpu ? SUBTREE_CPU : SUBTREE_GPU;
}

void bb_subtrees_defines(const bb_device *device, char text[BB_SUBTREES_DEFINES])
{
    char handover[96];
    bb_handover_defines(device, handover, sizeof handover);
    snprintf(text, BB_SUBTREES_DEFINES, "%s -DBB_SUBTREE_MOST=%u", handover, most_nodes(device));
}

bb_status bb_subtrees_create(bb_device *device, bb_account *account, bb_subtrees *subtrees)
{
    char defines[BB_SUBTREES_DEFINES];
    subtrees->device = device;
    subtrees->account = account;
    bb_subtrees_defines(device, defines);
    BB_TRY(bb_program_build(device, bb_source_find("subtrees.cl"), defines, &subtrees->program));
    BB_TRY(bb_kernel_get(subtrees->program, "subtrees_parents", &subtrees->parents_kernel));
    if (by_levels(subtrees))
        return BB_OK;
    BB_TRY(bb_kernel_get(subtrees->program, "subtrees_sizes", &subtrees->sizes_kernel));
    BB_TRY(bb_kernel_get(subtrees->program, "subtrees_mark", &subtrees->mark_kernel));
    BB_TRY(bb_primitives_create(device, account, &subtrees->primitives));
    return bb_compaction_create(device, account, subtrees->primitives, &subtrees->compaction);
}

void bb_subtrees_release(bb_subtrees *subtrees)
{
    bb_buffer_release(&subtrees->parents);
    bb_buffer_release(&subtrees->missing);
    bb_buffer_release(&subtrees->sizes);
    bb_buffer_release(&subtrees->marks);
    bb_buffer_release(&subtrees->roots);
    bb_buffer_release(&subtrees->root_count);
    bb_compaction_destroy(subtrees->compaction);
    bb_primitives_destroy(subtrees->primitives);
    bb_kernel_release(subtrees->parents_kernel);
    bb_kernel_release(subtrees->sizes_kernel);
    bb_kernel_release(subtrees->mark_kernel);
    bb_program_release(subtrees->program);
    *subtrees = (bb_subtrees){0};
}

static bb_status reserve_u32(bb_subtrees *subtrees, size_t count, const char *what, bb_buffer *out)
{
    return bb_buffer_reserve(subtrees->device, subtrees->account, count * sizeof(uint32_t), what,
                             out);
}

bb_status bb_subtrees_reserve(bb_subtrees *subtrees, size_t nodes)
{
    BB_TRY(reserve_u32(subtrees, nodes, "subtrees: parents", &subtrees->parents));
    BB_TRY(reserve_u32(subtrees, nodes, "subtrees: missing children", &subtrees->missing));
    if (by_levels(subtrees))
        return BB_OK;
    BB_TRY(reserve_u32(subtrees, nodes, "subtrees: sizes", &subtrees->sizes));
    BB_TRY(reserve_u32(subtrees, nodes, "subtrees: marks", &subtrees->marks));
    BB_TRY(reserve_u32(subtrees, nodes, "subtrees: roots", &subtrees->roots));
    BB_TRY(reserve_u32(subtrees, 1, "subtrees: number of roots", &subtrees->root_count));
    return bb_compaction_reserve(subtrees->compaction, (uint32_t)nodes);
}

bb_status bb_subtrees_cut(bb_subtrees *subtrees, const bb_tree *tree)
{
    uint32_t count = tree->info.node_count;
    BB_TRY(bb_launch(subtrees->device, subtrees->mark_kernel, count, GROUP_SIZE,
                     BB_MEM(subtrees->sizes), BB_VALUE(count), BB_VALUE(tree->info.root),
                     BB_MEM(subtrees->parents), BB_MEM(subtrees->marks)));
    BB_TRY(bb_compact_u32(subtrees->compaction, &subtrees->marks, NULL, count, &subtrees->roots,
                          &subtrees->root_count));
    return bb_buffer_read(&subtrees->root_count, 0, sizeof subtrees->found, &subtrees->found);
}

bb_status bb_subtrees_plan(bb_subtrees *subtrees, const bb_tree *tree)
{
    bb_device *device = subtrees->device;
    uint32_t count = tree->info.node_count;
    BB_TRY(bb_subtrees_reserve(subtrees, count));
    BB_TRY(bb_launch(device, subtrees->parents_kernel, count, GROUP_SIZE, BB_MEM(tree->d_nodes),
                     BB_VALUE(count), BB_VALUE(tree->info.root), BB_MEM(subtrees->parents),
                     BB_MEM(subtrees->missing)));
    if (by_levels(subtrees))
        return BB_OK;
    BB_TRY(bb_launch(device, subtrees->sizes_kernel, count, GROUP_SIZE, BB_MEM(tree->d_nodes),
                     BB_VALUE(count), BB_MEM(subtrees->parents), BB_MEM(subtrees->missing),
                     BB_MEM(subtrees->sizes)));
    return bb_subtrees_cut(subtrees, tree);
}
