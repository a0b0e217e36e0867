/* Codes of all boxes. codes.h says what a code is, codes.clh how a key is made and what the -D are.
 *
 *   for each BB_CODE_LANES primitives i, in parallel: key[i] = code(box[i]), value[i] = i
 *   before, if the host does not read the scene's bounds: the plan for them            (code_place)
 *
 * Limits: 2^31 - 1 primitives.
 */
#include "bb_device.h"
#include "codes.clh"

#if BB_CODE_LANES == 8
/* Word `word` of eight boxes. */
float8 eight(global const float *words, uint word)
{
    words += word;
    return (float8)(words[0], words[8], words[16], words[24], words[32], words[40], words[48],
                    words[56]);
}
#endif

#ifdef cl_khr_fp64
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
/* Completes the plan from the bounds, like bb_code_lay_out() of codes.c, in one work-item. Not for
 * codes with size bits. */
kernel void code_place(global const bb_box *bounds, uint centroids, uint cube,
                       global bb_code_plan *plan)
{
    global const bb_box *box = bounds + centroids;
    double whole[3], all = 0;
    for (uint k = 0; k < 3; k++) {
        whole[k] = (double)box->hi[k] - (double)box->lo[k];
        all = BB_MAX(whole[k], all);
    }
    for (uint k = 0; k < 3; k++) {
        double extent = cube != 0u ? all : whole[k], last = (double)plan->last[k];
        double scale = (last + 1.0) / extent;
        plan->low[k] = box->lo[k];
        plan->scale[k] = extent > 0 && last > 0 && scale <= FLT_MAX ? (float)scale : 0.0f;
    }
}
#endif

kernel void code_keys(global const bb_box *restrict boxes, uint count,
                      global const bb_code_plan *restrict plan, global const ulong *restrict tables,
                      global bb_key *restrict keys, global uint *restrict values)
{
    uint i = get_global_id(0) * BB_CODE_LANES;
    if (i >= count)
        return;
    bb_code_boxes b;
#if BB_CODE_LANES == 8
    if (count - i >= 8u) {
        global const float *words = (global const float *)(boxes + i);
#pragma unroll
        for (uint axis = 0; axis < 3; axis++) {
            b.lo[axis] = eight(words, axis);
            b.hi[axis] = eight(words, 4u + axis);
        }
        vstore8(bb_code_of(plan, tables, &b), i >> 3, keys);
        vstore8(i + (uint8)(0, 1, 2, 3, 4, 5, 6, 7), i >> 3, values);
        return;
    }
#endif
    for (; i < count && i < (get_global_id(0) + 1) * BB_CODE_LANES; i++) {
        for (uint axis = 0; axis < 3; axis++) {
            b.lo[axis] = (bb_floats)boxes[i].lo[axis];
            b.hi[axis] = (bb_floats)boxes[i].hi[axis];
        }
#if BB_CODE_LANES == 8
        keys[i] = bb_code_of(plan, tables, &b).s0;
#else
        keys[i] = bb_code_of(plan, tables, &b);
#endif
        values[i] = i;
    }
}
