/* Common to generated moving scenes: their frames, and the motion of the whole scene.
 *
 * Positions depend only on the frame. They are computed in doubles, by operations that are the same
 * on every machine (repeatable.h), and are rounded to float once.
 */
#ifndef BB_MOTION_H
#define BB_MOTION_H

#include "framework/base/random.h"
#include "framework/scene/scene.h"

typedef struct bb_motion {
    uint64_t frames, seed;
    uint32_t frame;
    double time; /* of the frame: 0 for the first, 1 for the last */
    double away; /* how far the whole scene moves until the last frame */
    double shift[3];
} bb_motion;

/* Options that a generator adds to its table. */
#define BB_MOTION_OPTIONS                                                                          \
    {"frames", NULL, NULL, "number of frames; 1: it does not move; default: 21"},                  \
        {"seed", "1", NULL, "seed of what is random"},                                             \
    {                                                                                              \
        "away", "0", NULL, "the whole scene moves this far away until the last frame: 1e6"         \
    }

enum { BB_MOTION_FRAMES = 21 };

/* Reads the options, for one frame; `frames` is their default number. BB_INVALID for numbers that
 * are out of range. */
bb_status bb_motion_read(const bb_spec *spec, const bb_option *options, uint32_t frames,
                         uint32_t frame, bb_motion *motion);

/* Sets the scene's number of frames when it is made. */
void bb_motion_declare(const bb_motion *motion, bb_scene *scene);

/* Writes a point, shifted and rounded; returns to + 3. */
float *bb_motion_put(const bb_motion *motion, const double p[3], float *to);

#endif
