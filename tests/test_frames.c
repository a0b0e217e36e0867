/* Moving scenes: frames are what they say, in the memory that is there, on both sides; and
 * instances follow them, by the builder's update() or by another build. */
#include "framework/builder/instance.h"
#include "framework/builder/registry.h"
#include "framework/scene/prim.h"
#include "framework/scene/scene_private.h"
#include "tests/device_fixture.h"
#include "tests/scene_files.h"

#include <math.h>

static const char wave[] = "wave:n=600,frames=5";

static int load_rogue(void **state)
{
    if (open_device(state) == 0 && bb_plugin_load(BB_TEST_PLUGIN_DIR "/rogue.so") == BB_OK)
        return 0;
    print_error("%s\n", bb_message());
    return -1;
}

/* ---- frames ---- */

static void expect_frame(bb_scene *scene, uint32_t frame, uint32_t expected)
{
    uint32_t changed = 99;
    ASSERT_OK(bb_scene_set_frame(scene, frame, &changed));
    assert_int_equal(changed, expected);
    assert_int_equal(scene->frame, frame);
}

/* All that is loaded: of another scene, loaded and never moved, or brought there another way. */
static void expect_equal(const bb_scene *a, const bb_scene *b)
{
    assert_true(a->hash == b->hash && a->scale == b->scale);
    assert_int_equal(a->out_of_range, b->out_of_range);
    assert_memory_equal(&a->bounds, &b->bounds, sizeof a->bounds);
    assert_memory_equal(a->boxes, b->boxes, a->prim_count * sizeof *a->boxes);
    assert_memory_equal(a->vertices, b->vertices, a->vertex_count * 3 * sizeof(float));
    assert_memory_equal(&a->profile, &b->profile, sizeof a->profile);
    assert_memory_equal(a->views, b->views, sizeof a->views);
}

static void frames_are_the_same_back_and_forth(void **state)
{
    (void)state;
    bb_scene *scene = load_scene(wave), *fresh = load_scene(wave), *other = load_scene(wave);
    uint64_t hashes[5];
    assert_int_equal(scene->frame_count, 5);
    assert_int_equal(scene->frame, 0);
    expect_frame(scene, 0, 0);
    for (uint32_t frame = 0; frame < 5; frame++) {
        expect_frame(scene, frame, frame > 0 ? BB_CHANGED_POSITIONS : 0);
        hashes[frame] = scene->hash;
        for (uint32_t i = 0; i < frame; i++)
            assert_true(hashes[i] != hashes[frame]);
    }
    expect_frame(scene, 4, 0);
    expect_frame(other, 2, BB_CHANGED_POSITIONS); /* at once, and on the way back */
    expect_frame(scene, 2, BB_CHANGED_POSITIONS);
    expect_equal(scene, other);
    assert_true(scene->hash == hashes[2]);
    expect_frame(scene, 0, BB_CHANGED_POSITIONS);
    expect_equal(scene, fresh);
    bb_scene_free(other);
    bb_scene_free(fresh);
    bb_scene_free(scene);
}

/* On every machine: the hashes of another one. */
static void frames_are_the_same_everywhere(void **state)
{
    (void)state;
    bb_scene *scene = load_scene(wave);
    const uint64_t expected[] = {0x3d10f92afb3240b8u, 0x90a88694903a688fu, 0xc042b0f9cf1dfc8cu,
                                 0x3dac58347347d797u, 0x171917907b5c7e68u};
    for (uint32_t frame = 0; frame < 5; frame++) {
        ASSERT_OK(bb_scene_set_frame(scene, frame, NULL));
        if (scene->hash != expected[frame])
            fail_msg("frame %u: hash %016llx", frame, (unsigned long long)scene->hash);
    }
    bb_scene_free(scene);
}

static void boxes_hold_what_moved(void **state)
{
    (void)state;
    bb_scene *scene = load_scene(wave);
    for (uint32_t frame = 5; frame-- > 0;) {
        ASSERT_OK(bb_scene_set_frame(scene, frame, NULL));
        for (uint32_t i = 0; i < scene->prim_count; i++)
            for (int axis = 0; axis < 3; axis++) {
                float a = bb_scene_vertex(scene, i, 0)[axis],
                      b = bb_scene_vertex(scene, i, 1)[axis],
                      c = bb_scene_vertex(scene, i, 2)[axis];
                const bb_box *box = &scene->boxes[i];
                assert_true(box->lo[axis] == fminf(a, fminf(b, c)));
                assert_true(box->hi[axis] == fmaxf(a, fmaxf(b, c)));
                assert_true(scene->bounds.lo[axis] <= box->lo[axis]);
                assert_true(scene->bounds.hi[axis] >= box->hi[axis]);
            }
    }
    bb_scene_free(scene);
}

static void expect_bytes(const bb_buffer *buffer, const void *expected, size_t size)
{
    void *bytes = malloc(size);
    ASSERT_OK(bb_buffer_read(buffer, 0, size, bytes));
    assert_memory_equal(bytes, expected, size);
    free(bytes);
}

/* In the same buffers, on the host too. */
static void the_device_follows(void **state)
{
    (void)state;
    bb_scene *scene = load_scene(wave);
    const bb_scene_device *there = &scene->on_device;
    ASSERT_OK(bb_scene_upload(scene, device));
    const bb_scene before = *scene;
    uint64_t booked = device->bytes;
    for (uint32_t i = 0; i < 6; i++) {
        ASSERT_OK(bb_scene_set_frame(scene, i * 3 % 5, NULL));
        expect_bytes(&there->boxes, scene->boxes, scene->prim_count * sizeof(bb_box));
        expect_bytes(&there->vertices, scene->vertices, scene->vertex_count * 3 * sizeof(float));
        expect_bytes(&there->prims, scene->prims[BB_TRIANGLE].data,
                     scene->prim_count * bb_prim_bytes(BB_TRIANGLE));
        assert_true(there->boxes.mem == before.on_device.boxes.mem);
        assert_true(there->vertices.mem == before.on_device.vertices.mem);
        assert_true(there->prims.mem == before.on_device.prims.mem);
        assert_true(scene->boxes == before.boxes && scene->vertices == before.vertices);
        assert_int_equal(device->bytes, booked);
    }
    bb_scene_free(scene);
}

static void expect_no_frame(bb_scene *scene, uint32_t frame, const char *words)
{
    uint64_t hash = scene->hash;
    uint32_t at = scene->frame, changed;
    assert_int_equal(bb_scene_set_frame(scene, frame, &changed), BB_INVALID);
    if (strstr(bb_message(), words) == NULL || strchr(bb_message(), '\n') != NULL)
        fail_msg("expected '%s' in '%s'", words, bb_message());
    assert_int_equal(changed, 0);
    assert_true(scene->hash == hash && scene->frame == at);
}

static void frames_that_there_are_not_are_refused(void **state)
{
    (void)state;
    bb_scene *scene = load_scene(wave);
    ASSERT_OK(bb_scene_set_frame(scene, 3, NULL));
    expect_no_frame(scene, 5, "has no frame 5: they are 0 to 4");
    expect_no_frame(scene, BB_NONE, "has no frame 4294967295: they are 0 to 4");
    bb_scene_free(scene);
    static const char *const still[] = {"cube", "spheres:n=100", "wave:n=600,frames=1"};
    for (size_t i = 0; i < sizeof still / sizeof still[0]; i++) {
        scene = load_scene(still[i]);
        assert_int_equal(scene->frame_count, 1);
        expect_frame(scene, 0, 0);
        expect_no_frame(scene, 1, "it does not move");
        bb_scene_free(scene);
    }
    expect_failure("wave:frames=0", BB_INVALID, "'frames'");
}

/* Frame 1 is none that could be. */
static bb_status set_bad_frame(const bb_spec *spec, const bb_option *options, bb_scene *scene,
                               uint32_t frame)
{
    (void)spec;
    (void)options;
    scene->vertices[0] = frame == 1 ? NAN : 0.25f * (float)frame - 0.5f;
    return BB_OK;
}

static void a_scene_recovers_from_a_bad_frame(void **state)
{
    (void)state;
    static const bb_generator bad = {.name = "bad", .set_frame = set_bad_frame},
                              none = {.name = "x"};
    bb_scene *scene = load_scene("cube"); /* its first vertex is at -0.5 */
    uint64_t hash = scene->hash;
    uint32_t changed;
    scene->frame_count = 3;
    assert_int_equal(bb_scene_remember_motion(&none, "x", scene), BB_FAILED);
    ASSERT_OK(bb_scene_remember_motion(&bad, "bad", scene));
    ASSERT_OK(bb_scene_upload(scene, device));
    assert_int_equal(bb_scene_set_frame(scene, 1, &changed), BB_INVALID);
    assert_int_equal(scene->frame, BB_NONE);
    /* what is on the device is not known */
    expect_frame(scene, 0, BB_CHANGED_POSITIONS | BB_CHANGED_TOPOLOGY);
    assert_true(scene->hash == hash);
    expect_bytes(&scene->on_device.boxes, scene->boxes, scene->prim_count * sizeof(bb_box));
    expect_frame(scene, 2, BB_CHANGED_POSITIONS);
    bb_scene_free(scene);
}

/* ---- instances ---- */

static bb_update_way update(bb_instance *instance, bb_scene *scene, uint32_t frame)
{
    uint32_t changed;
    bb_update_way way;
    bb_build_timing timing;
    ASSERT_OK(bb_scene_set_frame(scene, frame, &changed));
    ASSERT_OK(bb_instance_update(instance, scene, changed, false, &way, &timing));
    ASSERT_OK(bb_tree_download(&instance->tree, NULL));
    ASSERT_OK(bb_tree_check(&instance->tree, scene));
    assert_true(way == BB_KEPT ? timing.timing.ms == 0 : timing.timing.ms > 0);
    return way;
}

/* The phases say what was done. */
static void instances_say_how_they_followed(void **state)
{
    (void)state;
    static const struct {
        const char *builder;
        bb_update_way way;
    } cases[] = {
        {"lbvh", BB_REBUILT},
        {"lbvh:update=refit", BB_UPDATED},
        {"emc:update=refit", BB_UPDATED},
        {"sah", BB_REBUILT},
        {"sah:leaf=8,update=refit", BB_UPDATED},
        {"embree", BB_REBUILT},
        {"rogue:kind=follows", BB_UPDATED},
        {"rogue", BB_REBUILT},
        {"lbvh:update=refit+rotate", BB_REBUILT},
        {"presplit+lbvh:update=refit", BB_REBUILT},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        bb_scene *scene = load_scene(wave);
        bb_instance instance;
        ASSERT_OK(bb_scene_upload(scene, device));
        ASSERT_OK(bb_instance_create(device, cases[i].builder, scene, 1, &instance));
        assert_int_equal(update(&instance, scene, 2), BB_REBUILT); /* there was no tree */
        if (update(&instance, scene, 4) != cases[i].way)
            fail_msg("%s: another way", cases[i].builder);
        const bb_build_step *last = &instance.steps[instance.step_count - 1];
        bool refitted = last->phases.count == 1 && strcmp(last->phases.names[0], "refit") == 0;
        assert_true(refitted == (cases[i].way == BB_UPDATED));
        assert_int_equal(update(&instance, scene, 4), BB_KEPT);
        assert_int_equal(update(&instance, scene, 0), cases[i].way);
        bb_instance_destroy(&instance);
        bb_scene_free(scene);
    }
}

/* The shape stays, so that a tree that has been elsewhere is the tree of frame 0 again; on the way
 * its SAH rises above that of a new one, which is what the scene is there for. */
static void a_refitted_tree_gets_worse_and_comes_back(void **state)
{
    (void)state;
    bb_scene *scene = load_scene("wave:n=20000,frames=4");
    bb_instance refitted, rebuilt;
    uint64_t hashes[2];
    double costs[4];
    ASSERT_OK(bb_scene_upload(scene, device));
    ASSERT_OK(bb_instance_create(device, "lbvh:update=refit", scene, 1, &refitted));
    ASSERT_OK(bb_instance_create(device, "lbvh", scene, 1, &rebuilt));
    update(&refitted, scene, 0);
    ASSERT_OK(bb_tree_hash(&refitted.tree, &hashes[0]));
    for (uint32_t frame = 0; frame < 4; frame++) {
        update(&refitted, scene, frame);
        update(&rebuilt, scene, frame);
        costs[frame] = bb_tree_sah(&refitted.tree) / bb_tree_sah(&rebuilt.tree);
        print_message("frame %u: SAH of the refitted tree %.3f of a new one's\n", frame,
                      costs[frame]);
        assert_true(frame == 0 ? costs[0] == 1 : costs[frame] > 1.05 * costs[frame - 1]);
    }
    update(&refitted, scene, 0);
    ASSERT_OK(bb_tree_hash(&refitted.tree, &hashes[1]));
    assert_true(hashes[0] == hashes[1]);
    bb_instance_destroy(&rebuilt);
    bb_instance_destroy(&refitted);
    bb_scene_free(scene);
}

/* A tree of another scene is none that could follow. */
static void another_scene_is_built(void **state)
{
    (void)state;
    bb_scene *scene = load_scene(wave), *other = load_scene(wave);
    bb_instance instance;
    bb_update_way way;
    ASSERT_OK(bb_scene_upload(scene, device));
    ASSERT_OK(bb_scene_upload(other, device));
    ASSERT_OK(bb_instance_create(device, "lbvh:update=refit", scene, 1, &instance));
    ASSERT_OK(bb_instance_build(&instance, scene, false, NULL));
    ASSERT_OK(bb_instance_update(&instance, other, 0, false, &way, NULL));
    assert_int_equal(way, BB_REBUILT);
    ASSERT_OK(bb_instance_update(&instance, other, BB_CHANGED_TOPOLOGY, false, &way, NULL));
    assert_int_equal(way, BB_REBUILT);
    ASSERT_OK(bb_instance_update(&instance, other, BB_CHANGED_POSITIONS, false, &way, NULL));
    assert_int_equal(way, BB_UPDATED);
    bb_instance_destroy(&instance);
    bb_scene_free(other);
    bb_scene_free(scene);
}

/* An update that works for 20 ms, and then asks for a build, is part of what that build takes. */
static void what_was_given_up_is_paid_for(void **state)
{
    (void)state;
    bb_scene *scene = load_scene(wave);
    bb_instance instance;
    bb_update_way way;
    bb_build_timing timing;
    ASSERT_OK(bb_plugin_load(BB_TEST_PLUGIN_DIR "/fickle.so"));
    ASSERT_OK(bb_scene_upload(scene, device));
    ASSERT_OK(bb_instance_create(device, "fickle:how=tries", scene, 1, &instance));
    ASSERT_OK(bb_instance_build(&instance, scene, false, &timing));
    assert_int_equal(instance.step_count, 1);
    ASSERT_OK(bb_scene_set_frame(scene, 1, NULL));
    ASSERT_OK(bb_instance_update(&instance, scene, 0, false, &way, &timing));
    assert_int_equal(way, BB_REBUILT);
    assert_int_equal(instance.step_count, 2);
    const bb_build_timing *built = &instance.steps[0].timing, *tried = &instance.steps[1].timing;
    assert_string_equal(instance.steps[1].label, "update given up");
    assert_true(tried->timing.ms >= 20 && built->timing.ms > 0);
    assert_true(timing.timing.ms == built->timing.ms + tried->timing.ms);
    bb_instance_destroy(&instance);
    bb_scene_free(scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(frames_are_the_same_back_and_forth),
        cmocka_unit_test(frames_are_the_same_everywhere),
        cmocka_unit_test(boxes_hold_what_moved),
        cmocka_unit_test(the_device_follows),
        cmocka_unit_test(frames_that_there_are_not_are_refused),
        cmocka_unit_test(a_scene_recovers_from_a_bad_frame),
        cmocka_unit_test(instances_say_how_they_followed),
        cmocka_unit_test(a_refitted_tree_gets_worse_and_comes_back),
        cmocka_unit_test(another_scene_is_built),
        cmocka_unit_test(what_was_given_up_is_paid_for),
    };
    return cmocka_run_group_tests_name("frames", tests, load_rogue, close_device);
}
