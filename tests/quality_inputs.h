/* Boxes on which builders that compare areas of unions may stall, run deep or see no difference. */
#ifndef BB_TEST_QUALITY_INPUTS_H
#define BB_TEST_QUALITY_INPUTS_H

#include "tests/box_inputs.h"

static inline void fill_same(bb_random *random, uint32_t i, uint32_t count, bb_box *box)
{
    (void)random;
    (void)i;
    (void)count;
    set_box(box, (const double[]){3, -4, 5}, (const double[]){1, 2, 0.5});
}

/* Voxels of a layer, as regular terrain is. */
static inline void fill_row(bb_random *random, uint32_t i, uint32_t count, bb_box *box)
{
    (void)random;
    (void)count;
    set_box(box, (const double[]){i + 0.5, 0.5, 0}, (const double[]){0.5, 0.5, 0.5});
}

static inline void fill_grid(bb_random *random, uint32_t i, uint32_t count, bb_box *box)
{
    (void)random;
    (void)count;
    set_box(box, (const double[]){i % 8 + 0.5, i / 8 % 8 + 0.5, i / 64},
            (const double[]){0.5, 0.5, 0.5});
}

/* Each inside of the next; all centroids equal. */
static inline void fill_nest(bb_random *random, uint32_t i, uint32_t count, bb_box *box)
{
    (void)random;
    double side = 1.0 + (double)i / count;
    set_box(box, (const double[]){0, 0, 0}, (const double[]){side, side, side});
}

/* So large that no square of a side is finite, in a scene whose centroids are all one. */
static inline void fill_vast_nest(bb_random *random, uint32_t i, uint32_t count, bb_box *box)
{
    (void)random;
    double side = ldexp(1.0 + (double)i / count, 110);
    set_box(box, (const double[]){0, 0, 0}, (const double[]){side, side, side});
}

static inline void fill_gaps(bb_random *random, uint32_t i, uint32_t count, bb_box *box)
{
    (void)random;
    double at = pow(1.2, 40.0 * i / count);
    set_box(box, (const double[]){at, at, at}, (const double[]){0.1, 0.1, 0.1});
}

static inline void fill_alternating(bb_random *random, uint32_t i, uint32_t count, bb_box *box)
{
    (void)random;
    (void)count;
    double side = i % 2 == 0 ? 1 : 3;
    set_box(box, (const double[]){0, 0, 0}, (const double[]){side, side, side});
}

/* One box over everything. */
static inline void fill_lid(bb_random *random, uint32_t i, uint32_t count, bb_box *box)
{
    fill_mixed(random, i, count, box);
    if (i == 0)
        set_box(box, (const double[]){0, 0, 0}, (const double[]){4, 4, 4});
}

static inline void fill_far(bb_random *random, uint32_t i, uint32_t count, bb_box *box)
{
    fill_mixed(random, i, count, box);
    for (int k = 0; k < 3; k++) {
        box->lo[k] *= 1e18f;
        box->hi[k] *= 1e18f;
    }
}

static inline void fill_near(bb_random *random, uint32_t i, uint32_t count, bb_box *box)
{
    fill_mixed(random, i, count, box);
    for (int k = 0; k < 3; k++) {
        box->lo[k] *= 1e-18f;
        box->hi[k] *= 1e-18f;
    }
}

/* Beside one side the others are so thin that areas are denormal, a tenth of which is nothing. */
static inline void fill_thin(bb_random *random, uint32_t i, uint32_t count, bb_box *box)
{
    (void)i;
    (void)count;
    *box = (bb_box){.hi = {1, 0, 0}};
    box->lo[1] = ldexpf((float)bb_random_below(random, 4), -149);
    box->hi[1] = box->lo[1] + ldexpf(1, -149);
}

/* The first is an ordinary one. */
static const box_input quality_inputs[] = {
    {"mixed", fill_mixed},
    {"same", fill_same},
    {"row", fill_row},
    {"grid", fill_grid},
    {"nest", fill_nest},
    {"vast nest", fill_vast_nest},
    {"gaps", fill_gaps},
    {"alternating", fill_alternating},
    {"lid", fill_lid},
    {"1e18", fill_far},
    {"1e-18", fill_near},
    {"points", fill_points},
    {"one point", fill_one_point},
    {"flat", fill_flat},
    {"walls", fill_walls},
    {"outlier", fill_outlier},
    {"huge", fill_huge},
    {"tiny", fill_tiny},
    {"thin", fill_thin},
};
enum { QUALITY_INPUTS = sizeof quality_inputs / sizeof quality_inputs[0] };

/* Nine floats each: triangles from corner to corner of boxes. To be freed. */
static inline float *triangles_of_boxes(const bb_box *boxes, uint32_t count)
{
    float *corners = malloc(9 * (size_t)count * sizeof *corners);
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t axis = 0; axis < 3; axis++) {
            corners[9 * i + axis] = boxes[i].lo[axis];
            corners[9 * i + 3 + axis] = boxes[i].hi[axis];
            corners[9 * i + 6 + axis] = axis == i % 3 ? boxes[i].hi[axis] : boxes[i].lo[axis];
        }
    return corners;
}

#endif
