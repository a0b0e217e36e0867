/* What `check` says of builders that break a rule (tests/plugin/rogue), and that it does not pass what it
 * could not check. */
#include "framework/bench/conformance.h"
#include "tests/tree_fixture.h"

#include "framework/builder/registry.h"
#include "framework/scene/scene.h"
#include "tests/device_fixture.h"

enum { SIDE = 32 };

static int load_rogue(void **state)
{
    if (open_device(state) == 0 && bb_plugin_load(BB_TEST_PLUGIN_DIR "/rogue.so") == BB_OK)
        return 0;
    print_error("%s\n", bb_message());
    return -1;
}

/* What `check` would do. */
static bb_status check_on(const char *scene_name, const char *builder, bb_conformed *found)
{
    bb_scene *scene = NULL;
    bb_conformance *conformance = NULL;
    ASSERT_OK(bb_scene_load(scene_name, &scene));
    ASSERT_OK(bb_conformance_create(device, scene, SIDE, 1, &conformance));
    ASSERT_OK(bb_conformance_brute_force(conformance));
    bb_status status = bb_conformance_check(conformance, builder, found);
    bb_conformance_destroy(conformance);
    bb_scene_free(scene);
    return status;
}

static void expect_failure(const char *scene, const char *builder, const char *part)
{
    bb_conformed found;
    assert_int_equal(check_on(scene, builder, &found), BB_FAILED);
    if (strstr(bb_message(), part) == NULL)
        fail_msg("expected '%s' in '%s'", part, bb_message());
}

static void rule_breakers_are_found(void **state)
{
    (void)state;
    bb_conformed found;
    ASSERT_OK(check_on("sphere-mesh:n=30", "rogue", &found));
    expect_failure("sphere-mesh:n=30", "rogue:kind=stale", "built with the primitives in reverse");
    expect_failure("sphere-mesh:n=30", "rogue:kind=moving", "the same input gave another tree");
    expect_failure("sphere-mesh:n=30", "rogue:kind=marked", "the same input gave another tree");
    expect_failure("sphere-mesh:n=30", "rogue:kind=moving+rotate", "gave another tree");
}

/* On the device there is no clock of the phase's own that could be taken off. */
static void work_on_the_device_is_never_outside(void **state)
{
    (void)state;
    bb_phases on_device = {.device = device, .current = -1}, on_host = {.current = -1};
    assert_int_equal(bb_phase_outside(&on_device, "head start"), BB_FAILED);
    ASSERT_OK(bb_phase_outside(&on_host, "conversion"));
    ASSERT_OK(bb_phase(&on_host, NULL));
    assert_true(on_host.outside_ms > 0);
}

/* Of a pipeline as of a builder; what fits no stage of it is nothing that was checked. */
static void pipelines_are_checked(void **state)
{
    (void)state;
    bb_conformed found;
    ASSERT_OK(check_on("sphere-mesh:n=30", "presplit:saves=-1+rogue+rotate", &found));
    assert_non_null(strstr(found.note, "; presplit: "));
    assert_int_equal(check_on("sphere-mesh:n=300", "lobvh+rotate", &found), BB_UNSUPPORTED);
    assert_int_equal(check_on("spheres:n=30", "rogue+rotate", &found), BB_UNSUPPORTED);
    assert_non_null(strstr(bb_message(), "builder rogue does not take the primitives"));
}

/* Nothing but what a builder declares is there; views are, if it asks for one by name. */
static void undeclared_input_is_withheld(void **state)
{
    (void)state;
    bb_conformed found;
    ASSERT_OK(check_on("cube", "rogue:kind=nosy", &found));
    ASSERT_OK(check_on("interior:n=1000", "rogue:kind=nosy", &found));
    ASSERT_OK(check_on("cube", "rogue:kind=nosy,view=front", &found));
}

/* Stacks do not hold this chain; the other kernels are checked all the same, and the note says who refuses. */
static void refusing_kernels_are_named(void **state)
{
    (void)state;
    bb_conformed found;
    ASSERT_OK(check_on("awkward:kind=outlier,n=1500", "rogue:kind=chain", &found));
    if (strstr(found.note, "not taken by stack") == NULL || strstr(found.note, "trail") != NULL)
        fail_msg("'%s' does not say who refuses", &found);
}

/* All that a scene has is used, and what it does not have is named. */
static void missing_rays_are_named(void **state)
{
    (void)state;
    bb_conformed found;
    bb_scene *scene = NULL;
    bb_conformance *conformance = NULL;
    ASSERT_OK(bb_scene_load("cube", &scene));
    ASSERT_OK(bb_conformance_create(device, scene, SIDE, 1, &conformance));
    assert_string_equal(bb_conformance_left_out(conformance), "");
    bb_conformance_destroy(conformance);
    bb_scene_free(scene);
    ASSERT_OK(bb_scene_load("spheres:n=100", &scene));
    ASSERT_OK(bb_conformance_create(device, scene, SIDE, 1, &conformance));
    if (strncmp(bb_conformance_left_out(conformance), "edges:jitter=64 (", 17) != 0)
        fail_msg("'%s'", bb_conformance_left_out(conformance));
    ASSERT_OK(bb_conformance_check(conformance, "lbvh", &found));
    bb_conformance_destroy(conformance);
    bb_scene_free(scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rule_breakers_are_found),
        cmocka_unit_test(work_on_the_device_is_never_outside),
        cmocka_unit_test(pipelines_are_checked),
        cmocka_unit_test(undeclared_input_is_withheld),
        cmocka_unit_test(refusing_kernels_are_named),
        cmocka_unit_test(missing_rays_are_named),
    };
    return cmocka_run_group_tests_name("conformance", tests, load_rogue, close_device);
}
