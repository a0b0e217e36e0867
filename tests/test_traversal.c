/* Kernels against the oracle: every builder with every kernel on small scenes, closed meshes, and
 * scenes that are scaled, moved and permuted. (Awkward rays: test_awkward_rays.c.) Seed:
 * BVHBENCH_TEST_SEED. */
#include "framework/base/random.h"
#include "framework/bench/conformance.h"
#include "framework/builder/registry.h"
#include "framework/judge/queries.h"
#include "framework/workload/workload.h"
#include "tests/device_fixture.h"
#include "tests/registry.h"
#include "tests/trace_fixture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- every builder, every kernel ---- */

enum { SIDE = 40 }; /* of ray sets; `bvhbench check` takes larger ones */

static void every_builder_with_every_kernel_is_right(void **state)
{
    (void)state;
    static const char *const scenes[] = {"single",
                                         "cube",
                                         "interior:n=3000",
                                         "terrain:n=2000",
                                         "random:n=2000",
                                         "hairball:n=1000",
                                         "spheres:n=2000,state=initial",
                                         "spheres:n=2000,state=settled",
                                         "blocks:side=6,mixed=yes",
                                         "sphere-mesh",
                                         "boards:length=1e5,turn=1",
                                         "blinds:length=1e4,turn=2",
                                         "slivers:aspect=40,turn=3",
                                         "awkward:kind=outlier,n=1000",
                                         "awkward:kind=centroids,n=100",
                                         "awkward:kind=flat,n=1000",
                                         "awkward:kind=axis,n=1000",
                                         "awkward:kind=duplicates,n=1000"};
    for (size_t s = 0; s < sizeof scenes / sizeof scenes[0]; s++) {
        bb_scene *scene = load(scenes[s]);
        bb_conformance *conformance;
        check(bb_conformance_create(device, scene, SIDE, seed, &conformance), scenes[s]);
        check(bb_conformance_brute_force(conformance), scenes[s]);
        uint32_t ran = 0;
        for (uint32_t b = 0; b < bb_builder_count(); b++) {
            const bb_builder *builder = bb_builder_at(b);
            const char *compared = bb_builder_variants(builder, BB_ROLE_COMPARED);
            const char *all = compared != NULL ? compared : whole_builder(builder);
            char *variants[16];
            bb_conformed found;
            size_t count = 0;
            check(bb_spec_list(all, variants, 16, &count), all);
            for (size_t v = 0; v < count; v++) {
                bb_status status = bb_conformance_check(conformance, variants[v], &found);
                /* no builder may refuse but for the kinds of primitives that it says it does not
                 * take */
                bool takes = (scene->kinds & ~builder->kinds) == 0;
                if (status != (takes ? BB_OK : BB_UNSUPPORTED))
                    fail_msg("bvhbench check --scene %s --builder %s --seed %llu: %s", scenes[s],
                             variants[v], (unsigned long long)seed, bb_message());
                is_taken(status, variants[v], &ran);
                free(variants[v]);
            }
        }
        assert_true(ran > 0);
        bb_conformance_destroy(conformance);
        bb_scene_free(scene);
    }
}

/* ---- closed meshes ---- */

static void count_lost(const char *scene_name, const char *kernel, const char *intersector,
                       uint32_t count, uint64_t *lost, uint64_t *wrong)
{
    bb_scene *scene = load(scene_name);
    bb_oracle *oracle;
    bb_spec spec;
    bb_rays *rays;
    bb_answers answers;
    bb_accuracy accuracy;
    bed b;
    check(bb_oracle_create(scene, device->compute_units, &oracle), scene_name);
    check(bb_spec_parse("edges", &spec), "edges");
    bb_rays_request request = {.spec = &spec, .max_rays = count, .seed = seed};
    check(bb_rays_make(scene, oracle, &request, &rays), "edges");
    check(bb_answers_make(oracle, rays, &answers), "answers");
    open_bed(&b, scene, "lbvh", kernel, 1);
    bb_hit *hits = malloc(rays->count * sizeof *hits);
    trace(&b, intersector, rays->rays, rays->count, &bb_query_closest, hits, NULL);
    check(bb_judge(oracle, &answers, &(bb_verdict_request){.results = hits, .count = rays->count},
                   &accuracy),
          "judge");
    *lost = accuracy.missed;
    *wrong = accuracy.missed + accuracy.false_hits + accuracy.wrong_t;
    free(hits);
    bb_answers_release(&answers);
    bb_rays_free(rays);
    bb_oracle_destroy(oracle);
    close_bed(&b);
}

static void closed_meshes_do_not_leak(void **state)
{
    (void)state;
    static const char *const scenes[] = {
        "sphere-mesh:radius=2",     "sphere-mesh:radius=10,x=148376,y=1234,z=-223423",
        "sphere-mesh:radius=1000",  "sphere-mesh:radius=1000,x=148376,y=1234,z=-223423",
        "sphere-mesh:radius=1e-15", "sphere-mesh:radius=1e15",
    };
    for (size_t s = 0; s < sizeof scenes / sizeof scenes[0]; s++)
        for (const bb_kernel *const *k = bb_kernels; *k != NULL; k++) {
            uint64_t lost, wrong;
            count_lost(scenes[s], (*k)->name, "exact", 30000, &lost, &wrong);
            if (wrong != 0)
                fail_msg("%s, kernel %s: %llu lost, %llu wrong (seed %llu)", scenes[s], (*k)->name,
                         (unsigned long long)lost, (unsigned long long)wrong,
                         (unsigned long long)seed);
        }
}

/* The same measurement must find what is wrong: the careless intersector leaks. */
static void careless_intersector_is_found_out(void **state)
{
    (void)state;
    uint64_t lost, wrong;
    count_lost("sphere-mesh:radius=2", "stack", "fast", 100000, &lost, &wrong);
    assert_true(lost > 100);
}

/* ---- the stack ---- */

static void an_overflow_is_never_silent(void **state)
{
    (void)state;
    /* squares at distances 2^-i: each split takes one off, and a ray along the axis from the dense
     * side pushes at each */
    enum { LAYERS = 21 };
    bb_scene *scene = load("single");
    check(bb_host_alloc(NULL, 9 * LAYERS * sizeof(float), "v", &scene->vertices), "v");
    check(bb_host_alloc(NULL, 3 * LAYERS * sizeof(uint32_t), "i", &scene->prims[BB_TRIANGLE].data),
          "i");
    for (uint32_t i = 0; i < LAYERS; i++) {
        const float z = ldexpf(1.0f, -(int)i);
        const float v[9] = {-1, -1, z, 3, -1, z, -1, 3, z};
        memcpy(scene->vertices + 9 * i, v, sizeof v);
        for (uint32_t k = 0; k < 3; k++)
            bb_scene_indices(scene)[3 * i + k] = 3 * i + k;
    }
    scene->prims[BB_TRIANGLE].count = scene->prim_count = LAYERS;
    scene->vertex_count = 3 * LAYERS;
    check(bb_scene_finish(scene), "finish");
    bed b;
    open_bed(&b, scene, "lbvh:bits=63", "stack", 1);
    assert_true(b.layout.stack_need > 16);
    bb_ray ray = {.o = {0, 0, -1}, .d = {0, 0, 1}, .tmax = INFINITY};
    bb_hit hit;
    bb_count count;
    trace(&b, "exact", &ray, 1, &bb_query_closest, &hit, &count);
    assert_int_equal(hit.prim, LAYERS - 1);
    assert_int_equal(count.overflow, 0);
    check(bb_spec_parse("stack:stack=16", &b.kernel), "kernel");
    trace(&b, "exact", &ray, 1, &bb_query_closest, &hit, &count);
    assert_int_equal(count.overflow, 1);
    assert_int_equal(hit.prim, BB_POISON);
    close_bed(&b);
}

/* ---- triangles of zero area ---- */

/* Every third triangle of a room shrunk to a line or a point: kept, counted, harmless. */
static void zero_area_triangles_are_harmless(void **state)
{
    (void)state;
    bb_scene *scene = load("interior:n=3000");
    uint32_t shrunk = 0;
    for (uint32_t i = 0; i < scene->prims[BB_TRIANGLE].count; i += 3, shrunk++) {
        bb_scene_indices(scene)[3 * i + 1] = bb_scene_indices(scene)[3 * i];
        if (i % 2 == 0)
            bb_scene_indices(scene)[3 * i + 2] = bb_scene_indices(scene)[3 * i];
    }
    check(bb_scene_finish(scene), "finish");
    check(bb_scene_profile(scene), "profile");
    assert_true(scene->profile.zero_area >= shrunk);
    bb_conformance *conformance;
    check(bb_conformance_create(device, scene, SIDE, seed, &conformance), "conformance");
    check(bb_conformance_brute_force(conformance), "brute force");
    bb_conformed found;
    uint32_t ran = 0;
    for (uint32_t b = 0; b < bb_builder_count(); b++) {
        const char *builder = whole_builder(bb_builder_at(b));
        is_taken(bb_conformance_check(conformance, builder, &found), builder, &ran);
    }
    assert_true(ran > 0);
    bb_conformance_destroy(conformance);
    bb_scene_free(scene);
}

/* ---- metamorphic ---- */

enum { RAYS = 20000 };

static void make_rays(const bb_scene *scene, bb_ray *rays)
{
    bb_random random = bb_random_make(seed, 2);
    for (uint32_t i = 0; i < RAYS; i++) {
        rays[i] = (bb_ray){.tmax = INFINITY};
        for (int k = 0; k < 3; k++) {
            double low = scene->bounds.lo[k], high = scene->bounds.hi[k];
            /* on a coarse grid, so that moving by grid steps is exact */
            rays[i].o[k] = (float)(floor(bb_random_range(&random, low, high) * 256) / 256);
            rays[i].d[k] = (float)bb_random_range(&random, -1, 1);
        }
    }
}

static void trace_scene(bb_scene *scene, const bb_ray *rays, bb_hit *hits, const char *builder)
{
    bed b;
    open_bed(&b, scene, builder, "stack", 1);
    trace(&b, "exact", rays, RAYS, &bb_query_closest, hits, NULL);
    close_bed(&b);
}

/* The scene with its vertices on a grid of 1/256. */
static bb_scene *load_on_grid(const char *name)
{
    bb_scene *scene = load(name);
    for (size_t i = 0; i < 3 * (size_t)scene->vertex_count; i++)
        scene->vertices[i] = roundf(scene->vertices[i] * 256) / 256;
    check(bb_scene_finish(scene), name);
    return scene;
}

static void scaling_by_powers_of_two_changes_nothing(void **state)
{
    (void)state;
    bb_ray *rays = calloc(RAYS, sizeof *rays), *scaled = calloc(RAYS, sizeof *scaled);
    bb_hit *hits = calloc(RAYS, sizeof *hits), *others = calloc(RAYS, sizeof *others);
    bb_scene *scene = load("interior:n=3000");
    make_rays(scene, rays);
    trace_scene(scene, rays, hits, "lbvh");
    static const int exponents[] = {-90, -60, -20, -3, 1, 20, 60, 90};
    for (size_t e = 0; e < sizeof exponents / sizeof exponents[0]; e++) {
        float factor = ldexpf(1.0f, exponents[e]);
        scene = load("interior:n=3000");
        for (size_t i = 0; i < 3 * (size_t)scene->vertex_count; i++)
            scene->vertices[i] *= factor;
        check(bb_scene_finish(scene), "finish");
        memcpy(scaled, rays, RAYS * sizeof *rays);
        for (uint32_t i = 0; i < RAYS; i++)
            for (int k = 0; k < 3; k++)
                scaled[i].o[k] *= factor;
        trace_scene(scene, scaled, others, "lbvh");
        for (uint32_t i = 0; i < RAYS; i++)
            if (others[i].prim != hits[i].prim ||
                (hits[i].prim != BB_NONE && others[i].t != hits[i].t * factor))
                fail_msg("scaled by 2^%d, ray %u: %u at %a, not %u at %a (seed %llu)", exponents[e],
                         i, others[i].prim, others[i].t, hits[i].prim, hits[i].t * factor,
                         (unsigned long long)seed);
    }
    free(rays);
    free(scaled);
    free(hits);
    free(others);
}

static void moving_on_a_grid_changes_nothing(void **state)
{
    (void)state;
    bb_ray *rays = calloc(RAYS, sizeof *rays), *moved = calloc(RAYS, sizeof *moved);
    bb_hit *hits = calloc(RAYS, sizeof *hits), *others = calloc(RAYS, sizeof *others);
    bb_scene *scene = load_on_grid("interior:n=3000");
    make_rays(scene, rays);
    trace_scene(scene, rays, hits, "lbvh");
    const float by[3] = {1000, -2000, 4000};
    scene = load_on_grid("interior:n=3000");
    for (size_t i = 0; i < 3 * (size_t)scene->vertex_count; i++)
        scene->vertices[i] += by[i % 3];
    check(bb_scene_finish(scene), "finish");
    memcpy(moved, rays, RAYS * sizeof *rays);
    for (uint32_t i = 0; i < RAYS; i++)
        for (int k = 0; k < 3; k++)
            moved[i].o[k] += by[k];
    trace_scene(scene, moved, others, "lbvh");
    for (uint32_t i = 0; i < RAYS; i++)
        if (memcmp(&hits[i], &others[i], sizeof hits[i]) != 0)
            fail_msg("moved, ray %u: %u at %a, not %u at %a (seed %llu)", i, others[i].prim,
                     others[i].t, hits[i].prim, hits[i].t, (unsigned long long)seed);
    free(rays);
    free(moved);
    free(hits);
    free(others);
}

static void permuting_primitives_changes_no_distance(void **state)
{
    (void)state;
    bb_ray *rays = calloc(RAYS, sizeof *rays);
    bb_hit *hits = calloc(RAYS, sizeof *hits), *others = calloc(RAYS, sizeof *others);
    bb_scene *scene = load("interior:n=3000");
    make_rays(scene, rays);
    trace_scene(scene, rays, hits, "lbvh");
    scene = load("interior:n=3000");
    uint32_t count = scene->prims[BB_TRIANGLE].count;
    uint32_t *order = calloc(count, sizeof *order), *indices = calloc(count, 3 * sizeof *indices);
    bb_random random = bb_random_make(seed, 3);
    for (uint32_t i = 0; i < count; i++) {
        uint32_t k = bb_random_below(&random, i + 1);
        order[i] = order[k];
        order[k] = i;
    }
    for (uint32_t i = 0; i < count; i++)
        memcpy(indices + 3 * i, bb_scene_indices(scene) + 3 * order[i], 3 * sizeof *indices);
    memcpy(bb_scene_indices(scene), indices, 3 * count * sizeof *indices);
    check(bb_scene_finish(scene), "finish");
    trace_scene(scene, rays, others, "lbvh");
    for (uint32_t i = 0; i < RAYS; i++) {
        uint32_t prim = others[i].prim != BB_NONE ? order[others[i].prim] : BB_NONE;
        if (others[i].t != hits[i].t) /* of equal distances the lowest number wins */
            fail_msg("permuted, ray %u: %u at %a, not %u at %a (seed %llu)", i, prim, others[i].t,
                     hits[i].prim, hits[i].t, (unsigned long long)seed);
    }
    free(order);
    free(indices);
    free(rays);
    free(hits);
    free(others);
}

/* Leaf collapse, and trees of other builders: the same answers, bit for bit. */
static void the_answer_does_not_depend_on_the_tree(void **state)
{
    (void)state;
    bb_ray *rays = calloc(RAYS, sizeof *rays);
    bb_hit *hits = calloc(RAYS, sizeof *hits), *others = calloc(RAYS, sizeof *others);
    bb_scene *scene = load("interior:n=3000");
    make_rays(scene, rays);
    trace_scene(scene, rays, hits, "lbvh");
    uint32_t ran = 0;
    for (uint32_t b = 0; b < bb_builder_count(); b++) {
        bed other;
        const char *builder = whole_builder(bb_builder_at(b));
        if (!open_bed_if_taken(&other, load("interior:n=3000"), builder, "stack",
                               b % 2 == 0 ? 1 : 4, &ran))
            continue;
        trace(&other, "exact", rays, RAYS, &bb_query_closest, others, NULL);
        close_bed(&other);
        for (uint32_t i = 0; i < RAYS; i++)
            if (memcmp(&hits[i], &others[i], sizeof hits[i]) != 0)
                fail_msg("builder %s, ray %u: %u at %a, not %u at %a (seed %llu)", builder, i,
                         others[i].prim, others[i].t, hits[i].prim, hits[i].t,
                         (unsigned long long)seed);
    }
    assert_true(ran > 0);
    free(rays);
    free(hits);
    free(others);
}

/* ---- definitions ---- */

/* A program is found by its definitions: those that differ in the last letter only must not be
 * taken for the same, nor cut off. */
static void long_definitions_are_told_apart(void **state)
{
    (void)state;
    static char defines[2000];
    const size_t lengths[] = {8, 500, 700, 900, 1500};
    bed b;
    open_bed(&b, load("cube"), "lbvh", "stack", 1);
    const bb_traverser_request request = {.kernel = bb_kernel_find("stack"),
                                          .spec = &b.kernel,
                                          .intersector = bb_intersector_find("exact"),
                                          .query = &bb_query_closest,
                                          .defines = defines};
    uint32_t taken = 0;
    for (size_t i = 0; i < sizeof lengths / sizeof lengths[0]; i++) {
        bb_traverser *traversers[2];
        bb_status status[2];
        for (int k = 0; k < 2; k++) {
            memset(defines, 'X', lengths[i]);
            memcpy(defines, "-DBB_", 5);
            snprintf(defines + lengths[i], 4, "=%d", k);
            status[k] = bb_traverser_get(device, &request, &b.layout, &traversers[k]);
            if (status[k] != BB_OK)
                assert_non_null(strstr(bb_message(), "no room"));
        }
        assert_int_equal(status[0], status[1]);
        if (status[0] == BB_OK)
            assert_ptr_not_equal(traversers[0], traversers[1]);
        taken += status[0] == BB_OK;
    }
    assert_in_range(taken, 2, sizeof lengths / sizeof lengths[0] - 1);
    close_bed(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_builder_with_every_kernel_is_right),
        cmocka_unit_test(closed_meshes_do_not_leak),
        cmocka_unit_test(careless_intersector_is_found_out),
        cmocka_unit_test(an_overflow_is_never_silent),
        cmocka_unit_test(zero_area_triangles_are_harmless),
        cmocka_unit_test(scaling_by_powers_of_two_changes_nothing),
        cmocka_unit_test(moving_on_a_grid_changes_nothing),
        cmocka_unit_test(permuting_primitives_changes_no_distance),
        cmocka_unit_test(the_answer_does_not_depend_on_the_tree),
        cmocka_unit_test(long_definitions_are_told_apart),
    };
    return cmocka_run_group_tests(tests, open_device, close_device);
}
