/* Types and functions that the parts of `sbvh` share: references, splits, and both ways to
 * split. */
#ifndef BB_SBVH_SPLIT_H
#define BB_SBVH_SPLIT_H

#include "framework/builder/tree.h"
#include "framework/scene/scene.h"

enum { SB_BINS_MAX = 256 };

/* A box, empty while lo > hi. */
typedef struct sb_bounds {
    float lo[3], hi[3];
} sb_bounds;

/* A primitive, or its part in a box. */
typedef struct sb_ref {
    sb_bounds box;
    uint32_t prim;
} sb_ref;

/* The best split of one kind: cost = A(left) left + A(right) right, with half areas. left = 0:
 * there is none. */
typedef struct sb_split {
    double cost;
    uint32_t left, right;
    sb_bounds sides[2];
    int axis;
    uint32_t bin; /* object split: bins below this one are on the left */
    float low;    /* object split: where the bins begin, and bins per unit of length */
    double scale;
    float plane; /* spatial split */
} sb_split;

static inline sb_bounds sb_nothing(void)
{
    const float most = __builtin_inff();
    return (sb_bounds){{most, most, most}, {-most, -most, -most}};
}

static inline void sb_grow(sb_bounds *box, const sb_bounds *more)
{
    for (int k = 0; k < 3; k++) {
        box->lo[k] = more->lo[k] < box->lo[k] ? more->lo[k] : box->lo[k];
        box->hi[k] = more->hi[k] > box->hi[k] ? more->hi[k] : box->hi[k];
    }
}

/* Returns half the area; 0 for an empty box. */
static inline double sb_area(const sb_bounds *box)
{
    return box->lo[0] <= box->hi[0] ? bb_half_area(box->lo, box->hi) : 0;
}

static inline float sb_centroid(const sb_ref *ref, int axis)
{
    return 0.5f * ref->box.lo[axis] + 0.5f * ref->box.hi[axis];
}

/* Cuts a reference at a plane that is strictly inside of its box. Each side gets a box of the
 * primitive's part there, never too small; an empty box if there is no part. Not for spheres. */
void sb_cut(const bb_scene *scene, const sb_ref *ref, int axis, float plane, sb_bounds sides[2]);

/* Returns whether a reference may be cut. Spheres stay whole: the kernels' test of a sphere is
 * proven only for boxes that hold all of it. */
static inline bool sb_can_cut(const bb_scene *scene, const sb_ref *ref)
{
    const bb_prims *spheres = &scene->prims[BB_SPHERE];
    return ref->prim - spheres->first >= spheres->count;
}

/* ---- object splits: sbvh_object.c ---- */

/* Finds the best plane between `bins` bins of centroids. */
sb_split sb_find_object(const sb_ref *refs, uint32_t count, uint32_t bins);

/* Moves the right side's references to the front and the left side's behind them, both in order.
 * `scratch` has room for `count`. */
void sb_part_object(sb_ref *refs, uint32_t count, const sb_split *split, uint32_t bins,
                    sb_ref *scratch);

/* ---- spatial splits: sbvh_spatial.c ---- */

/* Finds the best of the planes between `bins` slabs of `box` that make at most `spare` more
 * references.
 */
sb_split sb_find_spatial(const bb_scene *scene, const sb_ref *refs, uint32_t count,
                         const sb_bounds *box, uint32_t bins, uint32_t spare);

/* Partitions like sb_part_object(), for a spatial split: a reference across the plane is cut in two
 * or goes to one side whole, whichever is cheapest. refs[] and scratch[] have room for `spare`
 * more; once these are used up no more are cut. Sets split->left and split->right to the resulting
 * numbers; if one is 0, refs[] is unchanged. */
void sb_part_spatial(const bb_scene *scene, sb_ref *refs, uint32_t count, uint32_t spare,
                     sb_split *split, sb_ref *scratch);

#endif
