#include "scenes/motion.h"

bb_status bb_motion_read(const bb_spec *spec, const bb_option *options, uint32_t frames,
                         uint32_t frame, bb_motion *motion)
{
    static const double direction[3] = {0.75, 0.375, 0.5};
    motion->frames = frames;
    if (bb_spec_value(spec, options, "frames") != NULL)
        BB_TRY(bb_spec_u64(spec, options, "frames", 1, 1000000, &motion->frames));
    BB_TRY(bb_spec_u64(spec, options, "seed", 0, UINT64_MAX, &motion->seed));
    BB_TRY(bb_spec_double(spec, options, "away", 0, 1e15, &motion->away));
    motion->frame = frame;
    motion->time = motion->frames > 1 ? (double)frame / (double)(motion->frames - 1) : 0;
    for (int axis = 0; axis < 3; axis++)
        motion->shift[axis] = motion->away * motion->time * direction[axis];
    return BB_OK;
}

void bb_motion_declare(const bb_motion *motion, bb_scene *scene)
{
    scene->frame_count = (uint32_t)motion->frames;
}

float *bb_motion_put(const bb_motion *motion, const double p[3], float *to)
{
    for (int axis = 0; axis < 3; axis++)
        to[axis] = (float)(p[axis] + motion->shift[axis]);
    return to + 3;
}
