/* The walk that all passes over a tree share: once along first/skip, verifying the links on the
 * way.
 *
 * A walk turns the links into three arrays by preorder position. So top-down passes are loops
 * forwards, bottom-up passes loops backwards, and no pass recurses, even if the tree is a chain of
 * a million nodes.
 */
#ifndef BB_TREE_WALK_H
#define BB_TREE_WALK_H

#include "framework/builder/tree.h"

typedef struct bb_walk {
    bb_tree_info info; /* as found; root as declared */
    uint32_t *order;   /* node at this position */
    uint32_t *parent;  /* position of its parent; BB_NONE for the root, which is at 0 */
    uint32_t *width;   /* children of an inner node, references of a leaf */
} bb_walk;

/* Walks `tree`. BB_FAILED with node numbers for links or reference runs that are out of range,
 * cyclic, shared or orphaned. Linear time. Release with bb_walk_release(), also after a failure. */
bb_status bb_walk_tree(const bb_tree *tree, bb_walk *walk);
void bb_walk_release(bb_walk *walk);

/* Writes the position after the subtree at each position into end[info.node_count]. */
void bb_walk_ends(const bb_walk *walk, uint32_t *end);

/* Returns the cost of a node without its descendants, per unit of area. */
double bb_node_cost(const bb_node *node, uint32_t width);

#endif
