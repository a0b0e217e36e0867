#include "framework/simulate/warp.h"

/* Turns besides the kinds of steps. */
enum { TURN_BEGIN = BB_ISSUE_BEGIN, TURN_END = BB_ISSUE_END, TURN_DONE = BB_ISSUE_KINDS };

/* Notes of which kind a lane's next step is. */
static void look_ahead(bb_warp *warp, uint32_t lane)
{
    if (warp->next[lane] < warp->end[lane])
        warp->at[bb_step_kind(warp->steps->words[warp->next[lane]])] |= 1ull << lane;
}

void bb_warp_start(bb_warp *warp, const bb_steps *steps, bb_control control, uint32_t ring,
                   uint32_t first, uint32_t lanes)
{
    *warp = (bb_warp){.steps = steps,
                      .control = control,
                      .first = first,
                      .lanes = lanes,
                      .ring = ring,
                      .turn = TURN_BEGIN};
    for (uint32_t i = 0; i < lanes; i++) {
        warp->next[i] = first + i > 0 ? steps->ends[first + i - 1] : 0;
        warp->end[i] = steps->ends[first + i];
        look_ahead(warp, i);
    }
}

static uint32_t place(const bb_warp *warp, uint32_t entry)
{
    return warp->ring > 0 ? entry % warp->ring : entry;
}

/* Has these lanes take their next step, which is of this kind. */
static bool take(bb_warp *warp, bb_issue *issue, uint32_t kind, uint64_t lanes)
{
    issue->kind = kind;
    issue->lanes = lanes;
    warp->at[kind] &= ~lanes;
    for (uint64_t rest = lanes; rest != 0; rest &= rest - 1) {
        const uint32_t i = (uint32_t)__builtin_ctzll(rest);
        issue->index[i] = bb_step_index(warp->steps->words[warp->next[i]++]);
        if (kind == BB_STEP_PUSH)
            issue->index[i] = place(warp, warp->top[i]++);
        else if (kind == BB_STEP_POP)
            issue->index[i] = place(warp, --warp->top[i]);
        look_ahead(warp, i);
    }
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

bool bb_warp_next(bb_warp *warp, bb_issue *issue)
{
    for (;;) {
        uint64_t lanes;
        switch (warp->turn) {
        case TURN_BEGIN:
            return ends_of_rays(warp, issue, BB_ISSUE_BEGIN, BB_STEP_NODE);
        case BB_STEP_NODE:
            lanes = warp->pushing = warp->at[BB_STEP_NODE];
            warp->turn = lanes != 0 ? BB_STEP_PUSH : BB_STEP_PRIMS;
            if (lanes != 0)
                return take(warp, issue, BB_STEP_NODE, lanes);
            break;
        case BB_STEP_PUSH:
            lanes = warp->pushing & warp->at[BB_STEP_PUSH];
            if (lanes != 0)
                return take(warp, issue, BB_STEP_PUSH, lanes);
            warp->turn = warp->control == BB_IF_IF ? BB_STEP_PRIMS : BB_STEP_NODE;
            break;
        case BB_STEP_PRIMS:
            lanes = warp->at[BB_STEP_PRIMS];
            if (lanes != 0)
                return take(warp, issue, BB_STEP_PRIMS, lanes);
            warp->turn = BB_STEP_POP;
            break;
        case BB_STEP_POP:
            lanes = warp->at[BB_STEP_POP];
            warp->restarting = warp->at[BB_STEP_RESTART];
            warp->turn = BB_STEP_RESTART;
            if (lanes != 0)
                return take(warp, issue, BB_STEP_POP, lanes);
            if (warp->restarting != 0)
                break;
            lanes = warp->at[BB_STEP_NODE] | warp->at[BB_STEP_PRIMS];
            warp->turn = lanes != 0 ? BB_STEP_NODE : TURN_END;
            break;
        case BB_STEP_RESTART:
            lanes = warp->restarting;
            warp->turn = BB_STEP_POP;
            if (lanes != 0)
                return take(warp, issue, BB_STEP_RESTART, lanes);
            break;
        case TURN_END:
            return ends_of_rays(warp, issue, BB_ISSUE_END, TURN_DONE);
        default:
            return false;
        }
    }
}
