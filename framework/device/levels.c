#include "framework/device/levels.h"

enum {
    ITEMS_MAX = 1 << 16,
    AT_ONCE = 16, /* levels enqueued before asking whether there is another one */
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

uint32_t bb_levels_items(const bb_levels *levels)
{
    size_t nodes = levels->lists[0].bytes / sizeof(uint32_t);
    return nodes < ITEMS_MAX ? (uint32_t)nodes : ITEMS_MAX;
}

bb_status bb_levels_run(bb_levels *levels,
                        bb_status (*launch)(void *context, const bb_levels *levels, uint32_t n),
                        void *context)
{
    for (uint32_t n = 1, left = 1; n <= levels->most && left > 0; n++) {
        BB_TRY(launch(context, levels, n));
        if (n % AT_ONCE == 0)
            BB_TRY(bb_buffer_read(&levels->counts, (n + 1) * sizeof left, sizeof left, &left));
    }
    return BB_OK;
}
