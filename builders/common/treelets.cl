/* Turns the common tree into pairs whose treelets can be rebuilt, and back:
 *
 *   inner nodes are numbered in order: marks, and a scan                           (treelets_marks)
 *   a pair for each inner node                                                     (treelets_pairs)
 *   leaves below each pair, bottom-up                                              (treelets_count)
 *   each round:                                                                    (treelets_start)
 *       level 1 = pairs of so many leaves without such pairs below
 *       CPUs: roots of the subtrees below those, one for each work-item
 *   after the tree is made: leaves of several references get them back            (treelets_leaves)
 *
 * Takes binary trees in which each inner node has two children, with nodes in any order.
 *
 *   BB_CHUNK   nodes or pairs per work-item
 */
#define BB_LANES 1
#include "treelet_levels.clh"
#include "pair_shared.h"

kernel void treelets_marks(global const bb_node *nodes, uint count, global uint *marks)
{
    uint n = get_global_id(0);
    if (n < count)
        marks[n] = (nodes[n].first & BB_LEAF_BIT) != 0 ? 0u : 1u;
}

/* Writes the child c of pair p's node as a side of that pair. `single`: each leaf has one
 * reference, which the side holds; else it holds the place of the leaf's first. True if the child
 * is inner. */
bool put_side(global const uint *words, uint c, uint p, global const uint *refs, uint single,
              global const uint *places, global bb_pair_side *side, global uint *parents)
{
    uint8 node = vload8(c, words);
    bool inner = (node.s3 & BB_LEAF_BIT) == 0;
    if (inner) {
        uint pair = places[c];
        parents[pair] = p;
        node.s3 = pair;
    } else if (single != 0) {
        node.s3 = BB_LEAF_BIT | refs[node.s3 & BB_INDEX_MASK];
    }
    node.s7 = inner ? 0u : 1u;
    vstore8(node, 0, (global uint *)side);
    return inner;
}

/* counts[1] and list[] get the pairs of two leaves. */
kernel void treelets_pairs(global const bb_node *nodes, uint count, uint root,
                           global const uint *refs, uint single, global const uint *places,
                           global bb_cluster_pair *pairs, global bb_pair_side *root_side,
                           global uint *parents, global uint *missing,
                           volatile global uint *counts, global uint *list)
{
    global const uint *words = (global const uint *)nodes;
    uint begin = get_global_id(0) * BB_CHUNK, end = BB_MIN(begin + BB_CHUNK, count);
    bb_above first = {counts + 1, list, 0, {0}};
    for (uint n = begin; n < end; n++) {
        uint8 node = vload8(n, words);
        if ((node.s3 & BB_LEAF_BIT) != 0)
            continue;
        uint p = places[n], a = node.s3, b = words[8u * a + 7u];
        global bb_pair_side *sides = pairs[p].side;
        uint inner = put_side(words, a, p, refs, single, places, sides, parents) ? 1u : 0u;
        inner += put_side(words, b, p, refs, single, places, sides + 1, parents) ? 1u : 0u;
        missing[p] = inner;
        if (inner == 0)
            bb_add_above(&first, p);
        if (n == root) {
            parents[p] = BB_NONE;
            node.s3 = p;
            node.s7 = (count + 1u) / 2u;
            vstore8(node, 0, (global uint *)root_side);
        }
    }
    bb_put_above(&first);
}

void count_pair(global bb_cluster_pair *pairs, uint p, global uint *held)
{
    uint sum = 0;
    for (uint k = 0; k < 2u; k++) {
        global bb_pair_side *side = &pairs[p].side[k];
        if ((side->link & BB_LEAF_BIT) == 0)
            side->count = held[side->link];
        sum += side->count;
    }
    held[p] = sum;
}

kernel void treelets_count(global bb_cluster_pair *pairs, global const uint *parents,
                           volatile global uint *missing, global uint *held, uint number,
                           volatile global uint *counts, global uint *list, global uint *next)
{
#define BB_LEVEL_WORK(level, begin, end)                                                           \
    for (uint i = begin; i < (end); i++) {                                                         \
        count_pair(pairs, level[i], held);                                                         \
        bb_go_up(level[i], parents, missing, &above);                                              \
    }
    BB_LEVEL_LOOP
}

/* Pairs of at least `lowest` leaves go by levels: parents[] and missing[] cover only these, and the
 * root's parent stays. Other pairs of at least `least` are below the roots of subtrees, tasks[]. */
kernel void treelets_start(global const bb_cluster_pair *pairs, uint count,
                           global const uint *held, uint lowest, uint least, global uint *parents,
                           global uint *missing, volatile global uint *counts, global uint *list,
                           global uint *tasks)
{
    uint begin = get_global_id(0) * BB_CHUNK, end = BB_MIN(begin + BB_CHUNK, count);
    bb_above first = {counts + 1, list, 0, {0}}, subtrees = {counts, tasks, 0, {0}};
    for (uint p = begin; p < end; p++) {
        if (held[p] < lowest) {
            if (held[p] == count + 1u) /* the root */
                bb_add_above(&subtrees, p);
            continue;
        }
        uint below = 0;
        for (uint k = 0; k < 2u; k++) {
            global const bb_pair_side *side = &pairs[p].side[k];
            if ((side->link & BB_LEAF_BIT) != 0 || side->count < least)
                continue;
            if (side->count < lowest) {
                bb_add_above(&subtrees, side->link);
                continue;
            }
            parents[side->link] = p;
            below++;
        }
        missing[p] = below;
        if (below == 0)
            bb_add_above(&first, p);
    }
    bb_put_above(&subtrees);
    bb_put_above(&first);
}

/* starts[i]: place of leaf i's first reference, with BB_LAST_BIT. */
kernel void treelets_leaves(global bb_node *nodes, uint count, global const uint *starts,
                            uint references, global bb_tree_info *info)
{
    uint n = get_global_id(0);
    if (n >= count)
        return;
    if (n == 0)
        info->ref_count = references;
    uint first = nodes[n].first;
    if ((first & BB_LEAF_BIT) != 0)
        nodes[n].first = BB_LEAF_BIT | (starts[first & BB_INDEX_MASK] & BB_INDEX_MASK);
}
