#include "framework/judge/open_way.h"

#include <math.h>
#include <stdlib.h>

enum { SIDES_MAX = 48 * BB_OUTLINE_CORNERS, PLACES_MAX = 1024 };

static const double together = 1e-6;             /* points this near to each other meet */
static const double same = 1e-9;                 /* points this near to each other are one place */
static const double steps[] = {0x1p-4, 0x1p-12}; /* distances of tested points from a place */

typedef struct side {
    double p[2], q[2];
} side;

typedef struct sides {
    side all[SIDES_MAX];
    uint32_t count;
} sides;

/* Places already tested: at a corner of many triangles all pairs of their sides cross. */
typedef struct places {
    double all[PLACES_MAX][2];
    uint32_t count;
} places;

static void collect(const bb_outline *outlines, uint32_t count, sides *s)
{
    s->count = 0;
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t c = 0; c < outlines[i].count && s->count < SIDES_MAX; c++) {
            const double *p = outlines[i].corners[c],
                         *q = outlines[i].corners[(c + 1) % outlines[i].count];
            s->all[s->count++] = (side){{p[0], p[1]}, {q[0], q[1]}};
        }
}

/* Computes the point of the side nearest to (x, y). */
static void nearest_on(const side *s, double x, double y, double out[2])
{
    double d[2] = {s->q[0] - s->p[0], s->q[1] - s->p[1]};
    double square = d[0] * d[0] + d[1] * d[1];
    double a = square > 0 ? ((x - s->p[0]) * d[0] + (y - s->p[1]) * d[1]) / square : 0;
    a = a < 0 ? 0 : a > 1 ? 1 : a;
    out[0] = s->p[0] + a * d[0];
    out[1] = s->p[1] + a * d[1];
}

static bool cross(const side *a, const side *b, double out[2])
{
    double u[2] = {a->q[0] - a->p[0], a->q[1] - a->p[1]};
    double v[2] = {b->q[0] - b->p[0], b->q[1] - b->p[1]};
    double w[2] = {b->p[0] - a->p[0], b->p[1] - a->p[1]};
    double turn = u[0] * v[1] - u[1] * v[0];
    double s = (w[0] * v[1] - w[1] * v[0]) / turn, t = (w[0] * u[1] - w[1] * u[0]) / turn;
    out[0] = a->p[0] + s * u[0];
    out[1] = a->p[1] + s * u[1];
    return s >= 0 && s <= 1 && t >= 0 && t <= 1; /* false for NaN */
}

static int compare_angles(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Collects the directions in which sides leave the place; a side that passes through has two. */
static uint32_t leave(const sides *s, const double at[2], double angles[2 * SIDES_MAX])
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < s->count; i++) {
        const side *one = &s->all[i];
        const double *ends[2] = {one->p, one->q};
        double nearest[2];
        nearest_on(one, at[0], at[1], nearest);
        if (hypot(nearest[0] - at[0], nearest[1] - at[1]) > together)
            continue;
        for (int end = 0; end < 2; end++)
            if (hypot(ends[end][0] - at[0], ends[end][1] - at[1]) > together)
                angles[count++] = atan2(ends[end][1] - at[1], ends[end][0] - at[0]);
    }
    qsort(angles, count, sizeof *angles, compare_angles);
    return count;
}

/* Returns whether the place is known, and notes it if there is room. */
static bool is_known(places *p, const double at[2])
{
    for (uint32_t i = 0; i < p->count; i++)
        if (fabs(p->all[i][0] - at[0]) <= same && fabs(p->all[i][1] - at[1]) <= same)
            return true;
    if (p->count < PLACES_MAX) {
        p->all[p->count][0] = at[0];
        p->all[p->count++][1] = at[1];
    }
    return false;
}

/* ---- the search ---- */

typedef struct hunt {
    const bb_cover *covers;
    uint32_t cover_count;
    bool (*is_open)(void *context, double x, double y);
    void *context;
    sides sides;
    places known;
} hunt;

/* Returns whether (x, y) is inside the convex outline, in either orientation. */
static bool is_inside(const bb_cover *cover, double x, double y)
{
    const bb_outline *outline = &cover->outline;
    double least = INFINITY, most = -INFINITY;
    for (uint32_t c = 0; c < outline->count; c++) {
        const double *p = outline->corners[c], *q = outline->corners[(c + 1) % outline->count];
        double d[2] = {q[0] - p[0], q[1] - p[1]}, length = hypot(d[0], d[1]);
        double distance = (d[0] * (y - p[1]) - d[1] * (x - p[0])) / length;
        if (!(length > 0)) /* a repeated corner bounds nothing */
            continue;
        least = fmin(least, distance);
        most = fmax(most, distance);
    }
    return outline->count > 2 && isfinite(least) && (least > cover->clear || most < -cover->clear);
}

static bool is_open_at(const hunt *h, double x, double y)
{
    for (uint32_t i = 0; i < h->cover_count; i++)
        if (is_inside(&h->covers[i], x, y))
            return false;
    return h->is_open(h->context, x, y);
}

static bool is_open_around(hunt *h, const double at[2])
{
    double angles[2 * SIDES_MAX];
    if (!(hypot(at[0], at[1]) < 1) || is_known(&h->known, at))
        return false;
    uint32_t count = leave(&h->sides, at, angles);
    for (uint32_t i = 0; i < count; i++) {
        double next = i + 1 < count ? angles[i + 1] : angles[0] + 2 * acos(-1);
        double middle = 0.5 * (angles[i] + next);
        for (uint32_t k = 0; k < sizeof steps / sizeof steps[0] && next > angles[i]; k++) {
            double x = at[0] + steps[k] * cos(middle), y = at[1] + steps[k] * sin(middle);
            if (hypot(x, y) <= 1 && is_open_at(h, x, y))
                return true;
        }
    }
    return false;
}

bool bb_find_open_way(const bb_outline *outlines, uint32_t count, const bb_cover *covers,
                      uint32_t cover_count, bool (*is_open)(void *context, double x, double y),
                      void *context)
{
    hunt h = {.covers = covers, .cover_count = cover_count, .is_open = is_open, .context = context};
    const sides *s = &h.sides;
    double at[2];
    collect(outlines, count, &h.sides);
    for (uint32_t i = 0; i < s->count; i++) {
        nearest_on(&s->all[i], 0, 0, at);
        if (is_open_around(&h, at) || is_open_around(&h, s->all[i].p))
            return true;
        for (uint32_t k = 0; k < i; k++)
            if (cross(&s->all[i], &s->all[k], at) && is_open_around(&h, at))
                return true;
    }
    return false;
}
