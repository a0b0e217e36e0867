/* Splits by priority (Karras, Aila 2013, "Fast Parallel Construction of High-Quality Bounding
 * Volume Hierarchies"; see presplit.c).
 *
 *   for each triangle: p = (2^-level (area of its box - area of ideal boxes))^(1/3) (ps_priorities)
 *   for some D: sum of min(floor(D p), PS_MOST), by chunks; host: the largest D within beta n
 *                                                                                        (ps_sums)
 *   for each primitive: the number of its splits at D, scanned                         (ps_counts)
 *   for each primitive: split its box and the halves that many times                    (ps_split)
 *
 * The level is that of the most important plane of the Morton grid through the box: 0 for the plane
 * that halves the scene, 1 for the planes that halve the halves. Sums are of integers, and
 * priorities use only products and differences.
 *
 * A split is at that plane, or else in the middle of the longest side. Each half holds the vertices
 * on its side and the points where edges cross the plane, rounded outwards, within the box that is
 * split. The remaining splits are distributed by the longest sides of the halves. The references of
 * a primitive are written one after the other; those that still have to be split wait in their
 * places, so no stack is needed.
 *
 * `keeps` is our addition: a triangle has no priority if its first split leaves more than the share
 * `keeps` of its box's area. Without it most splits are spent on walls, whose halves are flat and
 * as full as the whole: more nodes with no gain.
 *
 * Only triangles are split: other kinds do not fit their halves better than a box does.
 */
#include "bb_device.h"
#include "presplit_shared.h"

/* Shorter edges are not cut, and smaller boxes not split: divisors must not be denormal. */
#define PS_SHORT 0x1p-100f

typedef struct ps_part {
    float lo[3], hi[3];
} ps_part;

ps_part ps_load(global const bb_box *box)
{
    ps_part part;
    for (int k = 0; k < 3; k++) {
        part.lo[k] = box->lo[k];
        part.hi[k] = box->hi[k];
    }
    return part;
}

void ps_store(global bb_box *box, ps_part part, uint splits)
{
    for (int k = 0; k < 3; k++) {
        box->lo[k] = part.lo[k] + 0.0f; /* no -0 */
        box->hi[k] = part.hi[k] + 0.0f;
    }
    box->pad0 = splits;
    box->pad1 = 0;
}

/* Returns half of a side, which cannot overflow. */
float ps_half_side(const ps_part *part, int axis)
{
    return 0.5f * part->hi[axis] - 0.5f * part->lo[axis];
}

float ps_place(uint cell, ps_grid grid, int axis)
{
    return grid.lo[axis] + (float)cell * grid.step[axis];
}

/* Returns the last cell that begins at or before x; with `below`, before x. Cells' positions
 * decide, whatever the rounding of the quotient. */
uint ps_cell(float x, bool below, ps_grid grid, int axis)
{
    float last = (float)((1 << PS_GRID_BITS) - 1);
    uint cell = (uint)BB_MAX(BB_MIN((x - grid.lo[axis]) * grid.per_unit[axis], last), 0.0f);
    float next = ps_place(cell + 1u, grid, axis), own = ps_place(cell, grid, axis);
    if (below ? next < x : next <= x)
        return BB_MIN(cell + 1u, (uint)last);
    return (below ? own < x : own <= x) || cell == 0 ? cell : cell - 1u;
}

/* Finds the most important plane of the grid through the box: returns its level, or PS_GRID_BITS if
 * there is none, and sets axis and cell. Among planes of equal level the lowest axis wins. */
uint ps_plane(const ps_part *part, ps_grid grid, int *axis, uint *cell)
{
    uint most = 0;
    for (int k = 0; k < 3; k++) {
        uint low = ps_cell(part->lo[k], false, grid, k);
        uint high = ps_cell(part->hi[k], true, grid, k);
        uint bit = low < high ? 32u - clz(low ^ high) : 0;
        if (bit > most) {
            most = bit;
            *axis = k;
            *cell = high >> (bit - 1u) << (bit - 1u);
        }
    }
    return PS_GRID_BITS - most;
}

void ps_corners(global const uint *indices, global const float *vertices, uint i, float v[3][3])
{
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < 3; k++)
            v[c][k] = vertices[3u * (size_t)indices[3u * (size_t)i + c] + k];
}

/* ---- one split ---- */

void ps_include(ps_part *part, const float *lo, const float *hi)
{
    for (int k = 0; k < 3; k++) {
        part->lo[k] = BB_MIN(lo[k], part->lo[k]);
        part->hi[k] = BB_MAX(hi[k], part->hi[k]);
    }
}

/* Computes where the edge from a to b crosses the plane, as a box: a[axis] < plane < b[axis].
 *
 * With u = 2^-24 and a quotient that may be off by 2.5 ulp, the parameter is off by 8u of itself,
 * so a coordinate by 10u times that of the edge, and u times itself; `error` is more. */
void ps_cross(const float *a, const float *b, int axis, float plane, float *lo, float *hi)
{
    float whole = 0.5f * b[axis] - 0.5f * a[axis];
    float t = (0.5f * plane - 0.5f * a[axis]) / whole;
    for (int k = 0; k < 3; k++) {
        float half_edge = 0.5f * b[k] - 0.5f * a[k], step = t * half_edge;
        float at = a[k] + step + step;
        float error = fabs(half_edge) * 0x1p-19f + 0x1p-125f +
                      (fabs(a[k]) * 0x1p-22f + fabs(b[k]) * 0x1p-22f);
        float low = BB_MIN(a[k], b[k]), high = BB_MAX(a[k], b[k]);
        lo[k] = whole > PS_SHORT ? BB_MAX(at - error, low) : low;
        hi[k] = whole > PS_SHORT ? BB_MIN(at + error, high) : high;
    }
    lo[axis] = hi[axis] = plane;
}

bool ps_within(ps_part *part, const ps_part *box)
{
    bool any = true;
    for (int k = 0; k < 3; k++) {
        part->lo[k] = BB_MAX(part->lo[k], box->lo[k]);
        part->hi[k] = BB_MIN(part->hi[k], box->hi[k]);
        any = any && part->lo[k] <= part->hi[k];
    }
    return any;
}

/* Computes the parts of the triangle in `box` on both sides of the plane. Returns bit 0 if there is
 * a part below, bit 1 if there is one above; at least one is set. */
uint ps_cut(float v[3][3], const ps_part *box, int axis, float plane, ps_part *below,
            ps_part *above)
{
    for (int k = 0; k < 3; k++) {
        below->lo[k] = above->lo[k] = INFINITY;
        below->hi[k] = above->hi[k] = -INFINITY;
    }
    for (int c = 0; c < 3; c++) {
        const float *a = v[c], *b = v[c == 2 ? 0 : c + 1];
        if (a[axis] <= plane)
            ps_include(below, a, a);
        if (a[axis] >= plane)
            ps_include(above, a, a);
        bool rises = a[axis] < b[axis];
        const float *low = rises ? a : b, *high = rises ? b : a;
        if (low[axis] < plane && plane < high[axis]) {
            float lo[3], hi[3];
            ps_cross(low, high, axis, plane, lo, hi);
            ps_include(below, lo, hi);
            ps_include(above, lo, hi);
        }
    }
    below->hi[axis] = BB_MIN(below->hi[axis], plane);
    above->lo[axis] = BB_MAX(above->lo[axis], plane);
    return (ps_within(below, box) ? 1u : 0u) | (ps_within(above, box) ? 2u : 0u);
}

float ps_longest(const ps_part *part, int *axis)
{
    float longest = ps_half_side(part, 0);
    *axis = 0;
    for (int k = 1; k < 3; k++)
        if (ps_half_side(part, k) > longest) {
            longest = ps_half_side(part, k);
            *axis = k;
        }
    return longest;
}

/* Sets axis and plane of the split; returns false if no float lies between the ends. */
bool ps_choose(const ps_part *box, ps_grid grid, int *axis, float *plane)
{
    uint cell;
    if (ps_plane(box, grid, axis, &cell) < PS_GRID_BITS) {
        *plane = ps_place(cell, grid, *axis);
        if (box->lo[*axis] < *plane && *plane < box->hi[*axis])
            return true;
    }
    if (ps_longest(box, axis) < PS_SHORT)
        return false;
    *plane = 0.5f * box->lo[*axis] + 0.5f * box->hi[*axis];
    return box->lo[*axis] < *plane && *plane < box->hi[*axis];
}

/* ---- priorities ---- */

/* Newton's iteration for x^(-1/3), which needs no division; the first guess uses the exponent. */
float ps_cube_root(float x)
{
    float y = as_float(0x54A21D2Au - as_uint(x) / 3u);
    for (int i = 0; i < 4; i++)
        y = y * (1.33333337f - 0.333333343f * (x * y) * (y * y));
    return x * (y * y);
}

float ps_half_area(const ps_part *part, float unit)
{
    return bb_half_area(part->hi[0] * unit - part->lo[0] * unit,
                        part->hi[1] * unit - part->lo[1] * unit,
                        part->hi[2] * unit - part->lo[2] * unit);
}

/* Returns the limit of the total area of boxes of ever smaller parts: three times two sides of the
 * triangle's projections. */
float ps_ideal_area(float v[3][3], float unit)
{
    float d[3], e[3];
    for (int k = 0; k < 3; k++) {
        d[k] = v[1][k] * unit - v[0][k] * unit;
        e[k] = v[2][k] * unit - v[0][k] * unit;
    }
    return fabs(d[1] * e[2] - d[2] * e[1]) + fabs(d[2] * e[0] - d[0] * e[2]) +
           fabs(d[0] * e[1] - d[1] * e[0]);
}

/* Returns whether the halves of the box have less than `keeps` of its area together. */
bool ps_saves(float v[3][3], const ps_part *box, ps_grid grid, float keeps)
{
    ps_part below, above;
    int axis;
    float plane;
    return ps_choose(box, grid, &axis, &plane) &&
           ps_cut(v, box, axis, plane, &below, &above) == 3u &&
           ps_half_area(&below, grid.unit) + ps_half_area(&above, grid.unit) <=
               keeps * ps_half_area(box, grid.unit);
}

kernel void ps_priorities(global const bb_box *boxes, global const uint *indices,
                          global const float *vertices, uint triangles, uint count, ps_grid grid,
                          float keeps, global float *priorities)
{
    uint i = get_global_id(0);
    if (i >= count)
        return;
    float priority = 0.0f;
    if (i < triangles) {
        ps_part box = ps_load(boxes + i);
        float v[3][3];
        int axis;
        uint cell, level = ps_plane(&box, grid, &axis, &cell);
        ps_corners(indices, vertices, i, v);
        float excess = 2.0f * ps_half_area(&box, grid.unit) - ps_ideal_area(v, grid.unit);
        excess *= as_float((127u - level) << 23);
        if (excess >= 0x1p-120f && ps_saves(v, &box, grid, keeps))
            priority = ps_cube_root(excess);
    }
    priorities[i] = priority;
}

/* ---- how many splits ---- */

uint ps_splits(float priority, float d)
{
    return (uint)BB_MIN(priority * d, (float)PS_MOST);
}

/* sums[chunk]: number of splits for each D. */
kernel void ps_sums(global const float *priorities, uint count, uint chunk, ps_tries tries,
                    global uint *sums)
{
    uint number = get_global_id(0), begin = number * chunk;
    if (begin >= count)
        return;
    uint end = BB_MIN(count - begin, chunk) + begin;
    float16 d = vload16(0, tries.d);
    uint16 sum = 0;
    for (uint i = begin; i < end; i++) {
        float priority = priorities[i];
        if (priority * tries.d[PS_TRIES - 1] >= 1.0f)
            sum += convert_uint16(BB_MIN(priority * d, (float16)((float)PS_MOST)));
    }
    vstore16(sum, number, sums);
}

kernel void ps_counts(global const float *priorities, uint count, float d, global uint *splits)
{
    uint i = get_global_id(0);
    if (i < count)
        splits[i] = ps_splits(priorities[i], d);
}

/* ---- splitting ---- */

/* Returns how many of `splits` the part below gets. */
uint ps_share(const ps_part *below, const ps_part *above, uint splits)
{
    int axis;
    float low = ps_longest(below, &axis), high = ps_longest(above, &axis), sum = low + high;
    float share = sum > 0.0f ? low / sum : 0.5f;
    return BB_MIN((uint)((float)splits * share + 0.5f), splits);
}

/* Writes the splits + 1 parts of primitive i to references[i + places[i] ...] and to prims there.
 * pad0 of a part that still has to be split: number of its splits. */
kernel void ps_split(global const bb_box *boxes, global const uint *indices,
                     global const float *vertices, uint count, ps_grid grid,
                     global const float *priorities, float d, global const uint *places,
                     global bb_box *references, global uint *prims)
{
    uint i = get_global_id(0);
    if (i >= count)
        return;
    uint at = i + places[i], splits = ps_splits(priorities[i], d), last = at + splits;
    ps_part box = ps_load(boxes + i);
    float v[3][3];
    if (splits > 0)
        ps_corners(indices, vertices, i, v);
    for (;;) {
        /* a split that leaves everything on one side shrinks the box and does not count */
        for (uint tries = 0; splits > 0 && tries < 64; tries++) {
            ps_part below, above;
            int axis;
            float plane;
            if (!ps_choose(&box, grid, &axis, &plane))
                break;
            uint sides = ps_cut(v, &box, axis, plane, &below, &above);
            box = (sides & 1u) != 0 ? below : above;
            if (sides != 3u)
                continue;
            tries = 0;
            uint share = ps_share(&below, &above, splits - 1u);
            ps_store(references + at + share + 1u, above, splits - 1u - share);
            splits = share;
        }
        /* a box that cannot be split is listed as often as there are places */
        for (;; splits--) {
            ps_store(references + at, box, 0);
            prims[at++] = i;
            if (splits == 0)
                break;
        }
        if (at > last)
            return;
        box = ps_load(references + at);
        splits = references[at].pad0;
    }
}
