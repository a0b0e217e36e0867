/* Exclusive prefix sum over the work-items of one group, through local memory (Hillis and Steele 1986: log2 steps).
 *
 * Limits: every item of the group must call it, in uniform control flow; `sums` has one entry per item. Needs no
 * sub-groups and no lockstep.
 */
#ifndef BB_GROUP_SCAN_H
#define BB_GROUP_SCAN_H

/* Returns the sum of `value` over the items before this one; *total is the sum over all. `sums` may be used again
 * at once. */
static uint bb_group_scan(uint value, __local uint *sums, uint *total)
{
    const uint item = get_local_id(0);
    const uint size = get_local_size(0);
    uint inclusive = value;
    sums[item] = inclusive;
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint step = 1; step < size; step *= 2) {
        const uint before = item >= step ? sums[item - step] : 0;
        barrier(CLK_LOCAL_MEM_FENCE);
        inclusive += before;
        sums[item] = inclusive;
        barrier(CLK_LOCAL_MEM_FENCE);
    }
    *total = sums[size - 1];
    barrier(CLK_LOCAL_MEM_FENCE);
    return inclusive - value;
}

#endif
