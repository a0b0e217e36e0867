/* Does a fence of this device do what it promises? Message passing between work-groups, as the
 * bottom-up passes do it (handover.clh).
 *
 *   for each slot, two work-items of different groups, each:
 *       write a message
 *       go through the slot's atomic
 *       if it is the second: read the other's message, count the words that are not there yet
 *
 * A count of 0 proves nothing, any other count proves that the device can't be used this way. The
 * messages of a slot lie apart, so that they are in different cache lines.
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
    /* the other end of the array comes first, so that the two are seldom in step */
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
