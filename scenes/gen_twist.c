/* A square bar, 1 x 1 x 6, that is twisted by up to two turns over its length: a deformation like
 * that of bones or of a finite element. */
#include "scenes/repeatable.h"
#include "scenes/tube.h"

static const bb_option options_table[] = {
    {"n", "100000", NULL, "number of triangles, about"},
    BB_MOTION_OPTIONS,
    {0},
};

static const double section[4][2] = {{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}};
static const double length = 6, turn = 4 * 3.14159265358979323846; /* of the far end in the last
                                                                    * frame */

static bb_status read_bar(const bb_spec *spec, const bb_option *options, uint32_t frame,
                          bb_tube *bar, bb_motion *motion)
{
    uint64_t n;
    BB_TRY(bb_spec_u64(spec, options, "n", 16, INT32_MAX, &n));
    uint32_t across = (uint32_t)fmax(1, floor(sqrt((double)n / 48) + 0.5)); /* square cells */
    *bar = (bb_tube){4, section, length, across, 6 * across};
    return bb_motion_read(spec, options, BB_MOTION_FRAMES, frame, motion);
}

static void twist(const void *user, double p[3])
{
    const bb_motion *motion = user;
    double angle = turn * motion->time * p[2] / length, s = bb_sine(angle), c = bb_cosine(angle);
    double x = p[0], y = p[1];
    p[0] = c * x - s * y;
    p[1] = s * x + c * y;
}

static bb_status set_frame(const bb_spec *spec, const bb_option *options, bb_scene *scene,
                           uint32_t frame)
{
    bb_tube bar;
    bb_motion motion;
    BB_TRY(read_bar(spec, options, frame, &bar, &motion));
    bb_tube_place(&bar, &motion, twist, &motion, scene);
    return BB_OK;
}

static bb_status make(const bb_spec *spec, const bb_option *options, bb_scene *scene)
{
    bb_tube bar;
    bb_motion motion;
    BB_TRY(read_bar(spec, options, 0, &bar, &motion));
    BB_TRY(bb_tube_reserve(&bar, scene));
    bb_motion_declare(&motion, scene);
    return set_frame(spec, options, scene, 0);
}

extern const bb_generator bb_generator_twist;
const bb_generator bb_generator_twist = {
    .name = "twist",
    .summary = "a square bar that is twisted, in frames",
    .options = options_table,
    .make = make,
    .set_frame = set_frame,
};
