/* Host side of turns.cl. */
#include "turns.h"

#include <stdio.h>

BB_DEVICE_SOURCE(turns);

enum { GROUP_SIZE = 64 };

static bool by_levels(const bb_turner *turner)
{
    return turner->device->handover == BB_HANDOVER_LEVELS;
}

bb_status bb_turner_create(bb_turner *turner)
{
    char subtrees[BB_SUBTREES_DEFINES], defines[BB_SUBTREES_DEFINES + 160];
    bb_subtrees_defines(turner->device, subtrees);
    snprintf(defines, sizeof defines,
             "%s -DBB_TURN_CT=%.9ef -DBB_TURN_CI=%.9ef -DBB_TURN_ROTATES=%d -DBB_TURN_COSTS=%d "
             "-DBB_TURN_SPREADS=%d",
             subtrees, BB_COST_TRAVERSAL, BB_COST_INTERSECTION, turner->rotates, turner->costs,
             turner->spreads);
    BB_TRY(bb_subtrees_create(turner->device, turner->account, &turner->subtrees));
    BB_TRY(bb_program_build(turner->device, &bb_source_turns, defines, &turner->program));
    if (!by_levels(turner))
        return bb_kernel_get(turner->program, "turn_subtrees", &turner->subtrees_kernel);
    BB_TRY(bb_kernel_get(turner->program, "turn_leaves", &turner->leaves_kernel));
    return bb_kernel_get(turner->program, "turn_level", &turner->level_kernel);
}

void bb_turner_release(bb_turner *turner)
{
    bb_subtrees_release(&turner->subtrees);
    bb_buffer_release(&turner->heights);
    bb_buffer_release(&turner->costs_of);
    bb_buffer_release(&turner->spreads_of);
    bb_buffer_release(&turner->next);
    bb_buffer_release(&turner->totals_there);
    bb_levels_release(&turner->levels);
    bb_kernel_release(turner->subtrees_kernel);
    bb_kernel_release(turner->leaves_kernel);
    bb_kernel_release(turner->level_kernel);
    bb_program_release(turner->program);
}

static bb_status reserve_book(bb_turner *turner, bool kept, uint32_t nodes, const char *what,
                              bb_buffer *out)
{
    return bb_buffer_reserve(turner->device, turner->account, (kept ? nodes : 1) * 4ul, what, out);
}

static bb_status reserve(bb_turner *turner, const bb_tree *tree)
{
    uint32_t nodes = tree->info.node_count;
    bool lists = turner->rotates && !by_levels(turner);
    BB_TRY(reserve_book(turner, turner->rotates, nodes, "refit: heights", &turner->heights));
    BB_TRY(reserve_book(turner, turner->costs, nodes, "refit: costs", &turner->costs_of));
    BB_TRY(reserve_book(turner, turner->spreads, nodes, "refit: spreads", &turner->spreads_of));
    BB_TRY(reserve_book(turner, lists, nodes, "refit: next roots", &turner->next));
    BB_TRY(bb_buffer_reserve(turner->device, turner->account, sizeof turner->totals,
                             "refit: totals", &turner->totals_there));
    if (!by_levels(turner))
        return BB_OK;
    /* rotations may deepen the tree; a binary tree has at most as many levels as leaves */
    return bb_levels_reserve(&turner->levels, turner->device, turner->account, nodes,
                             turner->rotates ? tree->info.leaf_count : tree->info.depth,
                             "refit: levels");
}

bb_status bb_turner_plan(bb_turner *turner, const bb_tree *tree)
{
    BB_TRY(reserve(turner, tree));
    size_t bytes = tree->info.node_count * sizeof(uint32_t);
    BB_TRY(bb_subtrees_plan(&turner->subtrees, tree));
    if (!turner->rotates)
        return BB_OK;
    /* a leaf may be replaced by an inner node later */
    BB_TRY(bb_buffer_fill(&turner->subtrees.missing, bytes, 2));
    return bb_buffer_fill(&turner->heights, bytes, 0);
}

/* ---- up ---- */

typedef struct level_job {
    bb_turner *turner;
    bb_tree *tree;
    uint32_t may_turn;
} level_job;

static bb_status do_level(void *context, const bb_levels *levels, uint32_t n)
{
    const level_job *job = context;
    bb_turner *turner = job->turner;
    return bb_launch(turner->device, turner->level_kernel, bb_levels_items(levels), GROUP_SIZE,
                     BB_MEM(job->tree->d_nodes), BB_VALUE(job->may_turn),
                     BB_MEM(turner->subtrees.parents), BB_MEM(turner->subtrees.missing),
                     BB_MEM(turner->heights), BB_MEM(turner->costs_of), BB_MEM(turner->spreads_of),
                     BB_MEM(levels->lists[n % 2]), BB_VALUE(n), BB_MEM(levels->counts),
                     BB_MEM(levels->lists[(n + 1) % 2]), BB_MEM(turner->totals_there),
                     BB_MEM(job->tree->d_info));
}

static bb_status go_up_by_levels(bb_turner *turner, const bb_buffer *boxes, uint32_t may_turn,
                                 bb_tree *tree)
{
    level_job job = {turner, tree, may_turn};
    uint32_t count = tree->info.node_count;
    BB_TRY(bb_levels_start(&turner->levels));
    BB_TRY(bb_launch(turner->device, turner->leaves_kernel, count, GROUP_SIZE,
                     BB_MEM(tree->d_nodes), BB_MEM(tree->d_refs), BB_MEM(*boxes), BB_VALUE(count),
                     BB_MEM(turner->subtrees.parents), BB_MEM(turner->subtrees.missing),
                     BB_MEM(turner->heights), BB_MEM(turner->costs_of), BB_MEM(turner->spreads_of),
                     BB_MEM(turner->levels.counts), BB_MEM(turner->levels.lists[1]),
                     BB_MEM(turner->totals_there), BB_MEM(tree->d_info)));
    return bb_levels_run(&turner->levels, do_level, &job);
}

static bb_status go_up(bb_turner *turner, const bb_buffer *boxes, uint32_t may_turn, bb_tree *tree)
{
    const bb_subtrees *subtrees = &turner->subtrees;
    BB_TRY(bb_buffer_fill(&turner->totals_there, sizeof turner->totals, 0));
    if (by_levels(turner))
        return go_up_by_levels(turner, boxes, may_turn, tree);
    return bb_launch(turner->device, turner->subtrees_kernel, subtrees->found, GROUP_SIZE,
                     BB_MEM(tree->d_nodes), BB_MEM(tree->d_refs), BB_MEM(*boxes),
                     BB_MEM(subtrees->roots), BB_VALUE(subtrees->found), BB_VALUE(may_turn),
                     BB_MEM(subtrees->parents), BB_MEM(subtrees->missing), BB_MEM(subtrees->sizes),
                     BB_MEM(turner->heights), BB_MEM(turner->costs_of), BB_MEM(turner->spreads_of),
                     BB_MEM(turner->next), BB_MEM(turner->totals_there), BB_MEM(tree->d_info));
}

/* ---- afterwards ---- */

/* The pass has listed the roots for the next one. They are sorted, since neighbours share memory
 * pages and cache lines. */
static bb_status take_roots(bb_turner *turner, uint32_t nodes)
{
    bb_subtrees *subtrees = &turner->subtrees;
    bb_buffer roots = subtrees->roots;
    uint32_t bits = 1;
    while (((nodes - 1) >> bits) != 0)
        bits++;
    subtrees->roots = turner->next;
    turner->next = roots;
    subtrees->found = turner->totals.roots;
    /* the values that the sort moves along are not used */
    return bb_sort_u32(subtrees->primitives, &subtrees->roots, &subtrees->marks, subtrees->found,
                       bits);
}

bb_status bb_turner_pass(bb_turner *turner, const bb_buffer *boxes, bool may_turn, bb_tree *tree)
{
    BB_TRY(go_up(turner, boxes, may_turn, tree));
    BB_TRY(bb_buffer_read(&turner->totals_there, 0, sizeof turner->totals, &turner->totals));
    tree->disjoint = false;
    if (turner->totals.turned == 0) {
        bb_tree_boxes_changed(tree);
        return BB_OK;
    }
    bb_tree_changed(tree);
    return by_levels(turner) ? BB_OK : take_roots(turner, tree->info.node_count);
}
