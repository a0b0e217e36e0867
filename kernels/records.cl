/* Primitive records, for the layouts: what a kernel needs of a leaf's primitives lies in one place, in the order of the leaves.
 *
 *   record[i] = what its kind keeps of primitive refs[i] (prims.clh), in the layout's units; then
 *               refs[i] itself, with its last-bit
 *
 * Pro: one stream of memory per leaf, no indirection. Con: a primitive that several leaves reference is stored that often.
 * Limits: 2^31 - 1 records.
 */
#include "bb_device.h"

#include "prims.clh"

kernel void make_records(global const uint *refs, uint count, global const float *vertices,
                         global const uint *data, bb_prim_ends ends, float scale, uint form,
                         uint words, uint id_word, global uint *records)
{
    uint i = get_global_id(0);
    if (i >= count)
        return;
    uint prim = refs[i] & BB_INDEX_MASK;
    global uint *record = records + (ulong)i * words;
    for (uint w = 0; w < words; w++)
        record[w] = 0;
    bb_prim_write(record, 1, form, prim, data, vertices, &ends, scale);
    record[id_word] = refs[i];
}
