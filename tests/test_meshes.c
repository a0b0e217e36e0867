/* `bvhbench slice` and `bvhbench overlap` from outside: what they measure, write and refuse. */
#include "framework/base/memory.h"
#include "framework/base/random.h"
#include "framework/picture/exr.h"
#include "tests/table_fixture.h"

#include <math.h>
#include <stdlib.h>

/* Four ways of lbvh and olbvh by skip and octree after one without a tree; lbvh has no cells. */
static void expect_ways(const bb_table *table, const char *scene, uint32_t rounds)
{
    static const char *const ways[][2] = {{NULL, "no tree"},
                                          {"lbvh", "skip"},
                                          {"lbvh", "octree"},
                                          {"olbvh", "skip"},
                                          {"olbvh", "octree"}};
    for (int w = 0; w < 5; w++) {
        const bb_cell cell = {
            {[BB_SCENE] = scene, [BB_BUILDER] = ways[w][0], [BB_INTERSECTOR] = ways[w][1]}};
        const uint32_t row = bb_table_find(table, cell);
        assert_int_not_equal(row, BB_NO_ROW);
        if (w == 2) {
            assert_non_null(strstr(bb_table_get_text(table, row, "refused"), "'cells'"));
            assert_string_equal(bb_table_get_text(table, row, "status"), "refused");
            continue;
        }
        assert_true(number(table, cell, "answer_ms") > 0);
        assert_int_equal(bb_table_get_rounds(table, row, "answer_ms")->count, rounds + 1);
        assert_int_equal(bb_table_get_rounds(table, row, "answer_cpu_ms")->count, rounds + 1);
        assert_true(number(table, cell, "differ") == 0);
        if (w == 0) {
            assert_null(bb_table_get_rounds(table, row, "build_ms"));
            continue;
        }
        assert_true(number(table, cell, "build_ms") > 0);
        assert_int_equal(bb_table_get_rounds(table, row, "layout_ms")->count, rounds + 1);
        const bb_cell tree = {{[BB_SCENE] = scene, [BB_BUILDER] = ways[w][0]}};
        assert_true(number(table, tree, "tree_bytes") > 0);
        const bb_cell phase = {
            {[BB_SCENE] = scene, [BB_BUILDER] = ways[w][0], [BB_MAKER] = "codes"}};
        assert_true(number(table, phase, "phase_ms") > 0);
    }
    static const char *const of_run[] = {"date", "host", "device", "driver", "command"};
    for (size_t i = 0; i < sizeof of_run / sizeof of_run[0]; i++)
        assert_string_not_equal(bb_table_get_text(table, 0, of_run[i]), "");
    assert_true(bb_table_get_number(table, bb_table_find(table, (bb_cell){{[BB_SCENE] = scene}}),
                                    "rounds") == rounds);
    assert_string_equal(bb_table_get_text(table, 0, "seed"), "1");
}

static int access_in_folder(const char *name)
{
    char path[512];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return access(path, F_OK);
}

/* A way that cannot be is left out, were it the first. */
static void the_first_way_may_be_refused(void **state)
{
    (void)state;
    const outcome *o =
        run("slice --scene tets:side=3 --builder lbvh,olbvh --search octree --slices "
            "2 --size 8x8 --repeats 1");
    assert_int_equal(o->exit_status, 0);
    o = run("overlap tets:side=3 tets:side=2 --builder lbvh,olbvh --search octree --repeats 1");
    assert_int_equal(o->exit_status, 0);
}

static void slices_are_compared_and_drawn(void **state)
{
    (void)state;
    const outcome *o = run("slice --scene tets:side=6,shape=shell --builder lbvh,olbvh --no-tree "
                           "--slices 4 --size 40x30 --axis y --repeats 6 --out sliced");
    if (o->exit_status != 0)
        fail_msg("exit %d: %s%s", o->exit_status, o->out, o->err);
    assert_non_null(strstr(o->out, "slices 4; width 40; height 30; across y"));
    bb_table *table = read_table("sliced/slice.json");
    const char *name = "tets:side=6,shape=shell";
    const bb_cell scene = {{[BB_SCENE] = name}};
    expect_ways(table, name, 6);
    assert_true(number(table, scene, "voxels") == 4 * 40 * 30);
    const double filled = number(table, scene, "voxels_filled");
    assert_true(filled > 1000 && filled < 4 * 40 * 30);
    assert_true(number(table, scene, "voxels_extended") > 10);
    const bb_cell last = {{[BB_SCENE] = name, [BB_QUESTION] = "slice 3"}};
    assert_string_equal(bb_table_get_text(table, bb_table_find(table, last), "picture"),
                        "slice-1-003.png");
    bb_table_free(table);

    static char file[1 << 17];
    double material = 0;
    assert_true(read_file("sliced/slice-1-003.png", file, sizeof file) > 100);
    if (bb_exr_check() != BB_OK)
        return;
    for (int i = 0; i < 4; i++) {
        char exr[64];
        float *values = NULL;
        uint32_t width, height;
        snprintf(exr, sizeof exr, "sliced/slice-1-00%d.exr", i);
        size_t size = read_file(exr, file, sizeof file);
        ASSERT_OK(bb_exr_read(exr, file, size, "YA", &values, &width, &height));
        assert_true(width == 40 && height == 30);
        for (uint32_t p = 0; p < width * height; p++) {
            material += values[2 * p + 1] > 0;
            assert_true(values[2 * p + 1] > 0 || values[2 * p] == 0);
        }
        bb_host_free(values);
    }
    assert_true(material == filled);
}

static void overlaps_are_compared_and_drawn(void **state)
{
    (void)state;
    const outcome *o = run("overlap tets:side=6 tets:side=5,shape=block --fit 0.5 --builder "
                           "lbvh,olbvh --no-tree --repeats 6 --out lapped");
    if (o->exit_status != 0)
        fail_msg("exit %d: %s%s", o->exit_status, o->out, o->err);
    assert_non_null(strstr(o->out, "tets:side=5,shape=block, fitted by 0.5"));
    bb_table *table = read_table("lapped/overlap.json");
    const char *name = "tets:side=6 and tets:side=5,shape=block, fitted by 0.5";
    const bb_cell a = {{[BB_SCENE] = name, [BB_QUESTION] = "A: tets:side=6"}};
    const bb_cell b = {
        {[BB_SCENE] = name, [BB_QUESTION] = "B: tets:side=5,shape=block, fitted by 0.5"}};
    expect_ways(table, name, 6);
    assert_true(number(table, a, "meeting") > 0 &&
                number(table, a, "meeting") < number(table, a, "tetrahedra"));
    assert_true(number(table, b, "meeting") == 750 && number(table, b, "tetrahedra") == 750);
    bb_table_free(table);
    static char png[1 << 18];
    assert_true(read_file("lapped/apart-three-quarter.png", png, sizeof png) > 1000);
}

/* Device code that is broken on purpose, in one of two searches. */
static void answers_that_differ_are_status_1(void **state)
{
    (void)state;
    char command[1024];
    snprintf(command, sizeof command,
             "mkdir -p %s/kernels && sed 's/inside = found.tet != BB_NONE;/inside = (found.tet != "
             "BB_NONE) << BB_LOCATE_OCTREE;/' " BB_TEST_SOURCE_DIR
             "/kernels/slice_tets.cl >%s/kernels/slice_tets.cl",
             folder, folder);
    assert_int_equal(system(command), 0);
    const char *slices = "slice --scene tets:side=3 --builder olbvh --size 8x8 --slices 1 "
                         "--repeats 1 --quiet --out differ";
    expect(0, slices, "olbvh");
    snprintf(command, sizeof command, "%s --kernels-from kernels", slices);
    expect(1, command, "olbvh");
    expect(0, "report differ/slice.json", "answers differ from those of the first way");
}

/* Nothing is left of a mesh and itself: no picture, and no failure. */
static void a_mesh_overlaps_itself(void **state)
{
    (void)state;
    const outcome *o = run(
        "overlap tets:side=3 tets:side=3 --builder olbvh --search octree --repeats 1 --out self");
    if (o->exit_status != 0)
        fail_msg("exit %d: %s%s", o->exit_status, o->out, o->err);
    bb_table *table = read_table("self/overlap.json");
    const bb_cell cell = {
        {[BB_SCENE] = "tets:side=3 and tets:side=3", [BB_QUESTION] = "A: tets:side=3"}};
    assert_true(number(table, cell, "meeting") == number(table, cell, "tetrahedra"));
    bb_table_free(table);
}

/* Six tetrahedra of a cube: table 1 of the OLBVH's paper has 0.239 for its meshes of such. */
static void shapes_are_told(void **state)
{
    (void)state;
    const outcome *o = run("slice --scene tets:side=2,shape=block,jitter=0 --builder lbvh --search "
                           "skip --slices 1 --size 4x4 --repeats 1 --out shapes");
    assert_int_equal(o->exit_status, 0);
    bb_table *table = read_table("shapes/slice.json");
    const bb_cell scene = {{[BB_SCENE] = "tets:side=2,shape=block,jitter=0"}};
    static const char *const names[] = {"aspect_min", "aspect_median", "aspect_max"};
    for (int i = 0; i < 3; i++)
        assert_true(fabs(number(table, scene, names[i]) - 0.23915) < 1e-4);
    assert_true(fabs(number(table, scene, "volume_ratio") - 1) < 1e-5);
    bb_table_free(table);
}

/* Writes a mesh of small tetrahedra, far apart, in a box of side 1. */
static void write_sparse_mesh(uint32_t count)
{
    char *nodes = malloc(count * 4 * 96), *elements = malloc(count * 48);
    size_t n = (size_t)sprintf(nodes, "%u 3 0 0\n", 4 * count);
    size_t e = (size_t)sprintf(elements, "%u 4 0\n", count);
    bb_random random = bb_random_make(7, 0);
    for (uint32_t i = 0; i < count; i++) {
        double at[3];
        for (int k = 0; k < 3; k++)
            at[k] = bb_random_unit(&random);
        for (int c = 0; c < 4; c++)
            n += (size_t)sprintf(nodes + n, "%u %.7f %.7f %.7f\n", 4 * i + (uint32_t)c,
                                 at[0] + (c == 1) / 400.0, at[1] + (c == 2) / 400.0,
                                 at[2] + (c == 3) / 400.0);
        e += (size_t)sprintf(elements + e, "%u %u %u %u %u\n", i, 4 * i, 4 * i + 1, 4 * i + 2,
                             4 * i + 3);
    }
    write_file("sparse.node", nodes, n);
    write_file("sparse.ele", elements, e);
    free(nodes);
    free(elements);
}

/* By the arrays of an OLBVH alone, on a tree deeper than the stack: it begins again at the root. */
static void the_published_traversal_restarts(void **state)
{
    (void)state;
    write_sparse_mesh(400);
    const outcome *o = run("slice --scene sparse.ele --builder olbvh:bits=9 --search octree,olbvh "
                           "--slices 1 --size 3x3 --thickness 1 --repeats 1 --out deep");
    if (o->exit_status != 0)
        fail_msg("exit %d: %s%s", o->exit_status, o->out, o->err);
    bb_table *table = read_table("deep/slice.json");
    const char *scene = "sparse.ele", *builder = "olbvh:bits=9";
    const bb_cell tree = {{[BB_SCENE] = scene, [BB_BUILDER] = builder}};
    const bb_cell octants = {
        {[BB_SCENE] = scene, [BB_BUILDER] = builder, [BB_INTERSECTOR] = "octree"}};
    const bb_cell published = {
        {[BB_SCENE] = scene, [BB_BUILDER] = builder, [BB_INTERSECTOR] = "olbvh"}};
    const double nodes = number(table, tree, "nodes"), leaves = number(table, tree, "leaves");
    const double references = number(table, tree, "references"), levels = 10;
    assert_true(number(table, published, "differ") == 0);
    assert_true(number(table, octants, "restarts_per_item") == 0);
    assert_true(number(table, published, "restarts_per_item") > 1);
    assert_true(number(table, published, "query_bytes") ==
                24 * nodes /* BV */ + 4 * references + 4 * (nodes - leaves + 1) /* CO */ +
                    4 * (nodes + 1) /* PO */ + nodes + 4 * levels);
    bb_table_free(table);
}

/* A scene may be measured twice; then it has two names. */
static void a_scene_may_be_there_twice(void **state)
{
    (void)state;
    const outcome *o = run("slice --scene tets:side=2 --scene tets:side=2 --builder lbvh --search "
                           "skip --slices 1 --size 4x4 --repeats 1 --out twice");
    assert_int_equal(o->exit_status, 0);
    expect(0, "report twice/slice.json --csv", "scene,question,builder,maker,intersector,");
    expect(0, "report twice/slice.json --markdown", "## tets:side=2 (2)");
    expect(0, "report twice/slice.json --table", "tets:side=2 (2)\n");
    expect(0, "report twice/slice.json --out page.html", "page.html");
    assert_int_equal(access_in_folder("page.html"), 0);
    refuses("", "report twice/slice.json twice/slice.json", "alone");
    refuses("", "report twice/slice.json --google-benchmark", "alone");
    bb_table *table = read_table("twice/slice.json");
    assert_int_not_equal(bb_table_find(table, (bb_cell){{[BB_SCENE] = "tets:side=2"}}), BB_NO_ROW);
    assert_int_not_equal(bb_table_find(table, (bb_cell){{[BB_SCENE] = "tets:side=2 (2)"}}),
                         BB_NO_ROW);
    bb_table_free(table);
}

/* Scenes of one name that is no UTF-8, and builders whose names begin with the same 142 letters. */
static void names_that_are_alike_are_two(void **state)
{
    (void)state;
    static const char mesh[] =
        "MeshVersionFormatted 1\nDimension 3\nVertices\n4\n0 0 0 0\n1 0 0 0\n"
        "0 1 0 0\n0 0 1 0\nTetrahedra\n1\n1 2 3 4 0\nEnd\n";
    char arguments[1024];
    write_file("b\xff.mesh", mesh, sizeof mesh - 1);
    snprintf(arguments, sizeof arguments,
             "slice --scene b\xff.mesh --scene b\xff.mesh --builder olbvh:alpha=%0130d,"
             "olbvh:alpha=%0130d --search skip --slices 1 --size 4x4 --repeats 1 --out alike",
             1, 2);
    assert_int_equal(run(arguments)->exit_status, 0);
    bb_table *table = read_table("alike/slice.json");
    uint32_t ways[2] = {0, 0};
    for (uint32_t row = 0; row < bb_table_row_count(table); row++)
        for (int s = 0; s < 2; s++)
            ways[s] += strcmp(bb_table_name(table, row, BB_SCENE),
                              s == 0 ? "b%FF.mesh" : "b%FF.mesh (2)") == 0 &&
                       bb_table_name(table, row, BB_INTERSECTOR)[0] != '\0';
    assert_int_equal(ways[0], 2);
    assert_int_equal(ways[1], 2);
    bb_table_free(table);
}

static void what_cannot_be_is_said_in_one_line(void **state)
{
    (void)state;
    refuses("", "slice", "needs --scene");
    refuses("", "slice --scene cube", "no tetrahedra");
    refuses("", "slice --scene nbody:n=20", "no tetrahedra");
    refuses("", "slice --scene tets:side=2 --axis w", "x, y or z");
    refuses("", "slice --scene tets:side=2 --slices 0", "slices");
    refuses("", "slice --scene tets:side=2 --thickness -1", "thickness");
    refuses("", "slice --scene tets:side=2 --thickness 1e-20", "floats can tell");
    refuses("", "slice --scene tets:side=2 --size 0x9", "size");
    refuses("", "slice --scene tets:side=2 --search octre", "no search 'octre'");
    refuses("", "slice --scene tets:side=2 --search skip,skip", "twice");
    refuses("", "slice --scene tets:side=2 --scene tetz:side=2 --out bad", "tetz");
    refuses("", "slice --scene tets:side=2 --builder lbvh --search octree --out bad", "'cells'");
    assert_int_not_equal(access_in_folder("bad"), 0);
    refuses("", "slice --scene tets:side=2 --builder lbvh --search octree", "'cells'");
    refuses("", "slice --scene /nowhere.msh", "nowhere");
    refuses("", "overlap tets:side=2", "two meshes");
    refuses("", "overlap tets:side=2 cube", "no tetrahedra");
    refuses("", "overlap tets:side=2 tets:side=2 --fit -1", "fit");
    refuses("", "overlap tets:side=2 tets:side=2 --fit 1e-300", "fit");
    refuses("", "overlap tets:side=2 tets:side=2 --builder lbv", "lbv");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_first_way_may_be_refused),
        cmocka_unit_test(slices_are_compared_and_drawn),
        cmocka_unit_test(overlaps_are_compared_and_drawn),
        cmocka_unit_test(answers_that_differ_are_status_1),
        cmocka_unit_test(a_mesh_overlaps_itself),
        cmocka_unit_test(shapes_are_told),
        cmocka_unit_test(the_published_traversal_restarts),
        cmocka_unit_test(a_scene_may_be_there_twice),
        cmocka_unit_test(names_that_are_alike_are_two),
        cmocka_unit_test(what_cannot_be_is_said_in_one_line),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
