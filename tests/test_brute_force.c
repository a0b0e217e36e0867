/* Every kernel against brute force with its own primitive test, bit for bit: small scenes of all
 * kinds at all scales, trees of builders and random ones, awkward rays, leaves and groups of all
 * sizes, all queries, the forms for CPUs and for GPUs. Seed: BVHBENCH_TEST_SEED;
 * BVHBENCH_TEST_RUNS=N for more. */
#include "framework/base/random.h"
#include "framework/judge/queries.h"
#include "tests/device_fixture.h"
#include "tests/trace_fixture.h"
#include "tests/tree_fixture.h"

#include <float.h>

static const char *const kernels[] = {
    "stack:leaf=8,group=3",
    "stackless:leaf=5,group=1",
    "trail:leaf=2",
    "short:leaf=3,entries=2",
    "short4:leaf=1,entries=2",
    "short8:leaf=8,entries=4",
    "stack4:leaf=1",
    "stack4:leaf=3,plan=greedy,group=5",
    "stack8:leaf=8,order=octant",
    "stack8:leaf=64,node=0.1",
    "stack8q:leaf=4,plan=greedy",
    "stack8i:leaf=1,group=256",
    "stack8i:leaf=1,rays=1,group=1,plan=greedy",
    "stack8i:leaf=2,rays=4,group=7",
    "stack8i:leaf=8,group=100,plan=greedy",
    "stack8i:leaf=64,rays=64,group=33,persistent=yes",
    "stack8i:leaf=8,order=octant,group=50",
    "stack8i:plan=native,group=40",
    "stack8:plan=native,order=octant",
    "stack8q:leaf=4,plan=native",
    "stack4:leaf=3,plan=native,group=5",
    "packet:leaf=2,group=33",
    "packet8:leaf=8,rays=8,group=100",
    "packet8:leaf=3,rays=16,few=0,persistent=yes",
    "stack8:leaf=8,persistent=yes,group=16",
    "cwbvh",
    "cwbvh:leaf=2,plan=greedy,group=5",
    "cwbvh:leaf=3,persistent=yes,group=16",
};

enum { KERNELS = sizeof kernels / sizeof kernels[0], RAYS_MAX = 600 };

/* ---- scenes ---- */

/* Triangles on few points, so that many share corners, edges and planes, and some are flat. */
static bb_scene *make_soup(uint32_t count, float size, bb_random *random)
{
    bb_scene *scene = load("single");
    check(bb_host_alloc(NULL, 9 * count * sizeof(float), "v", &scene->vertices), "v");
    check(bb_host_alloc(NULL, 3 * count * sizeof(uint32_t), "i", &scene->prims[BB_TRIANGLE].data),
          "i");
    const uint32_t points = 3 + bb_random_below(random, 3 * count);
    const bool lattice = bb_random_below(random, 2) == 0;
    for (uint32_t i = 0; i < 3 * points && i < 9 * count; i++)
        scene->vertices[i] = lattice ? size * (((float)bb_random_below(random, 9) - 4) / 4)
                                     : size * (float)bb_random_range(random, -1, 1);
    if (bb_random_below(random, 2) == 0) /* in one octant, as far away as floats go */
        for (uint32_t i = 0; i < 3 * points && i < 9 * count; i++)
            scene->vertices[i] = size + fabsf(scene->vertices[i]);
    for (uint32_t i = 0; i < 3 * count; i++)
        bb_scene_indices(scene)[i] =
            bb_random_below(random, points < 3 * count ? points : 3 * count);
    scene->prims[BB_TRIANGLE].count = scene->prim_count = count;
    scene->vertex_count = points < 3 * count ? points : 3 * count;
    check(bb_scene_finish(scene), "finish");
    return scene;
}

static bb_scene *make_any_scene(uint32_t run, bb_random *random)
{
    static const char *const names[] = {"blocks:side=3,mixed=yes", "spheres:n=60,state=settled",
                                        "tets:side=3,flat=5,twins=7", "awkward:kind=zeros,n=100",
                                        "awkward:kind=duplicates,n=200"};
    static const float sizes[] = {1, 1, 100, 0x1p-99f, 1.6e38f, 0x1p60f};
    if (run % 3 == 0)
        return load(names[run / 3 % (sizeof names / sizeof names[0])]);
    const uint32_t most = bb_random_below(random, 2) == 0 ? 9 : 300;
    return make_soup(1 + bb_random_below(random, most),
                     sizes[bb_random_below(random, sizeof sizes / sizeof sizes[0])], random);
}

/* ---- rays ---- */

static float any_plane(const bb_scene *scene, int axis, bb_random *random)
{
    const bb_box *box = &scene->boxes[bb_random_below(random, scene->prim_count)];
    return bb_random_below(random, 2) == 0 ? box->lo[axis] : box->hi[axis];
}

static void aim(const bb_scene *scene, bb_random *random, bb_ray *ray)
{
    static const float tiny[] = {0.0f, -0.0f, 1e-45f, -1e-40f, 0x1p-63f, -0x1p-66f};
    static const float ends[] = {0,       -0.0f,    -1,  1e-45f, 0.5f,    0x1p60f,
                                 FLT_MAX, INFINITY, NAN, 1,      FLT_MIN, -INFINITY};
    float size = 0, longest = 0;
    for (int k = 0; k < 3; k++)
        size = fmaxf(size, scene->bounds.hi[k] - scene->bounds.lo[k]);
    size = fminf(size, FLT_MAX / 4);
    const uint32_t how = bb_random_below(random, 5);
    const float from = bb_random_below(random, 3) == 0 ? 0 : size;
    *ray = (bb_ray){.tmax = INFINITY};
    for (int k = 0; k < 3; k++) {
        float at = how < 3
                       ? any_plane(scene, k, random)
                       : (float)bb_random_range(random, scene->bounds.lo[k], scene->bounds.hi[k]);
        ray->d[k] = (float)bb_random_range(random, -1, 1);
        if (how == 0 || (how == 1 && bb_random_below(random, 2) == 0))
            ray->d[k] = (float)bb_random_below(random, 3) - 1;
        if (how == 4 && bb_random_below(random, 2) == 0)
            ray->d[k] = tiny[bb_random_below(random, sizeof tiny / sizeof tiny[0])];
        ray->o[k] = fmaxf(fminf(at - from * ray->d[k], FLT_MAX), -FLT_MAX);
        if (how == 2) /* along an edge, or towards a corner */
            ray->d[k] = any_plane(scene, k, random) / size - ray->o[k] / size;
        longest = fmaxf(longest, fabsf(ray->d[k]));
    }
    if (!(longest > 0x1p-60f))
        ray->d[bb_random_below(random, 3)] = 1;
    if (bb_random_below(random, 4) == 0) {
        float scale = ldexpf(1, (int)bb_random_below(random, 119) - 59);
        for (int k = 0; k < 3; k++)
            ray->d[k] *= scale;
    }
    if (bb_random_below(random, 3) == 0)
        ray->tmin = ends[bb_random_below(random, sizeof ends / sizeof ends[0])];
    if (bb_random_below(random, 3) == 0)
        ray->tmax = ends[bb_random_below(random, sizeof ends / sizeof ends[0])];
}

/* ---- trees ---- */

/* Nodes of a layout take no more children than they have places. */
static bool takes(const char *kernel, const bb_tree *tree)
{
    bb_spec spec;
    const bb_kernel *k;
    check(bb_kernel_parse(kernel, &spec, &k), kernel);
    return bb_kernel_wish(&spec).plan != BB_PLAN_NATIVE ||
           tree->info.arity <= bb_layout_find(k->layout)->width;
}

static void choose(bed *b, const char *kernel)
{
    const bb_kernel *k;
    bb_layout_data_release(&b->layout);
    bb_layout_maker_destroy(&b->maker);
    check(bb_kernel_parse(kernel, &b->kernel, &k), kernel);
    uint64_t leaf;
    check(bb_spec_u64(&b->kernel, bb_kernel_common_options, "leaf", 1, BB_LEAF_MAX, &leaf), kernel);
    check(bb_layout_maker_create(bb_layout_find(k->layout), device, &b->maker), kernel);
    b->maker.wish = bb_kernel_wish(&b->kernel);
    check(bb_layout_maker_make(&b->maker, b->scene, &b->instance.tree, (uint32_t)leaf,
                               BB_FORMAT_VERTICES, &b->layout),
          kernel);
}

/* `results` has `count` of the query's, and one more, which is to stay as it is. */
static void answer(const bed *b, const bb_ray *rays, uint32_t count, const bb_query *query,
                   void *results)
{
    bb_traverser_request request = {
        .kernel = bb_kernel_find(b->kernel.name),
        .spec = &b->kernel,
        .intersector = bb_intersector_find("exact"),
        .query = query,
    };
    bb_traverser *traverser;
    bb_buffer d_rays, d_results;
    size_t size = query->result_bytes;
    check(bb_traverser_get(device, &request, &b->layout, &traverser), "traverser");
    make_buffer(&d_rays, rays, count * sizeof *rays);
    make_buffer(&d_results, NULL, (count + 1) * size);
    check(bb_buffer_fill(&d_results, (count + 1) * size, BB_POISON), "poison");
    const bb_pass pass = {.query = query,
                          .traverser = traverser,
                          .layout = &b->layout,
                          .rays = &d_rays,
                          .results = &d_results};
    check(bb_pass_run(&pass, count, results, NULL), "trace");
    bb_u32 beyond;
    check(bb_buffer_read(&d_results, count * size, sizeof beyond, &beyond), "beyond");
    assert_int_equal(beyond, BB_POISON);
    bb_buffer_release(&d_rays);
    bb_buffer_release(&d_results);
}

/* Of any hit: whether there is one, and one within the interval. */
static bool are_alike(const bb_query *query, const bb_ray *ray, const void *brute,
                      const void *found)
{
    if (!query->any)
        return memcmp(brute, found, query->result_bytes) == 0;
    const bb_hit *a = brute, *b = found;
    return a->prim == BB_NONE ? memcmp(a, b, sizeof *a) == 0
                              : b->prim != BB_NONE && b->t >= a->t && b->t < ray->tmax;
}

static void compare(const bed *b, const char *kernel, const bb_ray *rays, uint32_t count,
                    const bb_query *query, const uint8_t *brute, const char *what)
{
    const size_t size = query->result_bytes;
    uint8_t *found = malloc((count + 1) * size);
    answer(b, rays, count, query, found);
    for (uint32_t i = 0; i < count; i++) {
        if (are_alike(query, &rays[i], brute + i * size, found + i * size))
            continue;
        char right[128], wrong[128];
        query->say(brute + i * size, right, sizeof right);
        query->say(found + i * size, wrong, sizeof wrong);
        const bb_ray *r = &rays[i];
        fail_msg(
            "%s (%u primitives), %s, %s, ray %u of %u: %s, brute force: %s; o %a %a %a d %a %a "
            "%a from %a to %a (seed %llu)",
            what, b->scene->prim_count, kernel, query->name, i, count, wrong, right, r->o[0],
            r->o[1], r->o[2], r->d[0], r->d[1], r->d[2], r->tmin, r->tmax,
            (unsigned long long)seed);
    }
    free(found);
}

static void grow(bb_scene *scene, uint32_t run, bb_random *random, bb_tree *tree, char *name,
                 size_t capacity)
{
    const uint32_t arity = 2 + bb_random_below(random, run % 4 == 0 ? 1 : 8);
    const uint32_t per_leaf = 1 + bb_random_below(random, run % 8 < 4 ? 1 : 6);
    snprintf(name, capacity, "run %u: random tree of arity %u, %u per leaf", run, arity, per_leaf);
    make_random_tree(scene, arity, per_leaf, random, tree);
    check(bb_tree_check(tree, scene), name);
}

static void test_run(uint32_t run)
{
    static const uint32_t counts[] = {1, 2, 31, 32, 33, 64, 65, 255, 256, 257, RAYS_MAX};
    static const char *const builders[] = {"null",          "lbvh",  "sah:leaf=4",
                                           "sbvh",          "lobvh", "ploc",
                                           "presplit+lbvh", "olbvh", "lbvh:arity=8"};
    bb_random random = bb_random_make(seed, run), other = bb_random_make(seed, run);
    static bb_ray rays[RAYS_MAX];
    bed brute, b;
    open_bed(&brute, make_any_scene(run, &random), "null", "stack", 1);
    for (uint32_t i = 0; i < RAYS_MAX; i++)
        aim(brute.scene, &random, &rays[i]);
    char what[128];
    const bool grown = run % 2 == 0;
    const char *builder = builders[bb_random_below(&random, sizeof builders / sizeof builders[0])];
    uint32_t ran = 0;
    if (!open_bed_if_taken(&b, make_any_scene(run, &other), grown ? "null" : builder, "stack", 1,
                           &ran)) {
        close_bed(&brute);
        return;
    }
    snprintf(what, sizeof what, "run %u: %s", run, builder);
    if (grown) {
        bb_tree_release(&b.instance.tree);
        grow(b.scene, run, &random, &b.instance.tree, what, sizeof what);
        check(bb_tree_upload(&b.instance.tree, device, NULL), what);
    }
    const bb_query *const queries[] = {&bb_query_closest, &bb_query_any, bb_query_find("interval")};
    static uint8_t right[3][RAYS_MAX * sizeof(bb_interval)];
    const uint32_t kinds = brute.scene->kinds;
    const bb_form form = device->form;
    for (uint32_t q = 0; q < 3; q++)
        if ((kinds & ~queries[q]->kinds) == 0)
            answer(&brute, rays, RAYS_MAX, q == 1 ? queries[0] : queries[q], right[q]);
    for (uint32_t k = 0; k < KERNELS; k++) {
        const uint32_t count = counts[bb_random_below(&random, sizeof counts / sizeof counts[0])];
        if (!takes(kernels[k], &b.instance.tree))
            continue;
        choose(&b, kernels[k]);
        device->form = (run + k) % 2 == 0 ? BB_FORM_CPU : BB_FORM_GPU; /* of what is compiled */
        for (uint32_t q = 0; q < 3; q++)
            if ((kinds & ~queries[q]->kinds) == 0 && (q == 0 || (run + k) % 4 == q))
                compare(&b, kernels[k], rays, count, queries[q], right[q], what);
        device->form = form;
    }
    close_bed(&b);
    close_bed(&brute);
}

static void kernels_answer_as_brute_force(void **state)
{
    (void)state;
    const char *more = getenv("BVHBENCH_TEST_RUNS");
    const uint32_t runs = more != NULL ? (uint32_t)strtoul(more, NULL, 10) : 16;
    for (uint32_t run = 0; run < runs; run++)
        test_run(run);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(kernels_answer_as_brute_force),
    };
    return cmocka_run_group_tests(tests, open_device, close_device);
}
