/* Pre-splitting by priority: against a plain reading of the paper for few triangles, in all forms;
 * covers, budgets, degenerate and extreme inputs, kinds that stay whole; options and orders of
 * stages. Early split clipping: test_presplit_esc.c. Seed: BVHBENCH_TEST_SEED. BVHBENCH_TEST_SMALL
 * keeps the inputs small (for oclgrind). */
#include "framework/builder/instance.h"
#include "framework/builder/registry.h"
#include "framework/builder/tree_cover.h"
#include "tests/box_inputs.h"
#include "tests/device_forms.h"
#include "tests/presplit_reference.h"
#include "tests/quality_inputs.h"
#include "tests/tree_fixture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { CORNERS = 9 };

static bool small;

/* ---- scenes ---- */

/* Sizes from large to small, every third one thin, some of them walls. */
static void fill_triangles(bb_random *random, uint32_t count, float *corners)
{
    for (uint32_t i = 0; i < count; i++) {
        double centre[3], size = ldexp(1, -(int)bb_random_below(random, 7));
        for (int k = 0; k < 3; k++)
            centre[k] = bb_random_range(random, -1, 1);
        uint32_t flat = bb_random_below(random, 8);
        for (int c = 0; c < CORNERS; c++) {
            double by = size * bb_random_range(random, -1, 1);
            if (i % 3 == 0 && c >= 6) /* near to the first corner */
                by = corners[CORNERS * i + c - 6] - centre[c % 3] + 0.01 * by;
            corners[CORNERS * i + c] = (float)(centre[c % 3] + (c % 3 == (int)flat ? 0 : by));
        }
    }
}

static void release(bb_scene *scene)
{
    bb_buffer_release(&scene->on_device.boxes);
    bb_buffer_release(&scene->on_device.vertices);
    bb_buffer_release(&scene->on_device.prims);
    free_scene(scene);
}

typedef struct presplit_build {
    bb_scene *scene;
    bb_instance instance;
    uint64_t hash;
} presplit_build;

/* Builds twice by one object; the tree is one, and valid. */
static void open_build(presplit_build *b, bb_device *on, const char *builder, const float *corners,
                       uint32_t count, const char *what)
{
    uint64_t again = 0;
    memset(b, 0, sizeof *b);
    b->scene = make_scene(corners, count, NULL, 0);
    bb_status status = bb_scene_upload(b->scene, on);
    if (status == BB_OK)
        status = bb_instance_create(on, builder, b->scene, 1, &b->instance);
    for (int i = 0; i < 2 && status == BB_OK; i++) {
        status = bb_instance_build(&b->instance, b->scene, false, NULL);
        if (status == BB_OK)
            status = bb_tree_download(&b->instance.tree, NULL);
        if (status == BB_OK)
            status = bb_tree_check(&b->instance.tree, b->scene);
        if (status == BB_OK)
            status = bb_tree_hash(&b->instance.tree, i == 0 ? &b->hash : &again);
    }
    if (status == BB_OK)
        status = bb_references_download(&b->instance.references, NULL);
    if (status != BB_OK)
        fail_msg("%s, %s, %u triangles, seed %llu: %s", builder, what, count,
                 (unsigned long long)seed, bb_message());
    assert_true(b->hash == again);
}

static void close_build(presplit_build *b)
{
    bb_instance_destroy(&b->instance);
    release(b->scene);
}

/* ---- by definition ---- */

/* Numbers of splits are those of one D, and a D that is larger by a thousandth exceeds the budget.
 */
static void expect_one_d(const definition *d, const uint32_t *splits, uint32_t count, double beta)
{
    double least = 0, most = INFINITY, sum = 0;
    for (uint32_t i = 0; i < count; i++) {
        double p = priority_of(d, i);
        if (splits[i] > 0)
            least = fmax(least, splits[i] / p);
        if (splits[i] < PS_MOST && p > 0)
            most = fmin(most, (splits[i] + 1) / p);
    }
    if (!(least <= most * (1 + 1e-5)))
        fail_msg("no D: %g to %g, seed %llu", least, most, (unsigned long long)seed);
    for (uint32_t i = 0; i < count; i++)
        sum += fmin(PS_MOST, floor(priority_of(d, i) * most * 1.001));
    if (isfinite(most) && sum <= floor(beta * count))
        fail_msg("%g splits of %u triangles keep to beta %g, seed %llu", sum, count, beta,
                 (unsigned long long)seed);
}

/* Returns how many primitives were compared. */
static uint32_t expect_parts(const presplit_build *b, const definition *d, const uint32_t *splits)
{
    uint32_t compared = 0;
    const bb_references *r = &b->instance.references;
    const uint32_t count = b->scene->prim_count;
    for (uint32_t i = 0, at = 0; i < count; at += splits[i++] + 1) {
        parts expected = {.count = 0};
        split_by_definition(d, i, b->scene->boxes[i], splits[i], &expected);
        assert_int_equal(expected.count, splits[i] + 1);
        compared += !expected.close && splits[i] > 0;
        for (uint32_t s = 0; s <= splits[i] && !expected.close; s++)
            for (int k = 0; k < 3; k++) {
                const bb_box *is = &r->boxes[at + s], *was = &expected.boxes[s];
                double near = 1e-5 * longest_of(&b->scene->boxes[i]) + 1e-6;
                assert_int_equal(r->prims[at + s], i);
                if (fabs((double)is->lo[k] - was->lo[k]) > near ||
                    fabs((double)is->hi[k] - was->hi[k]) > near)
                    fail_msg("part %u of %u of triangle %u, axis %d: %g to %g, not %g to %g, seed "
                             "%llu",
                             s, splits[i] + 1, i, k, is->lo[k], is->hi[k], was->lo[k], was->hi[k],
                             (unsigned long long)seed);
            }
    }
    return compared;
}

static void few_triangles_are_split_by_definition(void **state)
{
    (void)state;
    static const uint32_t counts[] = {1, 2, 3, 7, 20, 64};
    static const double betas[] = {0.1, 0.3, 1, 4};
    enum { COUNTS = sizeof counts / sizeof counts[0], BETAS = sizeof betas / sizeof betas[0] };
    bb_random random = bb_random_make(seed, 1);
    uint32_t split = 0, compared = 0;
    for (uint32_t run = 0; run < COUNTS * BETAS; run++) {
        const uint32_t count = counts[run / BETAS];
        if (small && (count < 7 || count > 20))
            continue;
        const double beta = betas[run % BETAS];
        float corners[64 * CORNERS];
        char builder[64];
        fill_triangles(&random, count, corners);
        const double least = run % 3 == 0 ? 0.3 : -1;
        snprintf(builder, sizeof builder, "presplit:beta=%g,saves=%g+sah", beta, least);
        for (int form = first_form(); form < FORMS; form++) {
            presplit_build b;
            open_build(&b, devices[form], builder, corners, count, "by definition");
            uint32_t splits[64] = {0};
            for (uint32_t i = 0; i < b.instance.references.count; i++)
                splits[b.instance.references.prims[i]]++;
            for (uint32_t i = 0; i < count; i++)
                split += --splits[i] > 0;
            definition d = define(b.scene, least);
            expect_one_d(&d, splits, count, beta);
            compared += expect_parts(&b, &d, splits);
            close_build(&b);
        }
    }
    assert_true(compared > (small ? 10 : 300) && compared > split / 2);
}

/* ---- what always holds ---- */

/* The same references, bit for bit, and the same tree. */
static void expect_same_in_all_forms(const char *builder, const float *corners, uint32_t count,
                                     double beta, const char *what)
{
    presplit_build first;
    open_build(&first, devices[first_form()], builder, corners, count, what);
    const bb_references *r = &first.instance.references;
    if (r->count > count + floor(beta * count))
        fail_msg("%s, %s: %u references of %u triangles", builder, what, r->count, count);
    assert_int_equal(first.instance.tree.duplicated, r->count > count);
    for (int form = first_form() + 1; form < FORMS; form++) {
        presplit_build other;
        open_build(&other, devices[form], builder, corners, count, what);
        const bb_references *o = &other.instance.references;
        if (o->count != r->count || memcmp(o->boxes, r->boxes, r->count * sizeof(bb_box)) != 0 ||
            memcmp(o->prims, r->prims, r->count * sizeof(uint32_t)) != 0 ||
            other.hash != first.hash)
            fail_msg("%s, %s, %u triangles: forms differ", builder, what, count);
        close_build(&other);
    }
    close_build(&first);
}

static void all_forms_split_alike(void **state)
{
    (void)state;
    static const double betas[] = {0, 0.3, 15};
    static const double scales[] = {1, 0x1p-90, 0x1p100, 1e-3};
    static const double offsets[] = {0, 0, 0, 1e4};
    const uint32_t count = small ? 30 : 1500;
    bb_random random = bb_random_make(seed, 2);
    float *corners = malloc(count * CORNERS * sizeof *corners);
    for (size_t s = 0; s < sizeof scales / sizeof scales[0]; s++) {
        fill_triangles(&random, count, corners);
        for (uint32_t i = 0; i < count * CORNERS; i++)
            corners[i] = (float)(corners[i] * scales[s] + offsets[s]);
        for (size_t i = small ? 1 + s % 2 : 0; i < (small ? 2 + s % 2 : 3); i++) {
            char builder[64], what[64];
            snprintf(builder, sizeof builder, "presplit:beta=%g,saves=-1+lbvh", betas[i]);
            snprintf(what, sizeof what, "times %g, from %g on", scales[s], offsets[s]);
            expect_same_in_all_forms(builder, corners, count, betas[i], what);
        }
    }
    free(corners);
}

/* Triangles from corner to corner of boxes that are awkward. */
static void degenerate_inputs_are_covered(void **state)
{
    (void)state;
    static const uint32_t counts[] = {1, 2, 3, 50, 300};
    for (size_t k = 0; k < QUALITY_INPUTS; k++)
        for (size_t c = 0; c < sizeof counts / sizeof counts[0]; c++) {
            const uint32_t count = counts[c];
            if (small && (k % 3 != 0 || c != k / 3 % 4))
                continue;
            bb_box *boxes = make_boxes(quality_inputs, k, count);
            float *corners = triangles_of_boxes(boxes, count);
            expect_same_in_all_forms("presplit:beta=2,saves=-1+sah", corners, count, 2,
                                     quality_inputs[k].name);
            free(corners);
            free(boxes);
        }
}

/* One triangle of many takes no more than PS_MOST splits. */
static void no_triangle_takes_all(void **state)
{
    (void)state;
    const uint32_t count = small ? 80 : 2000;
    float *corners = calloc(count * CORNERS, sizeof *corners);
    bb_random random = bb_random_make(seed, 3);
    fill_triangles(&random, count, corners);
    for (uint32_t i = 1; i < count; i++)
        for (int c = 0; c < CORNERS; c++)
            corners[CORNERS * i + c] = 0.5f + 1e-5f * corners[CORNERS * i + c];
    const float large[CORNERS] = {-1, -1, -1, 1, 1, 1, 1, 0.5f, -0.5f};
    memcpy(corners, large, sizeof large);
    presplit_build b;
    open_build(&b, devices[first_form()], "presplit:beta=0.5,saves=-1+sah", corners, count,
               "one of many");
    uint32_t of_first = 0;
    for (uint32_t i = 0; i < b.instance.references.count; i++)
        of_first += b.instance.references.prims[i] == 0;
    assert_int_equal(of_first, PS_MOST + 1);
    close_build(&b);
    free(corners);
}

static void what_is_no_triangle_stays_whole(void **state)
{
    (void)state;
    static const char *const scenes[] = {"tets:side=2", "spheres:n=500", "blocks:side=4"};
    for (size_t i = 0; i < (small ? 1 : sizeof scenes / sizeof scenes[0]); i++) {
        bb_scene *scene;
        bb_instance instance;
        ASSERT_OK(bb_scene_load(scenes[i], &scene));
        ASSERT_OK(bb_scene_upload(scene, devices[first_form()]));
        ASSERT_OK(
            bb_instance_create(devices[first_form()], "presplit:beta=2+sah", scene, 1, &instance));
        ASSERT_OK(bb_instance_build(&instance, scene, false, NULL));
        assert_int_equal(instance.references.count, scene->prim_count);
        assert_false(instance.tree.duplicated);
        ASSERT_OK(bb_tree_check(&instance.tree, scene));
        bb_instance_destroy(&instance);
        bb_scene_free(scene);
    }
}

/* What lies askew makes the better tree in parts, by any builder. */
static void splits_pay_where_boxes_are_empty(void **state)
{
    (void)state;
    static const char *const builders[] = {"sah", "lbvh", "ploc"};
    bb_scene *scene;
    if (small)
        return;
    ASSERT_OK(bb_scene_load("slivers:aspect=40", &scene));
    ASSERT_OK(bb_scene_upload(scene, devices[first_form()]));
    for (size_t i = 0; i < sizeof builders / sizeof builders[0]; i++) {
        double sah[2];
        for (int split = 0; split < 2; split++) {
            char text[64];
            bb_instance instance;
            snprintf(text, sizeof text, "%s%s", split ? "presplit:beta=1+" : "", builders[i]);
            ASSERT_OK(bb_instance_create(devices[first_form()], text, scene, 1, &instance));
            ASSERT_OK(bb_instance_build(&instance, scene, false, NULL));
            ASSERT_OK(bb_tree_download(&instance.tree, NULL));
            sah[split] = bb_tree_sah(&instance.tree);
            bb_instance_destroy(&instance);
        }
        if (!(sah[1] < 0.8 * sah[0]))
            fail_msg("%s: SAH %g, split %g", builders[i], sah[0], sah[1]);
    }
    bb_scene_free(scene);
}

/* ---- what is refused ---- */

static void options_choose_the_method(void **state)
{
    (void)state;
    static const char *const cases[][2] = {
        {"presplit:budget=2", "early split clipping"},
        {"presplit:saves=-1,above=0.1", "early split clipping"},
        {"presplit:method=esc", "early split clipping"},
        {"presplit", "early split clipping"},
        {"presplit:beta=0.1,saves=-1", "by priority"},
        {"presplit:beta=0.1", "by priority"},
        {"presplit:method=priority", "by priority"},
    };
    static const char *const bad[][2] = {
        {"presplit:beta=0.3,budget=2", "option 'budget' is not of the method 'priority'"},
        {"presplit:method=esc,beta=0.3", "option 'beta' is not of the method 'esc'"},
        {"presplit:method=priority,above=0", "option 'above' is not of the method 'priority'"},
        {"presplit:beta=16", "must be a number from 0 to 15"},
        {"presplit:beta=-1", "must be a number from 0 to 15"},
        {"presplit:method=none", "'none'"},
    };
    /* else `presplit` and `presplit:beta=0.3` would be one cell in a record */
    bb_spec plain;
    ASSERT_OK(bb_spec_parse("presplit", &plain));
    assert_null(bb_spec_value(&plain, bb_builder_find("presplit")->options, "beta"));
    float corners[20 * CORNERS];
    bb_random random = bb_random_make(seed, 4);
    fill_triangles(&random, 20, corners);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char builder[96], text[256];
        presplit_build b;
        if (small && i > 0)
            continue;
        snprintf(builder, sizeof builder, "%s+sah", cases[i][0]);
        open_build(&b, devices[first_form()], builder, corners, 20, "options");
        ASSERT_OK(bb_instance_describe(&b.instance, b.scene, text, sizeof text));
        if (strstr(text, cases[i][1]) == NULL)
            fail_msg("%s: expected '%s' in '%s'", builder, cases[i][1], text);
        close_build(&b);
    }
    bb_scene *scene = make_scene(corners, 20, NULL, 0);
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        char builder[96];
        bb_instance instance;
        snprintf(builder, sizeof builder, "%s+sah", bad[i][0]);
        assert_int_equal(bb_instance_create(devices[first_form()], builder, scene, 1, &instance),
                         BB_INVALID);
        if (strstr(bb_message(), bad[i][1]) == NULL || strchr(bb_message(), '\n') != NULL)
            fail_msg("'%s': expected '%s' in '%s'", builder, bad[i][1], bb_message());
    }
    free_scene(scene);
}

static void splits_come_first_or_not_at_all(void **state)
{
    (void)state;
    static const char *const bad[][2] = {
        {"lbvh+presplit", "can only come first"},
        {"ploc+presplit:beta=0.3+rotate", "can only come first"},
        {"sbvh+presplit", "can only come first"},
        {"presplit:beta=0.3+presplit+lbvh", "can only come first"},
        {"presplit:beta=0.3+sbvh", "reads the primitives' geometry"},
        {"presplit:beta=0.3+rotate", "gives references"},
        {"presplit:beta=0.3", "write presplit:beta=0.3+BUILDER"},
        {"rotate+lbvh", "takes another builder's tree"},
        {"refit+presplit+lbvh", "takes another builder's tree"},
        {"lbvh+sbvh", "takes no tree"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_int_equal(bb_instance_check(bad[i][0]), BB_INVALID);
        if (strstr(bb_message(), bad[i][1]) == NULL || strchr(bb_message(), '\n') != NULL)
            fail_msg("'%s': expected '%s' in '%s'", bad[i][0], bad[i][1], bb_message());
    }
}

static int open_all(void **state)
{
    small = getenv("BVHBENCH_TEST_SMALL") != NULL;
    return open_devices(state);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(few_triangles_are_split_by_definition),
        cmocka_unit_test(all_forms_split_alike),
        cmocka_unit_test(degenerate_inputs_are_covered),
        cmocka_unit_test(no_triangle_takes_all),
        cmocka_unit_test(what_is_no_triangle_stays_whole),
        cmocka_unit_test(splits_pay_where_boxes_are_empty),
        cmocka_unit_test(options_choose_the_method),
        cmocka_unit_test(splits_come_first_or_not_at_all),
    };
    return cmocka_run_group_tests_name("presplit", tests, open_all, close_devices);
}
