/* Nodes that are thinned: too large for the objects they have left. Eisemann, Grosch, Mueller,
 * Magnor 2007, section 3.1.
 *
 *   Q(n) = area(n) / objects(n); Q_init(n): when n was made
 *   candidates: inner nodes, without the root, with Q(n) > tau Q_init(n)
 *   for each that still is one: delete it; insert each of its children, with all below, from the
 *       parent of the deleted node down
 *
 * The parent's box held the children's before the node was deleted, so it is the first ancestor
 * that encloses them. Candidates are fixed before the first is deleted: what this makes a candidate
 * waits for the next update, and the phase ends. Only nodes whose area or objects changed since
 * they were last looked at can have become one.
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

/* Those beyond the budget stay touched, and so are looked at the next time. */
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
    bb_gs_free_node(tree, n); /* its slot may be needed for a child */
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
