/* What `check` says of builders that break a rule (tests/plugin/rogue), and that it does not pass
 * what it could not check. */
#include "framework/bench/conformance.h"
#include "tests/tree_fixture.h"

#include "framework/builder/phases.h"
#include "framework/builder/registry.h"
#include "framework/scene/scene.h"
#include "tests/device_fixture.h"

#include <sys/stat.h>

enum { SIDE = 32 };

/* Of a file in this test's folder, which is made. */
static const char *test_path(const char *test, const char *name)
{
    static char path[1024];
    const char *base = getenv("BVHBENCH_TEST_DIR");
    base = base != NULL ? base : "/tmp/bvhbench-tests";
    mkdir(base, 0777);
    snprintf(path, sizeof path, "%s/%s", base, test);
    mkdir(path, 0777);
    snprintf(path, sizeof path, "%s/%s/%s", base, test, name);
    return path;
}

static int load_rogue(void **state)
{
    if (open_device(state) == 0 && bb_plugin_load(BB_TEST_PLUGIN_DIR "/rogue.so") == BB_OK)
        return 0;
    print_error("%s\n", bb_message());
    return -1;
}

/* `find` stands in the file once. */
static void replace_in_file(const char *from, const char *to, const char *find, const char *with)
{
    static char text[65536];
    FILE *file = fopen(from, "rb");
    assert_non_null(file);
    text[fread(text, 1, sizeof text - 1, file)] = '\0';
    fclose(file);
    char *at = strstr(text, find);
    if (at == NULL || strstr(at + 1, find) != NULL)
        fail_msg("%s: '%s' must stand there once: mend the plant", from, find);
    file = fopen(to, "wb");
    assert_non_null(file);
    fprintf(file, "%.*s%s%s", (int)(at - text), text, with, at + strlen(find));
    assert_int_equal(fclose(file), 0);
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

static const char wave[] = "wave:n=500,strips=6,frames=4";

/* Each tree is brought to other frames and back; the note says how. */
static void trees_follow_a_moving_scene(void **state)
{
    (void)state;
    static const struct {
        const char *scene, *builder, *words;
    } cases[] = {
        {wave, "rogue:kind=follows", "; 4 frames: updated"},
        {wave, "rogue", "; 4 frames: rebuilt"},
        {wave, "lbvh:update=refit", "; 4 frames: updated"},
        {wave, "presplit+lbvh:update=refit+rotate", "; 4 frames: rebuilt"},
        {"wave:n=500,strips=6,frames=2", "lbvh", "; 2 frames: rebuilt"},
        {"wave:n=500,strips=6,frames=100", "lbvh", "; 4 frames: rebuilt"},
    };
    bb_conformed found;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        ASSERT_OK(check_on(cases[i].scene, cases[i].builder, &found));
        if (strstr(found.note, cases[i].words) == NULL)
            fail_msg("'%s' does not say '%s'", found.note, cases[i].words);
    }
    ASSERT_OK(check_on("wave:n=500,frames=1", "lbvh", &found));
    assert_null(strstr(found.note, "frames"));
}

static void trees_that_do_not_follow_are_found(void **state)
{
    (void)state;
    expect_failure(wave, "rogue:kind=still", "frame 1, updated: leaf ");
    expect_failure(wave, "rogue:kind=forgets", "frame 1, updated: node 0 does not contain");
    expect_failure(wave, "rogue:kind=frozen", "frame 1, rebuilt: leaf ");
}

/* A builder that fails in one frame leaves the scene where the next one wants it. */
static void a_failure_leaves_the_scene_at_frame_0(void **state)
{
    (void)state;
    bb_scene *scene = NULL;
    bb_conformance *conformance = NULL;
    bb_conformed found, before;
    ASSERT_OK(bb_scene_load(wave, &scene));
    ASSERT_OK(bb_conformance_create(device, scene, SIDE, 1, &conformance));
    ASSERT_OK(bb_conformance_check(conformance, "lbvh", &before));
    assert_int_equal(bb_conformance_check(conformance, "rogue:kind=still", &found), BB_FAILED);
    assert_int_equal(scene->frame, 0);
    ASSERT_OK(bb_conformance_check(conformance, "lbvh", &found));
    assert_true(found.hash == before.hash);
    bb_conformance_destroy(conformance);
    bb_scene_free(scene);
}

/* Bugs planted in refit.cl, `find` replaced by `replace`. */
static void bugs_of_the_refit_are_found(void **state)
{
    (void)state;
    static const struct {
        const char *find, *replace, *words;
    } plants[] = {
        {"            bb_store_node(nodes, p, e, first, end);",
         "            if ((p & 1u) == 0u) bb_store_node(nodes, p, e, first, end);",
         "frame 1, updated: node "},
        {"        bb_store_node(nodes, n, e, first, skip);", "", "frame 1, updated: leaf "},
        {"    for (uint p = parents[root]; p", "    for (uint p = BB_NONE; p", "frame "},
    };
    bb_device *right = device;
    for (size_t i = 0; i < sizeof plants / sizeof plants[0]; i++) {
        const char *path = test_path("conformance", "refit.cl");
        char folder[1024];
        snprintf(folder, sizeof folder, "%.*s", (int)(strrchr(path, '/') - path), path);
        replace_in_file(BB_TEST_SOURCE_DIR "/builders/common/refit.cl", path, plants[i].find,
                        plants[i].replace);
        ASSERT_OK(open_test_device(BB_FORM_AUTO, folder, &device));
        if (device->handover == BB_HANDOVER_FENCE)
            expect_failure(wave, "lbvh:update=refit", plants[i].words);
        bb_device_close(device);
        remove(path);
    }
    device = right;
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

/* Stacks do not hold this chain, but for those of packets, whose rays go on alone with another; the
 * other kernels are checked all the same, and the note says who refuses. */
static void refusing_kernels_are_named(void **state)
{
    (void)state;
    bb_conformed found;
    ASSERT_OK(check_on("awkward:kind=outlier,n=1500", "rogue:kind=chain", &found));
    if (strstr(found.note, "not taken by stack, ") == NULL || strstr(found.note, "trail") != NULL)
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
        cmocka_unit_test(trees_follow_a_moving_scene),
        cmocka_unit_test(trees_that_do_not_follow_are_found),
        cmocka_unit_test(a_failure_leaves_the_scene_at_frame_0),
        cmocka_unit_test(bugs_of_the_refit_are_found),
        cmocka_unit_test(work_on_the_device_is_never_outside),
        cmocka_unit_test(pipelines_are_checked),
        cmocka_unit_test(undeclared_input_is_withheld),
        cmocka_unit_test(refusing_kernels_are_named),
        cmocka_unit_test(missing_rays_are_named),
    };
    return cmocka_run_group_tests_name("conformance", tests, load_rogue, close_device);
}
