/* TRBVH: of all binary trees over a treelet's leaves the one of the least cost (Karras and Aila
 * 2013; see trbvh.c), by a table of what each subset of the leaves costs at least:
 *
 *   cost(one leaf) = 0
 *   below(s) = min over p, q of s, both not empty: cost(p) + cost(q)
 *   cost(s) = area(s) + below(s)
 *
 * A subset is a number whose bits are leaves, and a smaller one comes before it. Which p and q it
 * was is asked only where the tree gets better: the first p, that without the lowest leaf, in
 * ascending order. Sums are floats; the minimum of several does not depend on their order.
 */
#include "treelets.clh"

#define FULL ((1u << BB_TREELET) - 1u)
/* Boxes of subsets are those of two halves of the leaves, joined. */
#define LOW_LEAVES (BB_TREELET / 2)
#define HIGH_LEAVES (BB_TREELET - LOW_LEAVES)

uint last_leaf(uint s)
{
    return 31u - clz(s);
}

/* (Compilers make a popcount of s & (s - 1) == 0, which oclgrind does not know.) */
bool has_one(uint s)
{
    return s == 1u << last_leaf(s);
}

/* boxes[]: of all subsets of some leaves. */
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

/* The least cost(p) + cost(q) of s, which has three leaves or more. Four sums at a time, since each
 * minimum waits for the one before it. */
bb_lanes least_sum(bb_lanes *cost, uint s)
{
    uint rest = s & (s - 1u);
    const uint a = rest & -rest;
    rest ^= a;
    const uint b = rest & -rest;
    rest ^= b;
    bb_lanes least0 = INFINITY, least1 = INFINITY, least2 = INFINITY, least3 = INFINITY;
    uint p = 0;
    cost[s] = 0.0f; /* no leaves and all: cost[0] is infinite */
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
    bb_lanes below[1 << BB_TREELET]; /* of sets of three leaves or more */
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

/* The p of s with which it costs least; entries of one lane are BB_LANES apart. */
uint first_best(const float *cost, const float *below, uint s)
{
    const uint rest = s & (s - 1u);
    uint p = rest & -rest;
    if (has_one(rest))
        return rest;
    const float least = below[s * BB_LANES];
    while (p != 0 && cost[p * BB_LANES] + cost[(s ^ p) * BB_LANES] != least)
        p = (p - rest) & rest;
    return p != 0 ? p : rest; /* none only where the device adds lanes and numbers differently */
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
