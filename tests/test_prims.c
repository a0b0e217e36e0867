/* Kinds of primitives: axis-aligned boxes against MPFR with enough bits that nothing is rounded,
 * and for every kind what the harness relies on: points of its surface are in its box, in what is
 * left of a region around them, and where an exact line says. A few seconds. */
#include "framework/base/random.h"
#include "framework/judge/arbiter.h"
#include "framework/judge/queries.h"
#include "framework/scene/prim.h"

#include <math.h>
#include <mpfr.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { BITS = 2400, CASES = 40000 };

static bb_scene *one_box(const float box[6])
{
    bb_scene *scene = calloc(1, sizeof *scene);
    assert_non_null(scene);
    strcpy(scene->name, "one box");
    const bb_prim_counts counts = {.of = {[BB_AABB] = 1}};
    assert_int_equal(bb_scene_reserve(scene, 0, &counts), BB_OK);
    memcpy(scene->prims[BB_AABB].data, box, 6 * sizeof *box);
    return scene;
}

/* ---- the exact test ---- */

static mpfr_t entry, leave, time, direction;

/* Whether the line meets the box; it enters at `entry` and leaves at `leave`, but for rounding at
 * the 2400th bit, which no tie here reaches: ties are equal quotients, and these are rounded
 * alike. */
static bool reference(const float b[6], const double o[3], const float d[3])
{
    mpfr_set_inf(entry, -1);
    mpfr_set_inf(leave, 1);
    for (int k = 0; k < 3; k++) {
        if (d[k] == 0 && ((double)b[k] > o[k] || (double)b[k + 3] < o[k]))
            return false;
        if (d[k] == 0)
            continue;
        for (int end = 0; end < 2; end++) {
            bool near = (end == 0) == (d[k] > 0);
            mpfr_set_flt(time, b[end == 0 ? k : k + 3], MPFR_RNDN);
            mpfr_sub_d(time, time, o[k], MPFR_RNDN);
            mpfr_set_flt(direction, d[k], MPFR_RNDN);
            mpfr_div(time, time, direction, MPFR_RNDN);
            if (near && mpfr_cmp(time, entry) > 0)
                mpfr_set(entry, time, MPFR_RNDN);
            if (!near && mpfr_cmp(time, leave) < 0)
                mpfr_set(leave, time, MPFR_RNDN);
        }
    }
    return mpfr_cmp(entry, leave) <= 0;
}

/* Boxes some of which are flat, and lines some of which pass exactly through edges and corners. */
static void make_case(bb_random *random, float b[6], double o[3], float d[3])
{
    bool whole = bb_random_below(random, 2) == 0;
    for (int k = 0; k < 3; k++) {
        float lo =
            whole ? (float)bb_random_below(random, 9) - 4 : (float)bb_random_range(random, -1, 1);
        float side = whole
                         ? (float)bb_random_below(random, 5)
                         : (float)ldexp(bb_random_unit(random), -(int)bb_random_below(random, 40));
        b[k] = lo;
        b[k + 3] = lo + side;
        d[k] = whole
                   ? (float)bb_random_below(random, 7) - 3
                   : (float)ldexp(bb_random_range(random, -1, 1), (int)bb_random_below(random, 30));
    }
    if (d[0] == 0 && d[1] == 0 && d[2] == 0)
        d[bb_random_below(random, 3)] = 1;
    bool aimed = bb_random_below(random, 3) > 0;
    double steps = whole ? (double)bb_random_below(random, 9) : bb_random_range(random, 0, 9);
    for (int k = 0; k < 3; k++) {
        double at = b[bb_random_below(random, 2) == 0 ? k : k + 3];
        if (bb_random_below(random, 3) == 0)
            at = 0.5 * ((double)b[k] + (double)b[k + 3]);
        o[k] = aimed ? at - steps * d[k] : bb_random_range(random, -5, 5);
    }
}

static void lines_meet_boxes_as_in_exact_arithmetic(void **state)
{
    (void)state;
    uint32_t met = 0, touched = 0;
    mpfr_inits2(BITS, entry, leave, time, direction, (mpfr_ptr)0);
    for (uint32_t n = 0; n < CASES; n++) {
        bb_random random = bb_random_make(7, n);
        float b[6], d[3];
        double o[3], t[2] = {0, 0};
        make_case(&random, b, o, d);
        bb_scene *scene = one_box(b);
        bool expected = reference(b, o, d);
        int count = bb_prim_kinds[BB_AABB]->hits(scene, 0, o, d, t);
        if (count != (expected ? 2 : 0))
            fail_msg("case %u: %d hits, expected %s", n, count, expected ? "two" : "none");
        if (expected) {
            double from = mpfr_get_d(entry, MPFR_RNDN), to = mpfr_get_d(leave, MPFR_RNDN);
            met++;
            touched += mpfr_cmp(entry, leave) == 0;
            assert_true(t[0] <= t[1]);
            assert_true(fabs(t[0] - from) <= 0x1p-32 * fabs(from));
            assert_true(fabs(t[1] - to) <= 0x1p-32 * fabs(to));
        }
        bb_scene_free(scene);
    }
    mpfr_clears(entry, leave, time, direction, (mpfr_ptr)0);
    print_message("%u of %u lines meet, %u of them touch\n", met, CASES, touched);
    assert_true(met > CASES / 4 && met < CASES && touched > CASES / 100);
}

/* ---- all kinds ---- */

static bb_scene *mixed_scene(void)
{
    bb_scene *scene = NULL;
    assert_int_equal(bb_scene_load("blocks:side=6,mixed=yes", &scene), BB_OK);
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++)
        assert_true(scene->prims[kind].count > 5);
    return scene;
}

static void primitives_are_numbered_through(void **state)
{
    (void)state;
    bb_scene *scene = mixed_scene();
    const bb_prim_ends ends = bb_scene_ends(scene);
    uint32_t prim = 0;
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++) {
        for (uint32_t n = 0; n < scene->prims[kind].count; n++, prim++) {
            uint32_t i;
            assert_ptr_equal(bb_prim_of(scene, prim, &i), bb_prim_kinds[kind]);
            assert_int_equal(i, n);
        }
        assert_int_equal(ends.end[kind], prim);
    }
    assert_int_equal(prim, scene->prim_count);
    assert_int_equal(scene->kinds, BB_ALL_KINDS);
    char names[64];
    bb_prim_kind_names(scene->kinds, names, sizeof names);
    assert_string_equal(names, "triangles+spheres+boxes+tetrahedra");
    bb_scene_free(scene);
}

/* A line through the sampled point along its normal meets the primitive there. */
static void expect_hit(const bb_scene *scene, const bb_prim_kind *kind, uint32_t i,
                       const double point[3], const double normal[3])
{
    double o[3], t[2], nearest = (double)INFINITY;
    float d[3];
    for (int k = 0; k < 3; k++) {
        d[k] = (float)-normal[k];
        o[k] = point[k] - (double)d[k]; /* t is 1 */
    }
    int count = kind->hits(scene, i, o, d, t);
    for (int root = 0; root < count; root++)
        nearest = fmin(nearest, fabs(t[root] - 1.0));
    if (!(nearest < 1e-5))
        fail_msg("%s %u: a line to its point %g %g %g misses it by %g", kind->name, i, point[0],
                 point[1], point[2], nearest);
}

static void points_of_a_surface_are_on_it(void **state)
{
    (void)state;
    bb_scene *scene = mixed_scene();
    for (uint32_t prim = 0; prim < scene->prim_count; prim++) {
        uint32_t i;
        const bb_prim_kind *kind = bb_prim_of(scene, prim, &i);
        const bb_box *box = &scene->boxes[prim];
        bb_random random = bb_random_make(3, prim);
        for (int n = 0; n < 8; n++) {
            double point[3], normal[3], again[3], lo[3], hi[3], length = 0, cosine = 0;
            kind->sample(scene, i, &random, point, normal);
            kind->normal(scene, i, point, again);
            for (int k = 0; k < 3; k++) {
                assert_true(point[k] >= (double)box->lo[k] - 1e-12 &&
                            point[k] <= (double)box->hi[k] + 1e-12);
                lo[k] = point[k] - bb_random_unit(&random);
                hi[k] = point[k] + bb_random_unit(&random);
                length = hypot(length, again[k]);
            }
            assert_true(kind->shrink(scene, i, lo, hi));
            for (int k = 0; k < 3; k++) {
                assert_true(lo[k] <= point[k] + 1e-12 && point[k] - 1e-12 <= hi[k]);
                cosine += normal[k] * again[k] / length;
            }
            /* on an edge of a box either face's will do; a plate's two are opposite */
            assert_true(fabs(cosine) > 0.999 || kind == bb_prim_kinds[BB_AABB]);
            expect_hit(scene, kind, i, point, normal);
        }
    }
    bb_scene_free(scene);
}

static void regions_inside_a_box_hold_none_of_it(void **state)
{
    (void)state;
    bb_scene *scene = one_box((const float[6]){0, 0, 0, 4, 4, 4});
    const bb_prim_kind *box = bb_prim_kinds[BB_AABB];
    double lo[3] = {1, 1, 1}, hi[3] = {2, 2, 2};
    assert_false(box->shrink(scene, 0, lo, hi));
    lo[1] = -1;
    assert_true(box->shrink(scene, 0, lo, hi));
    assert_true(lo[1] == 0.0 && lo[0] == 1.0 && hi[1] == 2.0);
    double beyond_lo[3] = {5, 1, 1}, beyond_hi[3] = {6, 2, 2};
    assert_false(box->shrink(scene, 0, beyond_lo, beyond_hi));
    bb_scene_free(scene);
}

static void samples_are_even_over_the_faces(void **state)
{
    (void)state;
    enum { SAMPLES = 60000 };
    bb_scene *scene = one_box((const float[6]){0, 0, 0, 1, 2, 3});
    const bb_prim_kind *box = bb_prim_kinds[BB_AABB];
    const double areas[3] = {6, 3, 2};
    uint32_t faces[3][2] = {{0}};
    bb_random random = bb_random_make(5, 0);
    for (uint32_t n = 0; n < SAMPLES; n++) {
        double point[3], normal[3];
        box->sample(scene, 0, &random, point, normal);
        for (int k = 0; k < 3; k++)
            if (normal[k] != 0.0)
                faces[k][normal[k] > 0.0]++;
    }
    assert_true(box->area(scene, 0) == 22.0);
    for (int k = 0; k < 3; k++)
        for (int upper = 0; upper < 2; upper++)
            assert_true(fabs(faces[k][upper] - SAMPLES * areas[k] / 22) < 5 * sqrt(SAMPLES / 6.0));
    bb_scene_free(scene);
}

static void bad_boxes_are_refused(void **state)
{
    (void)state;
    const float bad[][6] = {{0, 0, 0, NAN, 1, 1}, {1, 0, 0, 0, 1, 1}, {0, 0, 0, 1, INFINITY, 1}};
    for (int n = 0; n < 3; n++) {
        bb_scene *scene = one_box(bad[n]);
        assert_int_equal(bb_scene_finish(scene), BB_INVALID);
        assert_non_null(strstr(bb_message(), "box 0"));
        bb_scene_free(scene);
    }
    bb_scene *scene = one_box((const float[6]){-0.0f, 0, 0, -0.0f, 1, 1});
    assert_int_equal(bb_scene_finish(scene), BB_OK);
    assert_false(signbit(bb_scene_floats(scene, BB_AABB)[0]));
    bb_scene_free(scene);
}

/* ---- the arbiter ---- */

/* Close to a box's silhouette some of the nine miss it: t must be near where the ray enters or
 * leaves all the same, not anywhere between. */
static void silhouettes_hide_no_wrong_distance(void **state)
{
    (void)state;
    bb_scene *scene = one_box((const float[6]){0, 0, 0, 1000, 1, 1});
    assert_int_equal(bb_scene_finish(scene), BB_OK);
    bb_arbiter arbiter;
    assert_int_equal(bb_arbiter_create(scene, &arbiter), BB_OK);
    const float heights[] = {0.5f, 0.9999f, 1.0f, 1.0004f};
    for (int h = 0; h < 4; h++) {
        const bb_ray ray = {{-5, heights[h], 0.5f}, 0, {1, 0, 0}, INFINITY};
        const bb_hit entered = {5, 0}, within = {500, 0}, left = {1005, 0},
                     none = {INFINITY, BB_NONE};
        assert_int_equal(bb_arbiter_judge(&arbiter, &ray, &entered, &bb_query_closest, false),
                         BB_RIGHT);
        assert_int_equal(bb_arbiter_judge(&arbiter, &ray, &within, &bb_query_any, false),
                         BB_WRONG_T);
        if (h == 0)
            assert_int_equal(bb_arbiter_judge(&arbiter, &ray, &left, &bb_query_closest, false),
                             BB_WRONG_T);
        assert_int_equal(bb_arbiter_judge(&arbiter, &ray, &none, &bb_query_closest, false),
                         h == 0 ? BB_MISSED : BB_RIGHT);
    }
    bb_arbiter_destroy(&arbiter);
    bb_scene_free(scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lines_meet_boxes_as_in_exact_arithmetic),
        cmocka_unit_test(primitives_are_numbered_through),
        cmocka_unit_test(points_of_a_surface_are_on_it),
        cmocka_unit_test(regions_inside_a_box_hold_none_of_it),
        cmocka_unit_test(samples_are_even_over_the_faces),
        cmocka_unit_test(bad_boxes_are_refused),
        cmocka_unit_test(silhouettes_hide_no_wrong_distance),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
