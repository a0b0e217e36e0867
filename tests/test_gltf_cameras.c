/* Cameras of glTF files as views: where they stand, what they are called, which are left out. */
#include "tests/scene_files.h"

#include <math.h>

#define NAMED(name) PERSPECTIVE(",\"name\":\"" name "\"")
#define LONG "0123456789012345678901234567890123456789012" /* as long as a name may be */
#define PERSPECTIVE(more) "{\"type\":\"perspective\",\"perspective\":{\"yfov\":1}" more "}"

/* One triangle as node 0 of `nodes`, which brackets enclose. */
static bb_scene *load_with(const char *cameras, const char *nodes, const char *more)
{
    char text[8192];
    const char *path = test_path("gltf_cameras", "case.gltf");
    snprintf(text, sizeof text,
             "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":36,\"uri\":"
             "\"data:application/octet-stream;base64,"
             "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA\"}],\"bufferViews\":[{\"buffer\":0,"
             "\"byteLength\":36}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,"
             "\"count\":3,\"type\":\"VEC3\"}],\"meshes\":[{\"primitives\":[{\"attributes\":"
             "{\"POSITION\":0}}]}],\"cameras\":%s,\"nodes\":[{\"mesh\":0},%s]%s}",
             cameras, nodes, more);
    write_text(path, text);
    return load_scene(path);
}

/* The names of the views before the derived ones, which must be there. */
static void expect_cameras(const bb_scene *scene, const char *const *names, uint32_t count)
{
    assert_int_equal(scene->view_count, count + 4);
    for (uint32_t i = 0; i < count; i++)
        assert_string_equal(scene->views[i].name, names[i]);
    assert_string_equal(scene->views[count].name, "three-quarter");
}

static void expect_vector(const double v[3], double x, double y, double z)
{
    ASSERT_NEAR(v[0], x, 1e-12);
    ASSERT_NEAR(v[1], y, 1e-12);
    ASSERT_NEAR(v[2], z, 1e-12);
}

/* By hand: translated by (5, 0, 0), then, in its parent, turned by 90 degrees about y and doubled.
 * The turn takes x to -z, and -z to -x. */
static void test_place(void **state)
{
    (void)state;
    static const char *const names[] = {"plain", "moved"};
    bb_scene *scene =
        load_with("[{\"type\":\"perspective\",\"name\":\"plain\",\"perspective\":"
                  "{\"yfov\":0.7853981633974483,\"aspectRatio\":1.5,\"znear\":0.1}},"
                  "{\"type\":\"perspective\",\"name\":\"moved\",\"perspective\":{\"yfov\":1}}]",
                  "{\"camera\":0},"
                  "{\"children\":[3],\"rotation\":[0,0.7071067811865476,0,0.7071067811865476],"
                  "\"scale\":[2,2,2]},{\"camera\":1,\"translation\":[5,0,0]}",
                  "");
    expect_cameras(scene, names, 2);
    const bb_view *view = scene->views;
    assert_false(view[0].parallel);
    ASSERT_NEAR(view[0].fov_y, 45, 1e-12);
    expect_vector(view[0].eye, 0, 0, 0);
    expect_vector(view[0].target, 0, 0, -1);
    expect_vector(view[0].up, 0, 1, 0);
    ASSERT_NEAR(view[1].fov_y, 57.29577951308232, 1e-12);
    expect_vector(view[1].eye, 0, 0, -10);
    assert_true(view[1].target[0] < -1e-3); /* looks along -x, from any distance */
    ASSERT_NEAR(view[1].target[1], 0, 1e-12);
    ASSERT_NEAR(view[1].target[2], -10, 1e-12);
    expect_vector(view[1].up, 0, 2, 0);
    bb_scene_free(scene);
}

static void test_orthographic(void **state)
{
    (void)state;
    static const char *const names[] = {"plan"};
    bb_scene *scene = load_with("[{\"type\":\"orthographic\",\"name\":\"plan\",\"orthographic\":"
                                "{\"xmag\":3,\"ymag\":2,\"zfar\":9,\"znear\":0}}]",
                                "{\"camera\":0}", "");
    expect_cameras(scene, names, 1);
    assert_true(scene->views[0].parallel);
    ASSERT_NEAR(scene->views[0].fov_y, 4, 0);
    bb_scene_free(scene);
}

/* The camera's name, else the node's; none twice, none that a key, an option or a file's name could
 * not hold, none that a derived view has. */
static void test_names(void **state)
{
    (void)state;
    static const char cameras[] = "[" NAMED("Cam.001") "," PERSPECTIVE("") "," NAMED(
        "../a b,c=d:e+f/\xc3\xa4") "," NAMED("back") "," NAMED(LONG "0123456789") "]";
    bb_scene *scene = load_with(
        cameras,
        "{\"camera\":0},{\"camera\":0},{\"camera\":1,\"name\":\"of node\"},{\"camera\":1},"
        "{\"camera\":2},{\"camera\":3},{\"camera\":4},{\"camera\":4},{\"camera\":2}",
        "");
    static const char *const names[] = {"Cam.001", "Cam.001-2",   "of-node",
                                        "camera",  "a-b-c-d-e-f", "back",
                                        LONG,      LONG "-2",     "a-b-c-d-e-f-2"};
    expect_cameras(scene, names, 9);
    assert_string_equal(scene->views[10].name, "back-2");
    bb_scene_free(scene);
}

/* Not cameras, or none that a picture can be made of: the triangles are read all the same. */
static void test_left_out(void **state)
{
    (void)state;
    static const char *const names[] = {"good"};
    bb_scene *scene = load_with(
        "[{},7,{\"type\":\"perspective\"},{\"type\":\"perspective\",\"perspective\":[]},"
        "{\"type\":\"perspective\",\"perspective\":{\"yfov\":\"wide\"}},"
        "{\"type\":\"perspective\",\"perspective\":{\"yfov\":0}},"
        "{\"type\":\"perspective\",\"perspective\":{\"yfov\":-1}},"
        "{\"type\":\"perspective\",\"perspective\":{\"yfov\":3.2}},"
        "{\"type\":\"orthographic\",\"orthographic\":{\"ymag\":0}},"
        "{\"type\":\"fisheye\",\"name\":7}," PERSPECTIVE(",\"name\":\"good\"") "]",
        "{\"camera\":0},{\"camera\":1},{\"camera\":2},{\"camera\":3},{\"camera\":4},"
        "{\"camera\":5},{\"camera\":6},{\"camera\":7},{\"camera\":8},{\"camera\":9},"
        "{\"camera\":11},{\"camera\":-1},{\"camera\":\"0\"},{\"camera\":10,\"scale\":[0,0,0]},"
        "{\"camera\":10,\"scale\":[1,0,1]},{\"camera\":10,\"translation\":[1e300,0,0]},"
        "{\"camera\":10}",
        "");
    expect_cameras(scene, names, 1);
    bb_scene_free(scene);
    scene = load_with("{}", "{\"camera\":0}", "");
    expect_cameras(scene, NULL, 0);
    bb_scene_free(scene);
}

/* Those of the default scene; of all scenes where none is named. */
static void test_scenes(void **state)
{
    (void)state;
    static const char *const names[] = {"b", "camera", "a"};
    const char *cameras = "[" PERSPECTIVE("") "]";
    const char *nodes = "{\"camera\":0,\"name\":\"a\"},{\"camera\":0,\"name\":\"b\",\"children\":["
                        "3]},{\"camera\":0}";
#define SCENES ",\"scenes\":[{\"nodes\":[2,0]},{\"nodes\":[1,0]}]"
    bb_scene *scene = load_with(cameras, nodes, SCENES);
    expect_cameras(scene, names, 3);
    bb_scene_free(scene);
    scene = load_with(cameras, nodes, SCENES ",\"scene\":0");
    expect_cameras(scene, names, 2);
    bb_scene_free(scene);
    scene = load_with(cameras, nodes, SCENES ",\"scene\":1");
    expect_cameras(scene, names + 2, 1);
    bb_scene_free(scene);
    scene = load_with(cameras, nodes, SCENES ",\"scene\":7");
    expect_cameras(scene, names, 3);
    bb_scene_free(scene);
}

/* More cameras than there is room for, and a file of views, which counts alone. */
static void test_many_and_views_beside(void **state)
{
    (void)state;
    char nodes[2048] = "{\"camera\":0}";
    for (int i = 1; i < 20; i++)
        strcat(nodes, ",{\"camera\":0}");
    bb_scene *scene = load_with("[" PERSPECTIVE("") "]", nodes, "");
    assert_int_equal(scene->view_count, BB_VIEWS_MAX);
    assert_string_equal(scene->views[15].name, "camera-16");
    bb_scene_free(scene);
    write_text(test_path("gltf_cameras", "case.views"),
               "mine eye=0,0,9 target=0,0,0 up=0,1,0 fov=40\n");
    scene = load_with("[" PERSPECTIVE("") "]", nodes, "");
    assert_int_equal(remove(test_path("gltf_cameras", "case.views")), 0);
    assert_int_equal(scene->view_count, 1);
    assert_string_equal(scene->views[0].name, "mine");
    bb_scene_free(scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_place),  cmocka_unit_test(test_orthographic),
        cmocka_unit_test(test_names),  cmocka_unit_test(test_left_out),
        cmocka_unit_test(test_scenes), cmocka_unit_test(test_many_and_views_beside),
    };
    return cmocka_run_group_tests_name("gltf_cameras", tests, NULL, NULL);
}
