/* Compaction: moves each value whose mark is 1 to its place in the scan of the marks.
 *
 *   places = exclusive scan of marks                                      (bb_scan_u32)
 *   for each i: if marks[i]: out[places[i]] = values[i], or i itself      (compact)
 *
 * Limits: 2^32 - 1 values.
 */
#include "bb_device.h"

kernel void compact(global const uint *marks, global const uint *places, global const uint *values,
                    uint numbers, uint count, global uint *out)
{
    uint i = get_global_id(0);
    if (i < count && marks[i] != 0)
        out[places[i]] = numbers != 0 ? i : values[i];
}
