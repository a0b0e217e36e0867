/* Binned SAH (Wald: On fast construction of SAH-based bounding volume hierarchies, RT 2007): on
 * each axis, the centroids are counted into K bins of equal width over their extent; the K - 1
 * planes between bins are the candidates.
 *
 *   for each primitive: bin k = K (c - low) / extent; count[k]++; box[k] grows
 *   from the right: area times count of the bins k ... K - 1
 *   from the left:  the same for bins 0 ... k - 1; the cost of plane k is the sum of both
 */
#include "sah_split.h"

#include <assert.h>
#include <math.h>
#include <string.h>

enum { BINS_MAX = 256 };

typedef struct bin {
    float lo[3], hi[3];
    uint32_t count;
} bin;

static uint32_t bin_of(float centroid, float low, double scale, uint32_t bins)
{
    uint32_t index = (uint32_t)(((double)centroid - low) * scale);
    return index < bins ? index : bins - 1; /* the highest centroid is on the last border */
}

/* Adds a box of `count` primitives. The box of an empty bin is undefined. */
static void add(bin *into, const float lo[3], const float hi[3], uint32_t count)
{
    if (into->count == 0) {
        memcpy(into->lo, lo, sizeof into->lo);
        memcpy(into->hi, hi, sizeof into->hi);
    } else {
        bb_sah_grow(into->lo, into->hi, lo, hi);
    }
    into->count += count;
}

/* Compares the planes between the bins of one axis with the best so far. A plane beside an empty
 * bin separates the same primitives as its neighbour, so only planes right of non-empty bins are
 * tried. */
static void try_axis(const bin *bins, uint32_t bin_count, uint32_t count, bb_sah_split candidate,
                     bb_sah_split *best)
{
    double right_costs[BINS_MAX + 1];
    bin side = {.count = 0};
    right_costs[bin_count] = 0.0;
    for (uint32_t k = bin_count; k-- > 1;) {
        right_costs[k] = right_costs[k + 1];
        if (bins[k].count == 0)
            continue;
        add(&side, bins[k].lo, bins[k].hi, bins[k].count);
        right_costs[k] = bb_half_area(side.lo, side.hi) * side.count;
    }
    side.count = 0;
    for (uint32_t k = 1; k < bin_count; k++) {
        if (bins[k - 1].count == 0)
            continue;
        add(&side, bins[k - 1].lo, bins[k - 1].hi, bins[k - 1].count);
        double cost = bb_half_area(side.lo, side.hi) * side.count + right_costs[k];
        if (side.count == count || !bb_sah_better(cost, side.count, count, best))
            continue;
        candidate.cost = cost;
        candidate.left = side.count;
        candidate.bin = k;
        *best = candidate;
    }
}

bb_sah_split bb_sah_find_binned(const bb_sah_state *state, uint32_t begin, uint32_t end)
{
    assert(state->bins <= BINS_MAX);
    const uint32_t *order = state->order[0];
    float lo[3] = {INFINITY, INFINITY, INFINITY}, hi[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (uint32_t i = begin; i < end; i++) {
        const float *c = state->centroids + 3 * (size_t)order[i];
        bb_sah_grow(lo, hi, c, c);
    }
    bin bins[3][BINS_MAX];
    double scale[3];
    for (int axis = 0; axis < 3; axis++) {
        bool flat = lo[axis] == hi[axis];
        scale[axis] = flat ? 0.0 : state->bins / ((double)hi[axis] - lo[axis]);
        for (uint32_t k = 0; k < state->bins; k++)
            bins[axis][k].count = 0;
    }
    for (uint32_t i = begin; i < end; i++) {
        const bb_box *box = &state->boxes[order[i]];
        const float *c = state->centroids + 3 * (size_t)order[i];
        for (int axis = 0; axis < 3; axis++)
            add(&bins[axis][bin_of(c[axis], lo[axis], scale[axis], state->bins)], box->lo, box->hi,
                1);
    }
    bb_sah_split best = {0};
    for (int axis = 0; axis < 3; axis++)
        if (scale[axis] > 0.0)
            try_axis(bins[axis], state->bins, end - begin,
                     (bb_sah_split){.axis = axis, .low = lo[axis], .scale = scale[axis]}, &best);
    return best;
}

void bb_sah_partition_binned(bb_sah_state *state, uint32_t begin, uint32_t end,
                             const bb_sah_split *split)
{
    uint32_t *order = state->order[0], left = begin, right = 0;
    for (uint32_t i = begin; i < end; i++) {
        uint32_t prim = order[i];
        float centroid = state->centroids[3 * (size_t)prim + split->axis];
        if (bin_of(centroid, split->low, split->scale, state->bins) < split->bin)
            order[left++] = prim;
        else
            state->scratch[right++] = prim;
    }
    memcpy(order + left, state->scratch, right * sizeof *order);
}
