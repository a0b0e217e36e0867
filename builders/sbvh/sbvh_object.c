/* Object splits: binned SAH (Wald 2007) over the references' centroids.
 *
 *   for each reference, on each axis: bin k = K (c - low) / extent; count[k]++; box[k] grows
 *   from the right: boxes and counts of the bins k ... K - 1
 *   from the left:  those of 0 ... k - 1; cost of plane k = A(left) left + A(right) right
 */
#include "sbvh_split.h"

#include <math.h>
#include <string.h>

typedef struct bin {
    sb_bounds box;
    uint32_t count;
} bin;

static uint32_t bin_of(float centroid, float low, double scale, uint32_t bins)
{
    uint32_t index = (uint32_t)(((double)centroid - low) * scale);
    return index < bins ? index : bins - 1; /* the highest centroid is on the last border */
}

/* Returns whether a split is cheaper, or equally cheap and more balanced: otherwise boxes of area 0
 * would make a chain. */
static bool is_better(double cost, uint32_t left, uint32_t count, const sb_split *best)
{
    if (best->left == 0 || cost != best->cost)
        return best->left == 0 || cost < best->cost;
    uint32_t smaller = left < count - left ? left : count - left;
    return smaller > (best->left < best->right ? best->left : best->right);
}

static void try_axis(const bin *bins, uint32_t bin_count, uint32_t count, sb_split candidate,
                     sb_split *best)
{
    bin right[SB_BINS_MAX + 1];
    right[bin_count] = (bin){sb_nothing(), 0};
    for (uint32_t k = bin_count; k-- > 1;) {
        right[k] = right[k + 1];
        sb_grow(&right[k].box, &bins[k].box);
        right[k].count += bins[k].count;
    }
    bin left = {sb_nothing(), 0};
    for (uint32_t k = 1; k < bin_count; k++) {
        if (bins[k - 1].count == 0) /* separates the same references as the plane before */
            continue;
        sb_grow(&left.box, &bins[k - 1].box);
        left.count += bins[k - 1].count;
        double cost = sb_area(&left.box) * left.count + sb_area(&right[k].box) * right[k].count;
        if (left.count == count || !is_better(cost, left.count, count, best))
            continue;
        candidate.cost = cost;
        candidate.left = left.count;
        candidate.right = count - left.count;
        candidate.sides[0] = left.box;
        candidate.sides[1] = right[k].box;
        candidate.bin = k;
        *best = candidate;
    }
}

sb_split sb_find_object(const sb_ref *refs, uint32_t count, uint32_t bins)
{
    bin table[3][SB_BINS_MAX];
    sb_bounds centroids = sb_nothing();
    double scale[3];
    for (uint32_t i = 0; i < count; i++) {
        sb_bounds at;
        for (int axis = 0; axis < 3; axis++)
            at.lo[axis] = at.hi[axis] = sb_centroid(&refs[i], axis);
        sb_grow(&centroids, &at);
    }
    for (int axis = 0; axis < 3; axis++) {
        double extent = (double)centroids.hi[axis] - centroids.lo[axis];
        scale[axis] = extent > 0 ? bins / extent : 0;
        for (uint32_t k = 0; k < bins; k++)
            table[axis][k] = (bin){sb_nothing(), 0};
    }
    for (uint32_t i = 0; i < count; i++)
        for (int axis = 0; axis < 3; axis++) {
            bin *b = &table[axis][bin_of(sb_centroid(&refs[i], axis), centroids.lo[axis],
                                         scale[axis], bins)];
            sb_grow(&b->box, &refs[i].box);
            b->count++;
        }
    sb_split best = {.left = 0};
    for (int axis = 0; axis < 3; axis++)
        if (scale[axis] > 0)
            try_axis(table[axis], bins, count,
                     (sb_split){.axis = axis, .low = centroids.lo[axis], .scale = scale[axis]},
                     &best);
    return best;
}

void sb_part_object(sb_ref *refs, uint32_t count, const sb_split *split, uint32_t bins,
                    sb_ref *scratch)
{
    uint32_t right = 0, left = 0;
    for (uint32_t i = 0; i < count; i++)
        if (bin_of(sb_centroid(&refs[i], split->axis), split->low, split->scale, bins) < split->bin)
            scratch[left++] = refs[i];
        else
            refs[right++] = refs[i];
    memcpy(refs + right, scratch, left * sizeof *refs);
}
