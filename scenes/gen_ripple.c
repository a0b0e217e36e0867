/* A square sheet that ripples like cloth or water. Neighbours stay neighbours. The rule: z = sin(12
 * x + 6 t) cos(9 y + 5 t) / 20 over the unit square. */
#include "scenes/motion.h"
#include "scenes/repeatable.h"

static const bb_option options_table[] = {
    {"n", "100000", NULL, "number of triangles, rounded to a square of cells"},
    BB_MOTION_OPTIONS,
    {0},
};

static bb_status read_sheet(const bb_spec *spec, const bb_option *options, uint32_t frame,
                            uint32_t *side, bb_motion *motion)
{
    uint64_t n;
    BB_TRY(bb_spec_u64(spec, options, "n", 2, INT32_MAX, &n));
    *side = (uint32_t)fmax(1, floor(sqrt((double)n / 2) + 0.5));
    return bb_motion_read(spec, options, BB_MOTION_FRAMES, frame, motion);
}

static bb_status set_frame(const bb_spec *spec, const bb_option *options, bb_scene *scene,
                           uint32_t frame)
{
    uint32_t side;
    bb_motion motion;
    BB_TRY(read_sheet(spec, options, frame, &side, &motion));
    float *to = scene->vertices;
    for (uint32_t j = 0; j <= side; j++) {
        double y = (double)j / side, along = bb_cosine(9 * y + 5 * motion.time);
        for (uint32_t i = 0; i <= side; i++) {
            double x = (double)i / side, z = 0.05 * bb_sine(12 * x + 6 * motion.time) * along;
            to = bb_motion_put(&motion, (const double[3]){x, y, z}, to);
        }
    }
    return BB_OK;
}

static bb_status make(const bb_spec *spec, const bb_option *options, bb_scene *scene)
{
    uint32_t side;
    bb_motion motion;
    BB_TRY(read_sheet(spec, options, 0, &side, &motion));
    BB_TRY(bb_scene_reserve_mesh(scene, (side + 1ull) * (side + 1ull), 2ull * side * side));
    uint32_t *to = bb_scene_indices(scene);
    for (uint32_t j = 0; j < side; j++)
        for (uint32_t i = 0; i < side; i++, to += 6) {
            uint32_t corner = j * (side + 1) + i;
            to[0] = to[3] = corner;
            to[1] = corner + 1;
            to[2] = to[4] = corner + side + 2;
            to[5] = corner + side + 1;
        }
    bb_motion_declare(&motion, scene);
    return set_frame(spec, options, scene, 0);
}

extern const bb_generator bb_generator_ripple;
const bb_generator bb_generator_ripple = {
    .name = "ripple",
    .summary = "a sheet with waves, in frames: cloth or water",
    .options = options_table,
    .make = make,
    .set_frame = set_frame,
};
