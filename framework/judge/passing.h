/* How far a ray passes a primitive, in doubles: only ever compared with a margin. */
#ifndef BB_PASSING_H
#define BB_PASSING_H

#include "framework/judge/open_way.h"
#include "framework/scene/scene.h"

/* A ray's frame: what lies at o + x across[0] + y across[1] + t d is seen at (x, y), at t. */
typedef struct bb_frame {
    double o[3], d[3];
    double length;       /* of d */
    double across[2][3]; /* unit vectors perpendicular to d and to each other */
} bb_frame;

typedef struct bb_passing {
    double distance; /* in scene units; INFINITY if the primitive is nowhere in the interval */
    double t_low,
        t_high; /* all of a triangle's extent along the ray; of a sphere, where it is nearest */
} bb_passing;

/* The least distance of the ray from the primitive's part at t in [from, to]. */
bb_passing bb_pass(const bb_frame *frame, const bb_scene *scene, uint32_t prim, double from,
                   double to);

/* The part of a triangle at t in [from, to] as the ray sees it, in the frame's units; empty for a sphere. */
void bb_see_outline(const bb_frame *frame, const bb_scene *scene, uint32_t prim, double from,
                    double to, bb_outline *outline);

#endif
