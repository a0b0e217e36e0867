/* The layout and traversal kernels on scenes of a few primitives, against brute force in double
 * precision on the host. Small enough for oclgrind, under which this program runs as well. */
#include "framework/base/random.h"
#include "framework/builder/instance.h"
#include "framework/builder/registry.h"
#include "framework/judge/queries.h"
#include "tests/device_fixture.h"
#include "tests/layout_leaf.h"
#include "tests/registry.h"
#include "traversal/collapse.h"
#include "traversal/pass.h"
#include "traversal/reach.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TRIANGLES = 40, SPHERES = 20, RAYS = 200 };

/* Triangles and spheres that do not touch: one per cell of a grid. */
static void make_scene(bb_scene *scene, uint32_t triangles, uint32_t spheres)
{
    bb_random random = bb_random_make(7, triangles + 100 * spheres);
    memset(scene, 0, sizeof *scene);
    strcpy(scene->name, "grid");
    scene->prims[BB_TRIANGLE].count = triangles;
    scene->prims[BB_SPHERE].count = spheres;
    scene->prims[BB_SPHERE].first = triangles;
    scene->vertex_count = 3 * triangles;
    scene->kinds = (triangles > 0 ? BB_TRIANGLES : 0) | (spheres > 0 ? BB_SPHERES : 0);
    if (triangles > 0) {
        check(bb_host_alloc(NULL, 9 * triangles * sizeof(float), "v", &scene->vertices), "v");
        check(bb_host_alloc(NULL, 3 * triangles * sizeof(uint32_t), "i",
                            &scene->prims[BB_TRIANGLE].data),
              "i");
    }
    if (spheres > 0)
        check(bb_host_alloc(NULL, 4 * spheres * sizeof(float), "s", &scene->prims[BB_SPHERE].data),
              "s");
    for (uint32_t p = 0; p < triangles + spheres; p++) {
        const float cell[3] = {(float)(p % 4), (float)(p / 4 % 4), (float)(p / 16)};
        for (uint32_t corner = 0; p < triangles && corner < 3; corner++) {
            bb_scene_indices(scene)[3 * p + corner] = 3 * p + corner;
            for (uint32_t k = 0; k < 3; k++)
                scene->vertices[9 * p + 3 * corner + k] =
                    cell[k] + 0.8f * (float)bb_random_unit(&random);
        }
        for (uint32_t k = 0; p >= triangles && k < 4; k++)
            bb_scene_floats(scene, BB_SPHERE)[4 * (p - triangles) + k] =
                k < 3 ? cell[k] + 0.5f : 0.4f;
    }
    check(bb_scene_finish(scene), "scene");
    check(bb_scene_upload(scene, device), "upload");
}

static void release_scene(bb_scene *scene)
{
    bb_host_free(scene->vertices);
    bb_host_free(bb_scene_indices(scene));
    bb_host_free(bb_scene_floats(scene, BB_SPHERE));
    bb_host_free(scene->boxes);
    bb_buffer_release(&scene->on_device.boxes);
    bb_buffer_release(&scene->on_device.vertices);
    bb_buffer_release(&scene->on_device.prims);
    bb_host_free(scene->seal);
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

/* Distance, INFINITY if there is none, NAN if it is too close to call. */
static double hit_triangle(const float *v, const bb_ray *ray)
{
    double e[2][3], s[3], d[3], p[3], q[3];
    for (int k = 0; k < 3; k++) {
        e[0][k] = (double)v[3 + k] - v[k];
        e[1][k] = (double)v[6 + k] - v[k];
        s[k] = (double)ray->o[k] - v[k];
        d[k] = ray->d[k];
    }
    cross(d, e[1], p);
    cross(s, e[0], q);
    double det = dot(e[0], p);
    double u = dot(s, p) / det, w = dot(d, q) / det, t = dot(e[1], q) / det;
    double inside = fmin(fmin(u, w), 1 - u - w);
    if (fabs(inside) < 1e-4 || fabs(det) < 1e-4)
        return NAN;
    return inside > 0 && t > 0 ? t : INFINITY;
}

static double hit_sphere(const float *s, const bb_ray *ray)
{
    double f[3], d[3];
    for (int k = 0; k < 3; k++) {
        f[k] = (double)ray->o[k] - s[k];
        d[k] = ray->d[k];
    }
    double a = dot(d, d), b = -dot(f, d) / a, c = (dot(f, f) - (double)s[3] * s[3]) / a;
    double discriminant = b * b - c;
    if (fabs(discriminant) < 1e-4)
        return NAN;
    if (discriminant < 0)
        return INFINITY;
    double near = b - sqrt(discriminant), far = b + sqrt(discriminant);
    return near > 0 ? near : far > 0 ? far : INFINITY;
}

/* Nearest primitive by brute force; false if a primitive is too close to call. */
static bool brute_force(const bb_scene *scene, const bb_ray *ray, double *t, uint32_t *prim)
{
    *t = INFINITY;
    *prim = BB_NONE;
    for (uint32_t p = 0; p < scene->prim_count; p++) {
        double found = p < scene->prims[BB_TRIANGLE].count
                           ? hit_triangle(scene->vertices + 9 * p, ray)
                           : hit_sphere(bb_scene_floats(scene, BB_SPHERE) +
                                            4 * (p - scene->prims[BB_TRIANGLE].count),
                                        ray);
        if (isnan(found))
            return false;
        if (found < *t) {
            *t = found;
            *prim = p;
        }
    }
    return true;
}

/* `parameters` of the kernel, such as ":group=8", or "". */
static void trace_with(const char *parameters, const bb_layout_data *layout,
                       const bb_kernel *kernel, const bb_intersector *intersector,
                       const bb_query *query, bool counting, const bb_ray *rays, bb_hit *hits)
{
    bb_spec spec;
    char text[128];
    snprintf(text, sizeof text, "%s%s", kernel->name, parameters);
    bb_traverser *traverser;
    bb_buffer d_rays = {0}, d_hits = {0}, d_counts = {0};
    bb_count counts[RAYS];
    check(bb_spec_parse(text, &spec), text);
    bb_traverser_request request = {
        .kernel = kernel,
        .spec = &spec,
        .intersector = intersector,
        .query = query,
        .counting = counting,
    };
    check(bb_traverser_get(device, &request, layout, &traverser), kernel->name);
    check(bb_buffer_reserve(device, NULL, RAYS * sizeof *rays, "rays", &d_rays), "rays");
    check(bb_buffer_reserve(device, NULL, RAYS * sizeof *hits, "hits", &d_hits), "hits");
    check(bb_buffer_reserve(device, NULL, sizeof counts, "counts", &d_counts), "counts");
    check(bb_buffer_write(&d_rays, 0, RAYS * sizeof *rays, rays), "rays");
    const bb_pass pass = {.query = query,
                          .traverser = traverser,
                          .layout = layout,
                          .rays = &d_rays,
                          .results = &d_hits,
                          .counts = &d_counts};
    check(bb_pass_run(&pass, RAYS, hits, counting ? counts : NULL), "trace");
    if (counting) {
        for (uint32_t i = 0; i < RAYS; i++)
            assert_int_equal(counts[i].overflow, 0);
    }
    bb_buffer_release(&d_rays);
    bb_buffer_release(&d_hits);
    bb_buffer_release(&d_counts);
}

static void trace(const bb_layout_data *layout, const bb_kernel *kernel,
                  const bb_intersector *intersector, const bb_query *query, bool counting,
                  const bb_ray *rays, bb_hit *hits)
{
    trace_with("", layout, kernel, intersector, query, counting, rays, hits);
}

static void aim_rays(const bb_scene *scene, bb_ray *rays)
{
    bb_random random = bb_random_make(9, scene->prim_count);
    for (uint32_t i = 0; i < RAYS; i++) {
        rays[i] = (bb_ray){.tmax = INFINITY};
        const bb_box *aim = &scene->boxes[bb_random_below(&random, scene->prim_count)];
        for (int k = 0; k < 3; k++) {
            rays[i].o[k] = (float)bb_random_range(&random, -1, 5);
            rays[i].d[k] = (float)bb_random_range(&random, aim->lo[k], aim->hi[k]) - rays[i].o[k];
        }
    }
}

static void compare(const bb_scene *scene, const bb_layout_data *layout, const bb_kernel *kernel,
                    const bb_intersector *intersector)
{
    static bb_ray rays[RAYS];
    static bb_hit closest[RAYS], counted[RAYS], any[RAYS];
    aim_rays(scene, rays);
    trace(layout, kernel, intersector, &bb_query_closest, false, rays, closest);
    bool exact = intersector == &bb_intersectors[0];
    /* a variant to compile for each: of the others, one kernel's */
    bool all = exact || kernel == bb_kernels[0];
    if (exact) {
        trace(layout, kernel, intersector, &bb_query_closest, true, rays, counted);
        assert_memory_equal(closest, counted, sizeof closest);
    }
    if (all)
        trace(layout, kernel, intersector, &bb_query_any, false, rays, any);
    uint32_t hits = 0, decided = 0;
    for (uint32_t i = 0; i < RAYS; i++) {
        double t;
        uint32_t prim;
        if (!brute_force(scene, &rays[i], &t, &prim))
            continue;
        decided++;
        hits += prim != BB_NONE;
        if (closest[i].prim != prim || (prim != BB_NONE && fabs(closest[i].t - t) > 1e-4 * t))
            fail_msg("kernel %s, layout %s, %s, ray %u: %u at %g, not %u at %g", kernel->name,
                     layout->name, intersector->name, i, closest[i].prim, closest[i].t, prim, t);
        if (all && (any[i].prim == BB_NONE) != (prim == BB_NONE))
            fail_msg("kernel %s, layout %s, %s, ray %u: any hit %u, closest %u", kernel->name,
                     layout->name, intersector->name, i, any[i].prim, prim);
    }
    assert_true(decided > RAYS / 2 && hits > RAYS / 4);
}

static void compare_on_tree(const bb_scene *scene, bb_tree *tree, uint32_t leaf, bb_plan plan,
                            const bb_kernel *kernel, const bb_intersector *intersector)
{
    bb_layout_maker maker;
    bb_layout_data data = {0};
    if (leaf > 1 && getenv("BVHBENCH_TEST_SMALL") != NULL)
        return; /* slow there, and test_collapse looks at leaf collapse itself */
    check(bb_layout_maker_create(bb_layout_find(kernel->layout), device, &maker), "layout");
    maker.wish.plan = plan;
    check(bb_layout_maker_make(&maker, scene, tree, leaf_for(maker.layout, leaf),
                               bb_intersector_format(intersector), &data),
          "layout");
    compare(scene, &data, kernel, intersector);
    bb_layout_data_release(&data);
    /* what it still has is its own */
    maker.layout->destroy(maker.self);
    bb_collapse_destroy(maker.collapse);
    bb_reach_destroy(maker.reach);
    assert_int_equal(maker.account.bytes, 0);
}

static void kernels_agree_with_brute_force(void **state)
{
    (void)state;
    static const uint32_t counts[][2] = {{TRIANGLES, 0}, {0, SPHERES}, {TRIANGLES, SPHERES}};
    bool small = getenv("BVHBENCH_TEST_SMALL") != NULL;
    for (size_t c = 0; c < 3; c++) {
        bb_scene scene;
        uint32_t ran = 0;
        make_scene(&scene, counts[c][0], counts[c][1]);
        for (uint32_t b = 0; b < bb_builder_count(); b++) {
            const char *builder = whole_builder(bb_builder_at(b));
            if (small && !is_on_host(builder))
                continue; /* here the layouts and traversals are looked at, not the builders */
            bb_instance instance;
            if (!is_taken(bb_instance_create(device, builder, &scene, 1, &instance), builder, &ran))
                continue;
            check(bb_instance_build(&instance, &scene, false, NULL), "build");
            check(bb_tree_upload(&instance.tree, device, NULL), "upload");
            for (const bb_kernel *const *kernel = bb_kernels; *kernel != NULL; kernel++)
                for (uint32_t leaf = 1; leaf <= 4; leaf += 3)
                    compare_on_tree(&scene, &instance.tree, leaf, BB_PLAN_OPTIMAL, *kernel,
                                    &bb_intersectors[0]);
            bb_instance_destroy(&instance);
        }
        assert_true(ran > 0);
        release_scene(&scene);
    }
}

/* Nodes opened greedily, for every kernel that reads wide ones. */
static void kernels_agree_on_greedy_nodes(void **state)
{
    (void)state;
    bb_scene scene;
    bb_instance instance;
    uint32_t ran = 0;
    make_scene(&scene, TRIANGLES, SPHERES);
    check(bb_instance_create(device, "sah", &scene, 1, &instance), "create");
    check(bb_instance_build(&instance, &scene, false, NULL), "build");
    check(bb_tree_upload(&instance.tree, device, NULL), "upload");
    for (const bb_kernel *const *kernel = bb_kernels; *kernel != NULL; kernel++)
        for (uint32_t leaf = 1; leaf <= 8 && bb_layout_find((*kernel)->layout)->width > 2;
             leaf += 7, ran++)
            compare_on_tree(&scene, &instance.tree, leaf, BB_PLAN_GREEDY, *kernel,
                            &bb_intersectors[0]);
    assert_true(ran >= 12);
    bb_instance_destroy(&instance);
    release_scene(&scene);
}

/* Away from edges all intersectors are right: with every kernel, for triangles, spheres and
 * both. */
static void every_kernel_takes_every_intersector(void **state)
{
    (void)state;
    static const uint32_t counts[][2] = {{TRIANGLES, SPHERES}, {TRIANGLES, 0}, {0, SPHERES}};
    bool small = getenv("BVHBENCH_TEST_SMALL") != NULL;
    for (size_t c = 0; c < 3; c++) {
        bb_scene scene;
        bb_instance instance;
        make_scene(&scene, counts[c][0], counts[c][1]);
        check(bb_instance_create(device, "sah", &scene, 1, &instance), "create");
        check(bb_instance_build(&instance, &scene, false, NULL), "build");
        check(bb_tree_upload(&instance.tree, device, NULL), "upload");
        for (const bb_intersector *i = bb_intersectors; i->name != NULL; i++) {
            bool affine = bb_intersector_format(i) == BB_FORMAT_AFFINE;
            if ((c > 0 || small) && !affine)
                continue; /* the kinds matter to the form of records */
            for (const bb_kernel *const *kernel = bb_kernels; *kernel != NULL; kernel++)
                compare_on_tree(&scene, &instance.tree, small ? 1 : 4, BB_PLAN_OPTIMAL, *kernel, i);
        }
        bb_instance_destroy(&instance);
        release_scene(&scene);
    }
}

/* Groups of any size, persistent or not, rays in any order: the same hits, bit for bit. */
static void answers_depend_on_neither_groups_nor_order(void **state)
{
    (void)state;
    static const char *const ways[] = {":group=1", ":group=24", ":persistent=yes,group=1",
                                       ":persistent=yes,group=16"};
    static bb_ray rays[RAYS], reversed[RAYS];
    static bb_hit hits[RAYS], others[RAYS];
    bb_scene scene;
    bb_instance instance;
    make_scene(&scene, TRIANGLES, SPHERES);
    check(bb_instance_create(device, "sah", &scene, 1, &instance), "create");
    check(bb_instance_build(&instance, &scene, false, NULL), "build");
    check(bb_tree_upload(&instance.tree, device, NULL), "upload");
    aim_rays(&scene, rays);
    for (uint32_t i = 0; i < RAYS; i++)
        reversed[i] = rays[RAYS - 1 - i];
    for (const bb_kernel *const *kernel = bb_kernels; *kernel != NULL; kernel++) {
        bb_layout_maker maker;
        bb_layout_data data = {0};
        const bb_intersector *exact = &bb_intersectors[0];
        check(bb_layout_maker_create(bb_layout_find((*kernel)->layout), device, &maker), "layout");
        check(bb_layout_maker_make(&maker, &scene, &instance.tree, 1, BB_FORMAT_VERTICES, &data),
              "layout");
        trace(&data, *kernel, exact, &bb_query_closest, false, rays, hits);
        for (size_t w = 0; w < sizeof ways / sizeof ways[0]; w++) {
            trace_with(ways[w], &data, *kernel, exact, &bb_query_closest, w % 2 == 1, reversed,
                       others);
            for (uint32_t i = 0; i < RAYS; i++)
                if (memcmp(&hits[i], &others[RAYS - 1 - i], sizeof hits[i]) != 0)
                    fail_msg("kernel %s%s, ray %u: %u at %g, not %u at %g", (*kernel)->name,
                             ways[w], i, others[RAYS - 1 - i].prim, others[RAYS - 1 - i].t,
                             hits[i].prim, hits[i].t);
        }
        bb_layout_data_release(&data);
        bb_layout_maker_destroy(&maker);
    }
    bb_instance_destroy(&instance);
    release_scene(&scene);
}

/* ---- trees of any shape ---- */

/* A tree over the primitives [from, to): nodes with 1 to 6 children, leaves of 1 to 3 primitives;
 * preorder. */
static void add_node(bb_tree *tree, const bb_scene *scene, bb_random *random, uint32_t from,
                     uint32_t to, uint32_t depth)
{
    uint32_t n = tree->info.node_count++;
    bb_node *node = &tree->nodes[n];
    tree->info.depth = depth > tree->info.depth ? depth : tree->info.depth;
    for (int k = 0; k < 3; k++) {
        node->lo[k] = INFINITY;
        node->hi[k] = -INFINITY;
        for (uint32_t p = from; p < to; p++) {
            node->lo[k] = fminf(node->lo[k], scene->boxes[p].lo[k]);
            node->hi[k] = fmaxf(node->hi[k], scene->boxes[p].hi[k]);
        }
    }
    uint32_t size = to - from;
    if (size <= 1 + bb_random_below(random, 3) && bb_random_below(random, 4) > 0) {
        node->first = BB_LEAF_BIT | tree->info.ref_count;
        for (uint32_t p = from; p < to; p++)
            tree->refs[tree->info.ref_count++] = p | (p + 1 == to ? BB_LAST_BIT : 0);
        tree->info.leaf_count++;
    } else {
        uint32_t most = size < 6 ? size : 6, children = 1 + bb_random_below(random, most);
        tree->info.arity = children > tree->info.arity ? children : tree->info.arity;
        node->first = n + 1;
        for (uint32_t c = 0; c < children; c++)
            add_node(tree, scene, random, from + size * c / children,
                     from + size * (c + 1) / children, depth + 1);
    }
    /* in preorder the next node is the skip of all that end here; set by the caller's fix-up */
    node->skip = tree->info.node_count;
}

static void trees_of_any_arity_are_traced_rightly(void **state)
{
    (void)state;
    bool small = getenv("BVHBENCH_TEST_SMALL") != NULL;
    for (uint32_t trial = 0; trial < (small ? 3u : 12u); trial++) {
        bb_scene scene;
        bb_tree tree;
        bb_random random = bb_random_make(trial, 5);
        make_scene(&scene, TRIANGLES, trial % 2 == 0 ? SPHERES : 0);
        bb_tree_init(&tree, NULL);
        check(bb_tree_reserve(&tree, device, BB_ON_HOST, 4096, 256), "tree");
        add_node(&tree, &scene, &random, 0, scene.prim_count, 0);
        for (uint32_t n = 0; n < tree.info.node_count; n++)
            if (tree.nodes[n].skip == tree.info.node_count)
                tree.nodes[n].skip = BB_NONE;
        check(bb_tree_check(&tree, &scene), "the test's own tree");
        check(bb_tree_upload(&tree, device, NULL), "upload");
        for (const bb_kernel *const *kernel = bb_kernels; *kernel != NULL; kernel++) {
            compare_on_tree(&scene, &tree, trial % 3 == 0 ? 4 : 1, BB_PLAN_OPTIMAL, *kernel,
                            &bb_intersectors[0]);
        }
        bb_tree_release(&tree);
        release_scene(&scene);
    }
}

/* A chain: each inner node has a leaf and the rest, in this order or the other. */
static void make_chain(const bb_scene *scene, bool leaf_first, bb_tree *tree)
{
    uint32_t count = scene->prim_count;
    bb_box rest = {.lo = {INFINITY, INFINITY, INFINITY}, .hi = {-INFINITY, -INFINITY, -INFINITY}};
    check(bb_tree_reserve(tree, device, BB_ON_HOST, 2 * (size_t)count - 1, count), "tree");
    /* inner node i at 2i, its leaf at 2i + 1, what is left at 2i + 2 */
    for (uint32_t i = count; i-- > 0;) {
        bool last = i == count - 1;
        uint32_t leaf = last ? 2 * i : 2 * i + 1, next = 2 * i + 2;
        const bb_box *box = &scene->boxes[i];
        for (int k = 0; k < 3; k++) {
            rest.lo[k] = fminf(rest.lo[k], box->lo[k]);
            rest.hi[k] = fmaxf(rest.hi[k], box->hi[k]);
            tree->nodes[leaf].lo[k] = box->lo[k];
            tree->nodes[leaf].hi[k] = box->hi[k];
            tree->nodes[2 * i].lo[k] = rest.lo[k];
            tree->nodes[2 * i].hi[k] = rest.hi[k];
        }
        tree->nodes[leaf].first = BB_LEAF_BIT | i;
        tree->refs[i] = i | BB_LAST_BIT;
        if (!last)
            tree->nodes[2 * i].first = leaf_first ? leaf : next;
    }
    tree->nodes[0].skip = BB_NONE;
    for (uint32_t i = 0; i + 1 < count; i++) {
        tree->nodes[2 * i + 1].skip = leaf_first ? 2 * i + 2 : tree->nodes[2 * i].skip;
        tree->nodes[2 * i + 2].skip = leaf_first ? tree->nodes[2 * i].skip : 2 * i + 1;
    }
    tree->info = (bb_tree_info){0, 2 * count - 1, count, count, 2, count - 1};
}

static void a_tree_of_depth_200_is_traced_rightly(void **state)
{
    (void)state;
    bool small = getenv("BVHBENCH_TEST_SMALL") != NULL;
    for (uint32_t trial = 0; trial < 2; trial++) {
        bb_scene scene;
        bb_tree tree;
        make_scene(&scene, small ? 30 : 201, 0);
        bb_tree_init(&tree, NULL);
        make_chain(&scene, trial == 0, &tree);
        check(bb_tree_check(&tree, &scene), "the test's own tree");
        check(bb_tree_upload(&tree, device, NULL), "upload");
        for (const bb_kernel *const *kernel = bb_kernels; *kernel != NULL; kernel++)
            compare_on_tree(&scene, &tree, 1, BB_PLAN_OPTIMAL, *kernel, &bb_intersectors[0]);
        bb_tree_release(&tree);
        release_scene(&scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(kernels_agree_with_brute_force),
        cmocka_unit_test(kernels_agree_on_greedy_nodes),
        cmocka_unit_test(every_kernel_takes_every_intersector),
        cmocka_unit_test(answers_depend_on_neither_groups_nor_order),
        cmocka_unit_test(trees_of_any_arity_are_traced_rightly),
        cmocka_unit_test(a_tree_of_depth_200_is_traced_rightly),
    };
    return cmocka_run_group_tests(tests, open_device, close_device);
}
