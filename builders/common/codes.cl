/* Codes of all boxes: see codes.h for what a code is, codes.clh for how a key is made and for the -D.
 *
 *   for each primitive i, in parallel: key[i] = code(box[i]), value[i] = i
 *
 * Limits: 2^31 - 1 primitives.
 */
#include "bb_device.h"
#include "codes.clh"

kernel void code_keys(global const bb_box *restrict boxes, uint count,
                      global const bb_code_plan *restrict plan, global const ulong *restrict tables,
                      global bb_key *restrict keys, global uint *restrict values)
{
    uint i = get_global_id(0);
    if (i >= count)
        return;
    global const float *box = (global const float *)(boxes + i);
    keys[i] = bb_code_of(plan, tables, vload4(0, box), vload4(1, box));
    values[i] = i;
}
