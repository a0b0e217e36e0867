/* Kernels without a full stack against the stack: the same answers, bit for bit, on the trees of
 * all builders; trees that are very deep; trails that are too short. Seed: BVHBENCH_TEST_SEED. */
#include "framework/base/random.h"
#include "framework/builder/registry.h"
#include "framework/judge/queries.h"
#include "tests/device_fixture.h"
#include "tests/registry.h"
#include "tests/trace_fixture.h"

enum { RAYS = 10000 };

static const char *const others[] = {"stackless", "trail", "short:entries=1", "short:entries=2",
                                     "short:entries=16"};
enum { OTHERS = sizeof others / sizeof others[0] };

static void make_rays(const bb_scene *scene, bb_ray *rays)
{
    bb_random random = bb_random_make(seed, 2);
    for (uint32_t i = 0; i < RAYS; i++) {
        rays[i] = (bb_ray){.tmax = i % 4 == 0 ? (float)bb_random_unit(&random) : INFINITY};
        for (int k = 0; k < 3; k++) {
            double low = scene->bounds.lo[k], high = scene->bounds.hi[k];
            rays[i].o[k] = (float)bb_random_range(&random, low, high);
            rays[i].d[k] = (float)bb_random_range(&random, low - high, high - low);
        }
    }
}

/* ---- the same answers ---- */

static void compare(const bed *b, const char *builder, const bb_hit *hits, const bb_hit *found,
                    const bb_query *query)
{
    for (uint32_t i = 0; i < RAYS; i++) {
        if (memcmp(&hits[i], &found[i], sizeof hits[i]) == 0)
            continue;
        /* any hit will do, if there is one */
        bool both = (hits[i].prim == BB_NONE) == (found[i].prim == BB_NONE);
        if (query == &bb_query_closest || !both)
            fail_msg(
                "%s, builder %s, kernel %s, %s hit, ray %u: %u at %a, not %u at %a (seed %llu)",
                b->scene->name, builder, b->kernel.text, query->name, i, found[i].prim, found[i].t,
                hits[i].prim, hits[i].t, (unsigned long long)seed);
    }
}

static void all_kernels_answer_as_the_stack_does(void **state)
{
    (void)state;
    static const char *const scenes[] = {"single",        "interior:n=3000", "terrain:n=2000",
                                         "random:n=2000", "hairball:n=1000", "spheres:n=2000"};
    bb_ray *rays = calloc(RAYS, sizeof *rays);
    bb_hit *hits = calloc(RAYS, sizeof *hits), *found = calloc(RAYS, sizeof *found);
    for (size_t s = 0; s < sizeof scenes / sizeof scenes[0]; s++) {
        uint32_t ran = 0;
        for (uint32_t i = 0; i < bb_builder_count(); i++) {
            const char *builder = whole_builder(bb_builder_at(i));
            uint32_t leaf = i % 2 == 0 ? 1 : 4;
            bed b;
            if (!open_bed_if_taken(&b, load(scenes[s]), builder, "stack", leaf, &ran))
                continue;
            make_rays(b.scene, rays);
            for (const bb_query *query = &bb_query_closest; query <= &bb_query_any; query++) {
                choose_kernel(&b, "stack", leaf);
                trace(&b, "exact", rays, RAYS, query, hits, NULL);
                for (size_t k = 0; k < OTHERS; k++) {
                    choose_kernel(&b, others[k], leaf);
                    trace(&b, "exact", rays, RAYS, query, found, NULL);
                    compare(&b, builder, hits, found, query);
                }
            }
            close_bed(&b);
        }
        assert_true(ran > 0);
    }
    free(rays);
    free(hits);
    free(found);
}

/* ---- deep trees ---- */

/* Triangles across the z axis, one per unit from 1 on. */
static bb_scene *make_layers(uint32_t count)
{
    bb_scene *scene = load("single");
    check(bb_host_alloc(NULL, 9 * count * sizeof(float), "v", &scene->vertices), "v");
    check(bb_host_alloc(NULL, 3 * count * sizeof(uint32_t), "i", &scene->prims[BB_TRIANGLE].data),
          "i");
    for (uint32_t i = 0; i < count; i++) {
        const float z = 1.0f + (float)i;
        const float v[9] = {-1, -1, z, 3, -1, z, -1, 3, z};
        memcpy(scene->vertices + 9 * i, v, sizeof v);
        for (uint32_t k = 0; k < 3; k++)
            bb_scene_indices(scene)[3 * i + k] = 3 * i + k;
    }
    scene->prims[BB_TRIANGLE].count = scene->prim_count = count;
    scene->vertex_count = 3 * count;
    check(bb_scene_finish(scene), "finish");
    check(bb_scene_upload(scene, device), "upload");
    return scene;
}

/* A chain over the layers, which takes one off per level. Node 2i holds [0, count - i), its
 * children are node 2i + 2, which goes on, and the leaf 2i + 1 of the last layer. */
static void make_chain(const bb_scene *scene, bb_tree *tree)
{
    uint32_t count = scene->prim_count;
    bb_tree_init(tree, NULL);
    check(bb_tree_reserve(tree, NULL, BB_ON_HOST, 2 * count - 1, count), "tree");
    for (uint32_t n = 0; n < 2 * count - 1; n++) {
        bb_node *node = &tree->nodes[n];
        uint32_t last = count - 1 - n / 2; /* layer */
        bool leaf = n % 2 == 1 || n == 2 * count - 2;
        *node = (bb_node){.lo = {-1, -1, 1}, .hi = {3, 3, scene->boxes[last].hi[2]}};
        if (leaf)
            node->lo[2] = node->hi[2];
        node->first = leaf ? BB_LEAF_BIT | last : n + 2;
        /* 2i + 2 comes first, then 2i + 1, then what is after node 2i: the leaf above it */
        node->skip = n == 0 || n == 1 ? BB_NONE : n % 2 == 0 ? n - 1 : n - 2;
    }
    for (uint32_t r = 0; r < count; r++)
        tree->refs[r] = r | BB_LAST_BIT;
    tree->info = (bb_tree_info){0, 2 * count - 1, count, count, 2, count - 1};
    check(bb_tree_check(tree, scene), "the test's own tree");
    check(bb_tree_upload(tree, device, NULL), "upload");
}

static void trees_of_depth_200_are_traced_by_every_kernel(void **state)
{
    (void)state;
    enum { LAYERS = 201 };
    bed b = {.scene = make_layers(LAYERS)};
    make_chain(b.scene, &b.instance.tree);
    assert_int_equal(b.instance.tree.info.depth, 200);
    /* from between any two layers, up and down, along the axis and off it: to the next layer */
    bb_ray rays[4 * LAYERS];
    bb_hit hits[4 * LAYERS];
    for (uint32_t i = 0; i < 4 * LAYERS; i++) {
        float x = (float)(i % 7) * 0.1f, z = (float)(i / 4) + 0.5f;
        rays[i] = (bb_ray){.o = {x, 0.2f, z}, .d = {0, 0, i % 2 == 0 ? 1 : -1}, .tmax = INFINITY};
        if (i % 4 >= 2)
            rays[i].d[0] = 1e-4f;
    }
    for (const bb_kernel *const *k = bb_kernels; *k != NULL; k++) {
        choose_kernel(&b, (*k)->name, 1);
        trace(&b, "exact", rays, 4 * LAYERS, &bb_query_closest, hits, NULL);
        for (uint32_t i = 0; i < 4 * LAYERS; i++) {
            /* layer j lies at 1 + j, the ray begins at layer + 1/2 */
            uint32_t up = i / 4 < LAYERS ? i / 4 : BB_NONE, down = i / 4 == 0 ? BB_NONE : i / 4 - 1;
            uint32_t expected = i % 2 == 0 ? up : down;
            if (hits[i].prim != expected)
                fail_msg("kernel %s, ray %u: %u at %g, not %u", (*k)->name, i, hits[i].prim,
                         hits[i].t, expected);
        }
    }
    bb_tree_release(&b.instance.tree);
    b.instance = (bb_instance){0};
    close_bed(&b);
}

/* A tree that is deeper than a trail's levels is refused, and one that is deeper than it was said
 * to be overflows. */
static void a_trail_that_is_too_short_is_never_silent(void **state)
{
    (void)state;
    enum { LAYERS = 100 };
    static const char *const trails[] = {"trail", "short:entries=2"};
    bed b = {.scene = make_layers(LAYERS)};
    make_chain(b.scene, &b.instance.tree);
    for (size_t t = 0; t < 2; t++) {
        bb_ray ray = {.o = {0, 0, 0}, .d = {0, 0, 1}, .tmax = INFINITY};
        bb_hit hit;
        bb_count count;
        choose_kernel(&b, trails[t], 1);
        trace(&b, "exact", &ray, 1, &bb_query_closest, &hit, &count);
        assert_int_equal(hit.prim, 0);
        assert_int_equal(count.overflow, 0);
        b.layout.levels = 64;
        trace(&b, "exact", &ray, 1, &bb_query_closest, &hit, &count);
        assert_int_equal(hit.prim, BB_POISON);
        assert_int_equal(count.overflow, 1);
        bb_traverser *traverser;
        bb_traverser_request request = {
            .query = &bb_query_closest,
            .kernel = bb_kernel_find(b.kernel.name),
            .spec = &b.kernel,
            .intersector = &bb_intersectors[0],
        };
        b.layout.levels = BB_TRAIL_MAX + 1;
        assert_int_equal(bb_traverser_get(device, &request, &b.layout, &traverser), BB_UNSUPPORTED);
        assert_non_null(strstr(bb_message(), "16385"));
    }
    bb_tree_release(&b.instance.tree);
    b.instance = (bb_instance){0};
    close_bed(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {

        cmocka_unit_test(all_kernels_answer_as_the_stack_does),
        cmocka_unit_test(trees_of_depth_200_are_traced_by_every_kernel),
        cmocka_unit_test(a_trail_that_is_too_short_is_never_silent),
    };
    return cmocka_run_group_tests(tests, open_device, close_device);
}
