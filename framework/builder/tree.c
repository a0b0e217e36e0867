/* The common tree: its memory and its copies, on host and device. */
#include "framework/builder/tree.h"
#include "framework/base/clock.h"

#include <assert.h>
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
    bb_account *copies = tree->copy_account;
    bb_tree_init(tree, tree->account);
    tree->copy_account = copies;
}

void bb_tree_changed(bb_tree *tree)
{
    static _Atomic uint64_t last;
    tree->copied = false;
    tree->refitted = false;
    tree->links = ++last;
}

void bb_tree_boxes_changed(bb_tree *tree)
{
    tree->copied = false;
    tree->refitted = true;
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
    /* The other side holds a copy, or data of an earlier use of this tree. */
    if (place != tree->place)
        bb_tree_release(tree);
    tree->place = place;
    bb_tree_changed(tree);
    for (uint32_t i = 0; i < tree->array_count; i++)
        tree->arrays[i].current = false;
    memset(&tree->info, 0, sizeof tree->info);
    return place == BB_ON_HOST ? reserve_host(tree, tree->account, nodes, refs)
                               : reserve_device(tree, device, tree->account, nodes, refs);
}

bb_status bb_tree_copy(const bb_tree *from, bb_tree *to)
{
    const bb_tree_info *info = &from->info;
    BB_TRY(bb_buffer_copy(&from->d_nodes, &to->d_nodes, info->node_count * sizeof(bb_node)));
    BB_TRY(bb_buffer_copy(&from->d_refs, &to->d_refs, info->ref_count * sizeof(uint32_t)));
    to->duplicated = from->duplicated;
    to->disjoint = from->disjoint;
    to->keep_nodes = from->keep_nodes;
    return bb_buffer_write(&to->d_info, 0, sizeof *info, info);
}

/* ---- side arrays ---- */

static bool has_name(const bb_tree_array *array, const char *name)
{
    return array->name != NULL && strcmp(array->name, name) == 0;
}

const bb_tree_array *bb_tree_find_array(const bb_tree *tree, const char *name)
{
    for (uint32_t i = 0; i < tree->array_count; i++)
        if (tree->arrays[i].current && has_name(&tree->arrays[i], name))
            return &tree->arrays[i];
    return NULL;
}

/* Returns the slot of an earlier array of that name, or a free one; NULL if there is none. */
static bb_tree_array *array_place(bb_tree *tree, const char *name)
{
    for (uint32_t i = 0; i < tree->array_count; i++)
        if (has_name(&tree->arrays[i], name))
            return &tree->arrays[i];
    for (uint32_t i = 0; i < tree->array_count; i++)
        if (!tree->arrays[i].current)
            return &tree->arrays[i];
    return tree->array_count < BB_TREE_ARRAYS_MAX ? &tree->arrays[tree->array_count++] : NULL;
}

static bb_status reserve_array_host(bb_tree_array *array, bb_account *account, size_t bytes)
{
    if (array->host != NULL && array->host_bytes >= bytes)
        return BB_OK;
    array->host_bytes = 0;
    BB_TRY(bb_host_alloc(account, bytes, array->name, &array->host));
    array->host_bytes = bytes;
    return BB_OK;
}

bb_status bb_tree_reserve_array(bb_tree *tree, bb_device *device, const char *name,
                                bool per_reference, uint32_t stride, bb_tree_array **out)
{
    bool on_host = tree->place == BB_ON_HOST;
    size_t nodes = on_host ? tree->node_capacity : tree->d_nodes.bytes / sizeof(bb_node);
    size_t refs = on_host ? tree->ref_capacity : tree->d_refs.bytes / sizeof(uint32_t);
    size_t bytes = (per_reference ? refs : nodes) * stride;
    if (nodes == 0 || stride == 0 || stride % 4 != 0)
        return bb_fail(BB_FAILED, "side array %s: %s", name,
                       nodes == 0 ? "there is no tree: reserve that first"
                                  : "its elements must have a multiple of 4 bytes");
    bb_tree_array *array = array_place(tree, name);
    if (array == NULL)
        return bb_fail(BB_FAILED, "side array %s: a tree has at most %d", name, BB_TREE_ARRAYS_MAX);
    array->name = name;
    array->per_reference = per_reference;
    array->stride = stride;
    BB_TRY(on_host ? reserve_array_host(array, tree->account, bytes)
                   : bb_buffer_reserve(device, tree->account, bytes, name, &array->buffer));
    array->current = true;
    tree->copied = false;
    *out = array;
    return BB_OK;
}

/* Returns the bytes in use of side array `array`; 0 if the tree does not have it any more. */
static size_t array_bytes(const bb_tree *tree, const bb_tree_array *array)
{
    uint32_t count = array->per_reference ? tree->info.ref_count : tree->info.node_count;
    return array->current ? (size_t)count * array->stride : 0;
}

static bb_status download_arrays(bb_tree *tree)
{
    for (uint32_t i = 0; i < tree->array_count; i++) {
        bb_tree_array *array = &tree->arrays[i];
        size_t bytes = array_bytes(tree, array);
        if (bytes > 0)
            BB_TRY(bb_buffer_read(&array->buffer, 0, bytes, array->host));
    }
    return BB_OK;
}

static bb_status upload_arrays(bb_tree *tree)
{
    for (uint32_t i = 0; i < tree->array_count; i++) {
        bb_tree_array *array = &tree->arrays[i];
        size_t bytes = array_bytes(tree, array);
        if (bytes > 0)
            BB_TRY(bb_buffer_write(&array->buffer, 0, bytes, array->host));
    }
    return BB_OK;
}

/* ---- copies ---- */

/* Refuses an info that claims more than there is room for, since copies rely on these counts. */
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
    BB_TRY(reserve_host(tree, tree->copy_account, info->node_count, info->ref_count));
    for (uint32_t i = 0; i < tree->array_count; i++)
        BB_TRY(reserve_array_host(&tree->arrays[i], tree->copy_account,
                                  array_bytes(tree, &tree->arrays[i])));

    double start = bb_wall_ms();
    if (info->node_count > 0)
        BB_TRY(bb_buffer_read(&tree->d_nodes, 0, info->node_count * sizeof(bb_node), tree->nodes));
    if (info->ref_count > 0)
        BB_TRY(bb_buffer_read(&tree->d_refs, 0, info->ref_count * sizeof(uint32_t), tree->refs));
    BB_TRY(download_arrays(tree));
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
    BB_TRY(reserve_device(tree, device, tree->copy_account, info->node_count, info->ref_count));
    for (uint32_t i = 0; i < tree->array_count; i++)
        BB_TRY(bb_buffer_reserve(device, tree->copy_account, array_bytes(tree, &tree->arrays[i]),
                                 tree->arrays[i].name, &tree->arrays[i].buffer));

    double start = bb_wall_ms();
    BB_TRY(bb_buffer_write(&tree->d_info, 0, sizeof *info, info));
    if (info->node_count > 0)
        BB_TRY(bb_buffer_write(&tree->d_nodes, 0, info->node_count * sizeof(bb_node), tree->nodes));
    if (info->ref_count > 0)
        BB_TRY(bb_buffer_write(&tree->d_refs, 0, info->ref_count * sizeof(uint32_t), tree->refs));
    BB_TRY(upload_arrays(tree));
    if (ms != NULL)
        *ms = bb_wall_ms() - start;
    tree->copied = true;
    return BB_OK;
}

void bb_tree_take_copy(bb_tree *tree, bb_tree *out)
{
    assert(tree->place == BB_ON_DEVICE && tree->copied && tree->copy_account == NULL);
    *out = *tree;
    out->account = NULL;
    out->place = BB_ON_HOST;
    out->copied = false;
    out->d_info = out->d_nodes = out->d_refs = (bb_buffer){0};
    for (uint32_t i = 0; i < tree->array_count; i++) {
        out->arrays[i].buffer = (bb_buffer){0};
        tree->arrays[i].host = NULL;
        tree->arrays[i].host_bytes = 0;
    }
    tree->nodes = NULL;
    tree->refs = NULL;
    tree->node_capacity = tree->ref_capacity = 0;
    tree->copied = false;
}

void bb_tree_drop_copy(bb_tree *tree)
{
    const bool on_host = tree->place == BB_ON_HOST;
    if (on_host)
        release_device(tree);
    else
        release_host(tree);
    for (uint32_t i = 0; i < tree->array_count; i++) {
        bb_tree_array *array = &tree->arrays[i];
        if (on_host) {
            bb_buffer_release(&array->buffer);
            continue;
        }
        bb_host_free(array->host);
        array->host = NULL;
        array->host_bytes = 0;
    }
    tree->copied = false;
}

uint64_t bb_tree_bytes(const bb_tree *tree)
{
    uint64_t bytes = (uint64_t)tree->info.node_count * sizeof(bb_node) +
                     (uint64_t)tree->info.ref_count * sizeof(uint32_t);
    for (uint32_t i = 0; i < tree->array_count; i++)
        bytes += array_bytes(tree, &tree->arrays[i]);
    return bytes;
}
