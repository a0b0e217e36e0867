/* Layouts against walks over the tree on the host, on random trees whose nodes lie in random order;
 * and which kernels a tree is traced by. Small enough for oclgrind, under which this program runs
 * as well. */
#include "framework/bench/bench_private.h"
#include "tests/device_fixture.h"
#include "tests/layout_leaf.h"
#include "tests/padding_reference.h"
#include "tests/tree_fixture.h"
#include "traversal/traversal.h"

/* ---- scenes and trees ---- */

static bb_scene *make_triangles(uint32_t count, bb_random *random)
{
    float *vertices = malloc(9 * (size_t)count * sizeof *vertices);
    for (size_t i = 0; i < 9 * (size_t)count; i++)
        vertices[i] = (float)bb_random_range(random, -100, 100);
    bb_scene *scene = make_scene(vertices, count, NULL, 0);
    free(vertices);
    check(bb_scene_upload(scene, device), "upload");
    return scene;
}

static uint32_t depth_of(const bb_tree *tree, uint32_t n)
{
    uint32_t depth = 0;
    if (!bb_node_is_leaf(&tree->nodes[n]))
        for (uint32_t c = tree->nodes[n].first; c != tree->nodes[n].skip; c = tree->nodes[c].skip) {
            uint32_t below = 1 + depth_of(tree, c);
            depth = below > depth ? below : depth;
        }
    return depth;
}

/* Puts nodes of one child above `count` random nodes of the tree. */
static void add_single_children(bb_tree *tree, uint32_t count, bb_random *random)
{
    bb_tree grown;
    uint32_t nodes = tree->info.node_count;
    bb_tree_init(&grown, NULL);
    check(bb_tree_reserve(&grown, NULL, BB_ON_HOST, nodes + count, tree->info.ref_count), "tree");
    memcpy(grown.nodes, tree->nodes, nodes * sizeof *grown.nodes);
    memcpy(grown.refs, tree->refs, tree->info.ref_count * sizeof *grown.refs);
    grown.info = tree->info;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t n = bb_random_below(random, nodes), above = nodes++;
        for (uint32_t k = 0; k < above; k++) {
            if (!bb_node_is_leaf(&grown.nodes[k]) && grown.nodes[k].first == n)
                grown.nodes[k].first = above;
            if (grown.nodes[k].skip == n)
                grown.nodes[k].skip = above;
        }
        grown.nodes[above] = grown.nodes[n];
        grown.nodes[above].first = n;
        if (grown.info.root == n)
            grown.info.root = above;
    }
    grown.info.node_count = nodes;
    grown.info.arity = grown.info.arity == 0 && count > 0 ? 1 : grown.info.arity;
    grown.info.depth = depth_of(&grown, grown.info.root);
    bb_tree_release(tree);
    *tree = grown;
}

/* ---- the skip layout ---- */

/* The subtree of n, and that it lies at *at onwards in the layout, with its links. */
static void walk(const bb_tree *tree, uint32_t n, const bb_node *out, uint32_t *at)
{
    const bb_node *node = &tree->nodes[n], *here = &out[(*at)++];
    bb_box box = {.lo = {node->lo[0], node->lo[1], node->lo[2]},
                  .hi = {node->hi[0], node->hi[1], node->hi[2]}};
    box = padded_box(&box);
    assert_memory_equal(box.lo, here->lo, sizeof box.lo);
    assert_memory_equal(box.hi, here->hi, sizeof box.hi);
    if (bb_node_is_leaf(node)) {
        assert_int_equal(here->first, node->first);
    } else {
        assert_int_equal(here->first, *at);
        for (uint32_t c = node->first; c != node->skip; c = tree->nodes[c].skip)
            walk(tree, c, out, at);
    }
    assert_int_equal(here->skip, *at == tree->info.node_count ? BB_NONE : *at);
}

static void compare_records(const bb_scene *scene, const bb_tree *tree, const bb_buffer *buffer)
{
    uint32_t count = tree->info.ref_count,
             size = bb_leaf_prim_words(BB_TRIANGLES, BB_FORMAT_VERTICES);
    uint32_t *words = malloc((size_t)count * size * sizeof *words);
    check(bb_buffer_read(buffer, 0, (size_t)count * size * sizeof *words, words), "read");
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t *record = words + (size_t)i * size;
        assert_int_equal(record[9], tree->refs[i]);
        assert_memory_equal(record, scene->vertices + 9 * (size_t)(tree->refs[i] & BB_INDEX_MASK),
                            9 * sizeof(float));
    }
    free(words);
}

static void compare_skip(const bb_scene *scene, bb_tree *tree, bb_layout_maker *maker)
{
    bb_layout_data data = {0};
    uint32_t count = tree->info.node_count, at = 0;
    check(bb_tree_check(tree, scene), "the test's own tree");
    check(bb_tree_upload(tree, device, NULL), "upload");
    check(bb_layout_maker_make(maker, scene, tree, 1, BB_FORMAT_VERTICES, &data), "skip");
    assert_true(data.keeps_shape);
    assert_int_equal(data.root, 0);
    bb_node *nodes = malloc(count * sizeof *nodes);
    check(bb_buffer_read(&data.buffers[0], 0, count * sizeof *nodes, nodes), "read");
    walk(tree, tree->info.root, nodes, &at);
    assert_int_equal(at, count);
    compare_records(scene, tree, &data.buffers[1]);
    free(nodes);
    bb_layout_data_release(&data);
}

static void skip_is_the_preorder_of_any_tree(void **state)
{
    (void)state;
    static const uint32_t sizes[] = {1, 2, 3, 40, 700, 9000};
    bool small = getenv("BVHBENCH_TEST_SMALL") != NULL;
    bb_layout_maker maker;
    check(bb_layout_maker_create(bb_layout_find("skip"), device, &maker), "skip");
    for (size_t s = 0; s < sizeof sizes / sizeof sizes[0] - (small ? 2 : 0); s++)
        for (uint32_t arity = 2; arity <= 9; arity++) {
            bb_random random = bb_random_make(seed, 100 * s + arity);
            bb_scene *scene = make_triangles(sizes[s], &random);
            bb_tree tree;
            make_random_tree(scene, arity, 4, &random, &tree);
            compare_skip(scene, &tree, &maker);
            add_single_children(&tree, 1 + sizes[s] / 10, &random);
            compare_skip(scene, &tree, &maker);
            bb_tree_release(&tree);
            free_scene(scene);
        }
    bb_layout_maker_destroy(&maker);
}

/* ---- native pairings ---- */

static bool keeps_shape(const char *layout, const bb_scene *scene, bb_tree *tree, uint32_t leaf)
{
    bb_layout_maker maker;
    bb_layout_data data = {0};
    check(bb_layout_maker_create(bb_layout_find(layout), device, &maker), layout);
    check(bb_layout_maker_make(&maker, scene, tree, leaf, BB_FORMAT_VERTICES, &data), layout);
    bool keeps = data.keeps_shape;
    bb_layout_data_release(&data);
    bb_layout_maker_destroy(&maker);
    return keeps;
}

static void layouts_say_whether_they_keep_the_shape(void **state)
{
    (void)state;
    bb_random random = bb_random_make(seed, 1);
    bb_scene *scene = make_triangles(50, &random);
    bb_tree binary, wide;
    make_random_tree(scene, 2, 1, &random, &binary);
    make_random_tree(scene, 5, 1, &random, &wide);
    check(bb_tree_upload(&binary, device, NULL), "upload");
    check(bb_tree_upload(&wide, device, NULL), "upload");
    assert_true(keeps_shape("pair", scene, &binary, 1));
    assert_false(keeps_shape("pair", scene, &binary, 4));
    assert_false(keeps_shape("pair", scene, &wide, 1));
    assert_true(keeps_shape("skip", scene, &wide, 1));
    assert_false(keeps_shape("skip", scene, &wide, 4));
    add_single_children(&binary, 1, &random);
    check(bb_tree_upload(&binary, device, NULL), "upload");
    assert_false(keeps_shape("pair", scene, &binary, 1));
    assert_true(keeps_shape("skip", scene, &binary, 1));
    bb_tree_release(&binary);
    bb_tree_release(&wide);
    free_scene(scene);
}

/* A kernel that was not asked for is taken where no other one traces the tree as it was built, and
 * there only. */
static void the_native_pairing_is_never_left_out(void **state)
{
    (void)state;
    static bb_bench bench;
    static bb_resident resident;
    static bb_entrant entrant = {.resident = &resident};
    static const bb_bench_request request = {.intersector_count = 1};
    bb_intersector intersector = bb_intersectors[0];
    bench.request = &request;
    bench.intersectors = &intersector;
    bench.kernel_count = 3;
    bench.kernels[1].layouts[BB_FORMAT_VERTICES] = 1;
    bench.kernels[2].layouts[BB_FORMAT_VERTICES] = 2;
    bench.kernels[2].native_only = true;
    entrant.record.has_tree = true;
    assert_true(bb_bench_takes(&bench, &entrant, 0));
    assert_true(bb_bench_takes(&bench, &entrant, 2));
    resident.keeps_shape[1] = true;
    assert_true(bb_bench_takes(&bench, &entrant, 0));
    assert_false(bb_bench_takes(&bench, &entrant, 2));
    resident.keeps_shape[1] = false;
    resident.keeps_shape[2] = true; /* its own: once made, it is still needed */
    assert_true(bb_bench_takes(&bench, &entrant, 2));
    entrant.record.has_tree = false;
    assert_false(bb_bench_takes(&bench, &entrant, 2));
}

/* ---- forms of records ---- */

typedef struct made {
    float *records;
    size_t words;
    uint64_t bytes; /* of the whole layout */
    char name[64];
} made;

static made make_form(const bb_layout *layout, const bb_scene *scene, bb_tree *tree, uint32_t form)
{
    bb_layout_maker maker;
    bb_layout_data data = {0};
    check(bb_layout_maker_create(layout, device, &maker), layout->name);
    check(bb_layout_maker_make(&maker, scene, tree, leaf_for(layout, 4), form, &data),
          layout->name);
    assert_int_equal(data.format, form);
    assert_int_equal(data.lanes, layout->block); /* some leaves have several */
    const bb_buffer *records = &data.buffers[1];
    made made = {malloc(records->bytes), records->bytes / sizeof(float), data.bytes, ""};
    memcpy(made.name, data.name, sizeof made.name);
    check(bb_buffer_read(records, 0, records->bytes, made.records), "records");
    bb_layout_data_release(&data);
    bb_layout_maker_destroy(&maker);
    return made;
}

/* Word w of lane `lane` of record r. */
static float word(const float *records, size_t r, uint32_t words, uint32_t lanes, uint32_t lane,
                  uint32_t w)
{
    return records[r * words + (size_t)w * lanes + lane];
}

/* The map takes corner c, which the other form holds, to where it belongs. */
static void check_map(const float corner[3], const float map[12], uint32_t c)
{
    double at[3], terms = 1;
    for (int row = 0; row < 3; row++) {
        const float *m = map + 4 * row;
        at[row] = m[3];
        for (int k = 0; k < 3; k++) {
            at[row] += (double)m[k] * corner[k];
            terms += fabs((double)m[k] * corner[k]);
        }
    }
    double z = fabs(at[0]), x = fabs(at[1] - (c == 1)), y = fabs(at[2] - (c == 2));
    if (!(fmax(z, fmax(x, y)) <= 1e-5 * terms))
        fail_msg("corner %u: %g %g %g, terms of %g", c, at[1], at[2], at[0], terms);
}

/* The same primitives at the same places; spheres as they are, triangles as maps. */
static void compare_forms(const bb_layout *layout, const bb_scene *scene, bb_tree *tree)
{
    uint32_t lanes = layout->block;
    made vertices = make_form(layout, scene, tree, BB_FORMAT_VERTICES);
    made maps = make_form(layout, scene, tree, BB_FORMAT_AFFINE);
    uint32_t words[2] = {lanes == 1 ? 12 : 40, lanes == 1 ? 16 : 52};
    size_t count = vertices.words / words[0];
    assert_int_equal(count, maps.words / words[1]);
    uint32_t triangles = 0;
    for (size_t r = 0; r < count; r++)
        for (uint32_t lane = 0; lane < lanes; lane++) {
            float ids[2] = {word(vertices.records, r, words[0], lanes, lane, 9),
                            word(maps.records, r, words[1], lanes, lane, 12)};
            assert_memory_equal(&ids[0], &ids[1], sizeof ids[0]);
            uint32_t prim;
            memcpy(&prim, &ids[0], sizeof prim);
            if (prim == BB_NONE)
                continue;
            bool triangle = (prim & BB_INDEX_MASK) < scene->prims[BB_TRIANGLE].count;
            triangles += triangle;
            float map[12], corner[3];
            for (uint32_t w = 0; w < 12; w++)
                map[w] = word(maps.records, r, words[1], lanes, lane, w);
            for (uint32_t c = 0; c < 3 && triangle; c++) {
                for (uint32_t k = 0; k < 3; k++)
                    corner[k] = word(vertices.records, r, words[0], lanes, lane, 3 * c + k);
                check_map(corner, map, c);
            }
            for (uint32_t k = 0; k < 4 && !triangle; k++)
                assert_true(map[k] == word(vertices.records, r, words[0], lanes, lane, k));
        }
    assert_int_equal(triangles, scene->prims[BB_TRIANGLE].count);
    char name[64];
    snprintf(name, sizeof name, "%s:leaf=%u,triangles=affine", layout->name, leaf_for(layout, 4));
    assert_string_equal(maps.name, name);
    assert_true(maps.bytes - vertices.bytes == count * (words[1] - words[0]) * sizeof(float));
    free(vertices.records);
    free(maps.records);
}

static void every_layout_has_maps_for_vertices(void **state)
{
    (void)state;
    enum { TRIANGLES = 60, SPHERES = 20 };
    float vertices[9 * TRIANGLES], spheres[4 * SPHERES];
    bb_random random = bb_random_make(seed, 5);
    for (uint32_t i = 0; i < 9 * TRIANGLES; i++)
        vertices[i] = (float)bb_random_range(&random, -100, 100);
    for (uint32_t i = 0; i < 4 * SPHERES; i++)
        spheres[i] = (float)bb_random_range(&random, 1, 100);
    bb_scene *scene = make_scene(vertices, TRIANGLES, spheres, SPHERES);
    check(bb_scene_upload(scene, device), "upload");
    bb_tree tree;
    make_random_tree(scene, 3, 1, &random, &tree);
    check(bb_tree_upload(&tree, device, NULL), "upload");
    for (const bb_layout *const *layout = bb_layouts; *layout != NULL; layout++)
        if ((*layout)->array.name == NULL) /* which this tree has not */
            compare_forms(*layout, scene, &tree);
    bb_tree_release(&tree);
    free_scene(scene);
}

int main(void)
{
    seed = 4711;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(skip_is_the_preorder_of_any_tree),
        cmocka_unit_test(layouts_say_whether_they_keep_the_shape),
        cmocka_unit_test(the_native_pairing_is_never_left_out),
        cmocka_unit_test(every_layout_has_maps_for_vertices),
    };
    return cmocka_run_group_tests(tests, open_device, close_device);
}
