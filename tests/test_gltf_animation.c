/* glTF clips: how keyframes are interpolated, how nodes follow them, and frames as such. Morph
 * targets and skins: test_gltf_skin.c; what is refused: test_gltf_clip_faults.c. */
#include "scenes/repeatable.h"
#include "tests/gltf_maker.h"

#include <math.h>
#include <mpfr.h>

#define FOX BB_TEST_SOURCE_DIR "/../shared/data/anim/fox/Fox.glb"

static const float corners[] = {1, 0, 0, 0, 2, 0, 0, 0, 4};

#define MESH "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}]"
#define CHANNEL(sampler, node, path)                                                               \
    "{\"sampler\":" #sampler ",\"target\":{\"node\":" #node ",\"path\":\"" path "\"}}"

static maker start(void)
{
    maker m = {0};
    add_floats(&m, 3, 3, corners);
    return m;
}

/* A file of one node whose `path` is moved; loaded with `frames` frames. */
static bb_scene *load_moved(maker *m, const char *path, const char *interpolation, int frames)
{
    char members[1024], text[1200];
    snprintf(members, sizeof members,
             MESH ",\"nodes\":[{\"mesh\":0}],\"animations\":[{\"samplers\":[{\"input\":1,"
                  "\"output\":2,\"interpolation\":\"%s\"}],\"channels\":[{\"sampler\":0,"
                  "\"target\":{\"node\":0,\"path\":\"%s\"}}]}]",
             interpolation, path);
    snprintf(text, sizeof text, "%s:clip=0,frames=%d",
             write_made(m, "gltf-animation", "moved.gltf", members), frames);
    return load_scene(text);
}

/* ---- interpolation ---- */

/* Half a turn about z in 4 s: constant speed, which straight lines between quaternions have not. */
static void rotations_go_along_arcs(void **state)
{
    (void)state;
    static const float times[] = {0, 4}, turn[] = {0, 0, 0, 1, 0, 0, 1, 0};
    const double root = sqrt(0.5);
    maker m = start();
    add_floats(&m, 2, 1, times);
    add_floats(&m, 2, 4, turn);
    bb_scene *scene = load_moved(&m, "rotation", "LINEAR", 5);
    assert_int_equal(scene->frame_count, 5);
    expect_vertex(scene, 0, 0, 1, 0, 0, 0);
    expect_vertex(scene, 1, 0, root, root, 0, 1e-7);
    expect_vertex(scene, 2, 0, 0, 1, 0, 1e-15);
    expect_vertex(scene, 2, 1, -2, 0, 0, 1e-15);
    expect_vertex(scene, 3, 0, -root, root, 0, 1e-7);
    expect_vertex(scene, 4, 0, -1, 0, 0, 0);
    expect_vertex(scene, 4, 2, 0, 0, 4, 0);
    bb_scene_free(scene);
}

/* The second keyframe is a sixth of a turn, with its sign changed: the same rotation. */
static void rotations_take_the_shorter_arc(void **state)
{
    (void)state;
    const float c = (float)cos(M_PI / 6), s = (float)sin(M_PI / 6);
    static const float times[] = {0, 1};
    const float turn[] = {0, 0, 0, 1, 0, 0, -s, -c};
    maker m = start();
    add_floats(&m, 2, 1, times);
    add_floats(&m, 2, 4, turn);
    bb_scene *scene = load_moved(&m, "rotation", "LINEAR", 5);
    for (uint32_t f = 0; f < 5; f++)
        expect_vertex(scene, f, 0, cos(f * M_PI / 12), sin(f * M_PI / 12), 0, 1e-7);
    bb_scene_free(scene);
}

/* Of 16 bits, and two that are all but the same. */
static void rotations_may_be_integers(void **state)
{
    (void)state;
    static const float times[] = {0, 1};
    static const int16_t turn[] = {0, 0, 0, 32767, 0, 0, 1, 32767};
    maker m = start();
    add_floats(&m, 2, 1, times);
    add_bytes(&m, turn, sizeof turn,
              "\"componentType\":5122,\"normalized\":true,\"count\":2,\"type\":\"VEC4\"");
    bb_scene *scene = load_moved(&m, "rotation", "LINEAR", 3);
    expect_vertex(scene, 1, 0, 1, 1 / 32767.0, 0, 1e-9);
    expect_vertex(scene, 2, 0, 1, 2 / 32767.0, 0, 1e-9);
    bb_scene_free(scene);
}

static void steps_hold(void **state)
{
    (void)state;
    static const float times[] = {1, 2, 3}, values[] = {1, 0, 0, 5, 0, 0, 7, 0, 0};
    maker m = start();
    add_floats(&m, 3, 1, times);
    add_floats(&m, 3, 3, values);
    bb_scene *scene = load_moved(&m, "translation", "STEP", 9);
    static const double expected[] = {1, 1, 1, 1, 5, 5, 5, 5, 7};
    for (uint32_t f = 0; f < 9; f++)
        expect_vertex(scene, f, 0, 1 + expected[f], 0, 0, 0);
    bb_scene_free(scene);
}

/* From 0 to 8 in 2 s, leaving at 3 per second and arriving at -1: with u = 1/4 the four weights are
 * 54/64, 9/64, 10/64 and -3/64, with u = 1/2 they are 1/2, 1/8, 1/2 and -1/8. */
static void splines_are_cubic(void **state)
{
    (void)state;
    static const float times[] = {10, 12};
    static const float values[] = {99, 99, 99, 0, 0, 0, 3, 0, 0, -1, 0, 0, 8, 0, 0, 77, 77, 77};
    maker m = start();
    add_floats(&m, 2, 1, times);
    add_floats(&m, 6, 3, values);
    bb_scene *scene = load_moved(&m, "translation", "CUBICSPLINE", 5);
    expect_vertex(scene, 0, 1, 0, 2, 0, 0);
    expect_vertex(scene, 1, 1, 2 * 3 * 9 / 64.0 + 8 * 10 / 64.0 + 2 * 3 / 64.0, 2, 0, 0);
    expect_vertex(scene, 2, 1, 2 * 3 / 8.0 + 8 / 2.0 + 2 / 8.0, 2, 0, 0);
    expect_vertex(scene, 4, 1, 8, 2, 0, 0);
    bb_scene_free(scene);
}

/* The spline of a rotation gets its length back: half-way between no turn and half a one, without
 * tangents, it is (0 0 1/2 1/2). */
static void splines_of_rotations_are_rotations(void **state)
{
    (void)state;
    static const float times[] = {0, 1};
    static const float values[] = {0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0,
                                   0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0};
    maker m = start();
    add_floats(&m, 2, 1, times);
    add_floats(&m, 6, 4, values);
    bb_scene *scene = load_moved(&m, "rotation", "CUBICSPLINE", 3);
    expect_vertex(scene, 1, 0, 0, 1, 0, 1e-15);
    bb_scene_free(scene);
}

/* 3 is replaced by 6 at the last keyframe. */
static void keyframes_may_be_sparse(void **state)
{
    (void)state;
    static const float times[] = {0, 1}, values[] = {1, 1, 1, 3, 3, 3}, other[] = {6, 6, 6};
    static const uint8_t second[] = {1};
    maker m = start();
    add_floats(&m, 2, 1, times);
    add_bytes(&m, values, sizeof values,
              "\"componentType\":5126,\"count\":2,\"type\":\"VEC3\",\"sparse\":{\"count\":1,"
              "\"indices\":{\"bufferView\":3,\"componentType\":5121},\"values\":{\"bufferView\":4}"
              "}");
    add_bytes(&m, second, 1, "\"componentType\":5121,\"count\":1,\"type\":\"SCALAR\"");
    add_floats(&m, 1, 3, other);
    bb_scene *scene = load_moved(&m, "scale", "LINEAR", 3);
    expect_vertex(scene, 1, 0, 3.5, 0, 0, 0);
    expect_vertex(scene, 2, 1, 0, 12, 0, 0);
    bb_scene_free(scene);
}

static void arctangents_are_exact(void **state)
{
    (void)state;
    mpfr_t exact;
    mpfr_init2(exact, 128);
    double worst_atan = 0, worst_sine = 0;
    for (int i = 1; i <= 20000; i++) {
        double x = i <= 10000 ? i / 10000.0 : ldexp(1 + i / 30000.0, -(i % 300));
        mpfr_set_d(exact, x, MPFR_RNDN);
        mpfr_atan(exact, exact, MPFR_RNDN);
        double angle = bb_arctangent(x);
        mpfr_d_sub(exact, angle, exact, MPFR_RNDN);
        worst_atan = fmax(worst_atan, fabs(mpfr_get_d(exact, MPFR_RNDN)) / angle);
        mpfr_set_d(exact, 2 * angle, MPFR_RNDN);
        mpfr_sin(exact, exact, MPFR_RNDN);
        double sine = bb_sine(2 * angle);
        mpfr_d_sub(exact, sine, exact, MPFR_RNDN);
        worst_sine = fmax(worst_sine, fabs(mpfr_get_d(exact, MPFR_RNDN)) / sine);
    }
    mpfr_clear(exact);
    print_message("relative errors: arctangent %.3g, sine %.3g\n", worst_atan, worst_sine);
    assert_true(worst_atan < 1e-15 && worst_sine < 1e-15);
    assert_true(bb_arctangent(0) == 0);
}

/* ---- nodes ---- */

/* The child goes out while its parent turns and shrinks; the parent's channel ends early and begins
 * late, and holds then. A node without channels stays. */
static void nodes_move_what_is_below_them(void **state)
{
    (void)state;
    static const float turning[] = {1, 3}, turn[] = {0, 0, 0, 1, 0, 0, 0.6f, 0.8f};
    static const float going[] = {0, 4}, way[] = {0, 0, 1, 4, 0, 1};
    maker m = start();
    add_floats(&m, 2, 1, turning);
    add_floats(&m, 2, 4, turn);
    add_floats(&m, 2, 1, going);
    add_floats(&m, 2, 3, way);
    char text[1200];
    const char *path = write_made(
        &m, "gltf-animation", "nodes.gltf",
        MESH ",\"nodes\":[{\"children\":[1],\"scale\":[0.5,0.5,0.5],\"translation\":[0,10,0]},"
             "{\"mesh\":0,\"scale\":[2,2,2]},{\"mesh\":0}],\"animations\":[{\"name\":\"a,b:c\","
             "\"samplers\":[{\"input\":1,\"output\":2},{\"input\":3,\"output\":4}],\"channels\":"
             "[" CHANNEL(0, 0, "rotation") "," CHANNEL(1, 1, "translation") "]}]");
    snprintf(text, sizeof text, "%s:clip=0,frames=5", path);
    bb_scene *scene = load_scene(text);
    assert_int_equal(scene->vertex_count, 6);
    for (uint32_t f = 0; f < 5; f++) {
        const double whole = 2 * atan2(0.6, 0.8), time = f; /* seconds */
        const double angle = time <= 1 ? 0 : time >= 3 ? whole : whole * (time - 1) / 2;
        const double x = (2 + time) * 0.5; /* the first vertex, below the parent */
        expect_vertex(scene, f, 0, x * cos(angle), 10 + x * sin(angle), 0.5, 2e-6);
        expect_vertex(scene, f, 3, 1, 0, 0, 0);
    }
    bb_scene_free(scene);
}

/* ---- frames ---- */

static void frames_are_the_same_back_and_forth(void **state)
{
    (void)state;
    static const float times[] = {0, 1, 2}, way[] = {0, 0, 0, 1, 2, 3, 0, 0, 0};
    maker m = start();
    add_floats(&m, 3, 1, times);
    add_floats(&m, 3, 3, way);
    bb_scene *scene = load_moved(&m, "translation", "LINEAR", 5);
    uint64_t hashes[5];
    uint32_t changed;
    for (uint32_t f = 0; f < 5; f++) {
        ASSERT_OK(bb_scene_set_frame(scene, f, &changed));
        assert_int_equal(changed, f > 0 ? BB_CHANGED_POSITIONS : 0);
        hashes[f] = scene->hash;
    }
    assert_true(hashes[0] == hashes[4] && hashes[1] == hashes[3] && hashes[1] != hashes[2]);
    ASSERT_OK(bb_scene_set_frame(scene, 0, &changed));
    assert_int_equal(changed, 0); /* it is where it was */
    ASSERT_OK(bb_scene_set_frame(scene, 2, &changed));
    assert_true(scene->hash == hashes[2]);
    assert_int_equal(bb_scene_set_frame(scene, 5, NULL), BB_INVALID);
    bb_scene_free(scene);
}

/* Without a clip the file stands still, and nobody looks at its animations; the default is 21
 * frames; one keyframe is a clip that stands still. */
static void a_file_moves_only_if_asked_to(void **state)
{
    (void)state;
    static const float times[] = {0, 2}, way[] = {5, 0, 0, 6, 0, 0};
    maker m = start();
    add_floats(&m, 2, 1, times);
    add_floats(&m, 2, 3, way);
    const char *path = write_made(
        &m, "gltf-animation", "still.gltf",
        MESH ",\"nodes\":[{\"mesh\":0,\"skin\":\"x\",\"weights\":7}],\"skins\":3,\"animations\":7");
    bb_scene *scene = load_scene(path);
    assert_int_equal(scene->frame_count, 1);
    assert_memory_equal(scene->vertices, corners, sizeof corners);
    bb_scene_free(scene);
    char text[1200];
    path = write_made(
        &m, "gltf-animation", "named.gltf",
        MESH ",\"nodes\":[{\"mesh\":0}],\"animations\":[{\"name\":\"0\",\"channels\":"
             "[" CHANNEL(0, 0,
                         "scale") "],\"samplers\":[{\"input\":1,\"output\":2}]"
                                  "},{\"name\":\"Go on\",\"samplers\":[{\"input\":1,\"output\":2}],"
                                  "\"channels\":[" CHANNEL(0, 0, "translation") "]}]");
    snprintf(text, sizeof text, "%s:clip=Go on", path);
    scene = load_scene(text);
    assert_int_equal(scene->frame_count, 21);
    expect_vertex(scene, 20, 0, 7, 0, 0, 0);
    expect_vertex(scene, 10, 0, 6.5, 0, 0, 0);
    bb_scene_free(scene);
}

/* Channels without a node, and those of paths that are not known, are counted. */
static void unknown_channels_are_ignored(void **state)
{
    (void)state;
    static const float times[] = {0, 2}, way[] = {5, 0, 0, 6, 0, 0};
    maker m = start();
    add_floats(&m, 2, 1, times);
    add_floats(&m, 2, 3, way);
    char text[1200];
    snprintf(
        text, sizeof text, "%s:clip=0,frames=2",
        write_made(&m, "gltf-animation", "unknown.gltf",
                   MESH
                   ",\"nodes\":[{\"mesh\":0}],\"extensionsUsed\":["
                   "\"KHR_animation_pointer\"],\"animations\":[{\"channels\":[{"
                   "\"sampler\":0,\"target\":{\"path\":\"pointer\",\"extensions\":{"
                   "\"KHR_animation_pointer\":{\"pointer\":\"/materials/0/x\"}}}},"
                   "{\"sampler\":0,\"target\":{\"path\":\"scale\"}}," CHANNEL(
                       0, 0, "translation") "," CHANNEL(0, 0, "colour") "],"
                                                                        "\"samplers\":[{\"input\":"
                                                                        "1,\"output\":2}]}]"));
    bb_scene *scene = load_scene(text);
    assert_int_equal(scene->ignored, 3);
    expect_vertex(scene, 1, 0, 7, 0, 0, 0);
    bb_scene_free(scene);
}

/* On every machine: the hashes of another one. */
static void a_fox_walks(void **state)
{
    (void)state;
    struct stat info;
    if (stat(FOX, &info) != 0) {
        print_message("skipped: there is no %s\n", FOX);
        skip();
    }
    static const uint64_t expected[] = {0x4281126ee59cad84u, 0xab2a57645cbaadaeu,
                                        0xc1c3d79e2d744581u};
    bb_scene *scene = load_scene(FOX ":clip=Walk,frames=12");
    for (uint32_t f = 0; f < 3; f++) {
        ASSERT_OK(bb_scene_set_frame(scene, f, NULL));
        if (scene->hash != expected[f])
            fail_msg("frame %u: hash %016llx", f, (unsigned long long)scene->hash);
    }
    bb_scene_free(scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rotations_go_along_arcs),
        cmocka_unit_test(rotations_take_the_shorter_arc),
        cmocka_unit_test(rotations_may_be_integers),
        cmocka_unit_test(steps_hold),
        cmocka_unit_test(splines_are_cubic),
        cmocka_unit_test(splines_of_rotations_are_rotations),
        cmocka_unit_test(keyframes_may_be_sparse),
        cmocka_unit_test(arctangents_are_exact),
        cmocka_unit_test(nodes_move_what_is_below_them),
        cmocka_unit_test(frames_are_the_same_back_and_forth),
        cmocka_unit_test(a_file_moves_only_if_asked_to),
        cmocka_unit_test(unknown_channels_are_ignored),
        cmocka_unit_test(a_fox_walks),
    };
    return cmocka_run_group_tests_name("gltf_animation", tests, NULL, NULL);
}
