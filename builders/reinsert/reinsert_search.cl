/* Finds the best new position for each subtree: the search of the reinsertion.
 *
 *   sample some subtrees' areas, evenly spaced; the host derives a threshold  (search_sample)
 *   list the subtrees above it: larger subtrees offer more gain                 (search_mark)
 *   for each of these, x, with parent p and sibling s:                          (search_find)
 *       saved = A(p)                                              x removed, s in p's place
 *       search below s
 *       for each pivot q above p, up to the root, with c its other child:
 *           gain of x beside c: saved - A(c u x); search below c
 *           saved += A(q) - A(q without x)
 *           gain of x beside q without x: saved - A(q)
 *   search below y: grown = sum of A(.) with x - A(.) without x, from the pivot's child down to y
 *       gain of x beside a child c of y: saved - grown - A(c u x)
 *       go on below the child that grows less and put the other one on a stack; no gain below a
 *       child can exceed saved - grown - A(x)
 *
 * Meister and Bittner 2018, "Parallel Reinsertion for Bounding Volume Hierarchy Optimization" (see
 * reinsert.c). The search does not change the tree. Our addition: x is never moved below a child
 * that is not larger than x (beside that child is as good), which also makes cycles of moves
 * impossible (reinsert_moves.cl). Ties go to the first candidate found, in the order of sides.
 *
 * Limits: a search ends after visiting BB_SEARCH_MOST families, with the best place so far; the
 * stack holds at most BB_SEARCH_WAITING children, others are skipped. Either can only make the
 * result worse, and does so alike on every device.
 */
#include "families.clh"
#include "lanes.clh"

#define BB_SEARCH_WAITING 32u

typedef struct subtree_search {
    bb_two_boxes box; /* x's box, in both lanes */
    float area;
    float unit;
    float best;
    uint to;
    uint left; /* families that may still be visited */
} subtree_search;

void try_place(subtree_search *search, uint place, float gain)
{
    if (gain > search->best) {
        search->best = gain;
        search->to = place;
    }
}

/* Searches below the inner node `f`, whose box has grown by x; `saved` is net of that growth. */
void search_below(global const bb_family *families, subtree_search *search, uint f, float saved)
{
    uint waiting_families[BB_SEARCH_WAITING];
    float waiting_saved[BB_SEARCH_WAITING];
    uint waiting = 0;
    for (;;) {
        if (search->left == 0u)
            return;
        search->left--;
        bb_two_boxes boxes;
        load_family(families, f, &boxes);
        uint2 links = vload2(0, families[f].links);
        float2 own = areas_of(&boxes, search->unit);
        join_boxes(&boxes, &search->box);
        float2 with = areas_of(&boxes, search->unit);
        float2 gain = saved - with, below = saved - (with - own), most = below - search->area;
        try_place(search, 2u * f, gain.x);
        try_place(search, 2u * f + 1u, gain.y);
        bool a = !is_leaf_link(links.x) && own.x > search->area && most.x > search->best;
        bool b = !is_leaf_link(links.y) && own.y > search->area && most.y > search->best;
        if (a && b) {
            bool first = below.x >= below.y;
            if (waiting < BB_SEARCH_WAITING) {
                waiting_families[waiting] = first ? links.y : links.x;
                waiting_saved[waiting++] = first ? below.y : below.x;
            }
            f = first ? links.x : links.y;
            saved = first ? below.x : below.y;
        } else if (a || b) {
            f = a ? links.x : links.y;
            saved = a ? below.x : below.y;
        } else {
            do {
                if (waiting == 0u)
                    return;
                waiting--;
                saved = waiting_saved[waiting];
            } while (!(saved - search->area > search->best));
            f = waiting_families[waiting];
        }
    }
}

/* Searches from the place of x's parent up. `path`: the box of the subtree there without x, and
 * with x. */
void search_above(global const bb_family *families, subtree_search *search, uint top, uint place,
                  bb_two_boxes *path, float saved)
{
    bb_two_boxes taken_in = search->box;
    drop_second(&taken_in);
    bool touches = true; /* x a side of the pivots' boxes; if not, no more is saved above */
    while (place >> 1 != top && search->left > 0u) {
        search->left--;
        uint f = place >> 1, side = 1u - (place & 1u), c = families[f].links[side];
        bb_two_boxes other;
        load_family(families, f, &other);
        spread_box(&other, side);
        place = families[f].place;
        if (saved - search->area > search->best) {
            bb_two_boxes joined = other;
            join_boxes(&joined, &taken_in);
            float2 both = areas_of(&joined, search->unit);
            float with = both.x, own = both.y, below = saved - (with - own);
            try_place(search, 2u * f + side, saved - with);
            if (!is_leaf_link(c) && own > search->area && below - search->area > search->best)
                search_below(families, search, c, below);
        } else if (!touches) {
            return;
        }
        if (touches) {
            join_boxes(path, &other);
            float2 both = areas_of(path, search->unit);
            float without = both.x, before = both.y;
            saved += before - without;
            try_place(search, place, saved - before);
            touches = !is_one_box(path);
        }
    }
}

/* Searches for a part of the list, every `step`-th entry from `first` on; writes moves[begin],
 * ... */
kernel void search_find(global const bb_family *families, uint top, float unit,
                        global const uint *list, uint first, uint step, uint begin,
                        uint count, global bb_move *moves)
{
    uint i = get_global_id(0);
    if (i >= count)
        return;
    uint from = list[first + i * step], p = from >> 1, side = from & 1u;
    uint s = families[p].links[1u - side];
    bb_two_boxes boxes;
    load_family(families, p, &boxes);
    bb_two_boxes path = boxes; /* the sibling's box, and the union of both */
    spread_box(&path, 1u - side);
    float sibling = areas_of(&path, unit).x;
    subtree_search search = {boxes, 0, unit, 0, BB_NONE, BB_SEARCH_MOST};
    spread_box(&search.box, side);
    search.area = areas_of(&search.box, unit).x;
    unite_boxes(&boxes);
    float saved = areas_of(&boxes, unit).x;
    put_second(&path, &boxes);
    if (!is_leaf_link(s) && sibling > search.area)
        search_below(families, &search, s, sibling);
    search_above(families, &search, top, families[p].place, &path, saved);
    bb_move move = {from, search.to, families[p].place, search.best};
    moves[begin + i] = move;
}

/* ---- which subtrees ---- */

/* areas[]: areas of both children of each `step`-th family. */
kernel void search_sample(global const bb_family *families, uint step, uint count, float unit,
                          global float2 *areas)
{
    uint i = get_global_id(0);
    if (i >= count)
        return;
    bb_two_boxes boxes;
    load_family(families, i * step, &boxes);
    areas[i] = areas_of(&boxes, unit);
}

kernel void search_mark(global const bb_family *families, uint count, float unit, float least,
                        global uint *marks)
{
    uint f = get_global_id(0);
    if (f >= count)
        return;
    bb_two_boxes boxes;
    load_family(families, f, &boxes);
    float2 areas = areas_of(&boxes, unit);
    marks[2u * f] = areas.x >= least ? 1u : 0u;
    marks[2u * f + 1u] = areas.y >= least ? 1u : 0u;
}
