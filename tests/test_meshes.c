/* `bvhbench slice` and `bvhbench overlap` from outside: what they measure, write and refuse. */
#include "framework/base/memory.h"
#include "framework/picture/exr.h"
#include "tests/program_fixture.h"

static cJSON *read_json(const char *name, const char *schema)
{
    cJSON *root = read_results(name);
    assert_string_equal(cJSON_GetStringValue(cJSON_GetObjectItem(root, "schema")), schema);
    return root;
}

static double number(const cJSON *object, const char *name)
{
    const cJSON *item = cJSON_GetObjectItem(object, name);
    if (!cJSON_IsNumber(item))
        fail_msg("there is no number '%s'", name);
    return item->valuedouble;
}

static double median(const cJSON *way, const char *name)
{
    return number(cJSON_GetObjectItem(way, name), "median");
}

/* Four ways of lbvh and olbvh by skip and octree after one without a tree; lbvh has no cells. */
static void expect_ways(const cJSON *result, const char *answer, const char *differ)
{
    const cJSON *ways = cJSON_GetObjectItem(result, "ways");
    char name[64];
    assert_int_equal(cJSON_GetArraySize(ways), 5);
    snprintf(name, sizeof name, "%s_ms", answer);
    for (int w = 0; w < 5; w++) {
        const cJSON *way = cJSON_GetArrayItem(ways, w);
        if (w == 2) {
            const char *refused = cJSON_GetStringValue(cJSON_GetObjectItem(way, "refused"));
            assert_non_null(strstr(refused, "'cells'"));
            continue;
        }
        assert_true(median(way, name) > 0);
        assert_true(number(way, differ) == 0);
        if (w == 0) {
            assert_true(cJSON_IsNull(cJSON_GetObjectItem(way, "builder")));
            continue;
        }
        assert_true(median(way, "build_ms") > 0);
        assert_true(number(way, "tree_bytes") > 0);
        snprintf(name, sizeof name, "%s_ratio", answer);
        assert_true(number(cJSON_GetObjectItem(way, "all_ratio"), "median") >=
                    number(cJSON_GetObjectItem(way, name), "median"));
        snprintf(name, sizeof name, "%s_ms", answer);
    }
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
    assert_non_null(strstr(o->out, "4 slices of 40 x 30 voxels across y"));
    cJSON *root = read_json("sliced/slice.json", "bvhbench-slice/1");
    const cJSON *result = cJSON_GetArrayItem(cJSON_GetObjectItem(root, "results"), 0);
    expect_ways(result, "slice", "voxels_that_differ");
    assert_true(number(result, "voxels") == 4 * 40 * 30);
    const double filled = number(result, "voxels_filled");
    assert_true(filled > 1000 && filled < 4 * 40 * 30);
    assert_true(number(result, "voxels_extended") > 10);
    cJSON_Delete(root);

    static char file[1 << 17];
    double material = 0;
    assert_true(read_file("sliced/slice-1-003.png", file, sizeof file) > 100);
    if (bb_exr_check() != BB_OK)
        return;
    for (int i = 0; i < 4; i++) {
        char name[64];
        float *values = NULL;
        uint32_t width, height;
        snprintf(name, sizeof name, "sliced/slice-1-00%d.exr", i);
        size_t size = read_file(name, file, sizeof file);
        ASSERT_OK(bb_exr_read(name, file, size, "YA", &values, &width, &height));
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
    cJSON *root = read_json("lapped/overlap.json", "bvhbench-overlap/1");
    const cJSON *result = cJSON_GetArrayItem(cJSON_GetObjectItem(root, "results"), 0);
    expect_ways(result, "overlap", "tetrahedra_that_differ");
    const cJSON *meshes = cJSON_GetObjectItem(result, "meshes");
    const cJSON *a = cJSON_GetArrayItem(meshes, 0), *b = cJSON_GetArrayItem(meshes, 1);
    assert_true(number(a, "meeting") > 0 && number(a, "meeting") < number(a, "tetrahedra"));
    assert_true(number(b, "meeting") == 750 && number(b, "tetrahedra") == 750);
    cJSON_Delete(root);
    static char png[1 << 18];
    assert_true(read_file("lapped/apart-three-quarter.png", png, sizeof png) > 1000);
}

/* Nothing is left of a mesh and itself: no picture, and no failure. */
static void a_mesh_overlaps_itself(void **state)
{
    (void)state;
    const outcome *o = run(
        "overlap tets:side=3 tets:side=3 --builder olbvh --search octree --repeats 1 --out self");
    if (o->exit_status != 0)
        fail_msg("exit %d: %s%s", o->exit_status, o->out, o->err);
    cJSON *root = read_json("self/overlap.json", "bvhbench-overlap/1");
    const cJSON *result = cJSON_GetArrayItem(cJSON_GetObjectItem(root, "results"), 0);
    const cJSON *mesh = cJSON_GetArrayItem(cJSON_GetObjectItem(result, "meshes"), 0);
    assert_true(number(mesh, "meeting") == number(mesh, "tetrahedra"));
    cJSON_Delete(root);
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
        cmocka_unit_test(a_mesh_overlaps_itself),
        cmocka_unit_test(what_cannot_be_is_said_in_one_line),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
