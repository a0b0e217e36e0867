#include "framework/device/levels.h"

enum {
    ITEMS_MAX = 1 << 16,
    ALONE = 256,        /* nodes of a level that one work-group handles alone */
    ALONE_BY_GROUP = 4, /* the same, if the whole group shares a node */
    LAUNCHES_MIN = 17,  /* of longer passes: those that handover.clh relies on, and the last */
};

bb_status bb_levels_reserve(bb_levels *levels, bb_device *device, bb_account *account,
                            uint32_t nodes, uint32_t most, const char *what)
{
    levels->most = most;
    for (int i = 0; i < 2; i++)
        BB_TRY(
            bb_buffer_reserve(device, account, nodes * sizeof(uint32_t), what, &levels->lists[i]));
    return bb_buffer_reserve(device, account, ((size_t)most + 2) * sizeof(uint32_t), what,
                             &levels->counts);
}

void bb_levels_release(bb_levels *levels)
{
    bb_buffer_release(&levels->lists[0]);
    bb_buffer_release(&levels->lists[1]);
    bb_buffer_release(&levels->counts);
}

bb_status bb_levels_start(bb_levels *levels)
{
    return bb_buffer_fill(&levels->counts, ((size_t)levels->most + 2) * sizeof(uint32_t), 0);
}

static uint32_t most_nodes(const bb_levels *levels)
{
    return (uint32_t)(levels->lists[0].bytes / sizeof(uint32_t));
}

uint32_t bb_levels_items(const bb_levels *levels)
{
    uint32_t nodes = most_nodes(levels);
    return levels->last ? 1 : nodes < ITEMS_MAX ? nodes : ITEMS_MAX;
}

/* Levels of a tree shrink by about a half; twice as many launches suffice for most trees. */
uint32_t bb_levels_launches(const bb_levels *levels)
{
    uint32_t launches = 1, nodes = most_nodes(levels);
    if (nodes > (levels->by_groups ? ALONE_BY_GROUP : ALONE)) {
        for (; nodes > 1; nodes /= 2)
            launches += 2;
        launches = launches < LAUNCHES_MIN ? LAUNCHES_MIN : launches;
    }
    return launches < levels->most ? launches : levels->most;
}

bb_status bb_levels_run(bb_levels *levels,
                        bb_status (*launch)(void *context, const bb_levels *levels, uint32_t n),
                        void *context)
{
    const uint32_t launches = bb_levels_launches(levels);
    bb_status status = BB_OK;
    for (uint32_t n = 1; n <= launches && status == BB_OK; n++) {
        levels->last = n == launches;
        status = launch(context, levels, n);
    }
    levels->last = false;
    return status;
}
