/* Host side of parts.cl. */
#include "parts.h"

BB_DEVICE_SOURCE(parts);

enum {
    GROUP_SIZE = 64,
    PART_GROUP_SIZE = 4, /* parts are few, and each is much work */
};

bb_status bb_parts_create(bb_parts *parts)
{
    BB_TRY(bb_program_build(parts->device, &bb_source_parts, "", &parts->program));
    BB_TRY(bb_kernel_get(parts->program, "parts_mark", &parts->mark));
    BB_TRY(bb_kernel_get(parts->program, "parts_measure", &parts->measure));
    BB_TRY(bb_kernel_get(parts->program, "parts_list", &parts->list));
    BB_TRY(bb_kernel_get(parts->program, "parts_fit", &parts->fit));
    BB_TRY(bb_kernel_get(parts->program, "parts_rebuild", &parts->rebuild));
    BB_TRY(bb_kernel_get(parts->program, "parts_depth", &parts->depth));
    BB_TRY(bb_primitives_create(parts->device, parts->account, &parts->primitives));
    return bb_compaction_create(parts->device, parts->account, parts->primitives,
                                &parts->compaction);
}

void bb_parts_release(bb_parts *parts)
{
    bb_buffer *const buffers[] = {
        &parts->marks, &parts->roots,  &parts->root_count, &parts->part_of, &parts->parts_there,
        &parts->order, &parts->leaves, &parts->ranges,     &parts->pairs,   &parts->chosen};
    for (size_t i = 0; i < sizeof buffers / sizeof buffers[0]; i++)
        bb_buffer_release(buffers[i]);
    bb_host_free(parts->parts);
    bb_host_free(parts->built);
    bb_host_free(parts->choice);
    bb_compaction_destroy(parts->compaction);
    bb_primitives_destroy(parts->primitives);
    bb_kernel_release(parts->mark);
    bb_kernel_release(parts->measure);
    bb_kernel_release(parts->list);
    bb_kernel_release(parts->fit);
    bb_kernel_release(parts->rebuild);
    bb_kernel_release(parts->depth);
    bb_program_release(parts->program);
    *parts = (bb_parts){0};
}

/* ---- plan ---- */

static bb_status reserve_there(bb_parts *parts, size_t bytes, const char *what, bb_buffer *out)
{
    return bb_buffer_reserve(parts->device, parts->account, bytes, what, out);
}

static bb_status reserve_for_nodes(bb_parts *parts, const bb_tree *tree)
{
    size_t nodes = tree->info.node_count, leaves = tree->info.leaf_count;
    BB_TRY(reserve_there(parts, nodes * sizeof(uint32_t), "refit: marks", &parts->marks));
    BB_TRY(
        reserve_there(parts, nodes * sizeof(uint32_t), "refit: parts of nodes", &parts->part_of));
    BB_TRY(reserve_there(parts, leaves * sizeof(uint32_t), "refit: roots", &parts->roots));
    BB_TRY(reserve_there(parts, sizeof(uint32_t), "refit: number of roots", &parts->root_count));
    BB_TRY(reserve_there(parts, leaves * sizeof(uint32_t), "refit: order", &parts->order));
    BB_TRY(reserve_there(parts, leaves * 4 * sizeof(uint32_t), "refit: ranges", &parts->ranges));
    BB_TRY(reserve_there(parts, leaves * 2 * sizeof(uint32_t), "refit: pairs", &parts->pairs));
    return bb_compaction_reserve(parts->compaction, (uint32_t)nodes);
}

/* Reserves the scratch. Each leaf of the tree is a leaf of its part, and each part is a leaf of the
 * top. */
static bb_status reserve_for_parts(bb_parts *parts, const bb_tree *tree)
{
    size_t count = parts->count + 1ul, leaves = tree->info.leaf_count + parts->count;
    BB_TRY(reserve_there(parts, count * sizeof(bb_part), "refit: parts", &parts->parts_there));
    BB_TRY(reserve_there(parts, count * sizeof(uint32_t), "refit: chosen", &parts->chosen));
    BB_TRY(reserve_there(parts, leaves * sizeof(bb_node), "refit: leaves", &parts->leaves));
    if (count <= parts->capacity)
        return BB_OK;
    parts->capacity = 0; /* stays 0 if an allocation fails */
    BB_TRY(bb_host_alloc(parts->account, count * sizeof(bb_part), "refit: parts", &parts->parts));
    BB_TRY(bb_host_alloc(parts->account, count * sizeof(double), "refit: costs", &parts->built));
    BB_TRY(
        bb_host_alloc(parts->account, count * sizeof(uint32_t), "refit: choice", &parts->choice));
    parts->capacity = (uint32_t)count;
    return BB_OK;
}

static bb_status find_roots(bb_parts *parts, const bb_tree *tree)
{
    uint32_t nodes = tree->info.node_count;
    BB_TRY(bb_buffer_fill(&parts->marks, nodes * sizeof(uint32_t), 0));
    BB_TRY(bb_launch(parts->device, parts->mark, nodes, GROUP_SIZE, BB_MEM(tree->d_nodes),
                     BB_VALUE(nodes), BB_VALUE(tree->info.root), BB_MEM(parts->marks)));
    BB_TRY(bb_compact_u32(parts->compaction, &parts->marks, NULL, nodes, &parts->roots,
                          &parts->root_count));
    return bb_buffer_read(&parts->root_count, 0, sizeof parts->count, &parts->count);
}

static bb_status read_parts(bb_parts *parts)
{
    return bb_buffer_read(&parts->parts_there, 0, (parts->count + 1ul) * sizeof(bb_part),
                          parts->parts);
}

static bb_status list_nodes(bb_parts *parts, const bb_tree *tree)
{
    uint32_t count = parts->count + 1, begin = 0;
    BB_TRY(bb_buffer_fill(&parts->part_of, tree->info.node_count * sizeof(uint32_t), BB_NONE));
    BB_TRY(bb_launch(parts->device, parts->measure, count, PART_GROUP_SIZE, BB_MEM(tree->d_nodes),
                     BB_MEM(parts->roots), BB_VALUE(parts->count), BB_VALUE(tree->info.root),
                     BB_MEM(parts->parts_there), BB_MEM(parts->part_of)));
    BB_TRY(read_parts(parts));
    for (uint32_t p = 0; p < count; p++) {
        parts->parts[p].begin = begin;
        begin += parts->parts[p].inner;
    }
    BB_TRY(bb_buffer_write(&parts->parts_there, 0, count * sizeof(bb_part), parts->parts));
    return bb_launch(parts->device, parts->list, count, PART_GROUP_SIZE, BB_MEM(tree->d_nodes),
                     BB_MEM(parts->part_of), BB_MEM(parts->parts_there), BB_VALUE(count),
                     BB_MEM(parts->order));
}

/* ---- refit ---- */

static bb_status launch_fit(bb_parts *parts, const bb_buffer *boxes, bb_tree *tree, uint32_t from,
                            uint32_t to)
{
    uint32_t count = parts->count + 1;
    return bb_launch(parts->device, parts->fit, to - from, PART_GROUP_SIZE, BB_MEM(tree->d_nodes),
                     BB_MEM(tree->d_refs), BB_MEM(*boxes), BB_MEM(parts->parts_there),
                     BB_VALUE(from), BB_VALUE(to), BB_VALUE(count), BB_MEM(parts->order));
}

static bb_status fit(bb_parts *parts, const bb_buffer *boxes, bb_tree *tree)
{
    BB_TRY(launch_fit(parts, boxes, tree, 0, parts->count));
    BB_TRY(launch_fit(parts, boxes, tree, parts->count, parts->count + 1));
    return read_parts(parts);
}

/* Returns the part's share of the tree's SAH. */
static double share_of(const bb_parts *parts, uint32_t p)
{
    double area = parts->parts[parts->count].area;
    return area > 0 ? parts->parts[p].cost / area : 0;
}

bb_status bb_parts_plan(bb_parts *parts, const bb_buffer *boxes, bb_tree *tree)
{
    BB_TRY(reserve_for_nodes(parts, tree));
    BB_TRY(find_roots(parts, tree));
    BB_TRY(reserve_for_parts(parts, tree));
    BB_TRY(list_nodes(parts, tree));
    BB_TRY(fit(parts, boxes, tree));
    for (uint32_t p = 0; p <= parts->count; p++)
        parts->built[p] = share_of(parts, p);
    return BB_OK;
}

/* ---- rebuild ---- */

/* Lists the parts that have become worse, in ascending order, so that the top is last. Parts of two
 * leaves have only one shape. */
static uint32_t choose(bb_parts *parts)
{
    uint32_t chosen = 0;
    for (uint32_t p = 0; p <= parts->count; p++)
        if (parts->parts[p].inner > 1 && share_of(parts, p) > parts->factor * parts->built[p])
            parts->choice[chosen++] = p;
    return chosen;
}

static bb_status launch_rebuild(bb_parts *parts, bb_tree *tree, uint32_t from, uint32_t to)
{
    if (from == to)
        return BB_OK;
    return bb_launch(parts->device, parts->rebuild, to - from, PART_GROUP_SIZE,
                     BB_MEM(tree->d_nodes), BB_MEM(parts->part_of), BB_MEM(parts->parts_there),
                     BB_MEM(parts->chosen), BB_VALUE(from), BB_VALUE(to), BB_MEM(parts->order),
                     BB_MEM(parts->leaves), BB_MEM(parts->ranges), BB_MEM(parts->pairs));
}

static bb_status rebuild(bb_parts *parts, bb_tree *tree, uint32_t chosen, uint32_t *rebuilt)
{
    bool with_top = parts->choice[chosen - 1] == parts->count;
    uint32_t without = with_top ? chosen - 1 : chosen;
    BB_TRY(bb_buffer_write(&parts->chosen, 0, chosen * sizeof(uint32_t), parts->choice));
    BB_TRY(launch_rebuild(parts, tree, 0, without));
    BB_TRY(launch_rebuild(parts, tree, without, chosen));
    BB_TRY(bb_launch(parts->device, parts->depth, 1, 1, BB_MEM(tree->d_nodes),
                     BB_MEM(parts->part_of), BB_MEM(parts->parts_there), BB_VALUE(parts->count),
                     BB_MEM(parts->order), BB_MEM(tree->d_info)));
    BB_TRY(read_parts(parts));
    for (uint32_t i = 0; i < chosen; i++) {
        uint32_t p = parts->choice[i];
        parts->built[p] = share_of(parts, p);
        *rebuilt += parts->parts[p].rebuilt;
    }
    return BB_OK;
}

bb_status bb_parts_update(bb_parts *parts, const bb_buffer *boxes, bb_tree *tree, uint32_t *rebuilt)
{
    *rebuilt = 0;
    BB_TRY(fit(parts, boxes, tree));
    tree->disjoint = false;
    uint32_t chosen = choose(parts);
    if (chosen != 0)
        BB_TRY(rebuild(parts, tree, chosen, rebuilt));
    if (*rebuilt == 0)
        bb_tree_boxes_changed(tree);
    else
        bb_tree_changed(tree);
    return BB_OK;
}
