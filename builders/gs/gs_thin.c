/* Thinning: deletes nodes that are too large for their remaining objects. Eisemann, Grosch,
 * Mueller, Magnor 2007, section 3.1.
 *
 *   Q(n) = area(n) / objects(n); Q_init(n) = Q(n) when n was made
 *   candidates: inner nodes except the root with Q(n) > tau Q_init(n)
 *   for each that still qualifies: delete it; insert each of its children, with its subtree, from
 *       the deleted node's parent down
 *
 * The parent's box contained the children's before the node was deleted, so the parent is the first
 * ancestor that encloses them. Candidates are fixed before the first is deleted: nodes that become
 * candidates by this wait for the next update, so the phase ends. Only nodes whose area or objects
 * changed since the last check can have become candidates.
 */
#include "gs.h"

static double q_of(const bb_gs_node *node)
{
    return node->area / node->objects;
}

void bb_gs_start_q(bb_gs_tree *tree)
{
    for (uint32_t i = 0; i < tree->count; i++) {
        tree->nodes[i].q_init = q_of(&tree->nodes[i]);
        tree->marks[i] = (uint8_t)(tree->marks[i] & ~BB_GS_TOUCHED);
    }
}

static bool is_thinned(const bb_gs_tree *tree, uint32_t n)
{
    const bb_gs_node *node = &tree->nodes[n];
    return !bb_gs_is_leaf(node) && n != tree->root && q_of(node) > tree->rules.tau * node->q_init;
}

/* Nodes beyond the budget stay marked as touched, and are checked the next time. */
static void find_candidates(bb_gs_tree *tree)
{
    uint32_t left = tree->rules.thin_budget > 0 ? tree->rules.thin_budget : BB_NONE;
    for (uint32_t n = 0; left > 0; n++) {
        n = bb_gs_next_marked(tree, n, BB_GS_TOUCHED);
        if (n == tree->count)
            return;
        bb_gs_node *node = &tree->nodes[n];
        bool thinned = is_thinned(tree, n);
        tree->marks[n] = (uint8_t)(tree->marks[n] & ~BB_GS_TOUCHED);
        if (thinned)
            tree->marks[n] = (uint8_t)(tree->marks[n] | BB_GS_CANDIDATE);
        left -= thinned;
        if (tree->rules.least_q && q_of(node) < node->q_init)
            node->q_init = q_of(node);
    }
}

static void dissolve(bb_gs_tree *tree, uint32_t n)
{
    uint32_t start = tree->rules.from_root ? tree->root : tree->nodes[n].parent;
    uint32_t first = tree->nodes[n].first, next;
    bb_gs_detach(tree, n, &start);
    bb_gs_free_node(tree, n); /* a child may need its slot */
    for (uint32_t c = first; c != BB_NONE; c = next) {
        bb_gs_node *child = &tree->nodes[c];
        next = child->next;
        child->parent = child->next = BB_NONE;
        child->prev = c;
        bb_gs_insert(tree, &start, c);
        tree->reinserted++;
    }
    tree->thinned++;
}

void bb_gs_thin(bb_gs_tree *tree)
{
    if (tree->rules.tau == 0)
        return;
    find_candidates(tree);
    for (uint32_t n = 0;; n++) {
        n = bb_gs_next_marked(tree, n, BB_GS_CANDIDATE);
        if (n == tree->count)
            return;
        tree->marks[n] = (uint8_t)(tree->marks[n] & ~BB_GS_CANDIDATE);
        if (is_thinned(tree, n))
            dissolve(tree, n);
    }
}
