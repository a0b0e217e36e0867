/* The common tree: its memory and its copies, on host and device. */
#include "framework/tree/tree.h"
#include "framework/base/clock.h"

#include <string.h>

enum { TREE_ENTRIES_MAX = BB_INDEX_MASK };

void bb_tree_init(bb_tree *tree, bb_account *account)
{
    memset(tree, 0, sizeof *tree);
    tree->account = account;
}

static void release_host(bb_tree *tree)
{
    bb_host_free(tree->nodes);
    bb_host_free(tree->refs);
    tree->nodes = NULL;
    tree->refs = NULL;
    tree->node_capacity = tree->ref_capacity = 0;
}

static void release_device(bb_tree *tree)
{
    bb_buffer_release(&tree->d_info);
    bb_buffer_release(&tree->d_nodes);
    bb_buffer_release(&tree->d_refs);
}

void bb_tree_release(bb_tree *tree)
{
    release_host(tree);
    release_device(tree);
    for (uint32_t i = 0; i < tree->array_count; i++) {
        bb_host_free(tree->arrays[i].host);
        bb_buffer_release(&tree->arrays[i].buffer);
    }
    bb_tree_init(tree, tree->account);
}

void bb_tree_changed(bb_tree *tree)
{
    tree->copied = false;
}

static bb_status reserve_host(bb_tree *tree, bb_account *account, size_t nodes, size_t refs)
{
    if (tree->nodes == NULL || tree->node_capacity < nodes) {
        tree->node_capacity = 0;
        BB_TRY(bb_host_alloc(account, nodes * sizeof(bb_node), "nodes of the tree", &tree->nodes));
        tree->node_capacity = nodes;
    }
    if (tree->refs == NULL || tree->ref_capacity < refs) {
        tree->ref_capacity = 0;
        BB_TRY(
            bb_host_alloc(account, refs * sizeof(uint32_t), "references of the tree", &tree->refs));
        tree->ref_capacity = refs;
    }
    return BB_OK;
}

static bb_status reserve_device(bb_tree *tree, bb_device *device, bb_account *account, size_t nodes,
                                size_t refs)
{
    BB_TRY(bb_buffer_reserve(device, account, sizeof(bb_tree_info), "info of the tree",
                             &tree->d_info));
    BB_TRY(bb_buffer_reserve(device, account, nodes * sizeof(bb_node), "nodes of the tree",
                             &tree->d_nodes));
    return bb_buffer_reserve(device, account, refs * sizeof(uint32_t), "references of the tree",
                             &tree->d_refs);
}

bb_status bb_tree_reserve(bb_tree *tree, bb_device *device, bb_place place, size_t nodes,
                          size_t refs)
{
    if (nodes > TREE_ENTRIES_MAX || refs > TREE_ENTRIES_MAX)
        return bb_fail(BB_REFUSED,
                       "a tree of %zu nodes and %zu references: at most %d of each can be linked",
                       nodes, refs, TREE_ENTRIES_MAX);
    /* What lies on the other side is a copy, or of an earlier life of this tree. */
    if (place != tree->place)
        bb_tree_release(tree);
    tree->place = place;
    tree->copied = false;
    memset(&tree->info, 0, sizeof tree->info);
    return place == BB_ON_HOST ? reserve_host(tree, tree->account, nodes, refs)
                               : reserve_device(tree, device, tree->account, nodes, refs);
}

/* Bytes in use of side array `array`. */
static size_t array_bytes(const bb_tree *tree, const bb_tree_array *array)
{
    uint32_t count = array->per_reference ? tree->info.ref_count : tree->info.node_count;
    return (size_t)count * array->stride;
}

/* Refuses an info that claims more than there is room for: what follows copies by these counts. */
static bb_status check_room(const bb_tree *tree, size_t nodes, size_t refs)
{
    const bb_tree_info *info = &tree->info;
    if (info->node_count > nodes || info->ref_count > refs)
        return bb_fail(BB_FAILED,
                       "the tree claims %u nodes and %u references, it has room for %zu and %zu",
                       info->node_count, info->ref_count, nodes, refs);
    return BB_OK;
}

bb_status bb_tree_fetch_info(bb_tree *tree)
{
    if (tree->place == BB_ON_HOST)
        return BB_OK;
    if (tree->d_info.mem == NULL)
        return bb_fail(BB_FAILED, "the tree has no room on the device: nothing was built");
    BB_TRY(bb_buffer_read(&tree->d_info, 0, sizeof tree->info, &tree->info));
    return check_room(tree, tree->d_nodes.bytes / sizeof(bb_node),
                      tree->d_refs.bytes / sizeof(uint32_t));
}

bb_status bb_tree_download(bb_tree *tree, double *ms)
{
    if (ms != NULL)
        *ms = 0.0;
    if (tree->place == BB_ON_HOST || tree->copied)
        return BB_OK;
    BB_TRY(bb_tree_fetch_info(tree));
    const bb_tree_info *info = &tree->info;
    BB_TRY(reserve_host(tree, NULL, info->node_count, info->ref_count));
    for (uint32_t i = 0; i < tree->array_count; i++)
        BB_TRY(bb_host_alloc(NULL, array_bytes(tree, &tree->arrays[i]), tree->arrays[i].name,
                             &tree->arrays[i].host));

    double start = bb_wall_ms();
    if (info->node_count > 0)
        BB_TRY(bb_buffer_read(&tree->d_nodes, 0, info->node_count * sizeof(bb_node), tree->nodes));
    if (info->ref_count > 0)
        BB_TRY(bb_buffer_read(&tree->d_refs, 0, info->ref_count * sizeof(uint32_t), tree->refs));
    for (uint32_t i = 0; i < tree->array_count; i++) {
        size_t bytes = array_bytes(tree, &tree->arrays[i]);
        if (bytes > tree->arrays[i].buffer.bytes)
            return bb_fail(BB_FAILED, "side array %s has %zu bytes, the tree's counts ask for %zu",
                           tree->arrays[i].name, tree->arrays[i].buffer.bytes, bytes);
        if (bytes > 0)
            BB_TRY(bb_buffer_read(&tree->arrays[i].buffer, 0, bytes, tree->arrays[i].host));
    }
    if (ms != NULL)
        *ms = bb_wall_ms() - start;
    tree->copied = true;
    return BB_OK;
}

bb_status bb_tree_upload(bb_tree *tree, bb_device *device, double *ms)
{
    if (ms != NULL)
        *ms = 0.0;
    if (tree->place == BB_ON_DEVICE || tree->copied)
        return BB_OK;
    const bb_tree_info *info = &tree->info;
    BB_TRY(check_room(tree, tree->node_capacity, tree->ref_capacity));
    BB_TRY(reserve_device(tree, device, NULL, info->node_count, info->ref_count));
    for (uint32_t i = 0; i < tree->array_count; i++)
        BB_TRY(bb_buffer_reserve(device, NULL, array_bytes(tree, &tree->arrays[i]),
                                 tree->arrays[i].name, &tree->arrays[i].buffer));

    double start = bb_wall_ms();
    BB_TRY(bb_buffer_write(&tree->d_info, 0, sizeof *info, info));
    if (info->node_count > 0)
        BB_TRY(bb_buffer_write(&tree->d_nodes, 0, info->node_count * sizeof(bb_node), tree->nodes));
    if (info->ref_count > 0)
        BB_TRY(bb_buffer_write(&tree->d_refs, 0, info->ref_count * sizeof(uint32_t), tree->refs));
    for (uint32_t i = 0; i < tree->array_count; i++)
        if (array_bytes(tree, &tree->arrays[i]) > 0)
            BB_TRY(bb_buffer_write(&tree->arrays[i].buffer, 0, array_bytes(tree, &tree->arrays[i]),
                                   tree->arrays[i].host));
    if (ms != NULL)
        *ms = bb_wall_ms() - start;
    tree->copied = true;
    return BB_OK;
}

uint64_t bb_tree_bytes(const bb_tree *tree)
{
    return (uint64_t)tree->info.node_count * sizeof(bb_node) +
           (uint64_t)tree->info.ref_count * sizeof(uint32_t);
}
