/* Refit on the host:
 *
 *   order = the nodes in preorder: the first child of an inner node, the skip of a leaf
 *   backwards: a node comes after all that is below it
 *       leaf: union of its primitives' boxes; inner node: union of its children's
 */
#include "builders/common/refit.h"

#include <math.h>

static void grow(bb_node *node, const float lo[3], const float hi[3])
{
    for (int axis = 0; axis < 3; axis++) {
        node->lo[axis] = lo[axis] < node->lo[axis] ? lo[axis] : node->lo[axis];
        node->hi[axis] = hi[axis] > node->hi[axis] ? hi[axis] : node->hi[axis];
    }
}

static void join_prims(const bb_tree *tree, const bb_box *boxes, bb_node *leaf)
{
    const uint32_t *ref = tree->refs + (leaf->first & BB_INDEX_MASK);
    do
        grow(leaf, boxes[*ref & BB_INDEX_MASK].lo, boxes[*ref & BB_INDEX_MASK].hi);
    while ((*ref++ & BB_LAST_BIT) == 0);
}

static void join_children(const bb_tree *tree, bb_node *node)
{
    const bb_node *nodes = tree->nodes;
    for (uint32_t child = node->first; child != node->skip; child = nodes[child].skip)
        grow(node, nodes[child].lo, nodes[child].hi);
}

/* Checks that a leaf's references are in range and end. */
static bb_status check_leaf(const bb_tree *tree, uint32_t n, uint32_t prim_count)
{
    uint32_t ref = tree->nodes[n].first & BB_INDEX_MASK;
    for (;; ref++) {
        if (ref >= tree->info.ref_count)
            return bb_fail(BB_FAILED, "refit: leaf %u has references beyond the last, %u", n,
                           tree->info.ref_count);
        if ((tree->refs[ref] & BB_INDEX_MASK) >= prim_count)
            return bb_fail(BB_FAILED, "refit: leaf %u refers to primitive %u of %u", n,
                           tree->refs[ref] & BB_INDEX_MASK, prim_count);
        if ((tree->refs[ref] & BB_LAST_BIT) != 0)
            return BB_OK;
    }
}

static bb_status list_nodes(const bb_tree *tree, uint32_t prim_count, uint32_t *order,
                            uint32_t *count)
{
    uint32_t total = tree->info.node_count;
    *count = 0;
    for (uint32_t n = tree->info.root; n != BB_NONE;) {
        if (n >= total)
            return bb_fail(BB_FAILED, "refit: a link leads to node %u of %u", n, total);
        if (*count == total)
            return bb_fail(BB_FAILED, "refit: node %u is reached twice: a cycle, or two parents",
                           n);
        order[(*count)++] = n;
        const bb_node *node = &tree->nodes[n];
        if (bb_node_is_leaf(node))
            BB_TRY(check_leaf(tree, n, prim_count));
        n = bb_node_is_leaf(node) ? node->skip : node->first;
    }
    return BB_OK;
}

bb_status bb_refit(bb_tree *tree, const bb_box *boxes, uint32_t prim_count, uint32_t *order)
{
    uint32_t count;
    if (tree->duplicated)
        return bb_fail(BB_UNSUPPORTED,
                       "refit: the tree has duplicated references, whose boxes cannot be computed "
                       "from primitives");
    BB_TRY(list_nodes(tree, prim_count, order, &count));
    while (count-- > 0) {
        bb_node *node = &tree->nodes[order[count]];
        for (int axis = 0; axis < 3; axis++) {
            node->lo[axis] = INFINITY;
            node->hi[axis] = -INFINITY;
        }
        if (bb_node_is_leaf(node))
            join_prims(tree, boxes, node);
        else
            join_children(tree, node);
    }
    tree->disjoint = false;
    bb_tree_boxes_changed(tree);
    return BB_OK;
}
