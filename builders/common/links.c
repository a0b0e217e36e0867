/* Skips from siblings:
 *
 *   n = root
 *   while there is a node n:
 *       if it is inner: the last of its children skips to where n does; go on with the first
 *       else: go on at skip(n), which is known: all that n hangs from was seen before
 */
#include "builders/common/links.h"

#include <assert.h>

/* Sets the depths of n's children and the skip of the last; returns their number. */
static uint32_t finish_children(bb_tree *tree, uint32_t n, uint32_t *depths)
{
    bb_node *nodes = tree->nodes;
    uint32_t count = 1, child = nodes[n].first, total = tree->info.node_count;
    for (; nodes[child].skip < total && count < total; count++) {
        if (depths != NULL)
            depths[child] = depths[n] + 1;
        child = nodes[child].skip;
    }
    if (depths != NULL)
        depths[child] = depths[n] + 1;
    if (nodes[child].skip == BB_NONE)
        nodes[child].skip = nodes[n].skip;
    return count;
}

bb_status bb_links_finish(bb_tree *tree, uint32_t *depths)
{
    bb_tree_info *info = &tree->info;
    const bb_node *nodes = tree->nodes;
    uint32_t met = 0, n = info->root;
    info->leaf_count = info->arity = 0;
    assert(n < info->node_count);
    if (depths != NULL)
        info->depth = depths[n] = 0;
    while (n != BB_NONE) {
        uint32_t from = n;
        if (++met > info->node_count)
            return bb_fail(BB_FAILED, "links: node %u is reached twice: a cycle, or two parents",
                           n);
        if (bb_node_is_leaf(&nodes[n])) {
            info->leaf_count++;
            if (depths != NULL && depths[n] > info->depth)
                info->depth = depths[n];
            n = nodes[n].skip;
        } else if ((n = nodes[n].first) < info->node_count) {
            uint32_t children = finish_children(tree, from, depths);
            info->arity = children > info->arity ? children : info->arity;
        }
        if (n != BB_NONE && n >= info->node_count)
            return bb_fail(BB_FAILED, "links: node %u links to node %u, there are %u", from, n,
                           info->node_count);
    }
    return BB_OK;
}
