/* The running union of boxes and of their centroids, as the reductions of both forms use it.
 *
 * Minimum and maximum are exact, so the order does not matter, but for the sign of a zero: it is dropped at the end.
 * The boxes are finite with lo <= hi; the centroid is 0.5*lo + 0.5*hi, which can't overflow.
 */
#ifndef BB_SCENE_BOUNDS_H
#define BB_SCENE_BOUNDS_H

/* The fourth lane carries nothing. */
typedef struct scene_bounds {
    float4 lo;
    float4 hi;
    float4 centre_lo;
    float4 centre_hi;
} scene_bounds;

static float4 load_corner(__global const float *corner)
{
    return (float4)(corner[0], corner[1], corner[2], 0.0f);
}

static scene_bounds scene_bounds_empty(void)
{
    const scene_bounds empty = {(float4)(INFINITY), (float4)(-INFINITY), (float4)(INFINITY),
                                (float4)(-INFINITY)};
    return empty;
}

static scene_bounds scene_bounds_union(scene_bounds a, scene_bounds b)
{
    a.lo = BB_MIN(b.lo, a.lo);
    a.hi = BB_MAX(b.hi, a.hi);
    a.centre_lo = BB_MIN(b.centre_lo, a.centre_lo);
    a.centre_hi = BB_MAX(b.centre_hi, a.centre_hi);
    return a;
}

static scene_bounds scene_bounds_of(__global const bb_box *box)
{
    scene_bounds bounds;
    bounds.lo = load_corner(box->lo);
    bounds.hi = load_corner(box->hi);
    bounds.centre_lo = bounds.centre_hi = 0.5f * bounds.lo + 0.5f * bounds.hi;
    return bounds;
}

/* Partial results lie as two bb_box, the box of the boxes and that of the centroids. */
static scene_bounds scene_bounds_load(__global const bb_box *two)
{
    scene_bounds bounds;
    bounds.lo = load_corner(two[0].lo);
    bounds.hi = load_corner(two[0].hi);
    bounds.centre_lo = load_corner(two[1].lo);
    bounds.centre_hi = load_corner(two[1].hi);
    return bounds;
}

static void store_box(float4 lo, float4 hi, __global bb_box *box)
{
    /* -0 + 0 is +0: the result is the same bits whichever zero came first. */
    lo += 0.0f;
    hi += 0.0f;
    box->lo[0] = lo.x;
    box->lo[1] = lo.y;
    box->lo[2] = lo.z;
    box->pad0 = 0;
    box->hi[0] = hi.x;
    box->hi[1] = hi.y;
    box->hi[2] = hi.z;
    box->pad1 = 0;
}

static void scene_bounds_store(scene_bounds bounds, __global bb_box *two)
{
    store_box(bounds.lo, bounds.hi, &two[0]);
    store_box(bounds.centre_lo, bounds.centre_hi, &two[1]);
}

#endif
