/* Boxes that hunt for mistakes in builders: sizes from large to none, flat, all in one place, far
 * out and at the ends of the floats' range. */
#ifndef BB_TEST_BOX_INPUTS_H
#define BB_TEST_BOX_INPUTS_H

#include "framework/base/random.h"
#include "tests/box_fixture.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

/* Box i of `count`. */
typedef void (*fill_function)(bb_random *random, uint32_t i, uint32_t count, bb_box *box);

typedef struct box_input {
    const char *name;
    fill_function fill;
} box_input;

/* `count` boxes of inputs[k], to be freed; others for another k. */
static inline bb_box *make_boxes(const box_input *inputs, size_t k, uint32_t count)
{
    bb_random random = bb_random_make(seed, k * 10000 + count);
    bb_box *boxes = malloc(count * sizeof *boxes);
    for (uint32_t i = 0; i < count; i++)
        inputs[k].fill(&random, i, count, &boxes[i]);
    return boxes;
}

static inline void set_box(bb_box *box, const double centre[3], const double half[3])
{
    *box = (bb_box){0};
    for (int k = 0; k < 3; k++) {
        box->lo[k] = (float)(centre[k] - half[k]);
        box->hi[k] = (float)(centre[k] + half[k]);
    }
}

static inline void random_centre(bb_random *random, double centre[3])
{
    for (int k = 0; k < 3; k++)
        centre[k] = bb_random_range(random, -1, 1);
}

/* Sides from 1 to 1/1024 of the scene's, each on its own. */
static inline void fill_mixed(bb_random *random, uint32_t i, uint32_t count, bb_box *box)
{
    (void)i;
    (void)count;
    double c[3], half[3];
    random_centre(random, c);
    for (int k = 0; k < 3; k++)
        half[k] = ldexp(bb_random_range(random, 0.5, 1), -(int)bb_random_below(random, 10));
    set_box(box, c, half);
}

static inline void fill_points(bb_random *random, uint32_t i, uint32_t count, bb_box *box)
{
    (void)i;
    (void)count;
    double c[3];
    random_centre(random, c);
    set_box(box, c, (const double[]){0, 0, 0});
}

static inline void fill_one_point(bb_random *random, uint32_t i, uint32_t count, bb_box *box)
{
    (void)random;
    (void)i;
    (void)count;
    set_box(box, (const double[]){3, -4, 5}, (const double[]){0, 0, 0});
}

static inline void fill_flat(bb_random *random, uint32_t i, uint32_t count, bb_box *box)
{
    fill_mixed(random, i, count, box);
    box->lo[1] = box->hi[1] = 7;
}

/* Axis-aligned triangles. */
static inline void fill_walls(bb_random *random, uint32_t i, uint32_t count, bb_box *box)
{
    fill_mixed(random, i, count, box);
    uint32_t axis = bb_random_below(random, 3);
    box->hi[axis] = box->lo[axis];
}

static inline void fill_outlier(bb_random *random, uint32_t i, uint32_t count, bb_box *box)
{
    fill_mixed(random, i, count, box);
    if (i == count / 2)
        set_box(box, (const double[]){1e8, 1e8, 1e8}, (const double[]){1, 1, 1});
}

/* As far apart as floats go: no difference of two coordinates is finite. */
static inline void fill_huge(bb_random *random, uint32_t i, uint32_t count, bb_box *box)
{
    fill_mixed(random, i, count, box);
    for (int k = 0; k < 3; k++) {
        box->lo[k] *= 0.4f * FLT_MAX;
        box->hi[k] *= 0.4f * FLT_MAX;
    }
}

static inline void fill_tiny(bb_random *random, uint32_t i, uint32_t count, bb_box *box)
{
    fill_mixed(random, i, count, box);
    for (int k = 0; k < 3; k++) {
        box->lo[k] = ldexpf(box->lo[k], -100);
        box->hi[k] = ldexpf(box->hi[k], -100);
    }
}

#endif
