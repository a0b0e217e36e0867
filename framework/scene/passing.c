/* Seen along the ray a polygon is flat and the ray is the point (0, 0). Parts outside the interval
 * are cut off first (Sutherland and Hodgman 1974): the surface on which a ray starts is near the
 * ray's line, but behind its origin. */
#include "framework/scene/passing.h"

#include <math.h>
#include <stdbool.h>

typedef struct corner {
    double x, y, t;
} corner;

static corner see(const bb_frame *frame, const float v[3])
{
    corner c = {0, 0, 0};
    for (int k = 0; k < 3; k++) {
        double x = (double)v[k] - frame->o[k];
        c.x += x * frame->across[0][k];
        c.y += x * frame->across[1][k];
        c.t += x * (frame->d[k] / frame->length);
    }
    c.t /= frame->length;
    return c;
}

/* Keeps the part with sign * t >= sign * bound; returns its number of corners. */
static int cut(corner *corners, int count, double bound, double sign)
{
    corner kept[BB_OUTLINE_CORNERS + 1];
    int left = 0;
    for (int i = 0; i < count; i++) {
        corner p = corners[i], q = corners[(i + 1) % count];
        double a = sign * (p.t - bound), b = sign * (q.t - bound);
        if (a >= 0.0)
            kept[left++] = p;
        if ((a < 0.0) != (b < 0.0)) {
            double s = a / (a - b);
            kept[left++] = (corner){p.x + s * (q.x - p.x), p.y + s * (q.y - p.y), bound};
        }
    }
    for (int i = 0; i < left; i++)
        corners[i] = kept[i];
    return left;
}

static void see_all(const bb_frame *frame, const float *const *from, uint32_t count,
                    corner corners[BB_OUTLINE_CORNERS + 1])
{
    for (uint32_t i = 0; i < count; i++)
        corners[i] = see(frame, from[i]);
}

/* Cuts a polygon to the interval; returns its number of corners. */
static int cut_ends(corner corners[BB_OUTLINE_CORNERS + 1], uint32_t count, double from, double to)
{
    int left = cut(corners, (int)count, from, 1.0);
    return left > 0 ? cut(corners, left, to, -1.0) : 0;
}

static double distance_to_segment(corner p, corner q)
{
    double x = q.x - p.x, y = q.y - p.y, square = x * x + y * y;
    double s = square > 0.0 ? -(p.x * x + p.y * y) / square : 0.0;
    s = s < 0.0 ? 0.0 : s > 1.0 ? 1.0 : s;
    return hypot(p.x + s * x, p.y + s * y);
}

static double distance_to_polygon(const corner *corners, int count)
{
    double distance = INFINITY;
    int left = 0, right = 0;
    for (int i = 0; i < count; i++) {
        corner p = corners[i], q = corners[(i + 1) % count];
        double turn = p.x * q.y - p.y * q.x;
        left += turn > 0.0;
        right += turn < 0.0;
        distance = fmin(distance, distance_to_segment(p, q));
    }
    return count > 0 && (left == count || right == count) ? 0.0 : distance;
}

bb_passing bb_pass_ball(const bb_frame *frame, const float sphere[4], double from, double to)
{
    corner c = see(frame, sphere);
    double nearest = fmin(fmax(c.t, from), to), along = (c.t - nearest) * frame->length;
    double distance = hypot(hypot(c.x, c.y), along) - (double)sphere[3];
    return (bb_passing){fmax(0.0, distance), c.t, c.t};
}

bb_passing bb_pass_polygon(const bb_frame *frame, const float *const *corners, uint32_t count,
                           double from, double to)
{
    corner seen[BB_OUTLINE_CORNERS + 1];
    see_all(frame, corners, count, seen);
    bb_passing passing = {INFINITY, INFINITY, -INFINITY};
    for (uint32_t i = 0; i < count; i++) {
        passing.t_low = fmin(passing.t_low, seen[i].t);
        passing.t_high = fmax(passing.t_high, seen[i].t);
    }
    passing.distance = distance_to_polygon(seen, cut_ends(seen, count, from, to));
    return passing;
}

void bb_see_polygon(const bb_frame *frame, const float *const *corners, uint32_t count, double from,
                    double to, bb_outline *outline)
{
    corner seen[BB_OUTLINE_CORNERS + 1];
    see_all(frame, corners, count, seen);
    outline->count = (uint32_t)cut_ends(seen, count, from, to);
    for (uint32_t i = 0; i < outline->count; i++) {
        outline->corners[i][0] = seen[i].x;
        outline->corners[i][1] = seen[i].y;
    }
}
