/* Chooses which of the moves that reinsert_search.cl found are made, and makes them.
 *
 *   a move from place (p, side) to place (o, side'), with g the family above p's node, rewrites
 *   places of p, g and o, and no others: it must own these three families
 *   rounds: for the moves that are still open:
 *       drop moves that need a family that is already taken                      (moves_clear)
 *       each move bids its gain for its families                                   (moves_bid)
 *       among the largest bids for a family the lowest place holds it              (moves_tie)
 *       moves that hold all three of their families are chosen, and take them   (moves_settle)
 *   make all chosen moves at once                                                 (moves_make)
 *   or undo them, if the tree has become worse                                    (moves_undo)
 *   refit boxes of rewritten families and all above them; each family is joined by the last of
 *       its children to finish                                     (moves_arrive, moves_refit)
 *
 * Meister and Bittner 2018. Their code locks six nodes for the larger gain, with ties decided by
 * the node. Here three families stand for the six nodes, and gain and place take one 32-bit atomic
 * each, since OpenCL 1.2 has no 64-bit ones. Further rounds are our addition: they find more moves
 * for the same search. Only integers are compared, so the same moves win in whatever order they
 * run.
 *
 * Why there are no cycles: go upwards from a node in the tree after the moves. Each step leads to
 * the old parent or, from a moved x, to the parent of the node that x was put beside. That parent
 * either was above x, too, or was larger than x in floats, as the search ensures. So no way up
 * returns to its start: areas never fall along it, and where they stay the same it follows the old
 * tree.
 */
#include "families.clh"
#include "handover.clh"

#define MOVE_OPEN 0u
#define MOVE_MADE 1u
#define MOVE_LOST 2u

uint3 families_of(bb_move move)
{
    return (uint3)(move.from >> 1, move.above >> 1, move.to >> 1);
}

kernel void moves_open(global const bb_move *moves, uint begin, uint end, global uint *states,
                       global uint *taken)
{
    uint i = begin + get_global_id(0);
    if (i >= end)
        return;
    bb_move move = moves[i];
    states[i] = move.to == BB_NONE ? MOVE_LOST : MOVE_OPEN;
    if (move.to == BB_NONE)
        return;
    uint3 f = families_of(move);
    taken[f.x] = taken[f.y] = taken[f.z] = 0u;
}

/* Resets the bids and holders of families that open moves need; no others are read. */
kernel void moves_clear(global const bb_move *moves, uint begin, uint end, global uint *states,
                        global const uint *taken, global uint *bids, global uint *holders)
{
    uint i = begin + get_global_id(0);
    if (i >= end || states[i] != MOVE_OPEN)
        return;
    uint3 f = families_of(moves[i]);
    if ((taken[f.x] | taken[f.y] | taken[f.z]) != 0u) {
        states[i] = MOVE_LOST;
        return;
    }
    bids[f.x] = bids[f.y] = bids[f.z] = 0u;
    holders[f.x] = holders[f.y] = holders[f.z] = BB_NONE;
}

/* Gains are positive floats, so they compare like integers. */
kernel void moves_bid(global const bb_move *moves, uint begin, uint end, global const uint *states,
                      volatile global uint *bids)
{
    uint i = begin + get_global_id(0);
    if (i >= end || states[i] != MOVE_OPEN)
        return;
    uint3 f = families_of(moves[i]);
    uint gain = as_uint(moves[i].gain);
    atomic_max(&bids[f.x], gain);
    atomic_max(&bids[f.y], gain);
    atomic_max(&bids[f.z], gain);
}

kernel void moves_tie(global const bb_move *moves, uint begin, uint end, global const uint *states,
                      global const uint *bids, volatile global uint *holders)
{
    uint i = begin + get_global_id(0);
    if (i >= end || states[i] != MOVE_OPEN)
        return;
    uint3 f = families_of(moves[i]);
    uint gain = as_uint(moves[i].gain), from = moves[i].from;
    if (bids[f.x] == gain)
        atomic_min(&holders[f.x], from);
    if (bids[f.y] == gain)
        atomic_min(&holders[f.y], from);
    if (bids[f.z] == gain)
        atomic_min(&holders[f.z], from);
}

/* made[0]: number of moves chosen so far, including earlier rounds. */
kernel void moves_settle(global const bb_move *moves, uint begin, uint end, global uint *states,
                         global const uint *holders, global uint *taken,
                         volatile global uint *made)
{
    uint i = begin + get_global_id(0);
    if (i >= end || states[i] != MOVE_OPEN)
        return;
    uint3 f = families_of(moves[i]);
    uint from = moves[i].from;
    if (holders[f.x] != from || holders[f.y] != from || holders[f.z] != from)
        return;
    states[i] = MOVE_MADE;
    taken[f.x] = taken[f.y] = taken[f.z] = 1u;
    atomic_inc(made);
}

/* ---- the moves ---- */

/* The content of a place: a box, in both lanes, and a link. */
typedef struct place_content {
    bb_two_boxes box;
    uint link;
} place_content;

void take(global const bb_family *families, uint place, place_content *content)
{
    load_family(families, place >> 1, &content->box);
    spread_box(&content->box, place & 1u);
    content->link = families[place >> 1].links[place & 1u];
}

void put(global bb_family *families, uint place, const place_content *content)
{
    store_box(families, place, &content->box);
    families[place >> 1].links[place & 1u] = content->link;
    if (!is_leaf_link(content->link))
        families[content->link].place = place;
}

/* Puts x's sibling in their parent's place, and the parent between `to` and the node there, which
 * becomes x's sibling. The boxes above are out of date afterwards. */
kernel void moves_make(global const bb_move *moves, uint begin, uint end, global const uint *states,
                       global bb_family *families)
{
    uint i = begin + get_global_id(0);
    if (i >= end || states[i] != MOVE_MADE)
        return;
    bb_move move = moves[i];
    uint p = move.from >> 1, beside = move.from ^ 1u;
    place_content moved;
    take(families, beside, &moved);
    put(families, move.above, &moved);
    take(families, move.to, &moved);
    put(families, beside, &moved);
    moved.link = p;
    put(families, move.to, &moved);
}

/* The inverse of moves_make. */
kernel void moves_undo(global const bb_move *moves, uint begin, uint end, global const uint *states,
                       global bb_family *families)
{
    uint i = begin + get_global_id(0);
    if (i >= end || states[i] != MOVE_MADE)
        return;
    bb_move move = moves[i];
    uint p = move.from >> 1, beside = move.from ^ 1u;
    place_content moved;
    take(families, beside, &moved);
    put(families, move.to, &moved);
    take(families, move.above, &moved);
    put(families, beside, &moved);
    moved.link = p;
    put(families, move.above, &moved);
}

/* ---- boxes ---- */

/* missing[f], 0 before: how many arrivals f waits for, from families below it and from moves. A
 * move arrives at all three of its families, which it has rewritten or would rewrite if undone. */
void arrive(global const bb_family *families, uint f, uint top, volatile global uint *missing)
{
    while (f != top && atomic_inc(&missing[f]) == 0u)
        f = families[f].place >> 1;
}

kernel void moves_arrive(global const bb_move *moves, uint begin, uint end,
                         global const uint *states, global const bb_family *families, uint top,
                         volatile global uint *missing)
{
    uint i = begin + get_global_id(0);
    if (i >= end || states[i] != MOVE_MADE)
        return;
    uint3 f = families_of(moves[i]);
    arrive(families, f.x, top, missing);
    arrive(families, f.y, top, missing);
    arrive(families, f.z, top, missing);
}

/* Joins the boxes of f's children; returns the family above f. */
uint fit_family(volatile global bb_family *families, uint f)
{
    uint place = families[f].place;
    bb_two_boxes boxes;
    load_family(families, f, &boxes);
    unite_boxes(&boxes);
    store_box(families, place, &boxes);
    return place >> 1;
}

#if BB_HANDOVER
void climb(volatile global bb_family *families, uint f, uint top, volatile global uint *missing)
{
    while (f != top) {
        BB_DEVICE_FENCE();
        if (atomic_dec(&missing[f]) != 1u)
            return;
        BB_DEVICE_FENCE();
        f = fit_family(families, f);
    }
}

kernel void moves_refit(global const bb_move *moves, uint begin, uint end,
                        global const uint *states, volatile global bb_family *families, uint top,
                        volatile global uint *missing)
{
    uint i = begin + get_global_id(0);
    if (i >= end || states[i] != MOVE_MADE)
        return;
    uint3 f = families_of(moves[i]);
    climb(families, f.x, top, missing);
    climb(families, f.y, top, missing);
    climb(families, f.z, top, missing);
}
#endif

void list_last(uint f, uint top, volatile global uint *missing, uint number,
               volatile global uint *counts, global uint *next)
{
    if (f != top && atomic_dec(&missing[f]) == 1u)
        bb_put_on_list(f, number, counts, next);
}

kernel void moves_refit_first(global const bb_move *moves, uint begin, uint end,
                              global const uint *states, uint top, volatile global uint *missing,
                              volatile global uint *counts, global uint *next)
{
    uint i = begin + get_global_id(0);
    if (i >= end || states[i] != MOVE_MADE)
        return;
    uint3 f = families_of(moves[i]);
    list_last(f.x, top, missing, 0u, counts, next);
    list_last(f.y, top, missing, 0u, counts, next);
    list_last(f.z, top, missing, 0u, counts, next);
}

kernel void moves_refit_level(global bb_family *families, uint top, volatile global uint *missing,
                              global uint *list, uint number, volatile global uint *counts,
                              global uint *next)
{
#define FIT(f) list_last(fit_family(families, f), top, missing, number, counts, next)
    BB_FOR_LISTS(FIT, 1u)
}
