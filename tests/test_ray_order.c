/* Sorted rays: the order against plain host code, and kernels that take rays in it, whose answers
 * and counts are those of the same kernel without. Seed: BVHBENCH_TEST_SEED. */
#include "framework/base/random.h"
#include "framework/judge/queries.h"
#include "tests/device_fixture.h"
#include "tests/trace_fixture.h"
#include "traversal/ray_order.h"

#include <math.h>
#include <stdlib.h>

enum { MOST = 20000 };

/* ---- the order ---- */

static uint32_t cell_of(float o, float lo, float hi)
{
    const float cells = hi > lo ? 512.0f / (hi - lo) : 0, cell = (o - lo) * cells;
    return isnan(cell) || cell < 0 ? 0 : cell > 511 ? 511 : (uint32_t)cell;
}

static uint32_t key_of(const bb_box *box, const bb_ray *ray)
{
    uint32_t key = 0;
    for (int axis = 0; axis < 3; axis++)
        key = key << 1 | (ray->d[axis] < 0);
    for (int bit = 8; bit >= 0; bit--)
        for (int axis = 0; axis < 3; axis++)
            key = key << 1 | (cell_of(ray->o[axis], box->lo[axis], box->hi[axis]) >> bit & 1);
    return key;
}

static void make_rays(bb_random *random, bb_ray *rays, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        rays[i] = (bb_ray){.tmax = INFINITY};
        for (int k = 0; k < 3; k++) {
            rays[i].o[k] = (float)bb_random_range(random, -1.5, 1.5);
            rays[i].d[k] = (float)bb_random_range(random, -1, 1);
        }
        if (i % 7 == 3)
            rays[i].o[i % 3] = i % 2 == 0 ? NAN : -INFINITY;
        if (i % 11 == 5)
            rays[i].d[i % 3] = i % 2 == 0 ? -0.0f : NAN;
        if (i % 5 == 1)
            rays[i] = rays[i - 1];
    }
}

static void expect_order(const bb_box *box, const bb_ray *rays, uint32_t count,
                         const uint32_t *order)
{
    bool *taken = calloc(count, sizeof *taken);
    for (uint32_t i = 0; i < count; i++) {
        assert_true(order[i] < count && !taken[order[i]]);
        taken[order[i]] = true;
        if (i == 0)
            continue;
        const uint32_t a = key_of(box, &rays[order[i - 1]]), b = key_of(box, &rays[order[i]]);
        if (a > b || (a == b && order[i - 1] > order[i]))
            fail_msg("place %u of %u: ray %u, key %x, after ray %u, key %x (seed %llu)", i, count,
                     order[i], b, order[i - 1], a, (unsigned long long)seed);
    }
    free(taken);
}

static void sorts_by_octant_and_origin(void **state)
{
    (void)state;
    static const bb_box boxes[] = {
        {.lo = {-1, -1, -1}, .hi = {1, 1, 1}},
        {.lo = {0, -1, -1}, .hi = {0, 1, 1e-30f}},                 /* flat, and thin */
        {.lo = {-3e38f, -1, 0.5f}, .hi = {3e38f, 1, 0.50000006f}}, /* a side beyond floats */
    };
    static const uint32_t counts[] = {1, 2, 64, 1000, 65, MOST, 3};
    bb_ray *rays = calloc(MOST, sizeof *rays);
    uint32_t *order = calloc(MOST, sizeof *order);
    bb_random random = bb_random_make(seed, 1);
    bb_ray_order *subject;
    bb_buffer on_device;
    const bb_buffer *ids;
    ASSERT_OK(bb_ray_order_of(device, &subject));
    make_buffer(&on_device, NULL, MOST * sizeof *rays);
    for (size_t b = 0; b < sizeof boxes / sizeof boxes[0]; b++)
        for (size_t c = 0; c < sizeof counts / sizeof counts[0]; c++) {
            make_rays(&random, rays, counts[c]);
            ASSERT_OK(bb_buffer_write(&on_device, 0, counts[c] * sizeof *rays, rays));
            ASSERT_OK(bb_ray_order_make(subject, rays, &boxes[b], &on_device, counts[c]));
            ASSERT_OK(bb_ray_order_take(subject, rays, counts[c], &ids));
            ASSERT_OK(bb_buffer_read(ids, 0, counts[c] * sizeof *order, order));
            expect_order(&boxes[b], rays, counts[c], order);
        }
    bb_buffer_release(&on_device);
    free(rays);
    free(order);
}

/* An order is taken once, by whom it was made for, for as many rays. */
static void orders_are_not_taken_twice(void **state)
{
    (void)state;
    static const bb_box box = {.lo = {-1, -1, -1}, .hi = {1, 1, 1}};
    const bb_ray rays[2] = {{.tmax = 1}, {.tmax = 1}};
    const int one = 1, two = 2;
    bb_ray_order *subject, *again;
    bb_buffer on_device;
    const bb_buffer *ids;
    ASSERT_OK(bb_ray_order_of(device, &subject));
    ASSERT_OK(bb_ray_order_of(device, &again));
    assert_ptr_equal(subject, again);
    make_buffer(&on_device, rays, sizeof rays);
    ASSERT_OK(bb_ray_order_make(subject, &one, &box, &on_device, 2));
    assert_int_equal(bb_ray_order_take(subject, &two, 2, &ids), BB_FAILED);
    assert_int_equal(bb_ray_order_take(subject, &one, 1, &ids), BB_FAILED);
    ASSERT_OK(bb_ray_order_take(subject, &one, 2, &ids));
    assert_int_equal(bb_ray_order_take(subject, &one, 2, &ids), BB_FAILED);
    bb_buffer_release(&on_device);
}

/* ---- kernels ---- */

static void answers_and_counts_stay_with_their_rays(void **state)
{
    (void)state;
    static const char *const kernels[] = {
        "stack:group=8", "stack8i:rays=8,group=64", "stackless",
        "short8",        "stack:persistent=yes",    "stack8i:rays=8,group=64,persistent=yes"};
    static const uint32_t counts[] = {1, 7, 64, 2000};
    bb_ray *rays = calloc(2000, sizeof *rays);
    bb_hit *right = calloc(2000, sizeof *right), *found = calloc(2000, sizeof *found);
    bb_count *tests = calloc(2000, sizeof *tests), *counted = calloc(2000, sizeof *counted);
    bb_random random = bb_random_make(seed, 2);
    bed b;
    open_bed(&b, load("interior:n=3000"), "lbvh", "stack", 1);
    make_rays(&random, rays, 2000);
    for (size_t k = 0; k < sizeof kernels / sizeof kernels[0]; k++)
        for (size_t c = 0; c < sizeof counts / sizeof counts[0]; c++) {
            char sorted[64];
            const uint32_t count = counts[c];
            const bb_query *query = k % 2 == 0 ? &bb_query_closest : &bb_query_any;
            snprintf(sorted, sizeof sorted, "%s%csort=yes", kernels[k],
                     strchr(kernels[k], ':') == NULL ? ':' : ',');
            choose_kernel(&b, kernels[k], 1);
            trace(&b, "exact", rays, count, query, right, tests);
            choose_kernel(&b, sorted, 1);
            memset(found, 0x55, count * sizeof *found);
            memset(counted, 0x55, count * sizeof *counted);
            trace(&b, "exact", rays, count, query, found, counted);
            for (uint32_t i = 0; i < count; i++)
                if (memcmp(&right[i], &found[i], sizeof right[i]) != 0 ||
                    memcmp(&tests[i], &counted[i], sizeof tests[i]) != 0)
                    fail_msg("%s, ray %u of %u: another answer or count (seed %llu)", sorted, i,
                             count, (unsigned long long)seed);
        }
    close_bed(&b);
    free(rays);
    free(right);
    free(found);
    free(tests);
    free(counted);
}

/* Every other ray goes the other way, so no packet as given is bounded. */
static void packets_find_partners(void **state)
{
    (void)state;
    enum { COUNT = 1024 };
    static const char *const kernels[] = {"packet8:rays=8", "packet8:rays=8,sort=yes"};
    bb_ray rays[COUNT];
    bb_hit hits[COUNT];
    bb_count counts[COUNT];
    uint64_t boxes_met[2] = {0};
    bb_random random = bb_random_make(seed, 3);
    bed b;
    open_bed(&b, load("interior:n=3000"), "lbvh", "stack", 1);
    for (uint32_t i = 0; i < COUNT; i++) {
        const double sign = i % 2 == 0 ? 1 : -1;
        rays[i] = (bb_ray){.tmax = INFINITY};
        for (int k = 0; k < 3; k++) {
            rays[i].o[k] = 0.5f * (b.scene->bounds.lo[k] + b.scene->bounds.hi[k]);
            rays[i].d[k] = (float)(sign * bb_random_range(&random, 0.9, 1));
        }
    }
    for (int k = 0; k < 2; k++) {
        choose_kernel(&b, kernels[k], 1);
        trace(&b, "exact", rays, COUNT, &bb_query_closest, hits, counts);
        for (uint32_t i = 0; i < COUNT; i++)
            boxes_met[k] += counts[i].nodes;
    }
    if (boxes_met[1] >= boxes_met[0])
        fail_msg("%llu tests of boxes sorted, %llu as given (seed %llu)",
                 (unsigned long long)boxes_met[1], (unsigned long long)boxes_met[0],
                 (unsigned long long)seed);
    close_bed(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sorts_by_octant_and_origin),
        cmocka_unit_test(orders_are_not_taken_twice),
        cmocka_unit_test(answers_and_counts_stay_with_their_rays),
        cmocka_unit_test(packets_find_partners),
    };
    return cmocka_run_group_tests(tests, open_device, close_device);
}
