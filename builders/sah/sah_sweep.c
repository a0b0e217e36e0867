/* Full-sweep SAH (with the cost of Goldsmith and Salmon 1987; MacDonald and Booth 1990): along each
 * axis, in the order of the centroids, every position between two primitives is a candidate. The
 * three orders are sorted once and split stably (Wald and Havran 2006), so the build takes n log n
 * steps in all.
 *
 *   from the right: area times count of the primitives i ... end
 *   from the left:  the same for begin ... i - 1; the cost of a split before i is the sum of both
 */
#include "sah_split.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static int compare_keys(const void *a, const void *b)
{
    uint64_t x, y;
    memcpy(&x, a, sizeof x);
    memcpy(&y, b, sizeof y);
    return (x > y) - (x < y);
}

/* Returns an integer of the same order as the float; -0 and 0 are equal. */
static uint32_t sortable(float value)
{
    uint32_t bits;
    value += 0.0f;
    memcpy(&bits, &value, sizeof bits);
    return bits & 0x80000000u ? ~bits : bits | 0x80000000u;
}

bb_status bb_sah_presort(bb_sah_state *state, bb_account *account)
{
    uint64_t *keys = NULL;
    BB_TRY(bb_host_alloc(account, state->count * sizeof *keys, "sah: sort keys", &keys));
    for (int axis = 0; axis < 3; axis++) {
        for (uint32_t i = 0; i < state->count; i++)
            keys[i] = (uint64_t)sortable(state->centroids[3 * (size_t)i + axis]) << 32 | i;
        qsort(keys, state->count, sizeof *keys, compare_keys);
        for (uint32_t i = 0; i < state->count; i++)
            state->order[axis][i] = (uint32_t)keys[i];
    }
    bb_host_free(keys);
    return BB_OK;
}

/* Compares the positions of one axis with the best so far. */
static void try_axis(const bb_sah_state *state, uint32_t begin, uint32_t end, int axis,
                     bb_sah_split *best)
{
    const uint32_t *order = state->order[axis];
    double *right_costs = state->right_costs;
    float lo[3] = {INFINITY, INFINITY, INFINITY}, hi[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (uint32_t i = end; i-- > begin + 1;) {
        const bb_box *box = &state->boxes[order[i]];
        bb_sah_grow(lo, hi, box->lo, box->hi);
        right_costs[i] = bb_half_area(lo, hi) * (end - i);
    }
    for (int k = 0; k < 3; k++) {
        lo[k] = INFINITY;
        hi[k] = -INFINITY;
    }
    for (uint32_t i = begin + 1; i < end; i++) {
        const bb_box *box = &state->boxes[order[i - 1]];
        bb_sah_grow(lo, hi, box->lo, box->hi);
        double cost = bb_half_area(lo, hi) * (i - begin) + right_costs[i];
        if (bb_sah_better(cost, i - begin, end - begin, best))
            *best = (bb_sah_split){.cost = cost, .left = i - begin, .axis = axis};
    }
}

bb_sah_split bb_sah_find_sweep(const bb_sah_state *state, uint32_t begin, uint32_t end)
{
    bb_sah_split best = {0};
    for (int axis = 0; axis < 3; axis++) {
        const uint32_t *order = state->order[axis];
        float first = state->centroids[3 * (size_t)order[begin] + axis];
        float last = state->centroids[3 * (size_t)order[end - 1] + axis];
        if (first != last)
            try_axis(state, begin, end, axis, &best);
    }
    return best;
}

void bb_sah_partition_sweep(bb_sah_state *state, uint32_t begin, uint32_t end,
                            const bb_sah_split *split)
{
    const uint32_t *sorted = state->order[split->axis];
    for (uint32_t i = begin; i < end; i++)
        state->goes_left[sorted[i]] = i - begin < split->left;
    for (int axis = 0; axis < 3; axis++) {
        if (axis == split->axis)
            continue;
        uint32_t *order = state->order[axis], left = begin, right = 0;
        for (uint32_t i = begin; i < end; i++) {
            uint32_t prim = order[i];
            if (state->goes_left[prim])
                order[left++] = prim;
            else
                state->scratch[right++] = prim;
        }
        memcpy(order + left, state->scratch, right * sizeof *order);
    }
}
