/* The splits of `sah` are the cheapest there are: against all candidates, one after the other, of
 * random and of crowded boxes. */
#include "builders/sah/sah_split.h"
#include "framework/base/random.h"
#include "tests/fixture.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { MOST = 40, BINS = 6, TRIALS = 3000 };

static bb_box boxes[MOST];
static float centroids[3 * MOST];
static uint32_t orders[3][MOST], scratch[MOST];
static bool goes_left[MOST];
static double right_costs[MOST];

static bb_sah_state make_state(bb_random *random)
{
    bb_sah_state state = {.boxes = boxes,
                          .count = 2 + bb_random_below(random, MOST - 1),
                          .bins = BINS,
                          .centroids = centroids,
                          .scratch = scratch,
                          .goes_left = goes_left,
                          .right_costs = right_costs};
    bool crowded = bb_random_below(random, 2) == 0; /* many centroids coincide on an axis */
    for (uint32_t i = 0; i < state.count; i++)
        for (int axis = 0; axis < 3; axis++) {
            float at =
                crowded ? (float)bb_random_below(random, 4) : (float)bb_random_range(random, 0, 4);
            float half = (float)bb_random_range(random, 0, 1);
            boxes[i].lo[axis] = at - half;
            boxes[i].hi[axis] = at + half;
            centroids[3 * i + (uint32_t)axis] = at;
        }
    for (int axis = 0; axis < 3; axis++) {
        state.order[axis] = orders[axis];
        for (uint32_t i = 0; i < state.count; i++)
            orders[axis][i] = i;
    }
    return state;
}

/* A(left) |left| + A(right) |right|; infinite if a side is empty. */
static double cost_of(uint32_t count, const bool *left)
{
    double cost = 0;
    for (int side = 0; side < 2; side++) {
        float lo[3] = {INFINITY, INFINITY, INFINITY}, hi[3] = {-INFINITY, -INFINITY, -INFINITY};
        uint32_t members = 0;
        for (uint32_t i = 0; i < count; i++)
            if (left[i] == (side == 0)) {
                bb_sah_grow(lo, hi, boxes[i].lo, boxes[i].hi);
                members++;
            }
        if (members == 0)
            return INFINITY;
        cost += bb_half_area(lo, hi) * members;
    }
    return cost;
}

static double least_binned(uint32_t count)
{
    double least = INFINITY;
    for (int axis = 0; axis < 3; axis++) {
        float low = INFINITY, high = -INFINITY;
        for (uint32_t i = 0; i < count; i++) {
            low = fminf(low, centroids[3 * i + (uint32_t)axis]);
            high = fmaxf(high, centroids[3 * i + (uint32_t)axis]);
        }
        for (uint32_t plane = 1; plane < BINS && low < high; plane++) {
            bool left[MOST];
            for (uint32_t i = 0; i < count; i++) {
                double at = (double)centroids[3 * i + (uint32_t)axis] - low;
                left[i] = (uint32_t)(at * (BINS / ((double)high - low))) < plane;
            }
            least = fmin(least, cost_of(count, left));
        }
    }
    return least;
}

/* Every position of the sorted orders, also between equal centroids. */
static double least_swept(uint32_t count)
{
    double least = INFINITY;
    for (int axis = 0; axis < 3; axis++) {
        const uint32_t *order = orders[axis];
        uint32_t first = 3 * order[0] + (uint32_t)axis;
        if (centroids[first] == centroids[3 * order[count - 1] + (uint32_t)axis])
            continue;
        for (uint32_t position = 1; position < count; position++) {
            bool left[MOST] = {false};
            for (uint32_t i = 0; i < position; i++)
                left[order[i]] = true;
            least = fmin(least, cost_of(count, left));
        }
    }
    return least;
}

static void splits_are_the_cheapest(void **state)
{
    (void)state;
    bb_random random = bb_random_make(5, 0);
    for (uint32_t trial = 0; trial < TRIALS; trial++) {
        bb_sah_state s = make_state(&random);
        bb_sah_split binned = bb_sah_find_binned(&s, 0, s.count);
        double least = least_binned(s.count);
        if (binned.left == 0 ? least < INFINITY : fabs(binned.cost - least) > 1e-12 * least)
            fail_msg("trial %u, %u boxes: binned costs %.17g, the cheapest %.17g", trial, s.count,
                     binned.cost, least);
        assert_int_equal(bb_sah_presort(&s, NULL), BB_OK);
        bb_sah_split swept = bb_sah_find_sweep(&s, 0, s.count);
        least = least_swept(s.count);
        if (swept.left == 0 ? least < INFINITY : fabs(swept.cost - least) > 1e-12 * least)
            fail_msg("trial %u, %u boxes: the sweep's costs %.17g, the cheapest %.17g", trial,
                     s.count, swept.cost, least);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(splits_are_the_cheapest)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
