/* What scenes ask for: decisions on made scenes whose needs are known; `auto` is what it decides,
 * given by hand, bit for bit; what is given wins and is recorded as given. */
#include "framework/builder/instance.h"
#include "framework/scene/needs.h"
#include "tests/decision_fixture.h"
#include "tests/device_fixture.h"
#include "tests/hand_scene.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Spheres on a grid, of radius `radius`; every tenth is `large` times as large. */
static bb_scene *grid(const uint32_t counts[3], float radius, float large)
{
    bb_scene *scene = hand_scene(0, counts[0] * counts[1] * counts[2]);
    float *s = bb_scene_floats(scene, BB_SPHERE);
    for (uint32_t i = 0; i < scene->prim_count; i++, s += 4) {
        s[0] = (float)(i % counts[0]);
        s[1] = (float)(i / counts[0] % counts[1]);
        s[2] = (float)(i / counts[0] / counts[1]);
        s[3] = i % 10 == 0 ? radius * large : radius;
    }
    hand_finish(scene);
    ASSERT_OK(bb_scene_profile(scene));
    return scene;
}

static void a_grid_needs_the_bits_that_count_it(void **state)
{
    (void)state;
    for (uint32_t k = 1; k <= 5; k++) {
        const uint32_t side = 1u << k, counts[3] = {side, side, side};
        bb_scene *scene = grid(counts, 0.01f, 1);
        assert_int_equal(scene->profile.bits_apart, 3 * k);
        /* two in a cell have one way to be split: a bit for them saves nothing, one more does */
        assert_true(bb_need_code_bits(scene) <= 3 * k);
        assert_true(bb_need_code_bits(scene) + 1 >= 3 * k);
        assert_int_equal(bb_need_size_octaves(scene), 0);
        hand_free(scene);
    }
}

/* An axis without extent takes its turn all the same: x, y, -, x, y, - ... */
static void a_flat_grid_needs_two_axes(void **state)
{
    (void)state;
    const uint32_t counts[3] = {16, 16, 1};
    bb_scene *scene = grid(counts, 0.01f, 1);
    assert_int_equal(scene->profile.bits_apart, 11);
    assert_true(bb_need_code_bits(scene) == 10 || bb_need_code_bits(scene) == 11);
    hand_free(scene);
}

/* Where primitives are as large as what a code would tell apart, it tells nothing worth it. */
static void large_primitives_need_fewer_bits(void **state)
{
    (void)state;
    const uint32_t counts[3] = {16, 16, 16};
    bb_scene *small = grid(counts, 0.01f, 1), *large = grid(counts, 20, 1);
    assert_int_equal(small->profile.bits_apart, large->profile.bits_apart);
    assert_true(bb_need_code_bits(large) < bb_need_code_bits(small));
    hand_free(small);
    hand_free(large);
}

static void what_is_one_point_needs_nothing(void **state)
{
    (void)state;
    bb_scene *scene = hand_scene(0, 100);
    memset(bb_scene_floats(scene, BB_SPHERE), 0, 400 * sizeof(float));
    hand_finish(scene);
    ASSERT_OK(bb_scene_profile(scene));
    assert_int_equal(scene->profile.bits_apart, 0);
    assert_int_equal(scene->profile.bits_useful, 0);
    assert_int_equal(bb_need_code_bits(scene), 3); /* the shortest code there is */
    assert_int_equal(bb_need_size_octaves(scene), 0);
    hand_free(scene);
    scene = hand_scene(1, 0);
    for (int i = 0; i < 9; i++)
        scene->vertices[i] = (float)(i * i);
    hand_finish(scene);
    ASSERT_OK(bb_scene_profile(scene));
    assert_int_equal(scene->profile.bits_useful, 0);
    assert_int_equal(bb_need_size_octaves(scene), 0);
    hand_free(scene);
}

/* Equal centroids are no reason for longer codes, close ones are. */
static void no_code_tells_equal_ones_apart(void **state)
{
    (void)state;
    bb_scene *scene = hand_scene(0, 64);
    float *s = bb_scene_floats(scene, BB_SPHERE);
    memset(s, 0, 256 * sizeof *s);
    s[0] = 1;
    hand_finish(scene);
    ASSERT_OK(bb_scene_profile(scene));
    assert_int_equal(scene->profile.bits_apart, 1);
    s[4] = 0x1p-40f; /* on its axis bit 41, of which a float's cell has 22 */
    hand_finish(scene);
    ASSERT_OK(bb_scene_profile(scene));
    assert_int_equal(scene->profile.bits_apart, BB_BITS_NONE);
    assert_true(scene->profile.bits_useful <= 3);
    hand_free(scene);
}

static void sizes_are_counted_in_octaves(void **state)
{
    (void)state;
    const uint32_t counts[3] = {9, 9, 9};
    bb_scene *scene = grid(counts, 0.01f, 64);
    const bb_profile *p = &scene->profile;
    assert_true(p->size_low <= p->size_median && p->size_high >= 60 * p->size_median);
    double whole = 0;
    for (int k = 0; k < 3; k++)
        whole += pow((double)scene->bounds.hi[k] - scene->bounds.lo[k], 2);
    assert_int_equal(bb_need_size_octaves(scene), ceil(log2(sqrt(whole) / p->size_median)));
    hand_free(scene);
}

static void decisions_say_what_they_rest_on(void **state)
{
    (void)state;
    const uint32_t counts[3] = {4, 4, 4};
    bb_scene *scene = grid(counts, 0.01f, 1);
    bb_decisions needs = {0};
    bb_scene_needs(scene, &needs);
    const bb_decision *kinds = find_decision(&needs, BB_DECIDED_KINDS);
    /* builders that are octrees decide that for themselves */
    assert_null(find_decision(&needs, BB_DECIDED_LEVELS));
    assert_string_equal(kinds->value, "spheres");
    assert_string_equal(kinds->figure, "0 triangles, 64 spheres, 0 boxes, 0 tetrahedra");
    assert_int_equal(kinds->by, BB_BY_SCENE);
    assert_non_null(strstr(find_decision(&needs, BB_DECIDED_CODE_BITS)->figure, "6 tell all"));
    assert_string_equal(find_decision(&needs, BB_DECIDED_SIZE_BITS)->value, "0");
    assert_string_equal(find_decision(&needs, "index bits")->value, "32");
    assert_null(find_decision(&needs, "nothing"));
    assert_null(find_decision(&needs, "frames"));
    scene->frame_count = 5;
    bb_scene_needs(scene, &needs);
    assert_string_equal(find_decision(&needs, "frames")->value, "1");
    assert_non_null(strstr(find_decision(&needs, "frames")->figure, "the first of 5"));
    assert_non_null(strstr(find_decision(&needs, "frames")->figure, "animate"));
    for (int i = 0; i < BB_DECISIONS_MAX + 3; i++)
        bb_decide_number(&needs, "one more", 1, BB_GIVEN, "none");
    assert_int_equal(needs.count, BB_DECISIONS_MAX);
    hand_free(scene);
}

/* ---- builders ---- */

static uint64_t build(const char *builder, bb_scene *scene, bb_decisions *decisions)
{
    bb_instance instance;
    check(bb_instance_create(device, builder, scene, 1, &instance), builder);
    check(bb_instance_build(&instance, scene, false, NULL), builder);
    check(bb_instance_decisions(&instance, scene, decisions), builder);
    check(bb_tree_download(&instance.tree, NULL), builder);
    check(bb_tree_check(&instance.tree, scene), builder);
    uint64_t hash;
    check(bb_tree_hash(&instance.tree, &hash), builder);
    bb_instance_destroy(&instance);
    return hash;
}

static const char *value_of(const bb_decisions *decisions, const char *what, bb_decider by)
{
    const bb_decision *d = find_decision(decisions, what);
    assert_non_null(d);
    assert_int_equal(d->by, by);
    return d->value;
}

static const char *const scenes[] = {"single",
                                     "cube",
                                     "spheres:n=3000,state=initial",
                                     "random:n=3000",
                                     "city:n=10000",
                                     "awkward:kind=flat",
                                     "awkward:kind=outlier,n=2000",
                                     "awkward:kind=centroids,n=500"};

static void auto_is_what_it_decides_given_by_hand(void **state)
{
    (void)state;
    static const char *const by_scene[][2] = {
        {"lbvh:bits=auto", "lbvh:bits=%s"},
        {"lbvh:bits=auto,link=karras,axes=extent", "lbvh:bits=%s,link=karras,axes=extent"},
        {"llbvh:bits=auto", "llbvh:bits=%s"},
        {"emc:bits=auto,size-bits=auto", "emc:bits=%s,size-bits=%s"},
        {"emc:code=emc64-cell,bits=auto,size-bits=auto",
         "emc:code=emc64-cell,bits=%s,size-bits=%s"},
    };
    for (size_t s = 0; s < sizeof scenes / sizeof scenes[0]; s++) {
        bb_scene *scene;
        ASSERT_OK(bb_scene_load(scenes[s], &scene));
        ASSERT_OK(bb_scene_upload(scene, device));
        for (size_t i = 0; i < sizeof by_scene / sizeof by_scene[0]; i++) {
            bb_decisions decided = {0}, given = {0};
            char text[200], bits[48], sizes[48] = "";
            uint64_t hash = build(by_scene[i][0], scene, &decided);
            snprintf(bits, sizeof bits, "%s",
                     value_of(&decided, BB_DECIDED_CODE_BITS, BB_BY_SCENE));
            if (strstr(by_scene[i][0], "size-bits") != NULL)
                snprintf(sizes, sizeof sizes, "%s",
                         value_of(&decided, BB_DECIDED_SIZE_BITS, BB_BY_SCENE));
            if (atoi(bits) < 3)
                continue; /* a code that stops short of what was asked for: no axis has extent */
            snprintf(text, sizeof text, by_scene[i][1], bits, sizes);
            if (build(text, scene, &given) != hash)
                fail_msg("%s: the tree of %s is not that of %s", scenes[s], by_scene[i][0], text);
            assert_string_equal(value_of(&given, BB_DECIDED_CODE_BITS, BB_GIVEN), bits);
        }
        bb_scene_free(scene);
    }
}

/* An object that is given another scene settles it anew, with keys of another width too. */
static void an_object_decides_for_each_scene(void **state)
{
    (void)state;
    static const char *const two[] = {"random:n=500", "scales:from=-8,to=8,n=1"};
    static const char *const builders[] = {
        "lbvh:bits=auto",   "llbvh:bits=auto", "emc:bits=auto,size-bits=auto",
        "aac:bits=auto",    "ploc:bits=auto",  "hploc:bits=auto",
        "bonsai:bits=auto", "hlbvh:bits=auto"};
    bb_scene *both[2];
    for (int s = 0; s < 2; s++) {
        ASSERT_OK(bb_scene_load(two[s], &both[s]));
        ASSERT_OK(bb_scene_upload(both[s], device));
    }
    both[1]->profile.bits_useful = 50; /* whatever it is: long keys */
    for (size_t i = 0; i < sizeof builders / sizeof builders[0]; i++) {
        bb_instance instance;
        check(bb_instance_create(device, builders[i], both[0], 1, &instance), builders[i]);
        for (int turn = 0; turn < 4; turn++) {
            bb_decisions fresh = {0}, again = {0};
            check(bb_instance_build(&instance, both[turn % 2], false, NULL), builders[i]);
            check(bb_tree_download(&instance.tree, NULL), builders[i]);
            check(bb_instance_decisions(&instance, both[turn % 2], &again), builders[i]);
            uint64_t hash = build(builders[i], both[turn % 2], &fresh), own;
            check(bb_tree_hash(&instance.tree, &own), builders[i]);
            if (own != hash)
                fail_msg("%s, turn %d: not the tree of a fresh object", builders[i], turn);
            assert_string_equal(again.items[0].value, fresh.items[0].value);
        }
        bb_instance_destroy(&instance);
    }
    bb_scene_free(both[0]);
    bb_scene_free(both[1]);
}

static void what_is_given_wins(void **state)
{
    (void)state;
    bb_scene *scene;
    bb_decisions d = {0};
    ASSERT_OK(bb_scene_load("random:n=500", &scene));
    ASSERT_OK(bb_scene_upload(scene, device));
    build("lbvh:bits=20", scene, &d);
    assert_string_equal(value_of(&d, BB_DECIDED_CODE_BITS, BB_GIVEN), "20");
    build("lbvh", scene, &d);
    assert_string_equal(value_of(&d, BB_DECIDED_CODE_BITS, BB_BY_DEFAULT), "30");
    build("emc:bits=auto,size-bits=4", scene, &d);
    value_of(&d, BB_DECIDED_SIZE_BITS, BB_GIVEN);
    value_of(&d, BB_DECIDED_CODE_BITS, BB_BY_SCENE);
    build("lobvh:levels=3", scene, &d);
    assert_string_equal(value_of(&d, BB_DECIDED_LEVELS, BB_GIVEN), "3");
    build("lobvh", scene, &d);
    value_of(&d, BB_DECIDED_LEVELS, BB_BY_SCENE);
    build("presplit+lbvh:bits=auto+rotate", scene, &d);
    value_of(&d, BB_DECIDED_CODE_BITS, BB_BY_SCENE);
    bb_scene_free(scene);
}

static void auto_without_a_profile_is_refused(void **state)
{
    (void)state;
    static const char *const builders[] = {"lbvh:bits=auto", "emc:size-bits=auto",
                                           "llbvh:bits=auto"};
    bb_scene *scene;
    ASSERT_OK(bb_scene_load("cube", &scene));
    ASSERT_OK(bb_scene_upload(scene, device));
    memset(&scene->profile, 0, sizeof scene->profile);
    for (size_t i = 0; i < 3; i++) {
        bb_instance instance;
        check(bb_instance_create(device, builders[i], scene, 1, &instance), builders[i]);
        assert_int_equal(bb_instance_build(&instance, scene, false, NULL), BB_FAILED);
        assert_non_null(strstr(bb_message(), "=auto needs the scene's profile"));
        bb_instance_destroy(&instance);
    }
    bb_scene_free(scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_grid_needs_the_bits_that_count_it),
        cmocka_unit_test(a_flat_grid_needs_two_axes),
        cmocka_unit_test(large_primitives_need_fewer_bits),
        cmocka_unit_test(what_is_one_point_needs_nothing),
        cmocka_unit_test(no_code_tells_equal_ones_apart),
        cmocka_unit_test(sizes_are_counted_in_octaves),
        cmocka_unit_test(decisions_say_what_they_rest_on),
        cmocka_unit_test(auto_is_what_it_decides_given_by_hand),
        cmocka_unit_test(an_object_decides_for_each_scene),
        cmocka_unit_test(what_is_given_wins),
        cmocka_unit_test(auto_without_a_profile_is_refused),
    };
    return cmocka_run_group_tests(tests, open_device, close_device);
}
