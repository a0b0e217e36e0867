/* Leaf primitives for the layouts: stores what a kernel needs of a leaf's primitives contiguously,
 * in the order of the leaves.
 *
 *   leaf_prims[i] = the data that its kind keeps of primitive refs[i] (prims.clh), in the layout's
 *                   units; then refs[i] itself, with its last-bit
 *
 * and, on request, one more with the primitive BB_NONE, which nothing can hit.
 *
 * Pro: one stream of memory per leaf, no indirection. Con: a primitive is stored once per leaf that
 * references it. Limits: 2^31 - 1 leaf primitives.
 */
#include "bb_device.h"

#include "prims.clh"

kernel void make_leaf_prims(global const uint *refs, uint count, global const float *vertices,
                         global const uint *data, bb_prim_ends ends, float scale, uint format,
                         uint words, uint id_word, uint closed, global uint *leaf_prims)
{
    uint i = get_global_id(0);
    global uint *leaf_prim = leaf_prims + (ulong)i * words;
    if (i == count && closed != 0u)
        for (uint w = 0; w < words; w++)
            leaf_prim[w] = w == id_word ? BB_NONE : as_uint(NAN);
    if (i >= count)
        return;
    bb_ask_ahead(refs, i, count, data, vertices, &ends);
    uint prim = refs[i] & BB_INDEX_MASK;
    for (uint w = 0; w < words; w++)
        leaf_prim[w] = 0;
    bb_prim_write(leaf_prim, 1, format, prim, data, vertices, &ends, scale);
    leaf_prim[id_word] = refs[i];
}
