/* OBJ scenes, feature by feature, on files written here; and what must be refused, in one line that
 * says where. */
#include "tests/program_fixture.h"
#include "tests/scene_files.h"

#define SQUARE "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"

static const char *write_obj(const char *text)
{
    const char *path = test_path("obj", "case.obj");
    write_text(path, text);
    return path;
}

static void expect_triangles(const char *text, const uint32_t *indices, uint32_t triangles,
                             uint32_t ignored)
{
    bb_scene *scene = load_scene(write_obj(text));
    assert_int_equal(scene->prims[BB_TRIANGLE].count, triangles);
    assert_memory_equal(bb_scene_indices(scene), indices, 12 * triangles);
    assert_int_equal(scene->ignored, ignored);
    assert_string_equal(scene->source, "OBJ");
    bb_scene_free(scene);
}

static void test_forms_of_faces(void **state)
{
    (void)state;
    static const uint32_t fan[] = {0, 1, 2, 0, 2, 3};
    static const char *const faces[] = {
        "f 1 2 3 4\n",
        "f 1 2 3 4",
        "  f\t1/1 2/2 3/3 4/4  \n",
        "f 1//1 2//1 3//1 4//1\r\n",
        "f 1/1/1 2/2/1 3/3/1 4/4/1\n",
        "f -4 -3 -2 -1\n",
        "f -4/-4/-1 -3/-3/-1 -2/-2/-1 -1/-1/-1\n",
        "f 1 2 3\ng second group\nusemtl nothing\ns off\no other\nf 1 3 4 # a remark\n",
        "mtllib is-not-there.mtl\nvt 0 0\nvn 0 0 1\nf 1 2 \\\n3 4\n",
        "f +1 +2 +3 +4\n",
    };
    for (size_t i = 0; i < sizeof faces / sizeof faces[0]; i++) {
        char text[512];
        snprintf(text, sizeof text, "# a square\n\n" SQUARE "%s", faces[i]);
        expect_triangles(text, fan, 2, 0);
    }
}

static void test_forms_of_numbers(void **state)
{
    (void)state;
    bb_scene *scene = load_scene(write_obj("v -1.5e+1 .25 +3.\nv 1E-1 -0.0 16777217 0.5\n"
                                           "v 1e-50 2 3 0.1 nan 0.3\nf 1 2 3\n"));
    static const float expected[] = {-15, 0.25f, 3, 0.1f, 0, 16777216, 0, 2, 3};
    assert_int_equal(scene->vertex_count, 3);
    assert_memory_equal(scene->vertices, expected, sizeof expected);
    bb_scene_free(scene);
}

static void test_order_and_ends_of_lines(void **state)
{
    (void)state;
    static const uint32_t one[] = {0, 1, 2};
    expect_triangles("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n", one, 1, 0);
    expect_triangles("\xef\xbb\xbfv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", one, 1, 0);
    expect_triangles("v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3\r", one, 1, 0);
    expect_triangles("v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\n\r\nf -3 -2 -1\r\n", one, 1, 0);
}

static void test_what_is_no_surface(void **state)
{
    (void)state;
    static const uint32_t one[] = {0, 1, 2};
    expect_triangles(SQUARE "f 1 2 3\nl 1 2 3\np 1 2\nf 1 2\n", one, 1, 3);
}

static void test_refused(void **state)
{
    (void)state;
    static const struct {
        const char *text, *words;
    } cases[] = {
        {"", "is empty"},
        {"\n# nothing\n", "has no vertex"},
        {SQUARE, "holds points only: 4 vertices and no face"},
        {SQUARE "l 1 2\n", "holds no face of three corners (1 points, lines and others)"},
        {SQUARE "f 1 2\n", "holds no face of three corners (1 points, lines and others)"},
        {SQUARE "f 1 2 5\n", "line 5: index 5 names no vertex, there are 4"},
        {SQUARE "f 1 2 -5\n", "line 5: index -5 names no vertex, there are 4 before it"},
        {SQUARE "f 1 2 0\n", "line 5: index 0 names no vertex"},
        {SQUARE "f 1 2 999999999\n", "line 5: index 999999999 names no vertex"},
        {SQUARE "f 1 2 4294967297\n", "line 5: '4294967297' is no v, v/vt, v//vn or v/vt/vn"},
        {SQUARE "f 1 2 3.5\n", "line 5: '3.5' is no v, v/vt"},
        {SQUARE "f 1 2 x\n", "line 5: 'x' is no v, v/vt"},
        {SQUARE "f 1 2 /3\n", "line 5: '/3' is no v, v/vt"},
        {SQUARE "f\n", "line 5: a face without corners"},
        {"v 0 0\n", "line 1: a vertex of fewer than three numbers"},
        {"v 0 0 0\nv 1 nan 0\n", "line 2: 'nan' is no finite number"},
        {"v 0 0 -inf\n", "line 1: '-inf' is no finite number"},
        {"v 0 0 1e39\n", "line 1: vertex 1 is not finite"},
        {"v 0 0 1e999999999\n", "line 1: '1e999999999' is no finite number"},
        {"v 0 0 1e\n", "line 1: '1e' is no finite number"},
        {"v 0 0 -\n", "line 1: '-' is no finite number"},
        {"v 0 0 0x10\n", "line 1: '0x10' is no finite number"},
        {"v 0 0 1.2.3\n", "line 1: '1.2.3' is no finite number"},
        {"v 0 0 1\xff\xc3\n", "line 1: '1?"
                              "?' is no finite number"},
        {"v 0 0 0\n\x7f"
         "ELF\x02\n",
         "line 2 is no text: the file is not OBJ"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
        expect_failure(write_obj(cases[i].text), BB_INVALID, cases[i].words);
    const char *path = test_path("obj", "zero.obj");
    write_bytes(path, "v 0 0 0\nv 1 0\0 0\n", 17);
    expect_failure(path, BB_INVALID, "line 2 is no text");
    expect_failure(test_path("obj", "missing.obj"), BB_INVALID, "there is no such file");
    path = test_path("obj", "folder.obj");
    mkdir(path, 0777);
    expect_failure(path, BB_INVALID, "is not a regular file");
}

/* What the block ends in the midst of, and more vertices than one block holds. */
static void test_a_large_file(void **state)
{
    (void)state;
    enum { STRIP = 5000 };
    const char *path = test_path("obj", "large.obj");
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    for (int i = 0; i < STRIP + 2; i++)
        fprintf(file, "v %d.25 %d -%d.5\n", i, i % 2, i);
    for (int i = 1; i <= STRIP; i++)
        fprintf(file, "f %d %d %d\n", i, i + 1, i + 2);
    assert_int_equal(fclose(file), 0);
    bb_scene *scene = load_scene(path);
    assert_int_equal(scene->prim_count, STRIP);
    for (int i = 0; i < STRIP; i++) {
        const float *at = bb_scene_vertex(scene, (uint32_t)i, 2);
        assert_true(at[0] == (float)i + 2.25f && at[1] == (float)(i % 2) &&
                    at[2] == -((float)i + 2.5f));
    }
    bb_scene_free(scene);
}

static void test_exit_status(void **state)
{
    (void)state;
    write_file("bad.obj", "v 0 0 nan\n", 10);
    const outcome *o = run("check --builder null --scene bad.obj --quiet");
    assert_int_equal(o->exit_status, 2);
    assert_string_equal(o->err, "bvhbench: bad.obj: line 1: 'nan' is no finite number\n");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_forms_of_faces),
        cmocka_unit_test(test_forms_of_numbers),
        cmocka_unit_test(test_order_and_ends_of_lines),
        cmocka_unit_test(test_what_is_no_surface),
        cmocka_unit_test(test_refused),
        cmocka_unit_test(test_a_large_file),
        cmocka_unit_test(test_exit_status),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
