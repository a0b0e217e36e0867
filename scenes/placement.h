/* Placement of a generated scene: turned about the origin, then scaled. Points are doubles and are
 * rounded to float once, at the end: if the scale is a power of two, the floats are exactly scaled
 * (unless they underflow). */
#ifndef BB_PLACEMENT_H
#define BB_PLACEMENT_H

#include "framework/scene/scene.h"

typedef struct bb_placement {
    bool turned;
    double turn[3][3]; /* rows of the rotation */
    double scale;
} bb_placement;

/* Options that a generator adds to its table. */
#define BB_PLACEMENT_OPTIONS                                                                       \
    {"scale", "1", NULL, "everything is multiplied by this, 1e-15 to 1e15"},                       \
    {                                                                                              \
        "turn", "0", NULL, "0: unchanged; N: the N-th random rotation about the origin"            \
    }

/* Reads scale and turn from the options. BB_INVALID for numbers that are out of range. */
bb_status bb_placement_read(const bb_spec *spec, const bb_option *options, bb_placement *out);

/* BB_INVALID if the scene is turned and its smallest detail is less than two steps of a float at
 * `farthest`, the largest distance from the origin. Both before scaling. */
bb_status bb_placement_check(const bb_placement *placement, const bb_spec *spec, double farthest,
                             double detail);

/* Turns and scales a point. */
void bb_placement_point(const bb_placement *placement, const double p[3], double out[3]);

/* Appends a pinhole view with `fov` degrees. */
void bb_placement_view(const bb_placement *placement, bb_scene *scene, const char *name,
                       const double eye[3], const double target[3], const double up[3], double fov);

/* Declares that the scene's mesh is closed and that p is inside. */
void bb_placement_inside(const bb_placement *placement, bb_scene *scene, const double p[3]);

#endif
