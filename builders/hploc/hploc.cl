/* H-PLOC (Benthin, Meister, Barczak, Mehalwal, Tsakok, Kensler 2024, "H-PLOC: Hierarchical Parallel
 * Locally-Ordered Clustering for Bounding Volume Hierarchy Construction"), for CPUs.
 *
 *   along the radix tree over the codes, bottom-up, at each node [l, r]:
 *       clusters = those of its left child and of its right child
 *       if it holds more than T primitives: PLOC rounds among them until at most T are left
 *   at the root: until one is left
 *
 * The radix tree is not stored: as in radix_tree.cl, node [l, r] is a right child if the split at
 * its left is below that at its right. A work-item takes a chunk of keys, left to right; subtrees
 * that wait for their right sibling are on a stack, and so their clusters, at most T each, are a
 * stack too, in the cache (hploc_chunks). Of subtrees whose sibling is in another chunk the
 * clusters stay where they are; one work-item goes on with these, in the same manner (hploc_top).
 *
 * A node's clusters depend on those of its children only, so neither chunks nor their order show in
 * the tree. What counts as nearest: ploc_cluster.clh.
 *
 *   BB_RADIUS   R of PLOC's search
 *   BB_GOAL     T
 *   BB_KEY64    keys are ulong; else uint
 */
#define BB_WINDOW ((2 * BB_GOAL + 7) / 8 * 8)
#include "ploc_list.clh"
#include "radix_keys.clh"
#include "hploc_shared.h"

#define BB_AHEAD 24u /* primitives whose boxes are asked for before they are needed */

#define BB_PIECES_MAX HPLOC_PIECES_MAX(BB_PREFIX_BITS)

/* The clusters of pieces lie one after the other in `list`, `top` of them. */
typedef struct hploc_work {
    global const bb_key *keys;
    uint count; /* of keys */
    bb_clusters list;
    uint top;
    global bb_cluster_pair *pairs;
    bb_near near;
} hploc_work;

/* Of the last `count` clusters lets at most `goal` remain. */
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

/* Climbs from `piece`, whose clusters are on top, with the `waiting` pieces, of which the first
 * `fixed` have their sibling elsewhere. Puts the piece that it comes to among them; true: that is
 * the root. */
bool hploc_climb(hploc_work *w, hploc_piece piece, global hploc_piece *pieces, uint *waiting,
                 uint *fixed)
{
    for (;;) {
        uint right = level_of(w->keys, w->count, piece.r);
        bool root = piece.level == right; /* both outside */
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

/* One work-item per `chunk` keys. The clusters of a chunk lie from its first key's place on, and
 * its pieces at BB_PIECES_MAX times its number, as many as piece_counts[] says. */
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

/* One work-item. `stack` has room for HPLOC_WAITING_MAX() pieces. */
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
            /* what is on the stack is never more than what was taken */
            for (uint k = 0; k < piece.count; k++)
                ploc_write(w.list, w.top + k, ploc_read(from, k));
            w.top += piece.count;
            from = ploc_from(from, piece.count);
            hploc_climb(&w, piece, stack, &waiting, &fixed);
        }
    }
    ploc_write_side(root, ploc_read(all, 0));
}
