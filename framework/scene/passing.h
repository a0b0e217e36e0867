/* How far a ray passes a primitive, and the primitive's outline along the ray, in doubles: results
 * are only compared with a margin. */
#ifndef BB_PASSING_H
#define BB_PASSING_H

#include <stdint.h>

/* A ray's frame: the point o + x across[0] + y across[1] + t d is seen at (x, y), at t. */
typedef struct bb_frame {
    double o[3], d[3];
    double length;       /* of d */
    double across[2][3]; /* unit vectors perpendicular to d and to each other */
} bb_frame;

typedef struct bb_passing {
    double distance;      /* in scene units; INFINITY if the primitive has no part in the
                           * interval */
    double t_low, t_high; /* its extent along the ray; for a sphere, its nearest point */
} bb_passing;

enum {
    BB_POLYGON_CORNERS = 4,                      /* of a flat part of a primitive, at most */
    BB_OUTLINE_CORNERS = BB_POLYGON_CORNERS + 2, /* when two ends are cut off */
};

/* A convex part of a primitive as seen along the ray, in the frame's units. */
typedef struct bb_outline {
    double corners[BB_OUTLINE_CORNERS][2];
    uint32_t count;
} bb_outline;

/* Returns the least distance of the ray from the polygon's part at t in [from, to]; corners[i]
 * points to x, y, z. */
bb_passing bb_pass_polygon(const bb_frame *frame, const float *const *corners, uint32_t count,
                           double from, double to);

/* Does the same for a ball: centre and radius. */
bb_passing bb_pass_ball(const bb_frame *frame, const float sphere[4], double from, double to);

/* Computes the outline of the polygon's part at t in [from, to]; may be empty. */
void bb_see_polygon(const bb_frame *frame, const float *const *corners, uint32_t count, double from,
                    double to, bb_outline *outline);

#endif
