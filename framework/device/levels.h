/* Passes over a tree level by level, for devices without a fence between work-groups
 * (kernels/handover.clh): two lists of nodes, and the number of nodes per level. The host does not
 * query the device in between: it enqueues launches for more levels than most trees have with many
 * nodes, and a last one, of a single work-group, for everything that may be left.
 */
#ifndef BB_LEVELS_H
#define BB_LEVELS_H

#include "framework/device/device.h"

#pragma GCC visibility push(default) /* what a plug-in may call */
#ifdef __cplusplus
extern "C" {
#endif

typedef struct bb_levels {
    bb_buffer lists[2]; /* u32: level n is in lists[n % 2] */
    bb_buffer counts;   /* u32 per level; level 0 has none, since the leaves put level 1 on its
                         * list */
    uint32_t most;
    bool by_groups; /* all work-items of a group share a node; set before a pass */
    bool last;      /* set during the last launch */
} bb_levels;

/* Reserves room for `nodes` inner nodes on at most `most` levels above the leaves. A zeroed object
 * is empty. */
bb_status bb_levels_reserve(bb_levels *levels, bb_device *device, bb_account *account,
                            uint32_t nodes, uint32_t most, const char *what);
void bb_levels_release(bb_levels *levels);

/* To be called before the launch over the leaves, which puts nodes on lists[1] and counts them in
 * counts[1]. */
bb_status bb_levels_start(bb_levels *levels);

/* Returns the work-items of a launch, which share a level's nodes, since only the device knows
 * their number. 1, for one work-group, in the last launch. */
uint32_t bb_levels_items(const bb_levels *levels);

/* Returns the number of launches that bb_levels_run() makes. */
uint32_t bb_levels_launches(const bb_levels *levels);

/* Calls launch(context, levels, n) for n = 1, 2, ...: it must enqueue a kernel with BB_FOR_LISTS()
 * over the counts[n] nodes of lists[n % 2] that puts nodes on lists[(n + 1) % 2]. */
bb_status bb_levels_run(bb_levels *levels,
                        bb_status (*launch)(void *context, const bb_levels *levels, uint32_t n),
                        void *context);

#ifdef __cplusplus
}
#endif
#pragma GCC visibility pop

#endif
