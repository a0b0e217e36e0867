/* Which of the moves that were found are made, and how (reinsert_search.cl finds them).
 *
 *   a move from place (p, side) to place (o, side'), with g the family above p's node, rewrites
 *   places of p, g and o, and no others: it needs these three families for itself
 *   rounds: of the moves that are still open
 *       a move that needs a family already taken is dropped                     (moves_clear)
 *       each bids its gain for its families                                       (moves_bid)
 *       of those with the largest bid the least place holds a family              (moves_tie)
 *       who holds all three is made, and takes them                            (moves_settle)
 *   all that were chosen are made at once                                        (moves_make)
 *   or taken back, should the tree have become worse                             (moves_undo)
 *   boxes: families that moves have rewritten, and all above them; each is joined by the last one
 *       below it to come                                             (moves_arrive, moves_refit)
 *
 * Meister and Bittner 2018, whose code locks six nodes, for the larger gain and, where gains are
 * equal, by the node. Here three families stand for the six, and gain and place take an atomic of
 * 32 bits each, since OpenCL 1.2 has none of 64. Further rounds are our addition: they find more
 * moves for the same search. Only integers are compared, and a claim is won by the same move in
 * whatever order they come.
 *
 * No ring: follow the moved tree upwards from a node. A step goes to what was above before, or with
 * a moved x to the parent of what it was put beside: which is above x, too, or was larger than x in
 * floats, as the search makes sure of. So no way up leads to where it began: areas never fall on
 * it, and where they stay the same it goes up the old tree.
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

/* Of families that are claimed; all others are asked by nobody. */
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

/* Gains are positive, and so compare as integers do. */
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

/* made[0]: how many, with those of earlier rounds. */
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

/* What is at a place: a box, in both lanes, and a link. */
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

/* x's sibling goes to where their parent is, the parent between `to` and what is there, which
 * becomes x's sibling. Boxes above are out of date then. */
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

/* The same backwards. */
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

/* missing[f]: how many will come to f, of those below it and the moves themselves; 0 before. A move
 * comes to all that it has rewritten, or would if it were undone. */
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

/* Joins both children of f; returns what is above it. */
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
