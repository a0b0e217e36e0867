/* Types and functions shared by both ways of splitting. */
#ifndef BB_SAH_SPLIT_H
#define BB_SAH_SPLIT_H

#include "framework/builder/tree.h"

/* Primitives in the order of the future leaves, and scratch. Both ways keep every range in
 * ascending order of (their key, index) and partition it stably, so that the tree depends on
 * nothing but the input. */
typedef struct bb_sah_state {
    const bb_box *boxes;
    uint32_t count;
    uint32_t bins;
    float *centroids;    /* x y z per primitive */
    uint32_t *order[3];  /* binned: only order[0]; sweep: sorted by centroid, one per axis */
    uint32_t *scratch;   /* count */
    bool *goes_left;     /* sweep: per primitive */
    double *right_costs; /* sweep: per position, cost of the primitives from there to the end */
} bb_sah_state;

/* The cheapest split of a range, with `left` primitives on the left. cost = A(left) |left| +
 * A(right) |right|, with half areas. left = 0: the centroids are all equal, and no plane separates
 * them. */
typedef struct bb_sah_split {
    double cost;
    uint32_t left;
    int axis;
    uint32_t bin; /* binned: bins below this one are on the left */
    float low;    /* binned: where the bins begin, and bins per unit of length */
    double scale;
} bb_sah_split;

/* Finds the cheapest split of the primitives [begin, end). */
bb_sah_split bb_sah_find_binned(const bb_sah_state *state, uint32_t begin, uint32_t end);
bb_sah_split bb_sah_find_sweep(const bb_sah_state *state, uint32_t begin, uint32_t end);

/* Reorders [begin, end) so that the split's left primitives come first, stably. */
void bb_sah_partition_binned(bb_sah_state *state, uint32_t begin, uint32_t end,
                             const bb_sah_split *split);
void bb_sah_partition_sweep(bb_sah_state *state, uint32_t begin, uint32_t end,
                            const bb_sah_split *split);

/* sweep only: sorts order[0..2] by centroid, once. */
bb_status bb_sah_presort(bb_sah_state *state, bb_account *account);

/* Grows lo, hi by a box; an empty box is lo = +inf, hi = -inf. */
static inline void bb_sah_grow(float lo[3], float hi[3], const float box_lo[3],
                               const float box_hi[3])
{
    for (int axis = 0; axis < 3; axis++) {
        lo[axis] = box_lo[axis] < lo[axis] ? box_lo[axis] : lo[axis];
        hi[axis] = box_hi[axis] > hi[axis] ? box_hi[axis] : hi[axis];
    }
}

/* Returns whether a split of `count` primitives is preferred: cheaper, or equally cheap and more
 * balanced. Without the second rule, primitives whose boxes all have area 0 would make a chain. */
static inline bool bb_sah_better(double cost, uint32_t left, uint32_t count,
                                 const bb_sah_split *best)
{
    if (best->left == 0 || cost != best->cost)
        return best->left == 0 || cost < best->cost;
    uint32_t smaller = left < count - left ? left : count - left;
    uint32_t smallest = best->left < count - best->left ? best->left : count - best->left;
    return smaller > smallest;
}

#endif
