/* Converts a tree over references into one over primitives.
 *
 *   refs[i] = prims[refs[i]], the last-bit kept
 *
 * Early split clipping (Ernst, Greiner: Early Split Clipping for Bounding Volume Hierarchies, 2007)
 * builds a tree over boxes of parts of primitives; leaves then name the primitives themselves.
 */
#include "bb_device.h"

kernel void map_references(global uint *refs, uint count, uint references, global const uint *prims)
{
    uint i = get_global_id(0);
    if (i >= count)
        return;
    uint ref = refs[i], at = ref & BB_INDEX_MASK;
    /* an invalid reference becomes an invalid primitive, which the tree's check reports */
    refs[i] = (at < references ? prims[at] : BB_INDEX_MASK) | (ref & BB_LAST_BIT);
}
