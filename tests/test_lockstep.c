/* The replay of recorded steps (framework/simulate/) against work-groups that run the same
 * traversals in lockstep on the device: the same steps, lanes, sectors and
 * lines of each kind, to the last one. */
#include "framework/base/arithmetic.h"
#include "framework/base/random.h"
#include "framework/builder/instance.h"
#include "framework/judge/queries.h"
#include "framework/simulate/lockstep.h"
#include "framework/simulate/trace_steps.h"
#include "tests/device_fixture.h"
#include "tests/tree_fixture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { RAYS = 150 }; /* groups of 32 and of 64, the last ones not whole */

static const char *const scenes[] = {"interior:n=1000", "soup:n=500", "sphere-mesh:n=12",
                                     "spheres:n=200", "blocks:side=6,mixed=yes"};

/* A layout as a kernel reads it. */
typedef struct laid_out {
    bb_spec spec;
    bb_traverser_request request;
    bb_layout_maker maker;
    bb_layout_data layout;
} laid_out;

static void lay_out(laid_out *l, const char *kernel, const bb_scene *scene, bb_tree *tree,
                    uint32_t leaf, bool preorder)
{
    *l = (laid_out){.request = {.spec = &l->spec,
                                .intersector = &bb_intersectors[0],
                                .query = &bb_query_closest}};
    check(bb_kernel_parse(kernel, &l->spec, &l->request.kernel), kernel);
    check(bb_layout_maker_create(bb_layout_find(l->request.kernel->layout), device, &l->maker),
          "layout");
    l->maker.wish.preorder = preorder;
    check(bb_tree_upload(tree, device, NULL), "upload");
    check(bb_layout_maker_make(&l->maker, scene, tree, leaf, BB_FORMAT_VERTICES, &l->layout),
          "layout");
}

static void release_layout(laid_out *l)
{
    bb_layout_data_release(&l->layout);
    bb_layout_maker_destroy(&l->maker);
}

/* ---- the comparison ---- */

static void expect_equal(const char *what, const bb_issued *replayed, const bb_issued *reference)
{
    const uint32_t k = bb_lockstep_differs(replayed, reference);
    if (k == BB_ISSUE_KINDS)
        return;
    const bb_issued *a = &replayed[k], *b = &reference[k];
    fail_msg("%s, %s (seed %llu): %llu steps, %llu lanes, %llu sectors, %llu lines; in lockstep "
             "%llu, %llu, %llu, %llu",
             what, bb_issue_names[k], (unsigned long long)seed, (unsigned long long)a->count,
             (unsigned long long)a->lanes, (unsigned long long)a->sectors,
             (unsigned long long)a->lines, (unsigned long long)b->count,
             (unsigned long long)b->lanes, (unsigned long long)b->sectors,
             (unsigned long long)b->lines);
}

static uint64_t nodes_compared, prims_compared; /* steps */

static void compare(const bb_lockstep_case *which, const char *scene_name, const bb_query *query,
                    const laid_out *l, const bb_ray *rays)
{
    bb_traverser_request request = l->request;
    char what[256];
    bb_steps steps;
    request.query = query;
    const bb_footing footing = bb_footing_of(&request, &l->layout);
    assert_int_equal(footing.ring, which->ring);
    check(bb_trace_steps(device, &request, &l->layout, rays, RAYS, BB_SAMPLE_ALL, &steps),
          which->kernel);
    bb_issued sums[BB_LOCKSTEP_WIDTHS][BB_ISSUE_KINDS];
    check(bb_lockstep_run(device, which, &request, &l->layout, rays, RAYS, sums), which->source);
    for (uint32_t w = 0; w < BB_LOCKSTEP_WIDTHS; w++) {
        const uint32_t width = 32u << w;
        bb_traffic traffic;
        const bb_machine machine = {.width = width,
                                    .units = 3,
                                    .in_flight = 2,
                                    .first_bytes = 1 << 14,
                                    .first_ways = 4,
                                    .second_bytes = 1 << 18,
                                    .second_ways = 16};
        check(bb_machine_run(&machine, &footing, &steps, &traffic), "machine");
        snprintf(what, sizeof what, "%s, %s, %s, width %u", which->kernel, scene_name, query->name,
                 width);
        assert_int_equal(traffic.rays, RAYS);
        nodes_compared += sums[w][BB_STEP_NODE].count;
        prims_compared += sums[w][BB_STEP_PRIMS].count;
        expect_equal(what, traffic.issued, sums[w]);
    }
    bb_steps_release(&steps);
}

static void replay_equals_lockstep(void **state)
{
    (void)state;
    static bb_ray rays[RAYS];
    for (size_t s = 0; s < sizeof scenes / sizeof scenes[0]; s++) {
        bb_scene *scene;
        bb_instance instance;
        check(bb_scene_load(scenes[s], &scene), scenes[s]);
        check(bb_scene_upload(scene, device), scenes[s]);
        bb_lockstep_rays(scene, seed, rays, RAYS);
        check(bb_instance_create(device, "hploc", scene, 1, &instance), "create");
        check(bb_instance_build(&instance, scene, false, NULL), "build");
        for (const bb_lockstep_case *c = bb_lockstep_cases; c->kernel != NULL; c++) {
            laid_out l;
            const bool packets = strncmp(c->kernel, "packet", 6) == 0;
            if (packets && scene->prims[BB_TRIANGLE].count == 0) /* they are not recorded */
                continue;
            lay_out(&l, c->kernel, scene, &instance.tree, c->leaf, false);
            compare(c, scenes[s], &bb_query_closest, &l, rays);
            compare(c, scenes[s], &bb_query_any, &l, rays);
            release_layout(&l);
        }
        bb_instance_destroy(&instance);
        bb_scene_free(scene);
    }
    /* rays that meet nothing would show nothing */
    assert_true(nodes_compared > 10000 && prims_compared > 3000);
}

/* ---- numbering ---- */

static void record_on(const bb_scene *scene, bb_tree *tree, const char *kernel, bool preorder,
                      const bb_ray *rays, bb_steps *steps)
{
    laid_out l;
    lay_out(&l, kernel, scene, tree, 1, preorder);
    assert_int_equal(strstr(l.layout.name, "preorder") != NULL, preorder);
    check(bb_trace_steps(device, &l.request, &l.layout, rays, RAYS, BB_SAMPLE_ALL, steps), kernel);
    release_layout(&l);
}

static bool is_same(const bb_steps *a, const bb_steps *b)
{
    return a->rays == b->rays && memcmp(a->ends, b->ends, a->rays * sizeof *a->ends) == 0 &&
           memcmp(a->words, b->words, a->ends[a->rays - 1] * sizeof *a->words) == 0;
}

/* Nodes in whatever order, as threads may leave them: the steps are those of the tree in preorder.
 * */
static void numbers_of_nodes_do_not_matter(void **state)
{
    (void)state;
    static bb_ray rays[RAYS];
    static const char *const kernels[] = {"stack",     "stack4", "stack8q",
                                          "stackless", "trail",  "cwbvh"};
    bb_scene *scene;
    bb_tree tree, ordered;
    bb_random random = bb_random_make(seed, 3);
    check(bb_scene_load("soup:n=300", &scene), "scene");
    check(bb_scene_upload(scene, device), "scene");
    bb_lockstep_rays(scene, seed, rays, RAYS);
    make_random_tree(scene, 2, 1, &random, &tree);
    bb_tree_init(&ordered, NULL);
    check(bb_tree_preorder(&tree, &ordered), "preorder");
    for (size_t k = 0; k < sizeof kernels / sizeof kernels[0]; k++) {
        bb_steps expected, renumbered, as_it_is;
        record_on(scene, &ordered, kernels[k], false, rays, &expected);
        record_on(scene, &tree, kernels[k], true, rays, &renumbered);
        record_on(scene, &tree, kernels[k], false, rays, &as_it_is);
        if (!is_same(&expected, &renumbered))
            fail_msg("%s (seed %llu): other steps than in preorder", kernels[k],
                     (unsigned long long)seed);
        assert_int_equal(expected.ends[RAYS - 1], as_it_is.ends[RAYS - 1]);
        bb_steps_release(&expected);
        bb_steps_release(&renumbered);
        bb_steps_release(&as_it_is);
    }
    bb_tree_release(&tree);
    bb_tree_release(&ordered);
    bb_scene_free(scene);
}

static uint32_t begin_of(const bb_steps *steps, uint32_t ray)
{
    return ray > 0 ? steps->ends[ray - 1] : 0;
}

/* Whether a run of both has the same steps. */
static bool is_same_run(const bb_steps *a, uint32_t of_a, const bb_steps *b, uint32_t of_b)
{
    const uint32_t first_a = begin_of(a, of_a * BB_STEPS_RUN);
    const uint32_t first_b = begin_of(b, of_b * BB_STEPS_RUN);
    for (uint32_t i = 0; i < BB_STEPS_RUN; i++)
        if (a->ends[of_a * BB_STEPS_RUN + i] - first_a !=
            b->ends[of_b * BB_STEPS_RUN + i] - first_b)
            return false;
    const size_t words = a->ends[(of_a + 1) * BB_STEPS_RUN - 1] - first_a;
    return memcmp(a->words + first_a, b->words + first_b, words * sizeof *a->words) == 0;
}

/* A sample has whole runs of the set, in their order, as many short and long ones as the set. */
static void samples_are_runs_of_the_set(void **state)
{
    (void)state;
    enum { RUNS = 192, COUNT = RUNS * BB_STEPS_RUN + 5, KINDS = 3, PART = 4 };
    static bb_ray rays[COUNT];
    bb_scene *scene;
    bb_tree tree;
    laid_out l;
    bb_steps all, some;
    bb_random random = bb_random_make(seed, 4);
    check(bb_scene_load("soup:n=100", &scene), "scene");
    check(bb_scene_upload(scene, device), "scene");
    /* of three runs the rays of one are empty, of one go past the scene, of one through it */
    for (uint32_t i = 0; i < COUNT; i++) {
        const uint32_t kind = i / BB_STEPS_RUN % KINDS;
        rays[i].tmax = kind == 0 ? -1 : INFINITY;
        for (int k = 0; k < 3; k++) {
            const float lo = scene->bounds.lo[k], hi = scene->bounds.hi[k];
            rays[i].o[k] =
                (float)bb_random_range(&random, lo, hi) + (kind == 1 ? 2 * (hi - lo) : 0);
            rays[i].d[k] = (float)bb_random_range(&random, 0.1, 1);
        }
    }
    make_random_tree(scene, 2, 1, &random, &tree);
    lay_out(&l, "stack", scene, &tree, 1, true);
    check(bb_trace_steps(device, &l.request, &l.layout, rays, COUNT, BB_SAMPLE_ALL, &all), "all");
    assert_int_equal(all.rays, COUNT);
    /* the same in several launches, where no buffer has room for all */
    const uint64_t largest = device->largest_allocation;
    device->largest_allocation = sizeof rays;
    assert_true(all.ends[COUNT - 1] * sizeof *all.words > 2 * sizeof rays);
    check(bb_trace_steps(device, &l.request, &l.layout, rays, COUNT, BB_SAMPLE_ALL, &some),
          "parts");
    device->largest_allocation = largest;
    assert_true(is_same(&all, &some));
    bb_steps_release(&some);
    for (uint32_t runs = RUNS / 16; runs <= RUNS; runs *= 2) {
        const uint32_t taken = runs / PART;
        check(bb_trace_steps(device, &l.request, &l.layout, rays, runs * BB_STEPS_RUN + 5,
                             (bb_sample_size){taken * BB_STEPS_RUN, taken * BB_STEPS_RUN}, &some),
              "some");
        assert_int_equal(some.rays, taken * BB_STEPS_RUN);
        uint32_t long_ones = 0, run = 0;
        for (uint32_t i = 0; i < taken; i++, run++) {
            while (run < runs && !is_same_run(&some, i, &all, run))
                run++;
            assert_true(run < runs);
            long_ones += run % KINDS == 2; /* others may be alike */
        }
        assert_int_equal(long_ones, taken / KINDS);
        bb_steps_release(&some);
    }
    release_layout(&l);
    bb_steps_release(&all);
    bb_tree_release(&tree);
    bb_scene_free(scene);
}

/* What cannot be recorded is refused with a reason. */
static void other_kernels_are_refused(void **state)
{
    (void)state;
    static const struct {
        const char *scene, *kernel;
    } refused[] = {{"soup:n=100", "stack8i"},
                   {"soup:n=100", "packet8:sort=yes"},
                   {"soup:n=100", "stack:sort=yes"},
                   {"spheres:n=100", "packet8"}};
    static bb_ray rays[RAYS];
    for (size_t k = 0; k < sizeof refused / sizeof refused[0]; k++) {
        bb_scene *scene;
        bb_instance instance;
        laid_out l;
        bb_steps steps;
        check(bb_scene_load(refused[k].scene, &scene), "scene");
        check(bb_scene_upload(scene, device), "scene");
        bb_lockstep_rays(scene, seed, rays, RAYS);
        check(bb_instance_create(device, "lbvh", scene, 1, &instance), "create");
        check(bb_instance_build(&instance, scene, false, NULL), "build");
        lay_out(&l, refused[k].kernel, scene, &instance.tree, 1, false);
        assert_int_equal(
            bb_trace_steps(device, &l.request, &l.layout, rays, RAYS, BB_SAMPLE_ALL, &steps),
            BB_UNSUPPORTED);
        assert_non_null(strstr(bb_message(), refused[k].kernel));
        release_layout(&l);
        bb_instance_destroy(&instance);
        bb_scene_free(scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(replay_equals_lockstep),
        cmocka_unit_test(numbers_of_nodes_do_not_matter),
        cmocka_unit_test(samples_are_runs_of_the_set),
        cmocka_unit_test(other_kernels_are_refused),
    };
    return cmocka_run_group_tests(tests, open_device, close_device);
}
