/* The walk along first/skip, and functions that follow directly from it: preorder form, hash, stack
 * need.
 *
 *   visit n
 *   if n is inner: go to first(n), a child of n
 *   else: next = skip(n)
 *         while the parent has the same skip: it is finished too, climb to its parent
 *         next is the next child of the remaining parent; the walk ends when none remains
 *
 * Parents are kept as positions in an array, so climbing needs no stack.
 */
#include "framework/builder/tree_walk.h"

#include <assert.h>
#include <string.h>
#include <xxhash.h>

void bb_walk_release(bb_walk *walk)
{
    bb_host_free(walk->order);
    bb_host_free(walk->parent);
    bb_host_free(walk->width);
    memset(walk, 0, sizeof *walk);
}

static bool test_and_set(uint64_t *bits, uint32_t index)
{
    uint64_t bit = 1ull << (index & 63);
    bool was = (bits[index >> 6] & bit) != 0;
    bits[index >> 6] |= bit;
    return was;
}

static uint32_t first_clear(const uint64_t *bits, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++)
        if ((bits[i >> 6] >> (i & 63) & 1) == 0)
            return i;
    return count;
}

static bb_status make_bits(uint32_t count, uint64_t **bits)
{
    size_t bytes = ((size_t)count / 64 + 1) * sizeof(uint64_t);
    BB_TRY(bb_host_alloc(NULL, bytes, "walk of the tree", bits));
    memset(*bits, 0, bytes);
    return BB_OK;
}

/* Finds the number of references of leaf `index`, each of which must be in no other leaf. */
static bb_status leaf_width(const bb_tree *tree, uint32_t index, uint64_t *used, uint32_t *width)
{
    uint32_t first = tree->nodes[index].first & BB_INDEX_MASK, count = tree->info.ref_count;
    if (first >= count)
        return bb_fail(BB_FAILED, "leaf %u is empty: its first reference is %u of %u", index, first,
                       count);
    for (uint32_t ref = first;; ref++) {
        if (ref == count)
            return bb_fail(BB_FAILED,
                           "leaf %u is not closed: no last-bit from reference %u to the end (%u)",
                           index, first, count);
        if (test_and_set(used, ref))
            return bb_fail(BB_FAILED, "reference %u of leaf %u belongs to another leaf too", ref,
                           index);
        if (tree->refs[ref] & BB_LAST_BIT) {
            *width = ref - first + 1;
            return BB_OK;
        }
    }
}

/* Finds the position of the parent of the node that follows the leaf `index`; BB_NONE at the end of
 * the walk.
 */
static bb_status climb(const bb_tree *tree, const bb_walk *walk, uint32_t index, uint32_t parent,
                       uint32_t *depth, uint32_t *out)
{
    uint32_t next = tree->nodes[index].skip;
    while (parent != BB_NONE && tree->nodes[walk->order[parent]].skip == next) {
        parent = walk->parent[parent];
        (*depth)--;
    }
    if (next == BB_NONE && parent != BB_NONE)
        return bb_fail(BB_FAILED,
                       "the skip of node %u ends the tree, but node %u above it goes on at node %u",
                       index, walk->order[parent], tree->nodes[walk->order[parent]].skip);
    if (next != BB_NONE && parent == BB_NONE)
        return bb_fail(BB_FAILED, "the skip of node %u leads to node %u, outside of the root",
                       index, next);
    *out = parent;
    return BB_OK;
}

static bb_status follow(const bb_tree *tree, bb_walk *walk, uint64_t *seen, uint64_t *used)
{
    uint32_t count = tree->info.node_count, position = 0, depth = 0;
    uint32_t node = tree->info.root, parent = BB_NONE, from = node;
    const char *link = "first";
    while (node != BB_NONE) {
        if (node >= count)
            return bb_fail(BB_FAILED, "the %s of node %u is node %u, there are %u", link, from,
                           node, count);
        if (test_and_set(seen, node))
            return bb_fail(BB_FAILED,
                           "node %u is reached twice, the second time by the %s of node %u: a "
                           "cycle, or two parents",
                           node, link, from);
        walk->order[position] = node;
        walk->parent[position] = parent;
        walk->width[position] = 0;
        if (parent != BB_NONE && ++walk->width[parent] > walk->info.arity)
            walk->info.arity = walk->width[parent];
        from = node;
        if (bb_node_is_leaf(&tree->nodes[node])) {
            BB_TRY(leaf_width(tree, node, used, &walk->width[position]));
            walk->info.leaf_count++;
            walk->info.ref_count += walk->width[position];
            walk->info.depth = depth > walk->info.depth ? depth : walk->info.depth;
            BB_TRY(climb(tree, walk, node, parent, &depth, &parent));
            link = "skip";
            node = tree->nodes[node].skip;
        } else {
            if (tree->nodes[node].first == tree->nodes[node].skip)
                return bb_fail(BB_FAILED, "inner node %u has no child: first and skip are %u", node,
                               tree->nodes[node].skip);
            parent = position;
            depth++;
            link = "first";
            node = tree->nodes[node].first;
        }
        position++;
    }
    walk->info.node_count = position;
    if (position < count)
        return bb_fail(BB_FAILED, "node %u is an orphan: %u of %u nodes are reached from the root",
                       first_clear(seen, count), position, count);
    if (walk->info.ref_count < tree->info.ref_count)
        return bb_fail(BB_FAILED, "reference %u is an orphan: the leaves hold %u of %u",
                       first_clear(used, tree->info.ref_count), walk->info.ref_count,
                       tree->info.ref_count);
    return BB_OK;
}

bb_status bb_walk_tree(const bb_tree *tree, bb_walk *walk)
{
    memset(walk, 0, sizeof *walk);
    const bb_tree_info *info = &tree->info;
    if (tree->place != BB_ON_HOST && !tree->copied)
        return bb_fail(BB_FAILED, "the tree is on the device: download it first");
    if (info->node_count > tree->node_capacity || info->ref_count > tree->ref_capacity)
        return bb_fail(BB_FAILED,
                       "the tree claims %u nodes and %u references, it has room for %zu and %zu",
                       info->node_count, info->ref_count, tree->node_capacity, tree->ref_capacity);
    if (info->root >= info->node_count)
        return bb_fail(BB_FAILED, "the root is node %u, there are %u", info->root,
                       info->node_count);
    if (tree->nodes[info->root].skip != BB_NONE)
        return bb_fail(BB_FAILED, "the skip of the root, node %u, is %u instead of none",
                       info->root, tree->nodes[info->root].skip);

    walk->info.root = info->root;
    size_t bytes = info->node_count * sizeof(uint32_t);
    uint64_t *seen = NULL, *used = NULL;
    bb_status status = bb_host_alloc(NULL, bytes, "walk of the tree", &walk->order);
    if (status == BB_OK)
        status = bb_host_alloc(NULL, bytes, "walk of the tree", &walk->parent);
    if (status == BB_OK)
        status = bb_host_alloc(NULL, bytes, "walk of the tree", &walk->width);
    if (status == BB_OK)
        status = make_bits(info->node_count, &seen);
    if (status == BB_OK)
        status = make_bits(info->ref_count, &used);
    if (status == BB_OK)
        status = follow(tree, walk, seen, used);
    bb_host_free(seen);
    bb_host_free(used);
    return status;
}

void bb_walk_ends(const bb_walk *walk, uint32_t *end)
{
    uint32_t count = walk->info.node_count;
    memset(end, 0, count * sizeof *end);
    for (uint32_t i = count; i-- > 0;) {
        if (end[i] == 0)
            end[i] = i + 1;
        if (i > 0 && end[i] > end[walk->parent[i]])
            end[walk->parent[i]] = end[i];
    }
}

double bb_node_cost(const bb_node *node, uint32_t width)
{
    return bb_node_is_leaf(node) ? BB_COST_INTERSECTION * width : BB_COST_TRAVERSAL * 0.5 * width;
}

/* Copies the side arrays in the order of the walk. */
static bb_status copy_arrays(const bb_tree *tree, const bb_walk *walk, bb_tree *out)
{
    for (uint32_t a = 0; a < tree->array_count; a++) {
        const bb_tree_array *from = &tree->arrays[a];
        bb_tree_array *to;
        if (!from->current)
            continue;
        BB_TRY(
            bb_tree_reserve_array(out, NULL, from->name, from->per_reference, from->stride, &to));
        const char *source = from->host;
        char *target = to->host;
        for (uint32_t i = 0; i < walk->info.node_count; i++) {
            const bb_node *node = &tree->nodes[walk->order[i]];
            bool leaf = bb_node_is_leaf(node);
            size_t at = from->per_reference ? node->first & BB_INDEX_MASK : walk->order[i];
            size_t count = !from->per_reference ? 1 : leaf ? walk->width[i] : 0;
            if (count > 0)
                memcpy(target, source + at * from->stride, count * from->stride);
            target += count * from->stride;
        }
    }
    return BB_OK;
}

bb_status bb_tree_preorder(const bb_tree *tree, bb_tree *out)
{
    assert(out != tree);
    bb_walk walk;
    uint32_t *end = NULL;
    bb_status status = bb_walk_tree(tree, &walk);
    if (status != BB_OK)
        goto out;
    uint32_t count = walk.info.node_count, ref = 0;
    status = bb_host_alloc(NULL, count * sizeof *end, "preorder of the tree", &end);
    if (status != BB_OK)
        goto out;
    status = bb_tree_reserve(out, NULL, BB_ON_HOST, count, walk.info.ref_count);
    if (status != BB_OK)
        goto out;
    bb_walk_ends(&walk, end);
    for (uint32_t i = 0; i < count; i++) {
        bb_node node = tree->nodes[walk.order[i]];
        if (bb_node_is_leaf(&node)) {
            memcpy(out->refs + ref, tree->refs + (node.first & BB_INDEX_MASK),
                   walk.width[i] * sizeof(uint32_t));
            node.first = BB_LEAF_BIT | ref;
            ref += walk.width[i];
        } else {
            node.first = i + 1;
        }
        node.skip = end[i] < count ? end[i] : BB_NONE;
        out->nodes[i] = node;
    }
    out->info = walk.info;
    out->info.root = 0;
    out->duplicated = tree->duplicated;
    out->disjoint = tree->disjoint;
    out->keep_nodes = tree->keep_nodes;
    status = copy_arrays(tree, &walk, out);
out:
    bb_host_free(end);
    bb_walk_release(&walk);
    return status;
}

bb_status bb_tree_hash(const bb_tree *tree, uint64_t *hash)
{
    bb_tree preorder;
    bb_tree_init(&preorder, NULL);
    bb_status status = bb_tree_preorder(tree, &preorder);
    if (status == BB_OK) {
        const bb_tree_info *info = &preorder.info;
        XXH64_hash_t value = XXH3_64bits_withSeed(
            preorder.nodes, info->node_count * sizeof(bb_node), info->node_count);
        *hash = XXH3_64bits_withSeed(preorder.refs, info->ref_count * sizeof(uint32_t), value);
        for (uint32_t i = 0; i < preorder.array_count; i++) {
            const bb_tree_array *array = &preorder.arrays[i];
            size_t count = array->per_reference ? info->ref_count : info->node_count;
            *hash = XXH3_64bits_withSeed(array->host, count * array->stride, *hash);
        }
    }
    bb_tree_release(&preorder);
    return status;
}
