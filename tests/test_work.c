/* What kernels count, against a walk over the layout on the host: interval queries cut nothing
 * off, so that a ray's work follows from the boxes that it meets. Rays that meet a box by a hair
 * are left out. Seed: BVHBENCH_TEST_SEED. */
#include "framework/judge/queries.h"
#include "tests/cwbvh_fixture.h"
#include "traversal/pass.h"

enum { RAYS = 400, LAYERS_MAX = 40 };

typedef struct work {
    uint32_t boxes, prims;
    uint32_t entries; /* of the stack, at most; of compressed nodes alone */
    bool unsure;
} work;

/* Whether the ray meets the box, by much. */
static bool meets(const bb_ray *ray, const bb_box *box, double slack, work *w)
{
    bool met[2];
    for (int grown = 0; grown < 2; grown++) {
        double entry = ray->tmin, exit = ray->tmax, by = grown ? slack : -slack;
        for (int k = 0; k < 3; k++) {
            double a = ((double)box->lo[k] - by - ray->o[k]) / ray->d[k];
            double b = ((double)box->hi[k] + by - ray->o[k]) / ray->d[k];
            entry = fmax(entry, fmin(a, b));
            exit = fmin(exit, fmax(a, b));
        }
        met[grown] = entry <= exit;
    }
    w->unsure = w->unsure || met[0] != met[1];
    return met[1];
}

/* ---- of trees ---- */

static uint32_t width_of(const bb_tree *tree, const bb_node *node)
{
    uint32_t width = 1;
    if (bb_node_is_leaf(node))
        for (uint32_t at = node->first & BB_INDEX_MASK; (tree->refs[at] & BB_LAST_BIT) == 0; at++)
            width++;
    else
        for (uint32_t c = node->first; tree->nodes[c].skip != node->skip; c = tree->nodes[c].skip)
            width++;
    return width;
}

static void walk_tree(const bb_tree *tree, uint32_t n, const bb_ray *ray, double slack, bool ask,
                      work *w)
{
    const bb_node *node = &tree->nodes[n];
    bb_box box = {.lo = {node->lo[0], node->lo[1], node->lo[2]},
                  .hi = {node->hi[0], node->hi[1], node->hi[2]}};
    if (ask && !meets(ray, &box, slack, w))
        return;
    const uint32_t width = width_of(tree, node);
    if (bb_node_is_leaf(node)) {
        w->prims += width;
        return;
    }
    w->boxes += width;
    for (uint32_t c = node->first; c != node->skip; c = tree->nodes[c].skip)
        walk_tree(tree, c, ray, slack, true, w);
}

/* ---- of wide layouts ---- */

static void walk_wide(const wide *l, uint32_t link, const bb_ray *ray, double slack, work *w)
{
    if ((link & BB_LEAF_BIT) != 0) {
        uint32_t block = link & BB_INDEX_MASK;
        const uint32_t *prims;
        do {
            prims = l->blocks + (size_t)block++ * l->words +
                    (size_t)bb_leaf_prim_payload(l->scene->kinds, 0) * l->lanes;
            for (uint32_t lane = 0; lane < l->lanes; lane++)
                w->prims += prims[lane] != BB_NONE;
        } while ((prims[0] & BB_LAST_BIT) == 0);
        return;
    }
    uint32_t count;
    const uint32_t *links = links_of(l, link, &count);
    w->boxes += count;
    for (uint32_t c = 0; c < l->width; c++) {
        const bb_box box = box_of(l, link, c);
        if (is_place(l, link, c) && meets(ray, &box, slack, w))
            walk_wide(l, links[c], ray, slack, w);
    }
}

/* ---- of compressed nodes ---- */

static bb_box compressed_box(const bb_cwbvh *node, uint32_t place)
{
    bb_box box = {.lo = {0}};
    for (int k = 0; k < 3; k++) {
        const uint8_t *q = node->planes + 16 * k + place;
        box.lo[k] = (float)(node->origin[k] + q[0] * step_of(node, k));
        box.hi[k] = (float)(node->origin[k] + q[8] * step_of(node, k));
    }
    return box;
}

/* `entries`: on the stack. Those nodes that are met are visited in the order of the octant, and as
 * long as one is left there is an entry for it. */
static void walk_compressed(const compressed *c, uint32_t n, const bb_ray *ray, double slack,
                            uint32_t entries, work *w)
{
    const bb_cwbvh *node = &c->nodes[n];
    uint32_t met[8], count = 0, octant = 0;
    for (int k = 0; k < 3; k++)
        octant |= (ray->d[k] < 0 ? 1u : 0u) << k;
    w->entries = entries > w->entries ? entries : w->entries;
    for (uint32_t i = 0; i < 8; i++) {
        const uint32_t place = i ^ octant, child = node_at(node, place);
        const uint32_t prims = leaf_prims(node, place);
        const bb_box box = compressed_box(node, place);
        w->boxes += node->meta[place] != 0;
        if (node->meta[place] == 0 || !meets(ray, &box, slack, w))
            continue;
        w->prims += prims;
        if (child != BB_NONE)
            met[count++] = child;
    }
    for (uint32_t i = 0; i < count; i++)
        walk_compressed(c, met[i], ray, slack, entries + (i + 1 < count), w);
}

/* ---- by kernels ---- */

static void ask(const char *kernel, const bb_query *query, const bb_scene *scene, bb_tree *tree,
                const bb_ray *rays, void *results, bb_count *counts)
{
    bb_spec spec;
    const bb_kernel *found;
    uint64_t leaf;
    ASSERT_OK(bb_kernel_parse(kernel, &spec, &found));
    ASSERT_OK(bb_spec_u64(&spec, bb_kernel_common_options, "leaf", 1, BB_LEAF_MAX, &leaf));
    bb_layout_maker maker;
    bb_layout_data data = {0};
    ASSERT_OK(bb_layout_maker_create(bb_layout_find(found->layout), device, &maker));
    maker.wish = bb_kernel_wish(&spec);
    ASSERT_OK(bb_layout_maker_make(&maker, scene, tree, (uint32_t)leaf, BB_FORMAT_VERTICES, &data));
    const bb_traverser_request request = {.kernel = found,
                                          .spec = &spec,
                                          .intersector = bb_intersector_find("exact"),
                                          .query = query,
                                          .counting = true};
    bb_traverser *traverser;
    ASSERT_OK(bb_traverser_get(device, &request, &data, &traverser));
    bb_buffer d_rays, d_results, d_counts;
    make_buffer(&d_rays, rays, RAYS * sizeof *rays);
    make_buffer(&d_results, NULL, RAYS * query->result_bytes);
    make_buffer(&d_counts, NULL, RAYS * sizeof *counts);
    const bb_pass pass = {.query = query,
                          .traverser = traverser,
                          .layout = &data,
                          .rays = &d_rays,
                          .results = &d_results,
                          .counts = &d_counts};
    ASSERT_OK(bb_pass_run(&pass, RAYS, results, counts));
    bb_buffer_release(&d_rays);
    bb_buffer_release(&d_results);
    bb_buffer_release(&d_counts);
    bb_layout_data_release(&data);
    bb_layout_maker_destroy(&maker);
}

/* `name`: of the wide layout, with leaves of up to `leaf`; NULL: the tree itself. */
static void expect_work(const char *kernel, const char *name, uint32_t leaf, const bb_scene *scene,
                        bb_tree *tree, const bb_ray *rays)
{
    const double slack = 1e-3;
    static bb_count counts[RAYS];
    static bb_interval results[RAYS];
    const bool octants = strstr(kernel, "order=octant") != NULL,
               asks_root = strncmp(kernel, "stackless", 9) == 0;
    const bb_layout_wish wish = {.octants = octants,
                                 .plan = strstr(kernel, "plan=greedy") != NULL   ? BB_PLAN_GREEDY
                                         : strstr(kernel, "plan=native") != NULL ? BB_PLAN_NATIVE
                                                                                 : BB_PLAN_OPTIMAL};
    ask(kernel, bb_query_find("interval"), scene, tree, rays, results, counts);
    wide w = {0};
    uint32_t root = 0, sure = 0;
    if (name != NULL)
        w = read_wide(name, scene, tree, leaf, &wish, &root);
    for (uint32_t i = 0; i < RAYS; i++) {
        work expected = {.boxes = asks_root ? 1 : 0};
        if (name != NULL)
            walk_wide(&w, root, &rays[i], slack, &expected);
        else
            walk_tree(tree, tree->info.root, &rays[i], slack, asks_root, &expected);
        if (expected.unsure)
            continue;
        sure++;
        assert_int_equal(counts[i].overflow, 0);
        if (counts[i].nodes != expected.boxes || counts[i].prims != expected.prims)
            fail_msg("%s, ray %u: %u boxes and %u primitives, by the layout %u and %u", kernel, i,
                     counts[i].nodes, counts[i].prims, expected.boxes, expected.prims);
    }
    assert_true(sure > RAYS / 3);
    if (name != NULL)
        free_wide(&w);
}

static bb_scene *make_triangles(uint32_t count, bb_random *random)
{
    float *v = malloc(9 * (size_t)count * sizeof *v);
    for (uint32_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) {
            const float at = (float)bb_random_range(random, -100, 100);
            for (int c = 0; c < 3; c++)
                v[9 * i + 3 * c + k] = at + (float)bb_random_range(random, -10, 10);
        }
    bb_scene *scene = make_scene(v, count, NULL, 0);
    free(v);
    ASSERT_OK(bb_scene_upload(scene, device));
    return scene;
}

static void aim(bb_ray rays[RAYS], bb_random *random)
{
    for (uint32_t i = 0; i < RAYS; i++) {
        rays[i] =
            (bb_ray){.tmin = i % 5 == 0 ? 40.0f : 0.0f, .tmax = i % 3 == 0 ? 90.0f : INFINITY};
        for (int k = 0; k < 3; k++) {
            rays[i].o[k] = (float)bb_random_range(random, -150, 150);
            rays[i].d[k] = (float)bb_random_range(random, -1, 1);
        }
    }
}

static void work_is_what_the_layout_asks_for(void **state)
{
    (void)state;
    static const struct {
        const char *kernel, *layout;
        uint32_t leaf;
    } wides[] = {
        {"stack4", "wide4", 1},
        {"stack4:leaf=3,plan=greedy", "wide4", 3},
        {"stack8", "wide8", 1},
        {"stack8:leaf=8,order=octant", "wide8", 8},
        {"stack8i", "wide8", 1},
        {"stack8i:leaf=8,group=37,rays=8", "wide8", 8},
        {"stack8q:leaf=4", "quant8", 4},
        {"stack8i:leaf=8,order=octant", "wide8", 8},
        {"stack8:plan=native", "wide8", 1},
        {"stack8q:leaf=4,plan=native", "quant8", 4},
    };
    static bb_ray rays[RAYS];
    for (uint32_t run = 0; run < 6; run++) {
        bb_random random = bb_random_make(seed, run);
        bb_scene *scene = make_triangles(1 + bb_random_below(&random, run == 0 ? 3 : 200), &random);
        bb_tree tree;
        const uint32_t arity = run % 2 == 0 ? 2 : 2 + bb_random_below(&random, 8);
        make_random_tree(scene, arity, 1 + bb_random_below(&random, 5), &random, &tree);
        ASSERT_OK(bb_tree_upload(&tree, device, NULL));
        aim(rays, &random);
        if (arity == 2)
            expect_work("stack", NULL, 1, scene, &tree, rays);
        expect_work("stackless", NULL, 1, scene, &tree, rays);
        for (size_t i = 0; i < sizeof wides / sizeof wides[0]; i++)
            if (tree.info.arity <= 8 || strstr(wides[i].kernel, "plan=native") == NULL)
                expect_work(wides[i].kernel, wides[i].layout, wides[i].leaf, scene, &tree, rays);
        bb_tree_release(&tree);
        free_scene(scene);
    }
}

/* What kernels count with compressed nodes, and that a stack of four entries is enough for those
 * rays that a walk says it is enough for, and for no others. */
static void compressed_nodes_take_what_a_walk_takes(void **state)
{
    (void)state;
    enum { TRIANGLES = 3000 };
    const double slack = 1e-3;
    static bb_ray rays[RAYS];
    static bb_count counts[RAYS];
    static bb_interval results[RAYS];
    bb_tree tree;
    bb_random random = bb_random_make(seed, 78);
    bb_scene *scene = make_triangles(TRIANGLES, &random);
    make_random_tree(scene, 2, 5, &random, &tree);
    ASSERT_OK(bb_tree_upload(&tree, device, NULL));
    aim(rays, &random);
    for (uint32_t leaf = 1; leaf <= 3; leaf += 2) {
        char kernel[32];
        uint32_t sure = 0, overflows = 0;
        compressed c = read_compressed(scene, &tree, leaf, false);
        snprintf(kernel, sizeof kernel, "cwbvh:leaf=%u,stack=4", leaf);
        ask(kernel, bb_query_find("interval"), scene, &tree, rays, results, counts);
        for (uint32_t i = 0; i < RAYS; i++) {
            work expected = {0};
            walk_compressed(&c, c.root, &rays[i], slack, 0, &expected);
            if (expected.unsure)
                continue;
            const bool fits = expected.entries <= 4;
            sure++;
            overflows += !fits;
            if (counts[i].overflow != (fits ? 0u : 1u) ||
                (fits && (counts[i].nodes != expected.boxes || counts[i].prims != expected.prims)))
                fail_msg("%s, ray %u: %u boxes, %u primitives, %s; by the layout %u, %u and %u "
                         "entries",
                         kernel, i, counts[i].nodes, counts[i].prims,
                         counts[i].overflow != 0 ? "an overflow" : "no overflow", expected.boxes,
                         expected.prims, expected.entries);
        }
        print_message("%s: %u rays, %u overflows, need %u\n", kernel, sure, overflows,
                      c.stack_need);
        assert_true(overflows > 10 && sure - overflows > 10);
        free_compressed(&c);
    }
    bb_tree_release(&tree);
    free_scene(scene);
}

/* Copies of one triangle: what a closest hit asks all of, an any hit has in the first block of
 * primitives, and a packet in the first leaf. */
static void any_hit_ends_the_search(void **state)
{
    (void)state;
    enum { COPIES = 100, LEAF = 8 };
    static const char *const kernels[] = {
        "stack",           "stackless",     "trail",          "short8",
        "stack4",          "stack8:leaf=8", "stack8q",        "stack8i",
        "stack8i:leaf=64", "cwbvh:leaf=3",  "packet8:leaf=8",
    };
    static bb_ray rays[RAYS];
    static bb_hit hits[RAYS];
    static bb_count counts[RAYS];
    float v[9 * COPIES];
    bb_tree tree;
    bb_random random = bb_random_make(seed, 77);
    for (uint32_t i = 0; i < 9 * COPIES; i++)
        v[i] = (const float[9]){-1, -1, 1, 3, -1, 2, -1, 3, 3}[i % 9];
    bb_scene *scene = make_scene(v, COPIES, NULL, 0);
    ASSERT_OK(bb_scene_upload(scene, device));
    make_random_tree(scene, 2, 1, &random, &tree);
    ASSERT_OK(bb_tree_upload(&tree, device, NULL));
    for (uint32_t i = 0; i < RAYS; i++)
        rays[i] = (bb_ray){.d = {0, 0, 1}, .tmax = INFINITY};
    for (size_t k = 0; k < sizeof kernels / sizeof kernels[0]; k++) {
        ask(kernels[k], &bb_query_closest, scene, &tree, rays, hits, counts);
        for (uint32_t i = 0; i < RAYS; i++)
            if (hits[i].prim != 0 || counts[i].prims != COPIES)
                fail_msg("%s, ray %u: %u of %u tests", kernels[k], i, counts[i].prims, COPIES);
        ask(kernels[k], &bb_query_any, scene, &tree, rays, hits, counts);
        const uint32_t most = strncmp(kernels[k], "packet", 6) == 0 ? LEAF : BB_BLOCK_LANES;
        for (uint32_t i = 0; i < RAYS; i++)
            if (hits[i].prim >= COPIES || counts[i].prims > most)
                fail_msg("%s, ray %u, any hit: %u tests", kernels[k], i, counts[i].prims);
    }
    bb_tree_release(&tree);
    free_scene(scene);
}

/* ---- stacks ---- */

/* Triangles at z = 2^-i, as large, triangle i and all behind it: a chain, of which a ray towards +z
 * from beside triangle k pushes all k before it comes to the nearest. */
static void make_chain(uint32_t layers, bb_scene **scene, bb_tree *tree)
{
    float v[9 * LAYERS_MAX];
    bb_node nodes[2 * LAYERS_MAX];
    uint32_t refs[LAYERS_MAX];
    const float least = ldexpf(1, 1 - (int)layers);
    for (uint32_t i = 0; i < layers; i++) {
        const float z = ldexpf(1, -(int)i);
        const float corners[9] = {-z, -z, z, 3 * z, -z, z, -z, 3 * z, z};
        const uint32_t leaf = i + 1 < layers ? 2 * i + 1 : 2 * i;
        memcpy(v + 9 * (size_t)i, corners, sizeof corners);
        nodes[2 * i] = make_node(V(-z, -z, least), V(3 * z, 3 * z, z), 2 * i + 1, BB_NONE);
        nodes[leaf] = make_node(V(-z, -z, z), V(3 * z, 3 * z, z), BB_LEAF_BIT | i,
                                i + 1 < layers ? 2 * i + 2 : BB_NONE);
        refs[i] = i | BB_LAST_BIT;
    }
    *scene = make_scene(v, layers, NULL, 0);
    ASSERT_OK(bb_scene_upload(*scene, device));
    make_tree(tree, nodes, 2 * layers - 1, refs, layers, 2, layers - 1);
    ASSERT_OK(bb_tree_check(tree, *scene));
    ASSERT_OK(bb_tree_upload(tree, device, NULL));
}

/* Ray i needs as many entries as there are triangles before the one that it starts beside. With a
 * second stack it has up to twice as many. */
static void expect_overflow(const char *kernel, uint32_t stacks, uint32_t size, uint32_t layers)
{
    bb_scene *scene;
    bb_tree tree;
    bb_ray rays[RAYS];
    bb_count counts[RAYS];
    bb_hit hits[RAYS];
    char text[96];
    snprintf(text, sizeof text, "%s,stack=%u", kernel, size);
    make_chain(layers, &scene, &tree);
    for (uint32_t i = 0; i < RAYS; i++) {
        const uint32_t nearest = i * 7 % layers;
        rays[i] = (bb_ray){.d = {0, 0, 1}, .tmax = INFINITY};
        rays[i].o[2] = ldexpf(0.75f, -(int)nearest);
    }
    ask(text, &bb_query_closest, scene, &tree, rays, hits, counts);
    for (uint32_t i = 0; i < RAYS; i++) {
        const uint32_t nearest = i * 7 % layers;
        const bool fits = counts[i].overflow == 0;
        if ((nearest <= size && !fits) || (nearest > stacks * size && fits) ||
            hits[i].prim != (fits ? nearest : BB_POISON))
            fail_msg("%s, %u triangles, ray %u: primitive %u, %s", text, layers, i, hits[i].prim,
                     counts[i].overflow != 0 ? "an overflow" : "no overflow");
    }
    bb_tree_release(&tree);
    free_scene(scene);
}

/* Neither sooner than said, nor later: then what is beyond the stack is overwritten. */
static void a_stack_has_the_entries_that_it_says(void **state)
{
    (void)state;
    static const struct {
        const char *kernel;
        uint32_t stacks; /* a packet's, and that of a ray which goes on alone */
    } kernels[] = {
        {"stack:leaf=1", 1},
        {"stack4:leaf=1", 1},
        {"stack8:leaf=1", 1},
        {"stack8q:leaf=1", 1},
        {"stack8i:leaf=1,group=64", 1},
        {"stack8i:rays=1,group=9", 1},
        {"packet:group=1,few=0", 2},
        {"packet8:group=1,few=0,rays=16", 2},
    };
    for (size_t k = 0; k < sizeof kernels / sizeof kernels[0]; k++)
        for (uint32_t size = 4; size <= 16; size *= 2)
            for (uint32_t i = 0; i <= 4; i++) {
                const uint32_t stacks = kernels[k].stacks;
                expect_overflow(kernels[k].kernel, stacks, size, stacks * size + i);
                expect_overflow(kernels[k].kernel, stacks, size, size + i);
            }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_hit_ends_the_search),
        cmocka_unit_test(a_stack_has_the_entries_that_it_says),
        cmocka_unit_test(work_is_what_the_layout_asks_for),
        cmocka_unit_test(compressed_nodes_take_what_a_walk_takes),
    };
    return cmocka_run_group_tests(tests, open_device, close_device);
}
