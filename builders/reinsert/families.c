/* Host side of reinsert_families.cl. */
#include "families.h"
#include "builders/common/scene_unit.h"
#include "framework/base/arithmetic.h"

BB_DEVICE_SOURCE(reinsert_families);

enum { GROUP_SIZE = 64, TASKS_MAX = 1024 };

bb_status bb_family_tree_create(bb_device *device, bb_account *account, bb_family_tree *tree)
{
    tree->device = device;
    tree->account = account;
    BB_TRY(bb_program_build(device, &bb_source_reinsert_families, "", &tree->program));
    BB_TRY(bb_kernel_get(tree->program, "families_mark", &tree->mark));
    BB_TRY(bb_kernel_get(tree->program, "families_gather", &tree->gather));
    BB_TRY(bb_kernel_get(tree->program, "families_cost", &tree->cost));
    BB_TRY(bb_primitives_create(device, account, &tree->primitives));
    if (bb_cpu_form(tree->device)) {
        BB_TRY(bb_kernel_get(tree->program, "families_top", &tree->top));
        return bb_kernel_get(tree->program, "families_walk", &tree->walk);
    }
    BB_TRY(bb_kernel_get(tree->program, "families_write", &tree->write));
    return bb_links_create(device, account, &tree->links);
}

void bb_family_tree_release(bb_family_tree *tree)
{
    bb_buffer_release(&tree->families);
    bb_buffer_release(&tree->numbers);
    bb_buffer_release(&tree->sums);
    bb_buffer_release(&tree->tasks);
    bb_buffer_release(&tree->task_range);
    bb_host_free(tree->sums_here);
    bb_links_destroy(tree->links);
    bb_primitives_destroy(tree->primitives);
    bb_kernel_release(tree->mark);
    bb_kernel_release(tree->gather);
    bb_kernel_release(tree->cost);
    bb_kernel_release(tree->top);
    bb_kernel_release(tree->walk);
    bb_kernel_release(tree->write);
    bb_program_release(tree->program);
    *tree = (bb_family_tree){0};
}

static uint32_t chunks_of(const bb_family_tree *tree)
{
    return bb_divide_up(tree->count, BB_COST_CHUNK);
}

static bb_status reserve(bb_family_tree *tree, uint32_t nodes)
{
    bb_device *device = tree->device;
    bb_account *account = tree->account;
    size_t chunks = chunks_of(tree), sums = chunks * sizeof *tree->sums_here;
    BB_TRY(bb_buffer_reserve(device, account, (tree->count + 1ul) * sizeof(bb_family),
                             "reinsert: families", &tree->families));
    BB_TRY(bb_buffer_reserve(device, account, nodes * sizeof(uint32_t), "reinsert: numbers",
                             &tree->numbers));
    BB_TRY(bb_buffer_reserve(device, account, sums, "reinsert: costs", &tree->sums));
    if (bb_cpu_form(tree->device)) {
        BB_TRY(bb_buffer_reserve(device, account, 8ul * TASKS_MAX, "reinsert: subtrees",
                                 &tree->tasks));
        BB_TRY(bb_buffer_reserve(device, account, 8, "reinsert: number of subtrees",
                                 &tree->task_range));
    }
    if (chunks <= tree->sum_capacity)
        return BB_OK;
    tree->sum_capacity = 0;
    BB_TRY(bb_host_alloc(account, sums, "reinsert: costs", &tree->sums_here));
    tree->sum_capacity = chunks;
    return BB_OK;
}

bb_status bb_family_tree_gather(bb_family_tree *tree, const bb_tree *from)
{
    const bb_tree_info *info = &from->info;
    bb_node root;
    tree->count = info->leaf_count - 1;
    BB_TRY(reserve(tree, info->node_count));
    BB_TRY(bb_buffer_read(&from->d_nodes, info->root * sizeof root, sizeof root, &root));
    const bb_box box = {.lo = {root.lo[0], root.lo[1], root.lo[2]},
                        .hi = {root.hi[0], root.hi[1], root.hi[2]}};
    tree->unit = bb_scene_unit(&box);
    BB_TRY(bb_launch(tree->device, tree->mark, info->node_count, GROUP_SIZE, BB_MEM(from->d_nodes),
                     BB_VALUE(info->node_count), BB_MEM(tree->numbers)));
    BB_TRY(bb_scan_u32(tree->primitives, &tree->numbers, &tree->numbers, info->node_count, NULL));
    return bb_launch(tree->device, tree->gather, info->node_count, GROUP_SIZE,
                     BB_MEM(from->d_nodes), BB_VALUE(info->node_count), BB_VALUE(info->root),
                     BB_MEM(tree->numbers), BB_VALUE(tree->count), BB_MEM(tree->families));
}

bb_status bb_family_tree_cost(bb_family_tree *tree, double *cost)
{
    uint32_t chunks = chunks_of(tree);
    BB_TRY(bb_launch(tree->device, tree->cost, chunks, 1, BB_MEM(tree->families),
                     BB_VALUE(tree->count), BB_VALUE(tree->unit), BB_MEM(tree->sums)));
    BB_TRY(bb_buffer_read(&tree->sums, 0, chunks * sizeof *tree->sums_here, tree->sums_here));
    *cost = 0;
    for (uint32_t i = 0; i < chunks; i++)
        *cost += (double)tree->sums_here[i] / BB_COST_ONE;
    return BB_OK;
}

static bb_status write_by_walks(bb_family_tree *tree, uint32_t ref_count, bb_tree *to)
{
    const uint32_t most = TASKS_MAX;
    const bb_tree_info info = {.root = 0,
                               .node_count = 2 * tree->count + 1,
                               .leaf_count = tree->count + 1,
                               .ref_count = ref_count,
                               .arity = 2};
    BB_TRY(bb_buffer_write(&to->d_info, 0, sizeof info, &info));
    BB_TRY(bb_launch(tree->device, tree->top, 1, 1, BB_MEM(tree->families), BB_VALUE(tree->count),
                     BB_VALUE(most), BB_MEM(to->d_nodes), BB_MEM(tree->tasks),
                     BB_MEM(tree->task_range), BB_MEM(to->d_info)));
    return bb_launch(tree->device, tree->walk, most, 1, BB_MEM(tree->families),
                     BB_VALUE(tree->count), BB_VALUE(most), BB_MEM(to->d_nodes),
                     BB_MEM(tree->tasks), BB_MEM(tree->task_range), BB_MEM(to->d_info));
}

bb_status bb_family_tree_write(bb_family_tree *tree, uint32_t ref_count, bb_tree *to)
{
    const bb_tree_info known = {
        .root = 0, .node_count = 2 * tree->count + 1, .ref_count = ref_count};
    if (bb_cpu_form(tree->device))
        return write_by_walks(tree, ref_count, to);
    BB_TRY(bb_launch(tree->device, tree->write, tree->count + 1, GROUP_SIZE, BB_MEM(tree->families),
                     BB_VALUE(tree->count), BB_MEM(to->d_nodes)));
    return bb_links_finish_device(tree->links, &known, to);
}
