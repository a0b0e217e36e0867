/* TRBVH: finds the binary tree of least cost over a treelet's leaves (Karras and Aila 2013; see
 * trbvh.c) by dynamic programming over all subsets of the leaves:
 *
 *   cost(one leaf) = 0
 *   below(s) = min over partitions of s into non-empty p and q: cost(p) + cost(q)
 *   cost(s) = area(s) + below(s)
 *
 * A subset is a number whose bits are leaves; smaller numbers are computed first. The partition is
 * recovered only if the tree improves: it is the first p in ascending order that reaches the
 * minimum, among those without the lowest leaf of s. Sums are floats; their minimum does not depend
 * on the order.
 */
#include "treelets.clh"

#define FULL ((1u << BB_TREELET) - 1u)
/* The box of a subset joins the boxes of its two halves. */
#define LOW_LEAVES (BB_TREELET / 2)
#define HIGH_LEAVES (BB_TREELET - LOW_LEAVES)

uint last_leaf(uint s)
{
    return 31u - clz(s);
}

/* (Compilers turn s & (s - 1) == 0 into a popcount, which oclgrind does not know.) */
bool has_one(uint s)
{
    return s == 1u << last_leaf(s);
}

/* boxes[]: boxes of all subsets of `count` leaves. */
void join_leaves(bb_lanes (*leaves)[6], uint count, bb_lanes (*boxes)[6])
{
    for (uint k = 0; k < 6u; k++)
        boxes[0][k] = k < 3u ? INFINITY : -INFINITY;
    for (uint leaf = 0; leaf < count; leaf++)
        for (uint s = 0; s < 1u << leaf; s++)
            for (uint k = 0; k < 6u; k++) {
                bb_lanes a = boxes[s][k], b = leaves[leaf][k];
                boxes[s | 1u << leaf][k] = k < 3u ? BB_MIN(a, b) : BB_MAX(a, b);
            }
}

/* Returns the smallest cost(p) + cost(q) of s, which has three leaves or more. Computes four sums
 * at a time, since each minimum waits for the one before it. */
bb_lanes least_sum(bb_lanes *cost, uint s)
{
    uint rest = s & (s - 1u);
    const uint a = rest & -rest;
    rest ^= a;
    const uint b = rest & -rest;
    rest ^= b;
    bb_lanes least0 = INFINITY, least1 = INFINITY, least2 = INFINITY, least3 = INFINITY;
    uint p = 0;
    cost[s] = 0.0f; /* so that cost[0] + cost[s] is infinite too */
    do {
        uint q = s ^ p;
        bb_lanes sum0 = cost[p] + cost[q];
        bb_lanes sum1 = cost[p | a] + cost[q ^ a];
        bb_lanes sum2 = cost[p | b] + cost[q ^ b];
        bb_lanes sum3 = cost[p | a | b] + cost[q ^ a ^ b];
        least0 = BB_MIN(sum0, least0);
        least1 = BB_MIN(sum1, least1);
        least2 = BB_MIN(sum2, least2);
        least3 = BB_MIN(sum3, least3);
        p = (p - rest) & rest;
    } while (p != 0);
    least0 = BB_MIN(least0, least1);
    least2 = BB_MIN(least2, least3);
    return BB_MIN(least0, least2);
}

typedef struct trbvh_table {
    bb_lanes cost[1 << BB_TREELET];
    bb_lanes below[1 << BB_TREELET]; /* only sets of three leaves or more */
} trbvh_table;

void fill_table(const bb_treelets *t, float unit, trbvh_table *table)
{
    bb_lanes leaves[BB_TREELET][6], low[1 << LOW_LEAVES][6], high[1 << HIGH_LEAVES][6];
    bb_treelet_planes(t, unit, leaves);
    join_leaves(leaves, LOW_LEAVES, low);
    join_leaves(leaves + LOW_LEAVES, HIGH_LEAVES, high);
    table->cost[0] = INFINITY;
    for (uint s = 1; s < FULL; s++) {
        if (has_one(s)) {
            table->cost[s] = 0.0f;
            continue;
        }
        bb_lanes area = bb_joined_area(low[s & ((1u << LOW_LEAVES) - 1u)], high[s >> LOW_LEAVES]);
        if (!has_one(s & (s - 1u))) {
            table->below[s] = least_sum(table->cost, s);
            area += table->below[s];
        }
        table->cost[s] = area;
    }
    table->below[FULL] = least_sum(table->cost, FULL);
}

/* Returns the first p of s with the least cost; entries of one lane are BB_LANES apart. */
uint first_best(const float *cost, const float *below, uint s)
{
    const uint rest = s & (s - 1u);
    uint p = rest & -rest;
    if (has_one(rest))
        return rest;
    const float least = below[s * BB_LANES];
    while (p != 0 && cost[p * BB_LANES] + cost[(s ^ p) * BB_LANES] != least)
        p = (p - rest) & rest;
    return p != 0 ? p : rest; /* 0 only if the device rounds vector and scalar sums differently */
}

void read_tree(const float *cost, const float *below, uchar (*links)[2])
{
    uint sets[BB_INNER], made = 1;
    sets[0] = FULL;
    for (uint e = 0; e < BB_INNER; e++) {
        uint p = first_best(cost, below, sets[e]);
        for (uint k = 0; k < 2u; k++, p ^= sets[e]) {
            bool leaf = has_one(p);
            links[e][k] = (uchar)(leaf ? last_leaf(p) : BB_TREELET + made);
            if (!leaf)
                sets[made++] = p;
        }
    }
}

uint bb_choose_trees(const bb_treelets *t, float unit, bb_treelet_links *links)
{
    trbvh_table table;
    uint better = 0;
    fill_table(t, unit, &table);
    const float *cost = (const float *)table.cost, *below = (const float *)table.below;
    for (uint lane = 0; lane < BB_LANES; lane++)
        if (below[FULL * BB_LANES + lane] < t->before[lane] * BB_BETTER) {
            read_tree(cost + lane, below + lane, links[lane]);
            better |= 1u << lane;
        }
    return better;
}

#include "treelet_rounds.clh"
