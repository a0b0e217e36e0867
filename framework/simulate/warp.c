#include "framework/simulate/warp.h"

/* Turns besides the kinds of steps that rays take on their own. */
enum {
    TURN_BEGIN = BB_ISSUE_BEGIN,
    TURN_END = BB_ISSUE_END,
    TURN_DONE,
    OF_PACKET,
    TURN_PACKET_NODE = OF_PACKET + BB_STEP_NODE,
    TURN_PACKET_PUSH = OF_PACKET + BB_STEP_PUSH,
    TURN_PACKET_PRIMS = OF_PACKET + BB_STEP_PRIMS,
    TURN_PACKET_POP = OF_PACKET + BB_STEP_POP,
    TURN_PACKET_BOX = OF_PACKET + BB_STEP_BOX,
};

/* The first place of a ray's own stack, beyond that of its packet. */
enum { OWN_STACK = 1 << 11 };

/* Notes of which kind a lane's next step is, and whose. */
static void look_ahead(bb_warp *warp, uint32_t lane)
{
    const uint64_t bit = 1ull << lane;
    for (; warp->next[lane] < warp->end[lane]; warp->next[lane]++) {
        const uint32_t word = warp->steps->words[warp->next[lane]], kind = bb_step_kind(word);
        if (kind != BB_STEP_MARK) {
            *((warp->together & bit) != 0 ? &warp->of_packet[kind] : &warp->at[kind]) |= bit;
            return;
        }
        warp->together = bb_step_index(word) != 0 ? warp->together | bit : warp->together & ~bit;
        warp->top[lane] = OWN_STACK;
    }
}

void bb_warp_start(bb_warp *warp, const bb_steps *steps, const bb_footing *footing, uint32_t first,
                   uint32_t lanes)
{
    *warp = (bb_warp){.steps = steps,
                      .footing = footing,
                      .first = first,
                      .lanes = lanes,
                      .turn = TURN_BEGIN,
                      .in_region = footing->in_region};
    for (uint32_t i = 0; i < lanes; i++) {
        warp->next[i] = first + i > 0 ? steps->ends[first + i - 1] : 0;
        warp->end[i] = steps->ends[first + i];
        look_ahead(warp, i);
    }
}

static bool is_of(const bb_warp *warp, bb_control control)
{
    return warp->footing->control == control;
}

static uint32_t place(const bb_warp *warp, uint32_t entry)
{
    const uint32_t ring = warp->footing->ring;
    return ring > 0 ? entry % ring : entry;
}

/* Has these lanes take their own next step, which is of this kind. */
static bool take(bb_warp *warp, bb_issue *issue, uint32_t kind, uint64_t lanes)
{
    issue->kind = kind;
    issue->lanes = issue->words[0] = issue->words[1] = lanes;
    if (warp->footing->is_link)
        issue->words[1] = 0;
    warp->at[kind] &= ~lanes;
    for (uint64_t rest = lanes; rest != 0; rest &= rest - 1) {
        const uint32_t i = (uint32_t)__builtin_ctzll(rest);
        issue->index[i] = bb_step_index(warp->steps->words[warp->next[i]++]);
        if (kind == BB_STEP_PUSH)
            issue->index[i] = place(warp, warp->top[i]++);
        else if (kind == BB_STEP_POP)
            issue->index[i] = place(warp, --warp->top[i]);
        else if (kind == BB_STEP_AGAIN) {
            warp->top[i] = 0;
            warp->in_region = issue->index[i] != 0;
        }
        look_ahead(warp, i);
    }
    return true;
}

/* Has all lanes whose own next step is of this kind take it, unless there are none; `next` is the
 * turn after that. */
static bool take_all(bb_warp *warp, bb_issue *issue, uint32_t kind, uint32_t next)
{
    const uint64_t lanes = warp->at[kind];
    warp->turn = next;
    return lanes != 0 && take(warp, issue, kind, lanes);
}

/* Returns the lanes of all packets of which some are in `lanes`, or their first two alone. */
static uint64_t whole_packets(const bb_warp *warp, uint64_t lanes, bool first_two)
{
    const uint32_t size = warp->footing->packet;
    const uint64_t packet = (1ull << size) - 1;
    uint64_t whole = 0;
    for (uint32_t i = 0; i < BB_WARP_MOST; i += size)
        if ((lanes >> i & packet) != 0)
            whole |= (first_two ? 3 : packet) << i;
    return whole;
}

/* Has the packets whose next step is of this kind take it; returns false if there are none. */
static bool take_packets(bb_warp *warp, bb_issue *issue, uint32_t kind)
{
    const uint64_t lanes = warp->of_packet[kind];
    const bool is_entry = kind == BB_STEP_PUSH || kind == BB_STEP_POP;
    uint64_t met = 0;
    if (lanes == 0)
        return false;
    warp->of_packet[kind] = 0;
    for (uint64_t rest = lanes; rest != 0; rest &= rest - 1) {
        const uint32_t i = (uint32_t)__builtin_ctzll(rest);
        const uint32_t index = bb_step_index(warp->steps->words[warp->next[i]++]);
        issue->index[i] = is_entry ? index >> 1 : index;
        /* those of its lanes that have no ray have words of its entries */
        for (uint32_t k = i + 1; k % warp->footing->packet != 0; k++)
            issue->index[k] = issue->index[i];
        met |= (uint64_t)(index & 1) << i;
        look_ahead(warp, i);
    }
    issue->kind = kind;
    if (kind == BB_STEP_POP)
        warp->active = met;
    issue->lanes = is_entry ? met : lanes & warp->active;
    issue->words[0] = whole_packets(warp, lanes, false);
    issue->words[1] = whole_packets(warp, lanes, true);
    return true;
}

/* Each ray is read before its first step and its answer written after the last ray's last one. */
static bool ends_of_rays(bb_warp *warp, bb_issue *issue, uint32_t kind, uint32_t turn)
{
    issue->kind = kind;
    issue->lanes = warp->lanes == 64 ? ~0ull : (1ull << warp->lanes) - 1;
    for (uint32_t i = 0; i < warp->lanes; i++)
        issue->index[i] = warp->first + i;
    warp->turn = turn;
    return true;
}

/* Whether what a search finds is looked up when all have found it. */
static bool finds_first(const bb_warp *warp)
{
    return is_of(warp, BB_IF_ELSE) || is_of(warp, BB_UNTIL_LEAF);
}

/* The turn that comes after the last pop. */
static uint32_t after_pops(const bb_warp *warp)
{
    const bool until_leaf = is_of(warp, BB_UNTIL_LEAF);
    const uint64_t nodes = warp->at[BB_STEP_NODE] | warp->at[BB_STEP_POP] |
                           (until_leaf ? warp->at[BB_STEP_BOX] : warp->at[BB_STEP_PRIMS]);
    return nodes != 0                                  ? BB_STEP_NODE
           : until_leaf && warp->at[BB_STEP_LEAF] != 0 ? BB_STEP_LEAF
                                                       : TURN_PACKET_POP;
}

/* The turn that comes when no ray takes samples. */
static uint32_t after_samples(const bb_warp *warp)
{
    const bool leaves = is_of(warp, BB_IF_IF_BY_LEAF) && warp->at[BB_STEP_PRIMS] != 0;
    return leaves ? BB_STEP_PRIMS : BB_STEP_POP;
}

bool bb_warp_next(bb_warp *warp, bb_issue *issue)
{
    for (;;) {
        uint64_t lanes;
        switch (warp->turn) {
        case TURN_BEGIN:
            return ends_of_rays(warp, issue, BB_ISSUE_BEGIN, BB_STEP_NODE);
        case BB_STEP_NODE:
            lanes = warp->pushing = warp->at[BB_STEP_NODE];
            if (is_of(warp, BB_IF_ELSE))
                warp->popping = warp->at[BB_STEP_POP];
            warp->turn = is_of(warp, BB_UNTIL_LEAF) ? BB_STEP_BOX
                         : lanes != 0               ? BB_STEP_PUSH
                                                    : BB_STEP_PRIMS;
            if (lanes != 0)
                return take(warp, issue, BB_STEP_NODE, lanes);
            break;
        case BB_STEP_BOX:
            lanes = warp->at[BB_STEP_BOX];
            if (lanes != 0)
                return take(warp, issue, BB_STEP_BOX, lanes);
            warp->turn = BB_STEP_PUSH;
            break;
        case BB_STEP_PUSH:
            lanes = warp->pushing & warp->at[BB_STEP_PUSH];
            if (lanes != 0)
                return take(warp, issue, BB_STEP_PUSH, lanes);
            warp->turn = is_of(warp, BB_WHILE_WHILE) || is_of(warp, BB_PACKETS) ? BB_STEP_NODE
                         : is_of(warp, BB_UNTIL_LEAF)                           ? BB_STEP_POP
                                                                                : BB_STEP_PRIMS;
            break;
        case BB_STEP_LEAF:
            if (take_all(warp, issue, BB_STEP_LEAF, BB_STEP_PRIMS))
                return true;
            break;
        case BB_STEP_PRIMS:
            lanes = warp->at[BB_STEP_PRIMS];
            warp->turn =
                lanes == 0 || is_of(warp, BB_IF_IF_BY_LEAF) ? BB_STEP_SAMPLE : BB_STEP_EXACT;
            if (lanes != 0)
                return take(warp, issue, BB_STEP_PRIMS, lanes);
            break;
        case BB_STEP_EXACT:
            if (take_all(warp, issue, BB_STEP_EXACT, BB_STEP_FURTHER))
                return true;
            break;
        case BB_STEP_FURTHER:
            if (take_all(warp, issue, BB_STEP_FURTHER, BB_STEP_PRIMS))
                return true;
            break;
        case BB_STEP_SAMPLE:
            if (take_all(warp, issue, BB_STEP_SAMPLE, BB_STEP_LOOKUP))
                return true;
            break;
        case BB_STEP_LOOKUP:
            lanes = finds_first(warp) ? 0 : warp->at[BB_STEP_LOOKUP];
            warp->turn = after_samples(warp);
            if (lanes != 0) {
                warp->turn = BB_STEP_SAMPLE;
                return take(warp, issue, BB_STEP_LOOKUP, lanes);
            }
            break;
        case BB_STEP_POP:
            lanes = warp->at[BB_STEP_POP];
            if (is_of(warp, BB_IF_ELSE))
                lanes = warp->popping;
            warp->popping = 0;
            warp->restarting = warp->at[BB_STEP_RESTART];
            warp->turn = BB_STEP_RESTART;
            if (lanes != 0)
                return take(warp, issue, BB_STEP_POP, lanes);
            if (warp->restarting != 0)
                break;
            warp->turn = after_pops(warp);
            break;
        case BB_STEP_RESTART:
            lanes = warp->restarting;
            warp->turn = BB_STEP_POP;
            if (lanes != 0)
                return take(warp, issue, BB_STEP_RESTART, lanes);
            break;
        case TURN_PACKET_POP:
            warp->turn = TURN_PACKET_PRIMS;
            if (take_packets(warp, issue, BB_STEP_POP))
                return true;
            warp->turn = BB_STEP_AGAIN;
            break;
        case TURN_PACKET_PRIMS:
            if (take_packets(warp, issue, BB_STEP_PRIMS))
                return true;
            warp->turn = TURN_PACKET_NODE;
            break;
        case TURN_PACKET_NODE:
            warp->turn = TURN_PACKET_BOX;
            if (take_packets(warp, issue, BB_STEP_NODE))
                return true;
            break;
        case TURN_PACKET_BOX:
            warp->turn = TURN_PACKET_PUSH;
            if (take_packets(warp, issue, BB_STEP_BOX))
                return true;
            warp->turn = BB_STEP_NODE;
            break;
        case TURN_PACKET_PUSH:
            warp->turn = TURN_PACKET_BOX;
            if (take_packets(warp, issue, BB_STEP_PUSH))
                return true;
            break;
        case BB_STEP_AGAIN:
            lanes = warp->at[BB_STEP_LOOKUP]; /* of what all have found */
            if (lanes != 0)
                return take(warp, issue, BB_STEP_LOOKUP, lanes);
            lanes = warp->at[BB_STEP_AGAIN];
            warp->turn = lanes != 0 ? BB_STEP_SAMPLE : TURN_END;
            if (lanes != 0)
                return take(warp, issue, BB_STEP_AGAIN, lanes);
            break;
        case TURN_END:
            return ends_of_rays(warp, issue, BB_ISSUE_END, TURN_DONE);
        default:
            return false;
        }
    }
}

uint64_t bb_warp_left(const bb_warp *warp)
{
    uint64_t left = 0;
    for (uint32_t i = 0; i < warp->lanes; i++)
        left += warp->end[i] - warp->next[i];
    return left;
}
