#include "framework/simulate/divergence.h"

#include "framework/simulate/warp.h"

void bb_divergence(const bb_steps *steps, const bb_footing *footing, uint32_t width,
                   bb_count *waits)
{
    bb_warp warp;
    bb_issue issue;
    uint32_t first, lanes;
    for (uint64_t g = 0; (lanes = bb_footing_lanes(footing, width, steps->rays, g, &first)) > 0;
         g++) {
        bb_warp_start(&warp, steps, footing, first, lanes);
        for (uint32_t i = 0; i < lanes; i++)
            waits[first + i] = (bb_count){0};
        while (bb_warp_next(&warp, &issue))
            for (uint32_t i = 0; i < lanes; i++) {
                const bool waiting = (issue.lanes >> i & 1) == 0;
                waits[first + i].nodes += waiting && bb_is_at_node(issue.kind);
                waits[first + i].prims += waiting && issue.kind == BB_STEP_PRIMS;
            }
    }
}
