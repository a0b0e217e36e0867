/* The host builders, sah (both methods) and null: on random and adversarial boxes their trees pass
 * the checker, come out the same twice, and the sweep is at least as good as the bins. */
#include "framework/base/clock.h"
#include "tests/builder_fixture.h"

static const uint64_t SEED = 99;

/* ---- adversarial scenes; `i` of `count` ---- */

typedef void fill(bb_box *box, uint32_t i, uint32_t count, bb_random *random);

static void set(bb_box *box, float x, float y, float z, float size)
{
    const float lo[3] = {x, y, z};
    for (int axis = 0; axis < 3; axis++) {
        box->lo[axis] = lo[axis];
        box->hi[axis] = lo[axis] + size;
    }
}

static void all_equal(bb_box *box, uint32_t i, uint32_t count, bb_random *random)
{
    (void)i, (void)count, (void)random;
    set(box, 1, 2, 3, 4);
}
static void all_points(bb_box *box, uint32_t i, uint32_t count, bb_random *random)
{
    (void)i, (void)count, (void)random;
    set(box, -0.0f, 0, 0, 0);
}
static void concentric(bb_box *box, uint32_t i, uint32_t count, bb_random *random)
{
    (void)count, (void)random;
    float r = (float)(i + 1);
    set(box, -r, -r, -r, 2 * r);
}
static void points_on_a_line(bb_box *box, uint32_t i, uint32_t count, bb_random *random)
{
    (void)random;
    set(box, (float)((i * 7919ull) % count), 0, 0, 0);
}
static void on_a_diagonal(bb_box *box, uint32_t i, uint32_t count, bb_random *random)
{
    (void)count, (void)random;
    set(box, (float)i, (float)i, (float)i, 1);
}
static void flat(bb_box *box, uint32_t i, uint32_t count, bb_random *random)
{
    (void)i, (void)count;
    set(box, (float)bb_random_unit(random), (float)bb_random_unit(random), 5, 0.1f);
    box->hi[2] = box->lo[2];
}
static void geometric(bb_box *box, uint32_t i, uint32_t count, bb_random *random)
{
    (void)random;
    float size = ldexpf(1, (int)(i * 200ull / count) - 100);
    set(box, size, 0, 0, size);
}
static void huge(bb_box *box, uint32_t i, uint32_t count, bb_random *random)
{
    (void)i, (void)count;
    for (int axis = 0; axis < 3; axis++) {
        float a = (float)bb_random_range(random, -3.4e38, 3.4e38);
        float b = (float)bb_random_range(random, -3.4e38, 3.4e38);
        box->lo[axis] = fminf(a, b);
        box->hi[axis] = fmaxf(a, b);
    }
}
static void denormal(bb_box *box, uint32_t i, uint32_t count, bb_random *random)
{
    (void)i, (void)count;
    for (int axis = 0; axis < 3; axis++) {
        box->lo[axis] = 0x1p-149f * (float)bb_random_below(random, 5);
        box->hi[axis] = box->lo[axis] + 0x1p-149f * (float)bb_random_below(random, 3);
    }
}
static void two_clusters(bb_box *box, uint32_t i, uint32_t count, bb_random *random)
{
    (void)count, (void)random;
    set(box, i % 2 ? 1e30f : -1e30f, 0, 0, 0);
}
static void one_outlier(bb_box *box, uint32_t i, uint32_t count, bb_random *random)
{
    (void)count;
    float far = i == 0 ? 1e8f : 0;
    set(box, far + (float)bb_random_unit(random), (float)bb_random_unit(random), 0, 1e-3f);
}
static void neighbouring_floats(bb_box *box, uint32_t i, uint32_t count, bb_random *random)
{
    (void)count, (void)random;
    set(box, i % 3 ? 1e7f : nextafterf(1e7f, 1e8f), i % 2 ? 1e7f : nextafterf(1e7f, 1e8f), 0, 0);
}
static void large_overlap(bb_box *box, uint32_t i, uint32_t count, bb_random *random)
{
    (void)i, (void)count;
    set(box, (float)bb_random_unit(random), (float)bb_random_unit(random),
        (float)bb_random_unit(random), 1e6f);
}

static const struct {
    const char *name;
    fill *fill;
} adversaries[] = {
    {"all_equal", all_equal},         {"all_points", all_points},
    {"concentric", concentric},       {"points_on_a_line", points_on_a_line},
    {"on_a_diagonal", on_a_diagonal}, {"flat", flat},
    {"geometric", geometric},         {"huge", huge},
    {"denormal", denormal},           {"two_clusters", two_clusters},
    {"one_outlier", one_outlier},     {"neighbouring_floats", neighbouring_floats},
    {"large_overlap", large_overlap},
};

static const char *const specs[] = {"null",
                                    "sah",
                                    "sah:bins=2",
                                    "sah:bins=256,leaf=3",
                                    "sah:leaf=255",
                                    "sah:method=sweep",
                                    "sah:method=sweep,leaf=8"};

static void test_adversarial_boxes(void **state)
{
    (void)state;
    const uint32_t counts[] = {1, 2, 3, 5, 64, 4000};
    for (size_t s = 0; s < sizeof specs / sizeof *specs; s++) {
        made m;
        open_builder(specs[s], &m);
        for (size_t a = 0; a < sizeof adversaries / sizeof *adversaries; a++)
            for (size_t c = 0; c < sizeof counts / sizeof *counts; c++) {
                bb_random random = bb_random_make(SEED, a);
                bb_scene *scene = make_box_scene(counts[c]);
                for (uint32_t i = 0; i < counts[c]; i++)
                    adversaries[a].fill(&scene->boxes[i], i, counts[c], &random);
                uint64_t once, twice;
                build(&m, scene);
                ASSERT_OK(bb_tree_hash(&m.tree, &once));
                build(&m, scene);
                ASSERT_OK(bb_tree_hash(&m.tree, &twice));
                if (once != twice)
                    fail_msg("%s on %s: another tree", specs[s], adversaries[a].name);
                if (m.tree.info.depth > 600)
                    fail_msg("%s on %s: depth %u of %u primitives", specs[s], adversaries[a].name,
                             m.tree.info.depth, counts[c]);
                free_scene(scene);
            }
        close_builder(&m);
    }
}

/* Equal boxes can't be told apart: halves by index, so the depth is the logarithm. Zero areas make
 * all splits equal. */
static void test_depth_of_ties(void **state)
{
    (void)state;
    const char *const methods[] = {"sah:method=binned", "sah:method=sweep"};
    fill *const fills[] = {all_equal, all_points, concentric, points_on_a_line};
    for (size_t s = 0; s < 2; s++)
        for (size_t f = 0; f < 4; f++) {
            made m;
            open_builder(methods[s], &m);
            bb_scene *scene = make_box_scene(1 << 14);
            for (uint32_t i = 0; i < scene->prim_count; i++)
                fills[f](&scene->boxes[i], i, scene->prim_count, NULL);
            build(&m, scene);
            assert_int_equal(m.tree.info.depth, 14);
            assert_int_equal(m.tree.info.node_count, 2 * scene->prim_count - 1);
            close_builder(&m);
            free_scene(scene);
        }
}

static double sah_of(const char *spec, const bb_scene *scene)
{
    made m;
    open_builder(spec, &m);
    build(&m, scene);
    double sah = bb_tree_sah(&m.tree);
    close_builder(&m);
    return sah;
}

static void test_quality(void **state)
{
    (void)state;
    for (uint32_t run = 0; run < 30; run++) {
        bb_random random = bb_random_make(SEED + 1, run);
        bb_scene *scene = make_random_scene(2 + bb_random_below(&random, 3000), &random);
        double binned = sah_of("sah", scene), sweep = sah_of("sah:method=sweep", scene);
        double leaves = sah_of("sah:method=sweep,leaf=8", scene), null = sah_of("null", scene);
        if (!(sweep <= 1.02 * binned && leaves <= sweep * (1 + 1e-12) && binned <= 2 * null))
            fail_msg("seed %llu run %u: binned %g sweep %g leaf=8 %g null %g",
                     (unsigned long long)SEED, run, binned, sweep, leaves, null);
        free_scene(scene);
    }
}

/* Four unit cubes on a line, the second pair far away: the cheapest first split is between the
 * pairs, on both methods. Root [0,102] x 1 x 1: half area 205; pairs [0,2] x 1 x 1: 5; cubes: 3.
 * (1.2 * 205 + 2 * 1.2 * 5 + 4 * 3) / 205. */
static void test_by_hand(void **state)
{
    (void)state;
    bb_scene *scene = make_box_scene(4);
    const float x[4] = {101, 0, 100, 1};
    for (uint32_t i = 0; i < 4; i++)
        set(&scene->boxes[i], x[i], 0, 0, 1);
    const char *const methods[] = {"sah:method=binned", "sah:method=sweep"};
    for (size_t s = 0; s < 2; s++)
        ASSERT_NEAR(sah_of(methods[s], scene), (1.2 * 205 + 2 * 1.2 * 5 + 4 * 3) / 205, 1e-14);
    free_scene(scene);
}

static void test_phases_and_options(void **state)
{
    (void)state;
    made m;
    bb_random random = bb_random_make(SEED + 2, 0);
    bb_scene *scene = make_random_scene(20000, &random);
    open_builder("sah:method=sweep", &m);
    build(&m, scene);
    assert_int_equal(m.phases.count, 3);
    assert_string_equal(m.phases.names[1], "sort");
    assert_int_equal(m.phases.current, -1);
    for (uint32_t i = 0; i < 3; i++)
        assert_true(m.phases.ms[i] > 0);
    close_builder(&m);
    free_scene(scene);

    const char *const bad[] = {"sah:bins=1", "sah:bins=257", "sah:leaf=0", "sah:leaf=x"};
    for (size_t i = 0; i < 4; i++) {
        bb_spec spec;
        void *self = NULL;
        bb_account account = {0};
        const bb_builder *sah = bb_builder_find("sah");
        ASSERT_OK(bb_spec_parse(bad[i], &spec));
        bb_builder_context context = {
            .account = &account, .spec = &spec, .options = sah->options, .threads = 1};
        assert_int_equal(sah->create(&context, &self), BB_INVALID);
        sah->destroy(self);
        assert_int_equal(account.bytes, 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_adversarial_boxes),
        cmocka_unit_test(test_depth_of_ties),
        cmocka_unit_test(test_quality),
        cmocka_unit_test(test_by_hand),
        cmocka_unit_test(test_phases_and_options),
    };
    return cmocka_run_group_tests_name("sah", tests, NULL, NULL);
}
