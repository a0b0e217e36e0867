/* Writes the common tree of gs. Both trees use the same numbers, so an update that changed few
 * nodes writes few:
 *
 *   fill free slots with the last nodes
 *   for each node whose box, first child or number changed: write box and first child
 *   for each node that is followed by another sibling than before: write the skip, also to its last
 *       child, to that one's last child, and so on
 *   for each node with other children: update the heights from there up to the first that is right
 *
 * After a build, or if many nodes changed, all are numbered anew in preorder and written; preorder
 * keeps nodes near in memory that are near in the tree. References do not change: leaf i refers to
 * object i.
 */
#include "gs.h"

#include <string.h>

enum { MANY = 4 }; /* many: more than a fourth of the nodes */

/* ---- collections, whose nodes come first ---- */

/* Returns the number of nodes before those of this tree. */
static uint32_t nodes_before(const bb_gs_tree *tree)
{
    return tree->groups != NULL ? tree->groups->first[tree->groups->count] : 0;
}

static uint32_t shifted(const bb_gs_tree *tree, uint32_t n)
{
    return n != BB_NONE ? nodes_before(tree) + n : BB_NONE;
}

static bool is_group(const bb_gs_tree *tree, const bb_gs_node *leaf)
{
    return tree->groups != NULL && bb_gs_is_leaf(leaf) &&
           bb_gs_is_group(tree->groups, leaf->first & BB_INDEX_MASK);
}

static uint32_t height_of_leaf(const bb_gs_tree *tree, const bb_gs_node *leaf)
{
    return is_group(tree, leaf) ? tree->groups->heights[leaf->first & BB_INDEX_MASK] : 0;
}

static uint32_t first_of(const bb_gs_tree *tree, const bb_gs_node *node)
{
    const uint32_t object = node->first & BB_INDEX_MASK;
    if (!bb_gs_is_leaf(node))
        return shifted(tree, node->first);
    if (tree->groups == NULL)
        return node->first;
    return is_group(tree, node) ? tree->groups->first[object]
                                : BB_LEAF_BIT | tree->groups->starts[object];
}

static void write_skip_of(const bb_gs_tree *tree, uint32_t n, uint32_t skip, bb_tree *out)
{
    out->nodes[shifted(tree, n)].skip = skip;
    if (is_group(tree, &tree->nodes[n]))
        bb_gs_groups_end(tree->groups, tree->nodes[n].first & BB_INDEX_MASK, skip, out);
}

/* ---- all nodes ---- */

/* scratch[n]: number of node n in preorder; BB_NONE for free slots. */
static uint32_t number_nodes(bb_gs_tree *tree)
{
    const bb_gs_node *nodes = tree->nodes;
    uint32_t count = 0, n = tree->root;
    memset(tree->scratch, 0xFF, tree->count * sizeof *tree->scratch);
    for (;;) {
        tree->scratch[n] = count++;
        if (!bb_gs_is_leaf(&nodes[n])) {
            n = nodes[n].first;
            continue;
        }
        while (n != BB_NONE && nodes[n].next == BB_NONE)
            n = nodes[n].parent;
        if (n == BB_NONE)
            return count;
        n = nodes[n].next;
    }
}

static uint32_t renumbered(const bb_gs_tree *tree, uint32_t n)
{
    return n != BB_NONE ? tree->scratch[n] : BB_NONE;
}

static void renumber_links(bb_gs_tree *tree)
{
    for (uint32_t i = 0; i < tree->count; i++) {
        bb_gs_node *node = &tree->nodes[i];
        if (tree->scratch[i] == BB_NONE)
            continue;
        node->parent = renumbered(tree, node->parent);
        node->next = renumbered(tree, node->next);
        node->prev = renumbered(tree, node->prev);
        if (bb_gs_is_leaf(node))
            tree->leaf_of[node->first & BB_INDEX_MASK] = tree->scratch[i];
        else
            node->first = renumbered(tree, node->first);
    }
    tree->root = renumbered(tree, tree->root);
}

/* Permutes the nodes in place: each displaced node is moved to its own place next. */
static void permute(bb_gs_tree *tree)
{
    uint32_t *to = tree->scratch;
    for (uint32_t i = 0; i < tree->count; i++)
        while (to[i] != BB_NONE && to[i] != i) {
            uint32_t k = to[i], to_k = to[k];
            bb_gs_node node = tree->nodes[k];
            uint8_t mark = tree->marks[k];
            tree->nodes[k] = tree->nodes[i];
            tree->marks[k] = tree->marks[i];
            tree->nodes[i] = node;
            tree->marks[i] = mark;
            to[k] = k;
            to[i] = to_k;
        }
}

static void emit_all(bb_gs_tree *tree, bb_tree *out)
{
    uint32_t count = number_nodes(tree);
    renumber_links(tree);
    permute(tree);
    memset(tree->marks + count, 0, tree->count - count);
    tree->count = count;
    tree->free = BB_NONE;
    for (uint32_t i = 0; i < count; i++) {
        const bb_gs_node *from = &tree->nodes[i];
        bb_node *to = &out->nodes[shifted(tree, i)];
        memcpy(to->lo, from->box.lo, sizeof to->lo);
        memcpy(to->hi, from->box.hi, sizeof to->hi);
        to->first = first_of(tree, from);
        write_skip_of(tree, i,
                      from->next != BB_NONE     ? shifted(tree, from->next)
                      : from->parent != BB_NONE ? out->nodes[shifted(tree, from->parent)].skip
                                                : BB_NONE,
                      out);
        tree->heights[i] = height_of_leaf(tree, from);
        tree->marks[i] = (uint8_t)(tree->marks[i] & BB_GS_TOUCHED);
    }
    for (uint32_t i = count; i-- > 1;) {
        uint32_t *height = &tree->heights[tree->nodes[i].parent];
        *height = *height > tree->heights[i] ? *height : tree->heights[i] + 1;
    }
}

/* ---- only nodes that changed ---- */

static void write_skip(const bb_gs_tree *tree, uint32_t n, bb_tree *out)
{
    const bb_gs_node *nodes = tree->nodes;
    uint32_t up = n;
    while (up != BB_NONE && nodes[up].next == BB_NONE)
        up = nodes[up].parent;
    const uint32_t skip = up != BB_NONE ? shifted(tree, nodes[up].next) : BB_NONE;
    for (;;) {
        write_skip_of(tree, n, skip, out);
        if (bb_gs_is_leaf(&nodes[n]))
            return;
        n = nodes[nodes[n].first].prev;
    }
}

static void update_heights(bb_gs_tree *tree, uint32_t n)
{
    const bb_gs_node *nodes = tree->nodes;
    for (; n != BB_NONE; n = nodes[n].parent) {
        uint32_t height = height_of_leaf(tree, &nodes[n]);
        uint32_t c = bb_gs_is_leaf(&nodes[n]) ? BB_NONE : nodes[n].first;
        for (; c != BB_NONE; c = nodes[c].next)
            height = height > tree->heights[c] ? height : tree->heights[c] + 1;
        if (height == tree->heights[n])
            return;
        tree->heights[n] = height;
    }
}

static void emit_marked(bb_gs_tree *tree, bb_tree *out)
{
    const uint8_t which = BB_GS_BOX | BB_GS_SKIP | BB_GS_HEIGHT;
    for (uint32_t n = 0; (n = bb_gs_next_marked(tree, n, which)) < tree->count; n++) {
        const bb_gs_node *from = &tree->nodes[n];
        bb_node *to = &out->nodes[shifted(tree, n)];
        memcpy(to->lo, from->box.lo, sizeof to->lo);
        memcpy(to->hi, from->box.hi, sizeof to->hi);
        to->first = first_of(tree, from);
        if ((tree->marks[n] & BB_GS_SKIP) != 0)
            write_skip(tree, n, out);
        if ((tree->marks[n] & BB_GS_HEIGHT) != 0)
            update_heights(tree, n);
        tree->marks[n] = (uint8_t)(tree->marks[n] & BB_GS_TOUCHED);
    }
}

static bool many_changed(const bb_gs_tree *tree)
{
    const uint8_t which = BB_GS_BOX | BB_GS_SKIP | BB_GS_HEIGHT;
    uint32_t changed = 0;
    for (uint32_t n = 0; (n = bb_gs_next_marked(tree, n, which)) < tree->count; n++)
        changed++;
    return changed > tree->count / MANY;
}

void bb_gs_emit(bb_gs_tree *tree, bool whole, bb_tree *out)
{
    if (whole || many_changed(tree)) {
        emit_all(tree, out);
    } else {
        bb_gs_compact(tree);
        emit_marked(tree, out);
    }
    const bb_gs_groups *groups = tree->groups;
    const uint32_t prims = groups != NULL ? groups->starts[groups->count] : tree->object_count;
    const uint32_t arity = groups != NULL ? groups->arity : 0;
    out->info = (bb_tree_info){.root = shifted(tree, tree->root),
                               .node_count = nodes_before(tree) + tree->count,
                               .leaf_count = prims,
                               .ref_count = prims,
                               .arity = arity > tree->arity ? arity : tree->arity,
                               .depth = tree->heights[tree->root]};
}
