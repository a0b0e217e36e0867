/* ATRBVH: merges a treelet's leaves greedily, always the two first whose union has the smallest
 * area (Domingues and Pedrini 2015, "Bounding Volume Hierarchy Optimization through Agglomerative
 * Treelet Restructuring"; see atrbvh.c):
 *
 *   distance(i, j) of places i > j = area of their union
 *   until one place is left:
 *       find the smallest distance, the first of equal ones by i, then by j
 *       place j becomes the union, place i becomes empty
 *
 * Merging uses masks, since each lane merges other places. Distances to empty places are infinite;
 * all others are finite.
 */
#include "treelets.clh"

#define DISTANCES (BB_TREELET * (BB_TREELET - 1) / 2)

/* Finds the places i and j of the smallest distance and returns it. */
bb_lanes nearest_two(const bb_lanes *distances, bb_lanes_int *i, bb_lanes_int *j)
{
    bb_lanes least = INFINITY;
    *i = 0;
    *j = 0;
    uint at = 0;
    for (int k = 1; k < BB_TREELET; k++)
        for (int l = 0; l < k; l++, at++) {
            bb_lanes_int closer = distances[at] < least;
            least = BB_MIN(distances[at], least);
            *i = closer ? (bb_lanes_int)k : *i;
            *j = closer ? (bb_lanes_int)l : *j;
        }
    return least;
}

/* Merges places i and j into place j. */
void merge(bb_lanes_int i, bb_lanes_int j, bb_lanes boxes[BB_TREELET][6], bb_lanes *distances)
{
    bb_lanes both[6], fresh[BB_TREELET];
    for (uint k = 0; k < 6u; k++)
        both[k] = k < 3u ? INFINITY : -INFINITY;
    for (int s = 0; s < BB_TREELET; s++) {
        bb_lanes_int taken = (i == s) | (j == s);
        for (uint k = 0; k < 6u; k++) {
            bb_lanes own = taken ? boxes[s][k] : both[k];
            both[k] = k < 3u ? BB_MIN(own, both[k]) : BB_MAX(own, both[k]);
        }
    }
    for (int s = 0; s < BB_TREELET; s++) {
        bb_lanes_int here = j == s;
        fresh[s] = bb_joined_area(both, boxes[s]);
        for (uint k = 0; k < 6u; k++)
            boxes[s][k] = here ? both[k] : boxes[s][k];
    }
    uint at = 0;
    for (int k = 1; k < BB_TREELET; k++)
        for (int l = 0; l < k; l++, at++) {
            bb_lanes old = distances[at], changed = (j == k) ? fresh[l] : old;
            changed = (j == l) ? fresh[k] : changed;
            bb_lanes_int empty = (i == k) | (i == l) | (old == INFINITY);
            distances[at] = empty ? (bb_lanes)INFINITY : changed;
        }
}

/* Merges each lane's leaves: which[m][0] and [1] are the places j and i of merge m. Returns the sum
 * of the areas of the inner nodes without the root. */
bb_lanes merge_all(const bb_treelets *t, float unit, bb_lanes_int which[BB_INNER][2])
{
    bb_lanes boxes[BB_TREELET][6], distances[DISTANCES], sum = 0.0f;
    bb_treelet_planes(t, unit, boxes);
    uint at = 0;
    for (uint k = 1; k < BB_TREELET; k++)
        for (uint l = 0; l < k; l++, at++)
            distances[at] = bb_joined_area(boxes[k], boxes[l]);
    for (uint m = 0; m < BB_INNER; m++) {
        bb_lanes least = nearest_two(distances, &which[m][1], &which[m][0]);
        if (m + 1u < BB_INNER) {
            sum += least;
            merge(which[m][1], which[m][0], boxes, distances);
        }
    }
    return sum;
}

/* Reads merges[], the places j and i of each merge, BB_LANES apart. The last merge is the root. */
void read_merges(const int *merges, uchar (*links)[2])
{
    uchar at[BB_TREELET];
    for (uint leaf = 0; leaf < BB_TREELET; leaf++)
        at[leaf] = (uchar)leaf;
    for (uint m = 0; m < BB_INNER; m++) {
        uint e = BB_INNER - 1u - m;
        int j = merges[2u * m * BB_LANES], i = merges[(2u * m + 1u) * BB_LANES];
        links[e][0] = at[j];
        links[e][1] = at[i];
        at[j] = (uchar)(BB_TREELET + e);
    }
}

uint bb_choose_trees(const bb_treelets *t, float unit, bb_treelet_links *links)
{
    bb_lanes_int which[BB_INNER][2];
    bb_lanes after = merge_all(t, unit, which);
    float sums[BB_LANES];
    uint better = 0;
    BB_STORE_LANES(after, sums);
    for (uint lane = 0; lane < BB_LANES; lane++)
        if (sums[lane] < t->before[lane] * BB_BETTER) {
            read_merges((const int *)which + lane, links[lane]);
            better |= 1u << lane;
        }
    return better;
}

#include "treelet_rounds.clh"
