/* Splits by priority (Karras, Aila 2013) by a plain reading of what builders/presplit/presplit.cl
 * says of them, in doubles: which plane, what a triangle's priority is, into which parts it
 * goes. */
#ifndef BB_TEST_PRESPLIT_REFERENCE_H
#define BB_TEST_PRESPLIT_REFERENCE_H

#include "framework/scene/scene.h"

#include "builders/presplit/presplit_shared.h"

#include <math.h>

typedef struct parts {
    bb_box boxes[PS_MOST + 1];
    uint32_t count;
    bool close; /* a decision hangs on the last bits: margins of what is rounded outwards tell */
} parts;

typedef struct definition {
    const bb_scene *scene;
    double lo[3], step[3];
    double unit, saves;
} definition;

static inline definition define(const bb_scene *scene, double saves)
{
    definition d = {.scene = scene, .unit = 1, .saves = saves};
    double longest = 0;
    for (int k = 0; k < 3; k++) {
        double lo = INFINITY, hi = -INFINITY;
        for (uint32_t i = 0; i < scene->prim_count; i++) {
            lo = fmin(lo, scene->boxes[i].lo[k]);
            hi = fmax(hi, scene->boxes[i].hi[k]);
        }
        d.lo[k] = lo;
        d.step[k] = (float)((hi - lo) / (1 << PS_GRID_BITS));
        longest = fmax(longest, hi - lo);
    }
    while (longest * d.unit >= 1)
        d.unit /= 2;
    while (longest * d.unit < 0.5)
        d.unit *= 2;
    return d;
}

/* Of all planes through the box that of the least level, then axis: tries them from the root. */
static inline int plane_of(const definition *d, const bb_box *box, int *axis, double *plane)
{
    for (int level = 0; level < PS_GRID_BITS; level++)
        for (int k = 0; k < 3; k++) {
            uint32_t width = 1u << (PS_GRID_BITS - 1 - level);
            for (uint32_t cell = width; cell < 1u << PS_GRID_BITS; cell += 2 * width) {
                double at = d->lo[k] + cell * d->step[k];
                if (box->lo[k] < (float)at && (float)at < box->hi[k]) {
                    *axis = k;
                    *plane = (float)at;
                    return level;
                }
            }
        }
    return PS_GRID_BITS;
}

static inline double longest_of(const bb_box *box)
{
    double longest = 0;
    for (int k = 0; k < 3; k++)
        longest = fmax(longest, (double)box->hi[k] - box->lo[k]);
    return longest;
}

/* The part of a triangle on one side of a plane, in a box. */
static inline bb_box side_of(const bb_scene *scene, uint32_t prim, const bb_box *box, int axis,
                             double plane, double sign)
{
    double lo[3] = {INFINITY, INFINITY, INFINITY}, hi[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (uint32_t c = 0; c < 3; c++) {
        const float *a = bb_scene_vertex(scene, prim, c);
        const float *b = bb_scene_vertex(scene, prim, (c + 1) % 3);
        double t = (plane - a[axis]) / ((double)b[axis] - a[axis]);
        for (int k = 0; k < 3; k++) {
            if (sign * a[axis] <= sign * plane) {
                lo[k] = fmin(lo[k], a[k]);
                hi[k] = fmax(hi[k], a[k]);
            }
            if (t > 0 && t < 1) {
                lo[k] = fmin(lo[k], a[k] + t * ((double)b[k] - a[k]));
                hi[k] = fmax(hi[k], a[k] + t * ((double)b[k] - a[k]));
            }
        }
    }
    bb_box side = *box;
    for (int k = 0; k < 3; k++) {
        side.lo[k] = fmaxf(side.lo[k], (float)lo[k]);
        side.hi[k] = fminf(side.hi[k], (float)hi[k]);
    }
    return side;
}

static inline void choose(const definition *d, const bb_box *box, int *axis, double *plane)
{
    if (plane_of(d, box, axis, plane) < PS_GRID_BITS)
        return;
    *axis = 0;
    for (int k = 1; k < 3; k++)
        if (box->hi[k] - box->lo[k] > box->hi[*axis] - box->lo[*axis])
            *axis = k;
    *plane = 0.5f * box->lo[*axis] + 0.5f * box->hi[*axis];
}

static inline bool saves(const definition *d, uint32_t prim)
{
    const bb_box *box = &d->scene->boxes[prim];
    double plane;
    int axis;
    choose(d, box, &axis, &plane);
    bb_box below = side_of(d->scene, prim, box, axis, plane, 1);
    bb_box above = side_of(d->scene, prim, box, axis, plane, -1);
    return bb_half_area(below.lo, below.hi) + bb_half_area(above.lo, above.hi) <=
           (1 - d->saves) * bb_half_area(box->lo, box->hi);
}

static inline double priority_of(const definition *d, uint32_t prim)
{
    if (!saves(d, prim))
        return 0;
    const float *v[3];
    const bb_box *box = &d->scene->boxes[prim];
    double e[3], f[3], plane;
    int axis;
    for (uint32_t c = 0; c < 3; c++)
        v[c] = bb_scene_vertex(d->scene, prim, c);
    for (int k = 0; k < 3; k++) {
        e[k] = ((double)v[1][k] - v[0][k]) * d->unit;
        f[k] = ((double)v[2][k] - v[0][k]) * d->unit;
    }
    double ideal = fabs(e[1] * f[2] - e[2] * f[1]) + fabs(e[2] * f[0] - e[0] * f[2]) +
                   fabs(e[0] * f[1] - e[1] * f[0]);
    double excess = 2 * bb_half_area(box->lo, box->hi) * d->unit * d->unit - ideal;
    return cbrt(fmax(0, ldexp(excess, -plane_of(d, box, &axis, &plane))));
}

/* The shortest side; less than 0: there is nothing. */
static inline double shortest_of(const bb_box *box)
{
    double shortest = INFINITY;
    for (int k = 0; k < 3; k++)
        shortest = fmin(shortest, (double)box->hi[k] - box->lo[k]);
    return shortest;
}

static inline void split_by_definition(const definition *d, uint32_t prim, bb_box box,
                                       uint32_t splits, parts *out)
{
    while (splits > 0) {
        double plane;
        int axis;
        choose(d, &box, &axis, &plane);
        bb_box below = side_of(d->scene, prim, &box, axis, plane, 1);
        bb_box above = side_of(d->scene, prim, &box, axis, plane, -1);
        double thin = fmin(shortest_of(&below), shortest_of(&above));
        out->close = out->close || (thin != 0 && fabs(thin) < 1e-5 * longest_of(&box));
        if (thin < 0) {
            box = shortest_of(&below) < 0 ? above : below;
            continue;
        }
        double low = longest_of(&below), high = longest_of(&above);
        double exact = (splits - 1) * (low / (low + high)) + 0.5;
        uint32_t share = (uint32_t)floor(exact);
        out->close = out->close || fabs(exact - round(exact)) < 1e-4;
        split_by_definition(d, prim, below, share, out);
        box = above;
        splits -= 1 + share;
    }
    out->boxes[out->count++] = box;
}

#endif
