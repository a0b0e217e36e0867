/* Points located by the nearest face on a ray (Wald et al. 2019) against searches of tetrahedra;
 * the faces themselves against those of all tetrahedra. BVHBENCH_TEST_SMALL: one small mesh. */
#include "framework/scene/exact.h"
#include "framework/scene/tets_faces.h"
#include "framework/tasks/locate_contest.h"
#include "tests/device_forms.h"
#include "tests/table_fixture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { POINTS = 4000 };

static const char *const meshes[] = {"tets:side=5", "tets:side=4,shape=block,jitter=0",
                                     "tets:side=6,shape=shell", "tets:side=5,flip=2,flat=5",
                                     "tets:side=6,grade=2,jitter=0"};
enum { MESHES = sizeof meshes / sizeof meshes[0] };

static int meshes_now(void)
{
    return getenv("BVHBENCH_TEST_SMALL") != NULL ? 1 : MESHES;
}

static bb_scene *load(const char *name)
{
    bb_scene *scene;
    check(bb_scene_load(name, &scene), name);
    return scene;
}

/* ---- the faces ---- */

/* Whether the face has the tetrahedron on the given side. */
static bool is_beside(const bb_scene *mesh, const uint32_t *abc, uint32_t tet, int side)
{
    const float *v[3];
    uint32_t shared = 0, opposite = 0;
    for (int c = 0; c < 4; c++) {
        const uint32_t corner = bb_scene_tet(mesh, tet)[c];
        if (corner == abc[0] || corner == abc[1] || corner == abc[2])
            shared++;
        else
            opposite = corner;
    }
    for (int c = 0; c < 3; c++)
        v[c] = mesh->vertices + 3 * (size_t)abc[c];
    const float *at = mesh->vertices + 3 * (size_t)opposite;
    return shared == 3 &&
           bb_exact_side((const double[3]){at[0], at[1], at[2]}, v[0], v[1], v[2]) * side > 0;
}

static void each_face_is_there_once(void **state)
{
    (void)state;
    for (int m = 0; m < meshes_now(); m++) {
        bb_scene *mesh = load(meshes[m]), *faces;
        bb_face_sides *sides;
        uint32_t uses = 0;
        check(bb_tets_faces(mesh, &faces, &sides), meshes[m]);
        const uint32_t *abc = faces->prims[BB_TRIANGLE].data;
        for (uint32_t i = 0; i < faces->prim_count; i++, abc += 3) {
            assert_true(abc[0] < abc[1] && abc[1] < abc[2]);
            assert_true(i == 0 || memcmp(abc, abc - 3, 3 * sizeof *abc) != 0);
            assert_true(sides[i].above != BB_NONE || sides[i].below != BB_NONE);
            assert_true(sides[i].above == BB_NONE || is_beside(mesh, abc, sides[i].above, 1));
            assert_true(sides[i].below == BB_NONE || is_beside(mesh, abc, sides[i].below, -1));
            uses += (sides[i].above != BB_NONE) + (sides[i].below != BB_NONE);
        }
        assert_int_equal(uses, 4 * (mesh->prims[BB_TETRAHEDRON].count - mesh->tets->flat_count));
        bb_scene_free(faces);
        bb_host_free(sides);
        bb_scene_free(mesh);
    }
}

/* No tetrahedron before it has the same corners. */
static void expect_lowest(const bb_scene *mesh, uint32_t tet)
{
    for (uint32_t before = 0; tet != BB_NONE && before < tet; before++) {
        uint32_t shared = 0;
        for (int a = 0; a < 4; a++)
            for (int b = 0; b < 4; b++)
                shared += bb_scene_tet(mesh, tet)[a] == bb_scene_tet(mesh, before)[b];
        assert_true(shared < 4);
    }
}

/* Of copies of a tetrahedron the lowest is at the face. */
static void twins_share_faces(void **state)
{
    (void)state;
    bb_scene *once = load("tets:side=3"), *twice = load("tets:side=3,twins=4"), *faces[2];
    bb_face_sides *sides[2];
    check(bb_tets_faces(once, &faces[0], &sides[0]), "once");
    check(bb_tets_faces(twice, &faces[1], &sides[1]), "twice");
    assert_true(twice->prims[BB_TETRAHEDRON].count > once->prims[BB_TETRAHEDRON].count);
    assert_int_equal(faces[0]->prim_count, faces[1]->prim_count);
    for (uint32_t i = 0; i < faces[1]->prim_count; i++) {
        expect_lowest(twice, sides[1][i].above);
        expect_lowest(twice, sides[1][i].below);
    }
    for (int i = 0; i < 2; i++) {
        bb_scene_free(faces[i]);
        bb_host_free(sides[i]);
    }
    bb_scene_free(once);
    bb_scene_free(twice);
}

/* ---- points ---- */

static bb_cell way(const char *mesh, const char *builder, const char *search)
{
    return (bb_cell){{[BB_SCENE] = mesh, [BB_BUILDER] = builder, [BB_INTERSECTOR] = search}};
}

static bb_table *locate(bb_device *device, const char *name)
{
    static const char *const builders[] = {"lbvh", "olbvh", "faces/lbvh", "faces/ploc"};
    static const char *const searches[] = {"skip"}, *const kernels[] = {"stack", "stack8"};
    const bb_location_request request = {.contest = {.device = device,
                                                     .name = name,
                                                     .builders = builders,
                                                     .builder_count = 4,
                                                     .searches = searches,
                                                     .search_count = 1,
                                                     .kernels = kernels,
                                                     .kernel_count = 2,
                                                     .repeats = 1,
                                                     .seed = seed,
                                                     .quiet = true},
                                         .points = POINTS};
    bb_scene *scene = load(name);
    bb_table *table;
    check(bb_table_create("locate", &table), "table");
    check(bb_scene_upload(scene, device), name);
    check(bb_location_run(&request, scene, table), name);
    bb_scene_free(scene);
    return table;
}

/* A point may be closer to a face than rounding tells: then another tetrahedron is found. */
static void faces_find_the_same(void **state)
{
    (void)state;
    static const char *const rivals[][2] = {
        {"faces/lbvh", "stack"},           {"faces/lbvh", "stack8"},
        {"faces/ploc", "stack"},           {"faces/ploc", "stack8"},
        {"faces/embree-native", "single"}, {"faces/embree-native", "packet8"}};
    for (int m = 0; m < meshes_now(); m++) {
        bb_table *table = locate(devices[first_form()], meshes[m]);
        assert_true(number(table, way(meshes[m], "olbvh", "skip"), "differ") == 0);
        for (size_t r = 0; r < sizeof rivals / sizeof rivals[0]; r++) {
            const char *builder = rivals[r][0], *kernel = rivals[r][1];
            const bool embree = strcmp(builder, "faces/embree-native") == 0;
            const bb_cell row = way(meshes[m], builder, kernel);
            if (embree && strcmp(kernel, "single") != 0 && bb_table_find(table, row) == BB_NO_ROW)
                continue; /* the library, or the processor, lacks it */
            const double differ = number(table, row, "differ");
            if (!(differ <= POINTS / 500))
                fail_msg("%s by %s on %s: %g of %d points differ", builder, kernel, meshes[m],
                         differ, POINTS);
            assert_true(number(table, row, "answer_ms") > 0);
            assert_true(number(table, row, "build_ms") > 0);
            assert_true(embree || number(table, row, "nodes_per_item") > 1);
        }
        bb_table_free(table);
    }
}

/* Where tetrahedra overlap, the nearest face may belong to another: rows say how often. */
static void wrong_answers_are_counted(void **state)
{
    (void)state;
    const char *name = "tets:side=4,jitter=1"; /* tangled */
    bb_table *table = locate(devices[first_form()], name);
    assert_true(number(table, way(name, "faces/lbvh", "stack"), "differ") > POINTS / 100);
    bb_table_free(table);
}

static int set_up(void **state)
{
    seed = seed_or(20261127);
    return open_devices(state);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_face_is_there_once),
        cmocka_unit_test(twins_share_faces),
        cmocka_unit_test(faces_find_the_same),
        cmocka_unit_test(wrong_answers_are_counted),
    };
    return cmocka_run_group_tests(tests, set_up, close_devices);
}
