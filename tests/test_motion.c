/* Generated scenes that move, and numbered files: each frame is the same by whichever way it is
 * reached, on every machine; what comes and goes; what is refused. */
#include "framework/bench/conformance.h"
#include "framework/scene/scene.h"
#include "scenes/repeatable.h"
#include "tests/device_fixture.h"
#include "tests/scene_files.h"

#include <math.h>
#include <unistd.h>

static const struct {
    const char *name;
    uint64_t last; /* hash of the last frame, as on another machine */
} moving[] = {
    {"ripple:n=800,frames=5", 0x375167cf7dad084fu},
    {"twist:n=800,frames=5", 0x1fdda61756a5837bu},
    {"limb:n=800,frames=5", 0xd36d02456346c47fu},
    {"car:room=interior:n=1000,frames=5", 0x6a650d30038f5158u},
    {"crowd:kind=rigid,n=3000,frames=5", 0x0f62c8d5d4a7a3a3u},
    {"crowd:kind=explode,n=800,frames=5", 0x3b5582a6ae9f4a3au},
    {"crowd:kind=fall,n=800,frames=5", 0xd1483b875a21c34au},
    {"crowd:kind=flow,n=800,frames=5", 0xb5c5ef3c254141e0u},
    {"crowd:kind=shuffle,n=800,frames=5", 0x5c4bc3d8a412e3e3u},
    {"crowd:kind=cross,n=800,frames=5", 0x5828db0037597eb2u},
    {"crowd:kind=origin,n=800,frames=5", 0x3562dd104c84bc87u},
    {"crowd:kind=grow,n=800,frames=5", 0xd298715b7df3b77au},
    {"twist:n=800,frames=5,away=1e6", 0x4b95ec3067302e4bu},
};

static void sines_are_right(void **state)
{
    (void)state;
    for (double x = -1000; x < 1000; x += 0.37) {
        assert_true(fabs(bb_sine(x) - sin(x)) < 1e-12);
        assert_true(fabs(bb_cosine(x) - cos(x)) < 1e-12);
    }
    assert_true(bb_sine(0) == 0);
}

static void frames_are_the_same_by_any_way_and_anywhere(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof moving / sizeof moving[0]; i++) {
        bb_scene *scene = load_scene(moving[i].name), *direct = load_scene(moving[i].name);
        uint64_t hashes[5];
        assert_int_equal(scene->frame_count, 5);
        for (uint32_t f = 0; f < 5; f++) {
            ASSERT_OK(bb_scene_set_frame(scene, f, NULL));
            hashes[f] = scene->hash;
        }
        for (uint32_t f = 5; f-- > 0;) {
            ASSERT_OK(bb_scene_set_frame(scene, f, NULL));
            assert_true(scene->hash == hashes[f]);
        }
        ASSERT_OK(bb_scene_set_frame(direct, 4, NULL));
        assert_true(direct->hash == hashes[4] && hashes[4] != hashes[1]);
        if (hashes[4] != moving[i].last)
            fail_msg("%s: hash %016llx", moving[i].name, (unsigned long long)hashes[4]);
        bb_scene_free(direct);
        bb_scene_free(scene);
    }
}

/* With fewer and more primitives, on the device too, in the same memory. */
static void things_come_and_go(void **state)
{
    (void)state;
    bb_scene *scene = load_scene("crowd:kind=grow,n=8000,frames=5");
    uint32_t least = scene->prim_count, changed;
    ASSERT_OK(bb_scene_upload(scene, device));
    cl_mem before = scene->on_device.boxes.mem;
    for (uint32_t i = 1; i < 8; i++) {
        uint32_t frame = i * 3 % 5;
        ASSERT_OK(bb_scene_set_frame(scene, frame, &changed));
        assert_int_equal(changed, BB_CHANGED_POSITIONS | BB_CHANGED_TOPOLOGY);
        assert_int_equal(scene->prim_count, least + frame * 8 * (1000 / 100 + 1));
        assert_true(scene->on_device.boxes.mem == before);
        size_t bytes = scene->prim_count * sizeof(bb_box);
        void *boxes = malloc(bytes);
        ASSERT_OK(bb_buffer_read(&scene->on_device.boxes, 0, bytes, boxes));
        assert_memory_equal(boxes, scene->boxes, bytes);
        free(boxes);
    }
    bb_scene_free(scene);
}

static void nothing_moves_in_still(void **state)
{
    (void)state;
    bb_scene *scene = load_scene("crowd:kind=still,n=800");
    uint32_t changed;
    assert_int_equal(scene->frame_count, 21);
    ASSERT_OK(bb_scene_set_frame(scene, 20, &changed));
    assert_int_equal(changed, 0);
    bb_scene_free(scene);
}

/* ---- numbered files ---- */

static void put(const char *name, const char *text)
{
    write_text(test_path("motion", name), text);
}

static const char *sequence(const char *name, const char *more)
{
    static char text[1200];
    snprintf(text, sizeof text, "sequence:first=%s%s", test_path("motion", name), more);
    return text;
}

static void files_are_frames(void **state)
{
    (void)state;
    put("a_08.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    put("a_09.obj", "v 0 0 4\nv 1 0 0\nv 0 1 8\nf 1 2 3\n");
    put("a_10.obj", "v 8 0 4\nv 1 0 0\nv 0 1 8\nf 1 2 3\n");
    bb_scene *scene = load_scene(sequence("a_08.obj", ""));
    assert_int_equal(scene->frame_count, 3);
    ASSERT_OK(bb_scene_set_frame(scene, 2, NULL));
    assert_true(scene->vertices[0] == 8 && scene->vertices[8] == 8);
    bb_scene_free(scene);
    scene = load_scene(sequence("a_08.obj", ",between=3"));
    assert_int_equal(scene->frame_count, 9);
    ASSERT_OK(bb_scene_set_frame(scene, 1, NULL));
    assert_true(scene->vertices[2] == 1 && scene->vertices[8] == 2);
    ASSERT_OK(bb_scene_set_frame(scene, 6, NULL));
    assert_true(scene->vertices[0] == 4 && scene->vertices[2] == 4);
    ASSERT_OK(bb_scene_set_frame(scene, 0, NULL));
    assert_true(scene->vertices[0] == 0 && scene->vertices[2] == 0);
    bb_scene_free(scene);
}

static void expect_frame_refused(const char *name, uint32_t frame, const char *words)
{
    bb_scene *scene = load_scene(name);
    assert_int_equal(bb_scene_set_frame(scene, frame, NULL), BB_INVALID);
    if (strstr(bb_message(), words) == NULL || strchr(bb_message(), '\n') != NULL)
        fail_msg("expected '%s' in '%s'", words, bb_message());
    ASSERT_OK(bb_scene_set_frame(scene, 0, NULL)); /* which there still is */
    bb_scene_free(scene);
}

static void bad_sequences_get_one_line(void **state)
{
    (void)state;
    char room[1200];
    const char *triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    for (int i = 2; i < 6; i++) { /* of an earlier run */
        char name[16];
        snprintf(name, sizeof name, "b_%d.obj", i);
        unlink(test_path("motion", name));
    }
    put("b_1.obj", triangle);
    expect_failure(sequence("b_1.obj", ""), BB_INVALID, "is not followed by '");
    put("b_4.obj", triangle);
    expect_failure(sequence("b_1.obj", ""), BB_INVALID, "is missing, and there are files behind");
    assert_null(strstr(bb_message(), "files=")); /* one alone is no sequence */
    put("b_2.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 3 2 1\n");
    put("b_3.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    expect_frame_refused(sequence("b_1.obj", ""), 1, "has other triangles than '");
    expect_frame_refused(sequence("b_1.obj", ""), 2, "b_3.obj");
    expect_frame_refused(sequence("b_1.obj", ",files=6"), 5, "there is no file '");
    expect_failure("sequence", BB_INVALID, "give first=FILE");
    expect_failure("sequence:first=walk.obj", BB_INVALID, "has no number");
    expect_failure("sequence:first=absent_1.obj", BB_INVALID, "there is no file");
    expect_failure("car:room=crowd\\:kind=nothing", BB_INVALID, "kind");
    expect_failure("car:room=spheres", BB_INVALID, "other primitives than triangles");
    expect_failure("twist:away=1e20", BB_INVALID, "'away'");
    expect_failure("crowd:kind=nothing", BB_INVALID, "kind");
    expect_failure("crowd:share=0.5", BB_INVALID, "share is for kind=shuffle");
    put("point.obj", "v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n");
    snprintf(room, sizeof room, "car:room=%s", test_path("motion", "point.obj"));
    expect_failure(room, BB_INVALID, "take a larger scene");
}

/* The frame is to blame, before any builder is looked at. */
static void conformance_refuses_bad_frames(void **state)
{
    (void)state;
    bb_conformance *conformance;
    put("c_1.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    put("c_2.obj", "v 0 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3\n");
    bb_scene *scene = load_scene(sequence("c_1.obj", ""));
    assert_int_equal(bb_conformance_create(device, scene, 8, 1, &conformance), BB_INVALID);
    if (strstr(bb_message(), "frame 1: ") == NULL || strstr(bb_message(), "c_2.obj") == NULL)
        fail_msg("%s", bb_message());
    bb_scene_free(scene);
}

/* The number of things in the last frame is 123 modulo 2^32, in the first 429,600: more than
 * memory would be reserved for. */
static void crowds_that_outgrow_numbers_are_refused(void **state)
{
    (void)state;
    expect_failure("crowd:kind=grow,n=268435456,frames=1000000", BB_INVALID, "frames");
    expect_failure("crowd:kind=grow,n=3436800,frames=999428", BB_INVALID, "frames");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sines_are_right),
        cmocka_unit_test(frames_are_the_same_by_any_way_and_anywhere),
        cmocka_unit_test(things_come_and_go),
        cmocka_unit_test(nothing_moves_in_still),
        cmocka_unit_test(files_are_frames),
        cmocka_unit_test(bad_sequences_get_one_line),
        cmocka_unit_test(conformance_refuses_bad_frames),
        cmocka_unit_test(crowds_that_outgrow_numbers_are_refused),
    };
    return cmocka_run_group_tests_name("motion", tests, open_device, close_device);
}
