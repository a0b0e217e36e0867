/* Tests whether a fence of this device does what it promises: message passing between work-groups,
 * as in the bottom-up passes (handover.clh).
 *
 *   for each slot, two work-items of different groups, each:
 *       write a message
 *       increment the slot's atomic
 *       if second: read the other's message and count the words that have not arrived
 *
 * A count of 0 proves nothing; any other count proves that the device cannot be used this way. The
 * messages of a slot are far apart, so that they are in different cache lines.
 */
#include "bb_device.h"
#include "handover.clh"

#define WORDS 8u

kernel void litmus(uint slots, uint stamp, global uint *messages, volatile global uint *gates,
                   volatile global uint *stale)
{
    uint item = get_global_id(0), side = item / slots, slot = item % slots;
    if (side > 1u)
        return;
    /* the other side starts at the other end, so that the two seldom run in step */
    slot = side == 0u ? slot : slots - 1u - slot;
    global uint *mine = messages + (ulong)(2u * slot + side) * WORDS;
    volatile global uint *other = messages + (ulong)(2u * slot + 1u - side) * WORDS;
    for (uint w = 0; w < WORDS; w++)
        mine[w] = stamp;
#if BB_HANDOVER
    BB_DEVICE_FENCE();
#endif
    if (atomic_inc(&gates[slot]) % 2u == 0u)
        return;
#if BB_HANDOVER
    BB_DEVICE_FENCE();
#endif
    uint missing = 0;
    for (uint w = 0; w < WORDS; w++)
        missing += other[w] != stamp ? 1u : 0u;
    if (missing != 0u)
        atomic_add(stale, missing);
}
