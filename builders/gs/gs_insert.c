/* The cheapest place for a box X: Goldsmith and Salmon 1987, for nodes of any number of children.
 *
 *   the cost of a tree: children(n) area(n), summed over its inner nodes
 *   n = start; inherited = children(n) (area(n + X) - area(n))
 *   repeat:
 *       X becomes a child of n:                     inherited + area(n + X)
 *       a new node over X and c, for each child c:  inherited + 2 area(c + X)
 *       growth(c) = children(c) (area(c + X) - area(c)), for each inner child c
 *       go to the c of least growth; inherited += growth(c)
 *   until no node below can beat the best of these; take the best
 *
 * What X costs below a node is at least the inherited cost plus area(X); this bound ends the walk.
 * A new root over the old one and X is a possible place, too. The whole tree is searched in order
 * of inherited cost, starting with the best place on the single path (Bittner, Hapala, Havran
 * 2013).
 *
 * Ties decide whether many equal boxes make a balanced tree or a chain. Among places of equal cost,
 * one that needs no new node wins, then the one with fewer objects. Among children of equal growth
 * the smaller one wins, then the one with fewer objects. Equal boxes fill nodes to the allowed
 * width: with any number of children allowed, one node gets them all, and each insertion tests them
 * all.
 */
#include "gs.h"

#include <math.h>

typedef bb_gs_choice choice;

static void consider(choice *best, double cost, uint32_t node, bool beside, uint32_t objects)
{
    if (cost > best->cost)
        return;
    if (cost < best->cost || beside < best->beside ||
        (beside == best->beside && objects < best->objects))
        *best = (choice){cost, node, beside, objects};
}

static bool has_room(const bb_gs_tree *tree, const bb_gs_node *node)
{
    const bb_gs_rules *rules = &tree->rules;
    return !rules->binary && (rules->max_children == 0 || node->children < rules->max_children);
}

static double growth_of(const bb_gs_node *node, double area_with_x)
{
    return node->children * (area_with_x - node->area);
}

/* ---- one path ---- */

/* The child with which a path continues. */
typedef struct way {
    double growth, area;
    uint32_t node, objects;
} way;

static bool is_better_way(const way *a, const way *b)
{
    if (a->growth != b->growth)
        return a->growth < b->growth;
    if (a->area != b->area)
        return a->area < b->area;
    return a->objects < b->objects;
}

/* Examines the inner node n, whose area becomes `area` with X, and returns the way to continue. */
static way look_at(const bb_gs_tree *tree, const bb_gs_box *x, uint32_t n, double inherited,
                   double area, choice *best)
{
    const bb_gs_node *nodes = tree->nodes;
    way to = {INFINITY, INFINITY, BB_NONE, BB_NONE};
    if (has_room(tree, &nodes[n]))
        consider(best, inherited + area, n, false, nodes[n].objects);
    for (uint32_t c = nodes[n].first; c != BB_NONE; c = nodes[c].next) {
        const bb_gs_node *child = &nodes[c];
        double with = bb_gs_area_with(&child->box, x);
        consider(best, inherited + 2 * with, c, true, child->objects);
        way way_on = {growth_of(child, with), with, c, child->objects};
        if (!bb_gs_is_leaf(child) && is_better_way(&way_on, &to))
            to = way_on;
    }
    return to;
}

static choice find_on_path(const bb_gs_tree *tree, uint32_t start, const bb_gs_box *x,
                           double x_area)
{
    const bb_gs_node *n = &tree->nodes[start];
    choice best = {INFINITY, BB_NONE, true, BB_NONE};
    double with = bb_gs_area_with(&n->box, x);
    if (start == tree->root)
        consider(&best, 2 * with, start, true, n->objects);
    if (bb_gs_is_leaf(n))
        return best;
    way at = {growth_of(n, with), with, start, n->objects};
    double inherited = 0;
    while (at.node != BB_NONE && inherited + at.growth + x_area <= best.cost) {
        inherited += at.growth;
        at = look_at(tree, x, at.node, inherited, at.area, &best);
    }
    return best;
}

/* ---- the whole tree ---- */

static bool comes_before(const bb_gs_step *a, const bb_gs_step *b)
{
    return a->inherited < b->inherited;
}

static void push(bb_gs_step *queue, uint32_t *count, bb_gs_step step)
{
    uint32_t i = (*count)++;
    for (; i > 0 && comes_before(&step, &queue[(i - 1) / 2]); i = (i - 1) / 2)
        queue[i] = queue[(i - 1) / 2];
    queue[i] = step;
}

static bb_gs_step pop(bb_gs_step *queue, uint32_t *count)
{
    bb_gs_step first = queue[0], last = queue[--*count];
    uint32_t i = 0;
    for (uint32_t c = 1; c < *count; i = c, c = 2 * c + 1) {
        if (c + 1 < *count && comes_before(&queue[c + 1], &queue[c]))
            c++;
        if (!comes_before(&queue[c], &last))
            break;
        queue[i] = queue[c];
    }
    queue[i] = last;
    return first;
}

/* Pushes the inner children of a node that may contain a place better than `best`. */
static void look_everywhere(const bb_gs_tree *tree, const bb_gs_box *x, double x_area,
                            bb_gs_step at, choice *best, uint32_t *queued)
{
    const bb_gs_node *nodes = tree->nodes, *n = &nodes[at.node];
    if (has_room(tree, n))
        consider(best, at.inherited + bb_gs_area_with(&n->box, x), at.node, false, n->objects);
    for (uint32_t c = n->first; c != BB_NONE; c = nodes[c].next) {
        double with = bb_gs_area_with(&nodes[c].box, x);
        consider(best, at.inherited + 2 * with, c, true, nodes[c].objects);
        if (bb_gs_is_leaf(&nodes[c]))
            continue;
        bb_gs_step step = {at.inherited + growth_of(&nodes[c], with), c};
        if (step.inherited + x_area < best->cost)
            push(tree->queue, queued, step);
    }
}

static choice find_everywhere(const bb_gs_tree *tree, uint32_t start, const bb_gs_box *x,
                              double x_area)
{
    choice best = find_on_path(tree, start, x, x_area);
    const bb_gs_node *n = &tree->nodes[start];
    uint32_t queued = 0;
    if (!bb_gs_is_leaf(n))
        push(tree->queue, &queued, (bb_gs_step){growth_of(n, bb_gs_area_with(&n->box, x)), start});
    while (queued > 0) {
        bb_gs_step at = pop(tree->queue, &queued);
        if (at.inherited + x_area >= best.cost)
            break;
        look_everywhere(tree, x, x_area, at, &best, &queued);
    }
    return best;
}

/* ---- */

bb_gs_choice bb_gs_find(bb_gs_tree *tree, uint32_t start, uint32_t x)
{
    const bb_gs_box *box = &tree->nodes[x].box;
    double area = tree->nodes[x].area;
    return tree->rules.whole ? find_everywhere(tree, start, box, area)
                             : find_on_path(tree, start, box, area);
}

void bb_gs_insert(bb_gs_tree *tree, uint32_t *start, uint32_t x)
{
    if (tree->root == BB_NONE) {
        tree->root = *start = x;
        return;
    }
    bool at_root = *start == tree->root;
    bb_gs_choice place = bb_gs_find(tree, *start, x);
    bb_gs_attach(tree, x, place.node, place.beside, tree->nodes[*start].parent);
    if (at_root)
        *start = tree->root;
}

void bb_gs_add(bb_gs_tree *tree, uint32_t object, const bb_gs_box *box)
{
    uint32_t start = tree->root;
    tree->boxes[object] = *box;
    bb_gs_insert(tree, &start, bb_gs_make_leaf(tree, object, box));
}
