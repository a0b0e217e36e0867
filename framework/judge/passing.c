/* Seen along the ray a triangle is flat and the ray is the point (0, 0). What of it lies outside the
 * interval is cut off first (Sutherland and Hodgman 1974): a surface on which a ray starts is near the
 * ray's line, and behind its origin.
 */
#include "framework/judge/passing.h"

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

/* Keeps what has sign * t >= sign * bound; how many corners are left. */
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

static void see_triangle(const bb_frame *frame, const bb_scene *scene, uint32_t prim,
                         corner corners[3])
{
    for (uint32_t i = 0; i < 3; i++)
        corners[i] = see(frame, bb_scene_vertex(scene, prim, i));
}

/* Of a triangle what lies in the interval; how many corners it has. */
static int cut_ends(corner corners[BB_OUTLINE_CORNERS + 1], double from, double to)
{
    int count = cut(corners, 3, from, 1.0);
    return count > 0 ? cut(corners, count, to, -1.0) : 0;
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

bb_passing bb_pass(const bb_frame *frame, const bb_scene *scene, uint32_t prim, double from,
                   double to)
{
    if (prim >= scene->triangle_count) {
        const float *s = scene->spheres + 4 * (size_t)(prim - scene->triangle_count);
        corner c = see(frame, s);
        double nearest = fmin(fmax(c.t, from), to), along = (c.t - nearest) * frame->length;
        double distance = hypot(hypot(c.x, c.y), along) - (double)s[3];
        return (bb_passing){fmax(0.0, distance), c.t, c.t};
    }
    corner corners[BB_OUTLINE_CORNERS + 1];
    see_triangle(frame, scene, prim, corners);
    bb_passing passing = {INFINITY, INFINITY, -INFINITY};
    for (int i = 0; i < 3; i++) {
        passing.t_low = fmin(passing.t_low, corners[i].t);
        passing.t_high = fmax(passing.t_high, corners[i].t);
    }
    passing.distance = distance_to_polygon(corners, cut_ends(corners, from, to));
    return passing;
}

void bb_see_outline(const bb_frame *frame, const bb_scene *scene, uint32_t prim, double from,
                    double to, bb_outline *outline)
{
    corner corners[BB_OUTLINE_CORNERS + 1];
    outline->count = 0;
    if (prim >= scene->triangle_count)
        return;
    see_triangle(frame, scene, prim, corners);
    outline->count = (uint32_t)cut_ends(corners, from, to);
    for (uint32_t i = 0; i < outline->count; i++) {
        outline->corners[i][0] = corners[i].x;
        outline->corners[i][1] = corners[i].y;
    }
}
