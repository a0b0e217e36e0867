/* Points in tetrahedra: by trees on the device against exact arithmetic over all of them, for
 * points anywhere, on corners, edges, faces and planes of cells, and beside these. Real meshes only
 * where ../shared is there. BVHBENCH_TEST_SMALL keeps the inputs small (for oclgrind);
 * with BVHBENCH_TEST_LONG it is more than 10^6 points. Seed:
 * BVHBENCH_TEST_SEED. */
#include "framework/base/random.h"
#include "framework/bench/tet_search.h"
#include "framework/builder/instance.h"
#include "tests/device_forms.h"
#include "tests/locate_all.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { HOLDERS_MAX = 64, WAYS = 5, MORE = 12, GROUP_SIZE = 64 };

static bool small;

static const struct {
    const char *builder, *layout;
} ways[WAYS] = {{"lbvh", "skip"},
                {"olbvh", "skip"},
                {"olbvh", "octree"},
                {"olbvh", "olbvh"},
                {"olbvh:bits=0", "olbvh"}};
enum { BY_OCTANTS = 2, AS_PUBLISHED = 3 }; /* of the same tree */

/* ---- points ---- */

static const float *corner_of(const bb_scene *scene, bb_random *random, uint32_t tet)
{
    return scene->vertices + 3 * (size_t)bb_scene_tet(scene, tet)[bb_random_below(random, 4)];
}

/* Anywhere; on a corner; in the middle of an edge or on a face, but for rounding; on a plane of the
 * grid of 32 cells; then perhaps a float further. */
static void make_point(const bb_scene *scene, bb_random *random, float point[3])
{
    const bb_box *bounds = &scene->bounds;
    uint32_t tet = bb_random_below(random, scene->prims[BB_TETRAHEDRON].count);
    uint32_t kind = bb_random_below(random, 5);
    const float *v[3];
    double w[3] = {bb_random_unit(random), bb_random_unit(random), 0};
    for (int c = 0; c < 3; c++)
        v[c] = corner_of(scene, random, tet);
    if (w[0] + w[1] > 1 || kind == 2)
        w[0] = w[1] = kind == 2 ? 0.5 : 0.25;
    w[2] = 1 - w[0] - w[1];
    for (int k = 0; k < 3; k++) {
        float side = bounds->hi[k] - bounds->lo[k];
        point[k] =
            (float)(w[0] * (double)v[0][k] + w[1] * (double)v[1][k] + w[2] * (double)v[2][k]);
        if (kind == 0)
            point[k] = bounds->lo[k] + (float)bb_random_range(random, -0.05, 1.05) * side;
        if (kind == 1)
            point[k] = v[0][k];
        if (kind == 3 && bb_random_below(random, 2) == 0)
            point[k] = bounds->lo[k] + side / 32 * (float)bb_random_below(random, 33);
        if (bb_random_below(random, 8) == 0)
            point[k] = nextafterf(point[k], bb_random_below(random, 2) == 0 ? -INFINITY : INFINITY);
    }
}

/* ---- comparison ---- */

typedef struct tally {
    uint32_t points, held, borders, misses, false_holds, others;
} tally;

static void judge(const bb_scene *scene, const float *points, const bb_located *found,
                  uint32_t count, tally *t)
{
    for (uint32_t i = 0; i < count; i++) {
        const double p[3] = {points[3 * i], points[3 * i + 1], points[3 * i + 2]};
        uint32_t holders[HOLDERS_MAX], n = locate_all(scene, p, holders, HOLDERS_MAX);
        bool among = false;
        assert_true(n <= HOLDERS_MAX);
        for (uint32_t h = 0; h < n; h++)
            among = among || holders[h] == found[i].prim;
        t->points++;
        t->held += n > 0;
        t->borders += n > 1;
        t->misses += n > 0 && found[i].prim == BB_NONE;
        t->false_holds += found[i].prim != BB_NONE && !among;
        t->others += n > 0 && among && found[i].prim != holders[0];
        if (found[i].prim != BB_NONE)
            assert_true(found[i].value >= scene->tets->field_lo - 1e-6f &&
                        found[i].value <= scene->tets->field_hi + 1e-6f);
    }
}

/* `counts` NULL: they are not counted. */
static void locate_points(bb_tet_kernels *kernels, const bb_scene *scene, const bb_tet_search *how,
                          const bb_buffer *points, uint32_t count, bb_buffer *results,
                          bb_buffer *counts)
{
    const bb_scene_device *there = &scene->on_device;
    const bb_prim_ends ends = bb_scene_ends(scene);
    bb_arg args[BB_TET_SEARCH_ARGS + 7];
    cl_kernel kernel;
    check(bb_tet_kernels_get(kernels, there->device, how->way, false, counts != NULL, &kernel),
          "locate_points");
    uint32_t n = bb_tet_search_args(how, args);
    args[n++] = BB_MEM(there->prims);
    args[n++] = BB_VALUE(ends);
    args[n++] = BB_MEM(there->field);
    args[n++] = BB_MEM(*points);
    args[n++] = BB_VALUE(count);
    args[n++] = BB_MEM(*results);
    if (counts != NULL)
        args[n++] = BB_MEM(*counts);
    check(bb_launch_args(there->device, kernel, count, GROUP_SIZE, args, n), "locate_points");
}

/* With `floats` as on a device that has no doubles. */
static void search(bb_device *on, bb_scene *scene, int way, bool floats, const bb_buffer *points,
                   uint32_t count, bb_located *found)
{
    bb_instance instance = {0};
    bb_layout_maker maker;
    bb_layout_data data = {0};
    bb_tet_kernels kernels = {
        .source = "locate_points.cl", .name = "locate_points", .floats = floats};
    bb_buffer results, counts;
    const bb_layout *layout = bb_layout_find(ways[way].layout);
    bb_count *counted = malloc(count * sizeof *counted);
    uint64_t tests = 0;
    check(bb_instance_create(on, ways[way].builder, scene, 1, &instance), ways[way].builder);
    check(bb_instance_build(&instance, scene, false, NULL), ways[way].builder);
    check(bb_layout_maker_create(layout, on, &maker), layout->name);
    check(bb_layout_maker_make(&maker, scene, &instance.tree, 1, BB_FORMAT_VERTICES, &data),
          layout->name);
    results = counts = (bb_buffer){0};
    check(bb_buffer_reserve(on, NULL, count * sizeof *found, "test", &results), "results");
    check(bb_buffer_reserve(on, NULL, count * sizeof *counted, "test", &counts), "counts");
    check(bb_buffer_fill(&results, count * sizeof *found, BB_POISON), "poison");
    bb_tet_search how;
    check(bb_tet_search_by(scene, layout, &data, &how), "search");
    locate_points(&kernels, scene, &how, points, count, &results, &counts);
    check(bb_buffer_read(&results, 0, count * sizeof *found, found), "results");
    check(bb_buffer_read(&counts, 0, count * sizeof *counted, counted), "counts");
    for (uint32_t i = 0; i < count; i++)
        tests += counted[i].prims;
    assert_true(tests > 0);
    locate_points(&kernels, scene, &how, points, count, &results, NULL);
    bb_located *again = malloc(count * sizeof *again);
    check(bb_buffer_read(&results, 0, count * sizeof *again, again), "results");
    assert_memory_equal(found, again, count * sizeof *again);
    free(again);
    free(counted);
    bb_buffer_release(&results);
    bb_buffer_release(&counts);
    bb_tet_kernels_release(&kernels);
    bb_layout_data_release(&data);
    bb_layout_maker_destroy(&maker);
    bb_instance_destroy(&instance);
}

/* The last tetrahedron becomes the first: the lowest that holds a point on a plane between cells is
 * then above the plane. */
static void reverse(bb_scene *scene)
{
    uint32_t *tets = scene->prims[BB_TETRAHEDRON].data;
    for (size_t i = 0, k = scene->prims[BB_TETRAHEDRON].count - 1; i < k; i++, k--)
        for (size_t c = 0; c < 4; c++) {
            const uint32_t swap = tets[4 * i + c];
            tets[4 * i + c] = tets[4 * k + c];
            tets[4 * k + c] = swap;
        }
    check(bb_scene_finish(scene), "reversed");
}

static void compare_in_order(bb_device *on, const char *name, uint32_t count, bool overlaps,
                             bool reversed)
{
    if (getenv("BVHBENCH_TEST_LONG") != NULL)
        count *= MORE;
    bb_scene *scene = NULL;
    bb_buffer on_device = {0};
    check(bb_scene_load(name, &scene), name);
    if (reversed)
        reverse(scene);
    check(bb_scene_upload(scene, on), name);
    float *points = malloc(3 * (size_t)count * sizeof *points);
    bb_located *found = malloc(count * sizeof *found), *first = malloc(count * sizeof *first);
    for (uint32_t i = 0; i < count; i++) {
        bb_random random = bb_random_make(seed, i);
        make_point(scene, &random, points + 3 * (size_t)i);
    }
    check(bb_buffer_reserve(on, NULL, 3 * (size_t)count * sizeof *points, "test", &on_device),
          name);
    check(bb_buffer_write(&on_device, 0, 3 * (size_t)count * sizeof *points, points), name);
    for (int floats = 0; floats < 2; floats++)
        for (int way = 0; way < WAYS; way++) {
            tally t = {0};
            search(on, scene, way, floats != 0, &on_device, count, found);
            judge(scene, points, found, count, &t);
            print_message("%s, %s by %s, %s: %u points, %u held, %u on borders; %u missed, %u held "
                          "wrongly, %u not the lowest\n",
                          name, ways[way].builder, ways[way].layout, floats ? "floats" : "doubles",
                          t.points, t.held, t.borders, t.misses, t.false_holds, t.others);
            assert_int_equal(t.misses, 0);
            if (way == BY_OCTANTS)
                memcpy(first, found, count * sizeof *found);
            if (way == AS_PUBLISHED) /* the same cell, also for points on its planes */
                assert_memory_equal(found, first, count * sizeof *found);
            assert_true(t.held > count / 4 && t.borders > count / 50);
            assert_true(t.false_holds <= (floats ? count : 2 + count / 50));
            assert_true(overlaps || t.others <= (floats ? count / 5 : 2 + count / 50));
        }
    bb_buffer_release(&on_device);
    free(points);
    free(found);
    free(first);
    bb_scene_free(scene);
}

static void compare(bb_device *on, const char *name, uint32_t count, bool overlaps)
{
    compare_in_order(on, name, count, overlaps, false);
}

static void no_point_is_missed(void **state)
{
    (void)state;
    for (int form = first_form(); form < LEVELS_FORM + 1; form++) {
        bb_device *on = devices[form];
        compare(on, "tets:side=2", small ? 200 : 10000, false);
        if (small || form != first_form())
            continue;
        compare(on, "tets:side=6,shape=block,jitter=0", 20000, false);
        /* faces on planes of cells */
        compare_in_order(on, "tets:side=8,shape=block,jitter=0", 20000, false, true);
        compare(on, "tets:side=6,shape=shell", 10000, false);
        compare(on, "tets:side=6,flip=2,flat=5", 10000, false);
        compare(on, "tets:side=5,twins=3", 10000, true);
        compare(on, "tets:side=10,grade=8,jitter=0", 10000, false); /* 8^9 times as wide */
        compare(on, "tets:side=4,jitter=1", 10000, true);           /* tangled */
        compare(on, "tets:side=3,shape=block,thin=100", 10000, false);
        compare(on, "tets:side=3,shape=block,thin=130", 10000, true); /* no normal floats */
    }
}

static void real_meshes(void **state)
{
    (void)state;
    static const char *const meshes[] = {"gargoyle/gargoyle.msh", "cubes_v41/cubes_v41.msh",
                                         "mat100x100/mat100x100t40.msh", "rod300x33/rod300x33.msh"};
    if (access(BB_TEST_SOURCE_DIR "/../shared/data/tet", F_OK) != 0) {
        print_message("skipped: ../shared/data/tet is not there\n");
        skip();
    }
    for (size_t i = 0; i < sizeof meshes / sizeof meshes[0] && !small; i++) {
        char path[256];
        snprintf(path, sizeof path, "%s/../shared/data/tet/%s", BB_TEST_SOURCE_DIR, meshes[i]);
        compare(devices[first_form()], path, 1000, false);
    }
}

static void some_layouts_are_searched(void **state)
{
    (void)state;
    assert_int_equal(bb_layout_find("pair")->search, BB_SEARCH_NONE);
    assert_int_equal(bb_layout_find("skip")->search, BB_SEARCH_SKIP);
}

static int set_up(void **state)
{
    small = getenv("BVHBENCH_TEST_SMALL") != NULL;
    seed = seed_or(20261122);
    return open_devices(state);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_point_is_missed),
        cmocka_unit_test(real_meshes),
        cmocka_unit_test(some_layouts_are_searched),
    };
    return cmocka_run_group_tests(tests, set_up, close_devices);
}
