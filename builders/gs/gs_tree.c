/* The nodes of gs: a pool with a list of free slots, and the upkeep of links, boxes and counts when
 * subtrees are linked and unlinked.
 *
 * A new child becomes the first child. So the skips of the common tree, which name the next sibling
 * or that of an ancestor, do not change: a child added last would change the skips of all nodes
 * that end with the child before it.
 */
#include "gs.h"

#include <assert.h>
#include <string.h>

/* ---- memory ---- */

static size_t mark_bytes(uint32_t objects)
{
    return (2 * (size_t)objects + 7) / 8 * 8;
}

bb_status bb_gs_reserve(bb_gs_tree *tree, bb_account *account, uint32_t objects)
{
    const char *what = "gs: nodes";
    size_t count = objects, nodes = 2 * count - 1;
    if (objects <= tree->capacity)
        return BB_OK;
    tree->capacity = tree->object_count = 0;
    BB_TRY(bb_host_alloc(account, nodes * sizeof *tree->nodes, what, &tree->nodes));
    BB_TRY(bb_host_alloc(account, mark_bytes(objects), what, &tree->marks));
    BB_TRY(bb_host_alloc(account, nodes * sizeof(uint32_t), what, &tree->heights));
    BB_TRY(bb_host_alloc(account, 2 * count * sizeof(uint32_t), what, &tree->scratch));
    BB_TRY(bb_host_alloc(account, count * sizeof(uint32_t), what, &tree->leaf_of));
    BB_TRY(bb_host_alloc(account, count * sizeof *tree->boxes, what, &tree->boxes));
    BB_TRY(bb_host_alloc(account, (count + 1) * sizeof(uint32_t), what, &tree->widths));
    if (tree->rules.whole)
        BB_TRY(bb_host_alloc(account, count * sizeof *tree->queue, what, &tree->queue));
    tree->capacity = objects;
    return BB_OK;
}

void bb_gs_release(bb_gs_tree *tree)
{
    bb_host_free(tree->nodes);
    bb_host_free(tree->marks);
    bb_host_free(tree->heights);
    bb_host_free(tree->scratch);
    bb_host_free(tree->leaf_of);
    bb_host_free(tree->boxes);
    bb_host_free(tree->widths);
    bb_host_free(tree->queue);
}

void bb_gs_clear(bb_gs_tree *tree, uint32_t objects)
{
    memset(tree->marks, 0, mark_bytes(objects));
    memset(tree->widths, 0, ((size_t)objects + 1) * sizeof *tree->widths);
    tree->object_count = objects;
    tree->count = tree->arity = 0;
    tree->free = tree->root = BB_NONE;
}

uint32_t bb_gs_next_marked(const bb_gs_tree *tree, uint32_t i, uint8_t which)
{
    const uint64_t all = 0x0101010101010101u * which;
    while (i < tree->count) {
        uint64_t eight;
        if (i % 8 == 0) {
            memcpy(&eight, tree->marks + i, sizeof eight);
            if ((eight & all) == 0) {
                i += 8;
                continue;
            }
        }
        if ((tree->marks[i] & which) != 0)
            return i;
        i++;
    }
    return tree->count;
}

static void mark(bb_gs_tree *tree, uint32_t n, uint8_t what)
{
    tree->marks[n] = (uint8_t)(tree->marks[n] | what);
}

/* ---- nodes ---- */

static uint32_t take_slot(bb_gs_tree *tree)
{
    uint32_t n = tree->free;
    if (n == BB_NONE)
        n = tree->count++;
    else
        tree->free = tree->nodes[n].next;
    assert(n < 2 * tree->capacity - 1);
    tree->marks[n] = BB_GS_BOX | BB_GS_SKIP | BB_GS_HEIGHT;
    tree->heights[n] = 0;
    return n;
}

uint32_t bb_gs_make_leaf(bb_gs_tree *tree, uint32_t object, const bb_gs_box *box)
{
    uint32_t n = take_slot(tree);
    tree->nodes[n] = (bb_gs_node){.box = *box,
                                  .parent = BB_NONE,
                                  .first = BB_LEAF_BIT | object,
                                  .next = BB_NONE,
                                  .prev = n,
                                  .objects = 1,
                                  .area = bb_gs_area(box)};
    tree->leaf_of[object] = n;
    return n;
}

void bb_gs_set_box(bb_gs_tree *tree, uint32_t n, const bb_gs_box *box)
{
    tree->nodes[n].box = *box;
    tree->nodes[n].area = bb_gs_area(box);
    mark(tree, n, BB_GS_BOX | BB_GS_TOUCHED);
}

/* Sets the number of children. Also updates the tree's arity when the last of the widest nodes
 * goes. */
static void set_width(bb_gs_tree *tree, uint32_t n, uint32_t width)
{
    uint32_t before = tree->nodes[n].children;
    if (before > 0)
        tree->widths[before]--;
    if (width > 0)
        tree->widths[width]++;
    tree->nodes[n].children = width;
    tree->arity = width > tree->arity ? width : tree->arity;
    while (tree->arity > 0 && tree->widths[tree->arity] == 0)
        tree->arity--;
    mark(tree, n, BB_GS_BOX | BB_GS_HEIGHT);
}

void bb_gs_free_node(bb_gs_tree *tree, uint32_t n)
{
    set_width(tree, n, 0);
    tree->marks[n] = BB_GS_FREE;
    tree->nodes[n].next = tree->free;
    tree->free = n;
}

/* ---- links ---- */

static void prepend(bb_gs_tree *tree, uint32_t n, uint32_t child)
{
    bb_gs_node *nodes = tree->nodes;
    uint32_t old = nodes[n].children > 0 ? nodes[n].first : BB_NONE;
    nodes[child].parent = n;
    nodes[child].next = old;
    nodes[child].prev = old != BB_NONE ? nodes[old].prev : child;
    if (old != BB_NONE)
        nodes[old].prev = child;
    nodes[n].first = child;
    set_width(tree, n, nodes[n].children + 1);
    mark(tree, child, BB_GS_SKIP);
}

/* Redirects the link to `child`, from its parent or from the sibling before it, to `to`. */
static void relink(bb_gs_tree *tree, uint32_t child, uint32_t to)
{
    bb_gs_node *nodes = tree->nodes;
    uint32_t parent = nodes[child].parent;
    if (parent == BB_NONE) {
        tree->root = to;
    } else if (nodes[parent].first == child) {
        nodes[parent].first = to;
        mark(tree, parent, BB_GS_BOX);
    } else {
        nodes[nodes[child].prev].next = to;
        mark(tree, nodes[child].prev, BB_GS_SKIP);
    }
}

/* Redirects the backward link to `child`, from the sibling after it or, if it is the last, from the
 * first. */
static void relink_back(bb_gs_tree *tree, uint32_t child, uint32_t to)
{
    bb_gs_node *nodes = tree->nodes;
    uint32_t parent = nodes[child].parent;
    if (nodes[child].next != BB_NONE)
        nodes[nodes[child].next].prev = to;
    else if (parent != BB_NONE && nodes[parent].first != BB_NONE)
        nodes[nodes[parent].first].prev = to;
}

/* Clears the links of an unlinked node. */
static void set_free(bb_gs_node *nodes, uint32_t n)
{
    nodes[n].parent = nodes[n].next = BB_NONE;
    nodes[n].prev = n;
}

static void unlink_child(bb_gs_tree *tree, uint32_t child)
{
    bb_gs_node *nodes = tree->nodes;
    uint32_t parent = nodes[child].parent;
    relink(tree, child, nodes[child].next);
    relink_back(tree, child, nodes[child].prev);
    set_width(tree, parent, nodes[parent].children - 1);
    set_free(nodes, child);
}

/* Puts the unlinked node `to` in the place of `child`, which is unlinked. */
static void replace_child(bb_gs_tree *tree, uint32_t child, uint32_t to)
{
    bb_gs_node *nodes = tree->nodes;
    nodes[to].parent = nodes[child].parent;
    nodes[to].next = nodes[child].next;
    nodes[to].prev = nodes[child].prev;
    relink(tree, child, to);
    relink_back(tree, child, to);
    if (nodes[to].parent == BB_NONE)
        nodes[to].prev = to;
    else
        mark(tree, nodes[to].parent, BB_GS_HEIGHT);
    mark(tree, to, BB_GS_SKIP);
    set_free(nodes, child);
}

/* ---- boxes and counts ---- */

static void grow(bb_gs_tree *tree, uint32_t n, const bb_gs_box *box)
{
    for (; n != BB_NONE && !bb_gs_contains(&tree->nodes[n].box, box); n = tree->nodes[n].parent) {
        bb_gs_box u = bb_gs_unite(&tree->nodes[n].box, box);
        bb_gs_set_box(tree, n, &u);
    }
}

static bool reaches_a_side(const bb_gs_box *inner, const bb_gs_box *outer)
{
    for (int k = 0; k < 3; k++)
        if (inner->lo[k] <= outer->lo[k] || inner->hi[k] >= outer->hi[k])
            return true;
    return false;
}

/* Shrinks boxes from n up after a part with the box `gone` was removed; stops where `gone` touched
 * no side. */
static void shrink(bb_gs_tree *tree, uint32_t n, const bb_gs_box *gone)
{
    const bb_gs_node *nodes = tree->nodes;
    for (; n != BB_NONE && reaches_a_side(gone, &nodes[n].box); n = nodes[n].parent) {
        uint32_t c = nodes[n].first;
        bb_gs_box u = nodes[c].box;
        while ((c = nodes[c].next) != BB_NONE)
            u = bb_gs_unite(&u, &nodes[c].box);
        if (bb_gs_contains(&u, &nodes[n].box))
            return;
        bb_gs_set_box(tree, n, &u);
    }
}

/* Adds `by`, modulo 2^32 so that it may be negative, to the object counts from n up to below
 * `above`. */
static void count(bb_gs_tree *tree, uint32_t n, uint32_t above, uint32_t by)
{
    for (; n != BB_NONE && n != above; n = tree->nodes[n].parent) {
        tree->nodes[n].objects += by;
        mark(tree, n, BB_GS_TOUCHED);
    }
}

/* ---- linking and unlinking of subtrees ---- */

void bb_gs_attach(bb_gs_tree *tree, uint32_t x, uint32_t node, bool beside, uint32_t above)
{
    bb_gs_node *nodes = tree->nodes;
    uint32_t parent = node;
    if (beside) {
        uint32_t m = take_slot(tree);
        bb_gs_box u = bb_gs_unite(&nodes[node].box, &nodes[x].box);
        nodes[m] = (bb_gs_node){
            .box = u, .area = bb_gs_area(&u), .objects = nodes[node].objects + nodes[x].objects};
        nodes[m].q_init = nodes[m].area / nodes[m].objects;
        replace_child(tree, node, m);
        prepend(tree, m, node);
        prepend(tree, m, x);
        parent = nodes[m].parent;
    } else {
        prepend(tree, node, x);
    }
    count(tree, parent, above, nodes[x].objects);
    grow(tree, parent, &nodes[x].box);
}

void bb_gs_detach(bb_gs_tree *tree, uint32_t x, uint32_t *start)
{
    bb_gs_node *nodes = tree->nodes;
    uint32_t n = nodes[x].parent;
    unlink_child(tree, x);
    if (nodes[n].children == 1) {
        uint32_t left = nodes[n].first, parent = nodes[n].parent;
        unlink_child(tree, left);
        replace_child(tree, n, left);
        bb_gs_free_node(tree, n);
        if (*start == n)
            *start = parent != BB_NONE ? parent : left;
        n = parent;
    }
    count(tree, n, nodes[*start].parent, 0u - nodes[x].objects);
    shrink(tree, n, &nodes[x].box);
}

/* ---- numbers ---- */

/* Gives node `from` the number `to`, which is a free slot. */
static void move_node(bb_gs_tree *tree, uint32_t from, uint32_t to)
{
    bb_gs_node *nodes = tree->nodes;
    nodes[to] = nodes[from];
    tree->heights[to] = tree->heights[from];
    tree->marks[to] = tree->marks[from];
    mark(tree, to, BB_GS_BOX | BB_GS_SKIP);
    relink(tree, from, to);
    relink_back(tree, from, to);
    if (nodes[to].parent == BB_NONE)
        nodes[to].prev = to;
    if (bb_gs_is_leaf(&nodes[to])) {
        tree->leaf_of[nodes[to].first & BB_INDEX_MASK] = to;
        return;
    }
    for (uint32_t c = nodes[to].first; c != BB_NONE; c = nodes[c].next)
        nodes[c].parent = to;
}

static void drop_free_end(bb_gs_tree *tree)
{
    while (tree->count > 0 && (tree->marks[tree->count - 1] & BB_GS_FREE) != 0)
        tree->marks[--tree->count] = 0;
}

void bb_gs_compact(bb_gs_tree *tree)
{
    drop_free_end(tree);
    for (uint32_t n = tree->free; n != BB_NONE;) {
        uint32_t next = tree->nodes[n].next;
        if (n < tree->count) {
            tree->count--;
            move_node(tree, tree->count, n);
            tree->marks[tree->count] = 0;
            drop_free_end(tree);
        }
        n = next;
    }
    tree->free = BB_NONE;
}
