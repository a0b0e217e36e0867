/* H-PLOC (Benthin, Meister, Barczak, Mehalwal, Tsakok, Kensler 2024, "H-PLOC: Hierarchical Parallel
 * Locally-Ordered Clustering for Bounding Volume Hierarchy Construction"), for CPUs.
 *
 *   along the radix tree over the codes, bottom-up, at each node [l, r]:
 *       clusters = those of its left child and of its right child
 *       if the node holds more than T primitives: PLOC rounds until at most T clusters are left
 *   at the root: PLOC rounds until one is left
 *
 * The radix tree is not stored: as in radix_tree.cl, node [l, r] is a right child if the split at
 * its left is below that at its right. A work-item goes through a chunk of keys from left to right
 * (hploc_chunks). Subtrees that wait for their right sibling are on a stack; their clusters, at
 * most T each, are on another, which stays in the cache. If the sibling of a subtree is in another
 * chunk, its clusters stay in place, and one work-item continues with them in the same way
 * (hploc_top).
 *
 * A node's clusters depend only on its children's, so the tree does not depend on the chunks or
 * their order. ploc_cluster.clh defines which cluster is nearest.
 *
 *   BB_RADIUS   R of PLOC's search
 *   BB_GOAL     T
 *   BB_KEY64    keys are ulong; else uint
 */
#define BB_WINDOW ((2 * BB_GOAL + 7) / 8 * 8)
#include "ploc_list.clh"
#include "radix_keys.clh"
#include "hploc_shared.h"

#define BB_AHEAD 24u /* how many primitives ahead boxes are prefetched */

#define BB_PIECES_MAX HPLOC_PIECES_MAX(BB_PREFIX_BITS)

/* The clusters of the pieces lie one after the other in `list`, `top` clusters in all. */
typedef struct hploc_work {
    global const bb_key *keys;
    uint count; /* number of keys */
    bb_clusters list;
    uint top;
    global bb_cluster_pair *pairs;
    bb_near near;
} hploc_work;

/* Merges among the last `count` clusters until at most `goal` are left. */
uint hploc_reduce(hploc_work *w, uint count, uint goal)
{
    bb_clusters list = ploc_from(w->list, w->top - count);
    uint left = count;
    int mask = BB_PLOC_EXACT;
    while (left > goal) {
        uint before = left;
        left = ploc_round(list, before, mask, &w->near, w->pairs);
        mask = before - left < BB_HPLOC_FEW(before) ? BB_PLOC_FORCED : BB_PLOC_EXACT;
    }
    w->top -= count - left;
    return left;
}

/* Climbs from `piece`, whose clusters are on top. The first `fixed` of the `waiting` pieces have
 * their sibling in another chunk. Pushes the piece that the climb ends with; returns whether it is
 * the root. */
bool hploc_climb(hploc_work *w, hploc_piece piece, global hploc_piece *pieces, uint *waiting,
                 uint *fixed)
{
    for (;;) {
        uint right = level_of(w->keys, w->count, piece.r);
        bool root = piece.level == right; /* both neighbours are outside of the tree */
        if (root || right < piece.level) {
            pieces[(*waiting)++] = piece;
            return root;
        }
        if (*waiting == *fixed) {
            pieces[(*waiting)++] = piece;
            *fixed = *waiting;
            return false;
        }
        hploc_piece sibling = pieces[--*waiting];
        piece.l = sibling.l;
        piece.level = sibling.level;
        piece.count += sibling.count;
        bool whole = piece.r - piece.l + 1u == w->count;
        if (piece.r - piece.l >= BB_GOAL || whole)
            piece.count = hploc_reduce(w, piece.count, whole ? 1u : BB_GOAL);
    }
}

/* One work-item per `chunk` keys. A chunk's clusters begin at the place of its first key; its
 * pieces, piece_counts[] of them, at BB_PIECES_MAX times its number. */
kernel void hploc_chunks(global const bb_key *keys, global const uint *values,
                         global const bb_box *boxes, uint count, uint chunk, global float *planes,
                         global uint4 *tags, uint stride, global bb_cluster_pair *pairs,
                         global hploc_piece *pieces, global uint *piece_counts)
{
    uint begin = get_global_id(0) * chunk;
    if (begin >= count)
        return;
    uint end = count - begin < chunk ? count : begin + chunk;
    bb_clusters all = {planes, tags, stride};
    hploc_work w;
    w.keys = keys;
    w.count = count;
    w.list = ploc_from(all, begin);
    w.top = 0;
    w.pairs = pairs;
    ploc_near_start(&w.near);
    pieces += get_global_id(0) * BB_PIECES_MAX;
    uint waiting = 0, fixed = 0;
    for (uint i = begin; i < end; i++) {
        if (i + BB_AHEAD < end)
            BB_PREFETCH(boxes + values[i + BB_AHEAD]);
        ploc_write(w.list, w.top++, ploc_leaf(boxes, values[i], i));
        hploc_piece piece = {i, i, 1u, level_of(keys, count, i - 1u)};
        hploc_climb(&w, piece, pieces, &waiting, &fixed);
    }
    piece_counts[get_global_id(0)] = waiting;
}

/* Runs in one work-item. `stack` has room for HPLOC_WAITING_MAX() pieces. */
kernel void hploc_top(global const bb_key *keys, uint count, uint chunk, global float *planes,
                      global uint4 *tags, uint stride, global bb_cluster_pair *pairs,
                      global const hploc_piece *pieces, global const uint *piece_counts,
                      global hploc_piece *stack, global bb_pair_side *root)
{
    bb_clusters all = {planes, tags, stride};
    hploc_work w;
    w.keys = keys;
    w.count = count;
    w.list = all;
    w.top = 0;
    w.pairs = pairs;
    ploc_near_start(&w.near);
    uint waiting = 0, fixed = 0;
    for (uint begin = 0, c = 0; begin < count; begin += BB_MIN(chunk, count - begin), c++) {
        bb_clusters from = ploc_from(all, begin);
        for (uint p = 0; p < piece_counts[c]; p++) {
            hploc_piece piece = pieces[c * BB_PIECES_MAX + p];
            /* the stack never holds more than was read, so reads are ahead of writes */
            for (uint k = 0; k < piece.count; k++)
                ploc_write(w.list, w.top + k, ploc_read(from, k));
            w.top += piece.count;
            from = ploc_from(from, piece.count);
            hploc_climb(&w, piece, stack, &waiting, &fixed);
        }
    }
    ploc_write_side(root, ploc_read(all, 0));
}
