/* Leaf collapse by the surface area heuristic: one pass, from tree to tree, for all builders and
 * layouts.
 *
 *   find the parent of each node                                              (collapse_parents)
 *   for each node, bottom-up; the last child to finish goes on with its parent (handover.clh):
 *       cost of a leaf = Ci A per started block of references
 *       cost of an inner node = Ct children/2 A plus its children's costs
 *       if the subtree has at most max_leaf references and a leaf of them costs no more: collapse
 *                                       (collapse_decide, or collapse_leaves and collapse_level)
 *   mark the nodes without a collapsed ancestor, and their references, each once (collapse_mark)
 *   places = exclusive scans of both marks
 *   write the marked ones to their places                                       (collapse_write)
 *
 * Leaves of more than `most` references become balanced binary trees of leaves of that many.
 *
 * MacDonald and Booth 1990 (the heuristic); Wald, Benthin and Boulos 2008 (leaves in blocks of the
 * vector's length). Nodes and references keep their order in memory. Accepts any tree. A primitive
 * that several leaves of a collapsed subtree reference is referenced once. Costs are floats, but
 * rounding can only decide between two valid trees.
 */
#include "bb_device.h"
#include "collapse_cost.clh"
#include "handover.clh"
#include "parents.clh"

kernel void collapse_parents(global const bb_node *nodes, uint count, uint root,
                             global uint *parents, global uint *missing)
{
    uint n = get_global_id(0);
    if (n < count)
        missing[n] = bb_make_parent(nodes, n, root, parents);
}

/* Returns the number of references from `first` to the end of the leaf. */
uint run_length(global const uint *refs, uint first)
{
    uint length = 1;
    while ((refs[first + length - 1u] & BB_LAST_BIT) == 0)
        length++;
    return length;
}

/* Computes the result for inner node n from its children's. */
bb_subtree join(global const bb_node *nodes, volatile global const bb_subtree *subtrees, uint n,
                const bb_cost_model *model)
{
    const uint enough = model->max_leaf + 1u;
    bb_subtree s = {0.0f, 0u, 0u, 0u, 0u, 0u};
    uint children = 0;
    for (uint c = nodes[n].first; c != nodes[n].skip; c = nodes[c].skip, children++) {
        uint height = subtrees[c].height + 1u, arity = subtrees[c].arity, refs = subtrees[c].refs;
        s.cost += subtrees[c].cost;
        s.leaves += subtrees[c].leaves;
        s.refs += BB_MIN(refs, enough);
        s.refs = BB_MIN(s.refs, enough);
        s.height = BB_MAX(height, s.height);
        s.arity = BB_MAX(arity, s.arity);
    }
    s.arity = BB_MAX(children, s.arity);
    float area = bb_collapse_area(nodes + n, model->scale);
    s.cost += bb_inner_cost(model, area, children);
    if (bb_better_leaf(model, area, s.refs, &s.cost)) {
        s.leaf = s.leaves = 1u;
        s.height = s.arity = 0u;
    }
    return s;
}

void put(volatile global bb_subtree *at, const bb_subtree *s)
{
    at->cost = s->cost;
    at->refs = s->refs;
    at->leaves = s->leaves;
    at->height = s->height;
    at->arity = s->arity;
    at->leaf = s->leaf;
}

/* Returns how many leaves a leaf of this many references is divided into. */
uint parts_of(uint refs, uint most)
{
    return (refs - 1u) / most + 1u;
}

void decide_leaf(global const bb_node *nodes, global const uint *refs, uint n, uint most,
                 const bb_cost_model *model, volatile global bb_subtree *subtrees)
{
    bb_subtree s = {0.0f, run_length(refs, nodes[n].first & BB_INDEX_MASK), 1u, 0u, 0u, 1u};
    s.leaves = parts_of(s.refs, most);
    s.arity = s.leaves > 1u ? 2u : 0u;
    s.height = 32u - clz(s.leaves - 1u);
    s.cost = bb_collapse_area(nodes + n, model->scale) * bb_leaf_cost(model, s.refs);
    put(subtrees + n, &s);
}

#if BB_HANDOVER
kernel void collapse_decide(global const bb_node *nodes, global const uint *refs, uint count,
                            float scale, float traversal, float intersection, uint block,
                            uint max_leaf, uint most, global const uint *parents,
                            volatile global uint *missing, volatile global bb_subtree *subtrees)
{
    uint n = get_global_id(0);
    if (n >= count || (nodes[n].first & BB_LEAF_BIT) == 0)
        return;
    const bb_cost_model model = {scale, traversal, intersection, block, max_leaf};
    decide_leaf(nodes, refs, n, most, &model, subtrees);
    for (uint p = parents[n]; p != BB_NONE; p = parents[p]) {
        BB_DEVICE_FENCE();
        if (atomic_dec(&missing[p]) != 1u)
            return;
        BB_DEVICE_FENCE();
        bb_subtree s = join(nodes, subtrees, p, &model);
        put(subtrees + p, &s);
    }
}
#endif

kernel void collapse_leaves(global const bb_node *nodes, global const uint *refs, uint count,
                            float scale, float traversal, float intersection, uint block,
                            uint max_leaf, uint most, global const uint *parents,
                            volatile global uint *missing, volatile global bb_subtree *subtrees,
                            volatile global uint *counts, global uint *next)
{
    uint n = get_global_id(0);
    if (n >= count || (nodes[n].first & BB_LEAF_BIT) == 0)
        return;
    const bb_cost_model model = {scale, traversal, intersection, block, max_leaf};
    decide_leaf(nodes, refs, n, most, &model, subtrees);
    uint p = parents[n];
    if (p != BB_NONE && atomic_dec(&missing[p]) == 1u)
        bb_put_on_list(p, 0u, counts, next);
}

void decide_listed(uint n, global const bb_node *nodes, const bb_cost_model *model,
                   global const uint *parents, volatile global uint *missing,
                   volatile global bb_subtree *subtrees, uint number,
                   volatile global uint *counts, global uint *next)
{
    bb_subtree s = join(nodes, subtrees, n, model);
    put(subtrees + n, &s);
    uint p = parents[n];
    if (p != BB_NONE && atomic_dec(&missing[p]) == 1u)
        bb_put_on_list(p, number, counts, next);
}

kernel void collapse_level(global const bb_node *nodes, float scale, float traversal,
                           float intersection, uint block, uint max_leaf,
                           global const uint *parents, volatile global uint *missing,
                           volatile global bb_subtree *subtrees, global uint *list, uint number,
                           volatile global uint *counts, global uint *next)
{
    const bb_cost_model model = {scale, traversal, intersection, block, max_leaf};
#define DECIDE(n) decide_listed(n, nodes, &model, parents, missing, subtrees, number, counts, next)
    BB_FOR_LISTS(DECIDE, 1u)
}

/* Counts the references below node n, each once if `duplicated`, and writes them to `out`, unless
 * it is NULL, as leaves of `most`. */
uint gather(global const bb_node *nodes, global const uint *refs, uint n, uint duplicated,
            uint most, global uint *out)
{
    uint end = nodes[n].skip, written = 0;
    /* those found so far: needed only if a collapsed node has several leaves */
    uint own[BB_LEAF_MAX];
    bool several = (nodes[n].first & BB_LEAF_BIT) == 0;
    for (uint c = n; c != end;
         c = (nodes[c].first & BB_LEAF_BIT) != 0 ? nodes[c].skip : nodes[c].first) {
        if ((nodes[c].first & BB_LEAF_BIT) == 0)
            continue;
        uint first = nodes[c].first & BB_INDEX_MASK, length = run_length(refs, first);
        for (uint i = 0; i < length; i++) {
            uint prim = refs[first + i] & BB_INDEX_MASK;
            bool known = false;
            for (uint k = 0; several && duplicated != 0u && k < written; k++)
                known = known || own[k] == prim;
            if (known)
                continue;
            if (several && written < BB_LEAF_MAX)
                own[written] = prim;
            if (out != NULL)
                out[written] = prim | ((written + 1u) % most == 0u ? BB_LAST_BIT : 0u);
            written++;
        }
    }
    if (out != NULL)
        out[written - 1u] |= BB_LAST_BIT;
    return written;
}

kernel void collapse_mark(global const bb_node *nodes, global const uint *refs, uint count,
                          uint max_leaf, uint duplicated, uint most,
                          global const uint *parents,
                          global const bb_subtree *subtrees, global uint *places,
                          global uint *firsts)
{
    uint n = get_global_id(0);
    if (n > count)
        return;
    places[n] = firsts[n] = 0;
    if (n == count)
        return;
    for (uint p = parents[n]; p != BB_NONE && subtrees[p].refs <= max_leaf; p = parents[p])
        if (subtrees[p].leaf != 0u)
            return;
    places[n] = 1;
    if (subtrees[n].leaf == 0u)
        return;
    firsts[n] = gather(nodes, refs, n, duplicated, most, NULL);
    places[n] = 2u * parts_of(firsts[n], most) - 1u;
}

/* Writes leaf `node`, whose first reference is `first`, as a balanced binary tree of `parts` leaves
 * of `most` references, in preorder from `at` on. */
void write_parts(bb_node node, uint first, uint parts, uint most, uint at, global bb_node *out)
{
    const uint skip = node.skip;
    for (uint i = 0; i < 2u * parts - 1u; i++) {
        /* descend to the i-th node, which has the parts from `begin` to `end` */
        uint begin = 0, end = parts, n = 0;
        node.skip = skip;
        while (n < i) {
            uint middle = (begin + end) / 2u, right = n + 2u * (middle - begin);
            if (i < right) {
                node.skip = at + right;
                end = middle;
                n++;
            } else {
                begin = middle;
                n = right;
            }
        }
        node.first = end - begin == 1u ? BB_LEAF_BIT | (first + most * begin) : at + i + 1u;
        out[at + i] = node;
    }
}

kernel void collapse_write(global const bb_node *nodes, global const uint *refs, uint count,
                           uint root, uint duplicated, uint most,
                           global const bb_subtree *subtrees,
                           global const uint *places, global const uint *firsts,
                           global bb_node *out_nodes, global uint *out_refs,
                           global bb_tree_info *info)
{
    uint n = get_global_id(0);
    if (n >= count || places[n] == places[n + 1u])
        return;
    bb_node node = nodes[n];
    /* the node that follows a kept node shares its ancestors, so it is kept too */
    node.skip = node.skip == BB_NONE ? BB_NONE : places[node.skip];
    if (subtrees[n].leaf != 0u) {
        uint length = gather(nodes, refs, n, duplicated, most, out_refs + firsts[n]);
        write_parts(node, firsts[n], parts_of(length, most), most, places[n], out_nodes);
    } else {
        node.first = places[node.first];
        out_nodes[places[n]] = node;
    }
    if (n == root) {
        info->root = places[n];
        info->node_count = places[count];
        info->leaf_count = subtrees[n].leaves;
        info->ref_count = firsts[count];
        info->arity = subtrees[n].arity;
        info->depth = subtrees[n].height;
    }
}
