/* Leaf collapse and the wide layouts, read back and taken apart on the host: random trees of any
 * arity, floats biased to extremes. */
#include "tests/padding_reference.h"
#include "tests/tree_fixture.h"

#include "tests/device_forms.h"

#include "traversal/collapse.h"
#include "traversal/traversal.h"

static const uint64_t SEED = 20240701;
static bb_device *device;

static bool small(void)
{
    return getenv("BVHBENCH_TEST_SMALL") != NULL; /* under oclgrind */
}

/* ---- leaf collapse ---- */

/* Collapses a copy on the device; `out` ends up on the host as well. */
static void collapse(bb_collapse *collapse, bb_tree *tree, uint32_t leaf, uint32_t width,
                     uint32_t block, bb_tree **out)
{
    ASSERT_OK(bb_tree_upload(tree, device, NULL));
    ASSERT_OK(bb_collapse_make(collapse, tree, 1.0f, leaf,
                               bb_collapse_traversal(bb_collapse_node_cost(width), width), block,
                               out));
    ASSERT_OK(bb_tree_download(*out, NULL));
}

static void collapsed_trees_are_valid_and_cost_no_more(void **state)
{
    (void)state;
    bb_account account = {0};
    bb_collapse *self;
    ASSERT_OK(bb_collapse_create(device, &account, &self));
    for (uint32_t run = 0; run < (small() ? 5u : 100u); run++) {
        bb_random random = bb_random_make(SEED, run);
        bb_scene *scene =
            make_random_scene(1 + bb_random_below(&random, small() ? 40 : 400), &random);
        bb_tree tree, *out;
        make_random_tree(scene, 2 + bb_random_below(&random, 7), 1, &random, &tree);
        double before = bb_tree_sah(&tree);
        for (uint32_t leaf = 1; leaf <= BB_LEAF_MAX; leaf *= 2)
            for (uint32_t block = 1; block <= 4; block += 3) {
                collapse(self, &tree, leaf, block == 1 ? 2 : 8, block, &out);
                if (bb_tree_check(out, scene) != BB_OK)
                    fail_msg("seed %llu run %u leaf %u block %u: %s", (unsigned long long)SEED, run,
                             leaf, block, bb_message());
                double after = bb_tree_sah(out);
                if ((block == 1 && !(after <= before * (1 + 1e-5))) ||
                    (leaf == 1 && fabs(after - before) > 1e-9))
                    fail_msg("seed %llu run %u leaf %u: SAH %g became %g", (unsigned long long)SEED,
                             run, leaf, before, after);
                for (uint32_t i = 0, width = 1; i < out->info.ref_count; i++, width++) {
                    assert_true(width <= leaf);
                    width = out->refs[i] & BB_LAST_BIT ? 0 : width;
                }
            }
        bb_tree_release(&tree);
        free_scene(scene);
    }
    bb_collapse_destroy(self);
    assert_int_equal(account.bytes, 0);
}

/* Two leaves of equal boxes: a leaf of both costs 2 A, or A as a block, the inner node 1.2 A + 2 A.
 * Far apart, the inner node is kept. */
static void collapse_decides_by_cost(void **state)
{
    (void)state;
    const float lo[3] = {0, 0, 0}, hi[3] = {1, 1, 1}, far_lo[3] = {100, 0, 0},
                far_hi[3] = {101, 1, 1};
    const uint32_t refs[] = {0 | BB_LAST_BIT, 1 | BB_LAST_BIT};
    const bb_node near[] = {make_node(lo, hi, 1, BB_NONE), make_node(lo, hi, BB_LEAF_BIT | 0, 2),
                            make_node(lo, hi, BB_LEAF_BIT | 1, BB_NONE)};
    const bb_node far[] = {make_node(lo, far_hi, 1, BB_NONE), near[1],
                           make_node(far_lo, far_hi, BB_LEAF_BIT | 1, BB_NONE)};
    bb_collapse *self;
    bb_tree tree, *out;
    ASSERT_OK(bb_collapse_create(device, NULL, &self));
    make_tree(&tree, near, 3, refs, 2, 2, 1);
    collapse(self, &tree, 1, 2, 1, &out);
    assert_int_equal(out->info.node_count, 3);
    collapse(self, &tree, 2, 2, 1, &out);
    assert_int_equal(out->info.node_count, 1);
    assert_int_equal(out->info.leaf_count, 1);
    assert_int_equal(out->info.ref_count, 2);
    assert_int_equal(out->info.arity, 0);
    assert_int_equal(out->info.depth, 0);
    bb_tree_release(&tree);

    make_tree(&tree, far, 3, refs, 2, 2, 1);
    collapse(self, &tree, 2, 2, 1, &out); /* 2 * 203 against 1.2 * 203 + 2 * 3 */
    assert_int_equal(out->info.node_count, 3);
    assert_int_equal(out->info.arity, 2);
    assert_int_equal(out->info.depth, 1);
    collapse(self, &tree, 2, 8, 4, &out); /* one block, 203, against 1.2 * 4 / 7 * 203 + 2 * 3 */
    assert_int_equal(out->info.node_count, 3);
    collapse(self, &tree, 2, 2, 4, &out); /* 203 against 1.2 * 203 + 2 * 3 */
    assert_int_equal(out->info.node_count, 1);
    /* the same where a node of 8 costs as much as 40 blocks: 40 / 7 * 203 + 2 * 3 */
    ASSERT_OK(bb_collapse_make(self, &tree, 1.0f, 2, bb_collapse_traversal(40, 8), 4, &out));
    assert_int_equal(out->info.node_count, 1);
    bb_tree_release(&tree);

    /* Whichever the axis on which all is flat, and of whose faces nothing is seen: 2 * 101 against
     * 1.2 * 101 + 2. */
    for (uint32_t flat = 0; flat < 3; flat++) {
        float sizes[3] = {1, 1, 1}, from[3] = {0, 0, 0}, to[3];
        uint32_t along = (flat + 1) % 3;
        sizes[flat] = 0;
        memcpy(to, sizes, sizeof sizes);
        from[along] = 100;
        to[along] = 101;
        const bb_node row[] = {make_node(lo, to, 1, BB_NONE),
                               make_node(lo, sizes, BB_LEAF_BIT | 0, 2),
                               make_node(from, to, BB_LEAF_BIT | 1, BB_NONE)};
        make_tree(&tree, row, 3, refs, 2, 2, 1);
        collapse(self, &tree, 2, 2, 1, &out);
        assert_int_equal(out->info.node_count, 3);
        bb_tree_release(&tree);
    }

    /* A primitive that both leaves reference is referenced once by the leaf of both. */
    make_tree(&tree, near, 3, refs, 2, 2, 1);
    tree.duplicated = true;
    tree.refs[1] = 0 | BB_LAST_BIT;
    collapse(self, &tree, 2, 2, 1, &out);
    assert_int_equal(out->info.ref_count, 1);
    bb_tree_release(&tree);
    bb_collapse_destroy(self);
}

/* ---- wide layouts ---- */

typedef struct wide {
    const bb_scene *scene;
    uint32_t width;
    bool quantised, octants;
    uint8_t *nodes;
    uint32_t *blocks;
    uint32_t words, lanes; /* of a block */
    uint32_t *seen;        /* per primitive */
    uint32_t stack_need, said_need;
} wide;

static const uint32_t *links_of(const wide *w, uint32_t node, uint32_t *count)
{
    if (w->quantised) {
        const bb_quant8 *n = (const bb_quant8 *)w->nodes + node;
        *count = n->count;
        return n->links;
    }
    if (w->width == 4) {
        const bb_wide4 *n = (const bb_wide4 *)w->nodes + node;
        *count = n->count;
        return n->links;
    }
    const bb_wide8 *n = (const bb_wide8 *)w->nodes + node;
    *count = n->count;
    return n->links;
}

static bool is_place(const wide *w, uint32_t node, uint32_t child)
{
    if (w->quantised)
        return (((const bb_quant8 *)w->nodes + node)->places >> child & 1u) != 0;
    const float *planes = w->width == 4 ? ((const bb_wide4 *)w->nodes + node)->planes
                                        : ((const bb_wide8 *)w->nodes + node)->planes;
    return isfinite(planes[child]);
}

static bb_box box_of(const wide *w, uint32_t node, uint32_t child)
{
    bb_box box = {.lo = {0}};
    for (uint32_t axis = 0; axis < 3; axis++) {
        uint32_t lo = 2 * axis * w->width + child, hi = lo + w->width;
        if (w->quantised) {
            const bb_quant8 *n = (const bb_quant8 *)w->nodes + node;
            box.lo[axis] = fmaf(n->planes[lo], n->scale[axis], n->base[axis]);
            box.hi[axis] = fmaf(n->planes[hi], n->scale[axis], n->base[axis]);
        } else {
            const float *planes = w->width == 4 ? ((const bb_wide4 *)w->nodes + node)->planes
                                                : ((const bb_wide8 *)w->nodes + node)->planes;
            box.lo[axis] = planes[lo];
            box.hi[axis] = planes[hi];
        }
    }
    return box;
}

static void join(bb_box *box, const bb_box *other)
{
    for (int k = 0; k < 3; k++) {
        box->lo[k] = fminf(box->lo[k], other->lo[k]);
        box->hi[k] = fmaxf(box->hi[k], other->hi[k]);
    }
}

/* Box of the primitives in the leaf, which are marked as seen; false if it has none. */
static bool read_leaf(wide *w, uint32_t block, bb_box *box)
{
    bool any = false, last = false;
    for (; !last; block++) {
        const uint32_t *words = w->blocks + (size_t)block * w->words;
        const uint32_t *prims = words + bb_leaf_prim_payload(w->scene->kinds, 0) * w->lanes;
        last = (prims[0] & BB_LAST_BIT) != 0;
        for (uint32_t lane = 0; lane < w->lanes; lane++) {
            if (prims[lane] == BB_NONE) {
                assert_true(lane == 0 || prims[w->lanes - 1] == BB_NONE);
                continue;
            }
            uint32_t prim = lane == 0 ? prims[0] & BB_INDEX_MASK : prims[lane];
            assert_true(prim < w->scene->prim_count);
            assert_int_equal(prim < w->scene->prims[BB_TRIANGLE].count,
                             (prims[0] & BB_INDEX_MASK) < w->scene->prims[BB_TRIANGLE].count);
            bool triangle = prim < w->scene->prims[BB_TRIANGLE].count;
            const float *from = triangle
                                    ? w->scene->vertices + 9 * (size_t)prim
                                    : bb_scene_floats(w->scene, BB_SPHERE) +
                                          4 * (size_t)(prim - w->scene->prims[BB_TRIANGLE].count);
            for (uint32_t k = 0; k < (triangle ? 9u : 4u); k++)
                assert_memory_equal(&words[k * w->lanes + lane], &from[k], sizeof *from);
            w->seen[prim]++;
            join(box, &w->scene->boxes[prim]);
            any = true;
        }
    }
    return any;
}

/* How well a box fits a place, whose bit a says that it shall lie high on axis a. */
static float fit_of(const bb_box *box, uint32_t place)
{
    float fit = 0;
    for (uint32_t axis = 0; axis < 3; axis++) {
        float middle = 0.5f * box->lo[axis] + 0.5f * box->hi[axis];
        fit += (place >> axis & 1u) != 0 ? middle : -middle;
    }
    return fit;
}

/* Without octants children take the first places. With them, the pair of child and place that fits
 * best comes first: a place that a child fits better than its own has one that fits it as well. */
static void check_places(const wide *w, uint32_t node, uint32_t count)
{
    for (uint32_t c = 0; c < w->width; c++) {
        if (!w->octants)
            assert_int_equal(is_place(w, node, c), c < count);
        if (!w->octants || !is_place(w, node, c))
            continue;
        const bb_box box = box_of(w, node, c);
        for (uint32_t place = 0; place < w->width; place++) {
            const bb_box there = box_of(w, node, place);
            if (fit_of(&box, place) > fit_of(&box, c) &&
                !(is_place(w, node, place) && fit_of(&there, place) >= fit_of(&box, place)))
                fail_msg("node %u: child %u fits place %u better", node, c, place);
        }
    }
}

/* Box of the primitives below `link`. Recursion: trees of the tests are shallow. */
static bool read_link(wide *w, uint32_t link, uint32_t above, bb_box *box)
{
    if ((link & BB_LEAF_BIT) != 0)
        return read_leaf(w, link & BB_INDEX_MASK, box);
    uint32_t count, children = 0;
    const uint32_t *links = links_of(w, link, &count);
    uint32_t need = above + count - 1;
    w->stack_need = need > w->stack_need ? need : w->stack_need;
    for (uint32_t c = 0; c < w->width; c++) {
        bb_box below = {.lo = {INFINITY, INFINITY, INFINITY},
                        .hi = {-INFINITY, -INFINITY, -INFINITY}};
        bb_box said = box_of(w, link, c);
        if (!read_link(w, links[c], need, &below)) {
            for (int k = 0; k < 3; k++) /* boxes of flat nodes can't be empty: a bit says it */
                assert_true(w->quantised || said.lo[k] > said.hi[k]);
            assert_false(is_place(w, link, c));
            continue;
        }
        assert_true(is_place(w, link, c));
        children++;
        bb_box padded = padded_box(&below);
        for (int k = 0; k < 3; k++) {
            bool right = w->quantised ? said.lo[k] <= padded.lo[k] && said.hi[k] >= padded.hi[k]
                                      : said.lo[k] == padded.lo[k] && said.hi[k] == padded.hi[k];
            if (!right)
                fail_msg("node %u child %u axis %d: %a to %a, its primitives, padded, %a to %a",
                         link, c, k, said.lo[k], said.hi[k], padded.lo[k], padded.hi[k]);
        }
        join(box, &below);
    }
    assert_int_equal(children, count);
    assert_true(count >= 2);
    if (w->width == 8 && !w->quantised) /* whose planes are those that places were given by */
        check_places(w, link, count);
    return true;
}

static void *download(const bb_buffer *buffer)
{
    void *copy = malloc(buffer->bytes);
    ASSERT_OK(bb_buffer_read(buffer, 0, buffer->bytes, copy));
    return copy;
}

/* A layout as the host sees it; *root: its link. */
static wide read_wide(const char *name, const bb_scene *scene, bb_tree *tree, uint32_t leaf,
                      const bb_layout_wish *wish, uint32_t *root)
{
    bb_layout_maker maker;
    bb_layout_data data = {0};
    ASSERT_OK(bb_layout_maker_create(bb_layout_find(name), device, &maker));
    maker.wish = *wish;
    ASSERT_OK(bb_layout_maker_make(&maker, scene, tree, leaf, BB_FORMAT_VERTICES, &data));
    wide w = {
        .scene = scene,
        .width = strcmp(name, "wide4") == 0 ? 4 : 8,
        .quantised = strcmp(name, "quant8") == 0,
        .octants = wish->octants,
        .nodes = download(&data.buffers[0]),
        .blocks = download(&data.buffers[1]),
        .words = data.lanes == 1 ? bb_leaf_prim_words(scene->kinds, BB_FORMAT_VERTICES)
                                 : bb_block_words(scene->kinds, BB_FORMAT_VERTICES),
        .lanes = data.lanes,
        .seen = calloc(scene->prim_count, sizeof *w.seen),
        .said_need = data.stack_need,
    };
    *root = data.root;
    assert_int_equal(strstr(data.name, "plan=greedy") != NULL, wish->greedy);
    bb_layout_data_release(&data);
    bb_layout_maker_destroy(&maker);
    return w;
}

static void free_wide(wide *w)
{
    free(w->nodes);
    free(w->blocks);
    free(w->seen);
}

static void take_apart(const char *name, const bb_scene *scene, bb_tree *tree, uint32_t leaf,
                       bool octants, bool greedy)
{
    const bb_layout_wish wish = {.octants = octants, .greedy = greedy};
    uint32_t root;
    wide w = read_wide(name, scene, tree, leaf, &wish, &root);
    /* records of one lane where no leaf needs more */
    assert_int_equal(
        w.lanes, leaf == 1 && tree->info.leaf_count == tree->info.ref_count ? 1 : BB_BLOCK_LANES);
    bb_box box = {.lo = {INFINITY, INFINITY, INFINITY}, .hi = {-INFINITY, -INFINITY, -INFINITY}};
    assert_true(read_link(&w, root, 0, &box));
    assert_int_equal(w.stack_need, w.said_need);
    for (uint32_t i = 0; i < scene->prim_count; i++)
        assert_int_equal(w.seen[i], 1);
    free_wide(&w);
}

/* A coordinate of any size that layouts have, near others of its kind or not. */
static float extreme(bb_random *random, uint32_t kind)
{
    static const float pool[] = {0.0f,  -0.0f,    1e-45f, -3e-42f, 1.2e-38f, 1e-30f, 1e-3f, 1.0f,
                                 -1.0f, 16777216, -1e7f,  1e12f,   -1e15f,   1e17f,  -2e17f};
    float sign = bb_random_below(random, 2) ? 1.0f : -1.0f;
    switch (kind) {
    case 0:
        return (float)bb_random_range(random, -100, 100);
    case 1:
        return pool[bb_random_below(random, sizeof pool / sizeof pool[0])];
    case 2: /* far away */
        return 1e7f + (float)bb_random_below(random, 64);
    case 3: /* any exponent */
        return sign * ldexpf(1.0f + (float)bb_random_unit(random) * 0.999f,
                             (int)bb_random_below(random, 207) - 149);
    default: /* denormal */
        return sign * ldexpf((float)bb_random_below(random, 1000), -149);
    }
}

static void free_uploaded(bb_scene *scene)
{
    bb_scene_device *geometry = &scene->on_device;
    bb_buffer_release(&geometry->boxes);
    bb_buffer_release(&geometry->vertices);
    bb_buffer_release(&geometry->prims);
    free_scene(scene);
}

static void wide_layouts_hold_the_tree(void **state)
{
    (void)state;
    static const char *const names[] = {"wide4", "wide8", "quant8"};
    for (uint32_t run = 0; run < (small() ? 10u : 200u); run++) {
        bb_random random = bb_random_make(SEED + 1, run);
        uint32_t triangles = bb_random_below(&random, small() ? 30 : 300);
        uint32_t spheres = run % 3 == 0 ? bb_random_below(&random, 50) : 0;
        if (run % 6 == 0)
            triangles = 0;
        if (triangles + spheres == 0)
            triangles = 1;
        float *v = malloc((9 * (size_t)triangles + 4 * (size_t)spheres) * sizeof *v);
        for (uint32_t i = 0; i < 9 * triangles; i++)
            v[i] = extreme(&random, run % 5);
        for (uint32_t i = 0; i < 4 * spheres; i++)
            v[9 * triangles + i] = fabsf(extreme(&random, 0));
        bb_scene *scene = make_scene(v, triangles, v + 9 * (size_t)triangles, spheres);
        free(v);
        ASSERT_OK(bb_scene_upload(scene, device));
        bb_tree tree;
        make_random_tree(scene, 2 + bb_random_below(&random, 12), 1 + bb_random_below(&random, 9),
                         &random, &tree);
        ASSERT_OK(bb_tree_upload(&tree, device, NULL));
        for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
            for (uint32_t leaf = 1; leaf <= 8; leaf += 7)
                take_apart(names[i], scene, &tree, leaf, run % 2 == 0, run / 2 % 2 == 0);
        bb_tree_release(&tree);
        free_uploaded(scene);
    }
}

/* A chain down the first children, each with two leaves beside it: from level to level a node's
 * work-item has seven more pairs to open later on than there is room for. Pair i is at x = i; the
 * chain's nodes are 0 .. PAIRS - 2, then come three nodes of each pair. */
static void make_comb(const bb_scene *scene, uint32_t pairs, bb_tree *tree)
{
    const uint32_t chain = pairs - 1, count = chain + 3 * pairs;
    bb_node *nodes = malloc(count * sizeof *nodes);
    uint32_t *refs = malloc(2 * pairs * sizeof *refs);
    bb_box below = {.lo = {INFINITY, INFINITY, INFINITY}, .hi = {-INFINITY, -INFINITY, -INFINITY}};
    for (uint32_t i = pairs; i-- > 0;) {
        const uint32_t up = i < chain ? i : i - 1, pair = chain + 3 * i;
        /* of the chain's node: the pair of the one above */
        const uint32_t skip = up == 0 ? BB_NONE : chain + 3 * (up - 1);
        const bb_box *boxes = &scene->boxes[2 * i];
        bb_box both = boxes[0];
        join(&both, &boxes[1]);
        join(&below, &both);
        for (uint32_t k = 0; k < 2; k++)
            refs[2 * i + k] = (2 * i + k) | BB_LAST_BIT;
        const uint32_t after =
            i < chain ? skip : chain + 3 * up; /* the last pair is a first child */
        nodes[pair] = make_node(both.lo, both.hi, pair + 1, after);
        nodes[pair + 1] = make_node(boxes[0].lo, boxes[0].hi, BB_LEAF_BIT | 2 * i, pair + 2);
        nodes[pair + 2] = make_node(boxes[1].lo, boxes[1].hi, BB_LEAF_BIT | (2 * i + 1), after);
        if (i < chain)
            nodes[i] =
                make_node(below.lo, below.hi, i + 1 < chain ? i + 1 : chain + 3 * chain, skip);
    }
    make_tree(tree, nodes, count, refs, 2 * pairs, 2, pairs);
    free(nodes);
    free(refs);
}

static void pairs_wait_where_there_is_no_room(void **state)
{
    (void)state;
    enum { PAIRS = 200 };
    float *v = calloc(18 * PAIRS, sizeof *v);
    for (uint32_t i = 0; i < 2 * PAIRS; i++)
        for (uint32_t corner = 0; corner < 3; corner++) {
            v[9 * i + 3 * corner] = (float)(i / 2) + 0.1f * (float)corner;
            v[9 * i + 3 * corner + 1] = (float)(i % 2) + (corner == 1 ? 0.1f : 0);
        }
    bb_scene *scene = make_scene(v, 2 * PAIRS, NULL, 0);
    free(v);
    ASSERT_OK(bb_scene_upload(scene, device));
    bb_tree tree;
    make_comb(scene, PAIRS, &tree);
    ASSERT_OK(bb_tree_check(&tree, scene));
    ASSERT_OK(bb_tree_upload(&tree, device, NULL));
    for (int greedy = 0; greedy < 2; greedy++) {
        take_apart("wide8", scene, &tree, 1, false, greedy);
        take_apart("wide4", scene, &tree, 1, false, greedy);
    }
    bb_tree_release(&tree);
    free_uploaded(scene);
}

/* ---- which nodes there are ---- */

/* Half the area of a box of small whole numbers: without error. */
static float half_area(const float lo[3], const float hi[3])
{
    float x = hi[0] - lo[0], y = hi[1] - lo[1], z = hi[2] - lo[2];
    return x * y + y * z + z * x;
}

/* By the definition: the largest of `out`, of equals the first, makes way for its children, as long
 * as there is room. */
static uint32_t children_by_greed(const bb_tree *tree, uint32_t n, uint32_t width, uint32_t out[8])
{
    uint32_t count = 1;
    out[0] = n;
    while (count < width) {
        uint32_t largest = count;
        float area = -1;
        for (uint32_t c = 0; c < count; c++) {
            const bb_node *node = &tree->nodes[out[c]];
            if ((node->first & BB_LEAF_BIT) == 0 && half_area(node->lo, node->hi) > area) {
                area = half_area(node->lo, node->hi);
                largest = c;
            }
        }
        if (largest == count)
            break;
        memmove(out + largest + 2, out + largest + 1, (count - largest - 1) * sizeof *out);
        out[largest] = tree->nodes[out[largest]].first;
        out[largest + 1] = tree->nodes[out[largest]].skip;
        count++;
    }
    return count;
}

/* That what `link` leads to is what greed makes of node n of the tree. */
static void compare_by_greed(const wide *w, const bb_tree *tree, uint32_t link, uint32_t n)
{
    assert_int_equal(link & BB_LEAF_BIT, tree->nodes[n].first & BB_LEAF_BIT);
    if ((link & BB_LEAF_BIT) != 0)
        return;
    uint32_t wanted[8], count;
    const uint32_t *links = links_of(w, link, &count);
    assert_int_equal(count, children_by_greed(tree, n, w->width, wanted));
    for (uint32_t c = 0; c < count; c++) {
        bb_box box, said = box_of(w, link, c);
        memcpy(box.lo, tree->nodes[wanted[c]].lo, sizeof box.lo);
        memcpy(box.hi, tree->nodes[wanted[c]].hi, sizeof box.hi);
        box = padded_box(&box);
        for (int k = 0; k < 3; k++)
            assert_true(said.lo[k] == box.lo[k] && said.hi[k] == box.hi[k]);
        compare_by_greed(w, tree, links[c], wanted[c]);
    }
}

/* Areas of the nodes below a node, children that are leaves left out. */
static double area_below(const wide *w, uint32_t link)
{
    uint32_t count;
    const uint32_t *links = links_of(w, link, &count);
    double sum = 0;
    for (uint32_t c = 0; c < count; c++) {
        const bb_box box = box_of(w, link, c);
        if ((links[c] & BB_LEAF_BIT) == 0)
            sum += half_area(box.lo, box.hi) + area_below(w, links[c]);
    }
    return sum;
}

/* Who asks for it by name gets it; who has no use for it is told. */
static void a_kernel_asks_for_its_nodes(void **state)
{
    (void)state;
    bb_spec spec;
    const bb_kernel *kernel;
    ASSERT_OK(bb_kernel_parse("stack8i:leaf=8,plan=greedy", &spec, &kernel));
    assert_true(bb_kernel_wish(&spec).greedy);
    ASSERT_OK(bb_kernel_parse("short4:plan=optimal", &spec, &kernel));
    assert_false(bb_kernel_wish(&spec).greedy);
    assert_int_equal(bb_kernel_parse("stack4:plan=best", &spec, &kernel), BB_INVALID);
    assert_int_equal(bb_kernel_parse("stack:plan=optimal", &spec, &kernel), BB_INVALID);
    assert_non_null(strstr(bb_message(), "drop plan="));
    ASSERT_OK(bb_kernel_parse("stack8i:leaf=8,node=0.25", &spec, &kernel));
    assert_true(bb_kernel_wish(&spec).node_cost == 0.25);
    ASSERT_OK(bb_kernel_parse("stack:leaf=8", &spec, &kernel));
    assert_true(bb_kernel_wish(&spec).node_cost == 0);
    assert_int_equal(bb_kernel_parse("stack8i:leaf=8,node=0", &spec, &kernel), BB_INVALID);
    assert_int_equal(bb_kernel_parse("stack8i:leaf=8,node=half", &spec, &kernel), BB_INVALID);
    assert_int_equal(bb_kernel_parse("stack8i:node=0.25", &spec, &kernel), BB_INVALID);
    assert_non_null(strstr(bb_message(), "give leaf=N"));
}

/* Triangles with corners of small whole numbers, so that areas have no error and many are equal. */
static bb_scene *make_lattice_scene(uint32_t count, bb_random *random)
{
    float v[9 * 64];
    assert_true(count <= 64);
    for (uint32_t i = 0; i < 9 * count; i++)
        v[i] = (float)bb_random_below(random, 12);
    bb_scene *scene = make_scene(v, count, NULL, 0);
    assert_true(scene->scale == 1.0f); /* what padded_box() is for */
    ASSERT_OK(bb_scene_upload(scene, device));
    return scene;
}

/* The cheaper a node, the fewer leaves become one: and the layout's name says what it was taken to
 * cost. */
static void cheap_nodes_keep_leaves_apart(void **state)
{
    (void)state;
    static const double costs[] = {100, 0.01};
    bb_random random = bb_random_make(SEED + 5, 0);
    bb_tree tree;
    size_t before = 0;
    device = devices[CPU_FORM];
    bb_scene *scene = make_lattice_scene(64, &random);
    make_random_tree(scene, 2, 1, &random, &tree);
    ASSERT_OK(bb_tree_upload(&tree, device, NULL));
    for (size_t i = 0; i < sizeof costs / sizeof costs[0]; i++) {
        bb_layout_maker maker;
        bb_layout_data data = {0};
        char node[24];
        ASSERT_OK(bb_layout_maker_create(bb_layout_find("wide8"), device, &maker));
        maker.wish.node_cost = costs[i];
        ASSERT_OK(bb_layout_maker_make(&maker, scene, &tree, 8, BB_FORMAT_VERTICES, &data));
        snprintf(node, sizeof node, "node=%g", costs[i]);
        assert_non_null(strstr(data.name, node));
        assert_true(data.buffers[0].bytes > before);
        before = data.buffers[0].bytes;
        bb_layout_data_release(&data);
        bb_layout_maker_destroy(&maker);
    }
    bb_tree_release(&tree);
    free_uploaded(scene);
}

/* Greedy nodes are those of the definition, and the plan's have no more area: less on some tree. */
static void nodes_are_those_of_the_plan(void **state)
{
    (void)state;
    const bb_layout_wish greedy = {.greedy = true}, optimal = {.greedy = false};
    uint32_t better = 0;
    for (uint32_t run = 0; run < (small() ? 6u : 60u); run++) {
        bb_random random = bb_random_make(SEED + 4, run);
        bb_scene *scene = make_lattice_scene(2 + bb_random_below(&random, 63), &random);
        const char *name = run % 2 == 0 ? "wide8" : "wide4";
        bb_tree tree;
        uint32_t root;
        make_random_tree(scene, 2, 1, &random, &tree);
        ASSERT_OK(bb_tree_upload(&tree, device, NULL));
        wide w = read_wide(name, scene, &tree, 1, &greedy, &root);
        compare_by_greed(&w, &tree, root, tree.info.root);
        double most = area_below(&w, root);
        free_wide(&w);
        w = read_wide(name, scene, &tree, 1, &optimal, &root);
        double least = area_below(&w, root);
        free_wide(&w);
        if (!(least <= most * (1 + 1e-6)))
            fail_msg("run %u %s: nodes of %g planned, of %g by greed", run, name, least, most);
        better += least < most * 0.99;
        bb_tree_release(&tree);
        free_uploaded(scene);
    }
    assert_true(better > 0);
}

/* ---- the ways to the same layout ---- */

typedef struct made {
    uint32_t root, stack_need, lanes;
    size_t sizes[2];
    void *data[2];
} made;

static made make_on(int form, bb_scene *scene, const char *name, uint32_t arity, uint32_t per_leaf,
                    uint64_t run, uint32_t leaf)
{
    bb_random random = bb_random_make(SEED + 3, run);
    bb_layout_maker maker;
    bb_layout_data data = {0};
    bb_tree tree;
    device = devices[form];
    ASSERT_OK(bb_scene_upload(scene, device));
    make_random_tree(scene, arity, per_leaf, &random, &tree);
    ASSERT_OK(bb_tree_upload(&tree, device, NULL));
    ASSERT_OK(bb_layout_maker_create(bb_layout_find(name), device, &maker));
    maker.wish = (bb_layout_wish){
        .octants = run % 2 == 1, .greedy = run / 2 % 2 == 1, .node_cost = run % 3 == 1 ? 0.5 : 0};
    ASSERT_OK(bb_layout_maker_make(&maker, scene, &tree, leaf, BB_FORMAT_VERTICES, &data));
    made made = {data.root, data.stack_need, data.lanes, {0}, {NULL}};
    for (uint32_t i = 0; i < 2; i++) {
        made.sizes[i] = data.buffers[i].bytes;
        made.data[i] = download(&data.buffers[i]);
    }
    bb_layout_data_release(&data);
    bb_layout_maker_destroy(&maker);
    bb_tree_release(&tree);
    bb_scene_device *geometry = &scene->on_device;
    bb_buffer_release(&geometry->boxes);
    bb_buffer_release(&geometry->vertices);
    bb_buffer_release(&geometry->prims);
    return made;
}

/* Straight from a binary tree, or by way of pairs, with a fence or by levels: one layout, bit for
 * bit. Scenes of one kind of primitives and of two, extreme coordinates, and sizes with and without
 * nodes above the subtrees of the cut. */
static void all_ways_make_one_layout(void **state)
{
    (void)state;
    static const char *const names[] = {"wide8", "wide4", "quant8"};
    static const uint32_t leaves[] = {1, 2, 8, 64};
    for (uint32_t run = 0; run < (small() ? 4u : 40u); run++) {
        bb_random random = bb_random_make(SEED + 2, run);
        uint32_t triangles = 1 + bb_random_below(&random, small() ? 60 : run % 8 == 0 ? 6000 : 300);
        uint32_t spheres = run % 3 == 0 ? bb_random_below(&random, 50) : 0;
        float *v = malloc((9 * (size_t)triangles + 4 * (size_t)spheres) * sizeof *v);
        for (uint32_t i = 0; i < 9 * triangles; i++)
            v[i] = extreme(&random, run % 5);
        for (uint32_t i = 0; i < 4 * spheres; i++)
            v[9 * triangles + i] = fabsf(extreme(&random, 0));
        bb_scene *scene = make_scene(v, triangles, v + 9 * (size_t)triangles, spheres);
        free(v);
        for (uint32_t k = 0; k < 4; k++) {
            const char *name = names[(run + k) % 3];
            const uint32_t per_leaf = run % 4 == 3 ? 3 : 1; /* else straight */
            made first = {0};
            for (int form = CPU_FORM; form < FORMS; form++) {
                made made = make_on(form, scene, name, 2, per_leaf, run, leaves[k]);
                if (form == CPU_FORM) {
                    first = made;
                    continue;
                }
                assert_int_equal(first.root, made.root);
                assert_int_equal(first.stack_need, made.stack_need);
                assert_int_equal(first.lanes, made.lanes);
                for (uint32_t i = 0; i < 2; i++) {
                    assert_int_equal(first.sizes[i], made.sizes[i]);
                    bool is_written = i == 1 || (made.root & BB_LEAF_BIT) == 0;
                    if (is_written && memcmp(first.data[i], made.data[i], made.sizes[i]) != 0)
                        fail_msg("run %u %s leaf %u: buffer %u of form %d differs", run, name,
                                 leaves[k], i, form);
                    free(made.data[i]);
                }
            }
            free(first.data[0]);
            free(first.data[1]);
        }
        free_scene(scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(collapsed_trees_are_valid_and_cost_no_more),
        cmocka_unit_test(collapse_decides_by_cost),
        cmocka_unit_test(wide_layouts_hold_the_tree),
        cmocka_unit_test(pairs_wait_where_there_is_no_room),
        cmocka_unit_test(nodes_are_those_of_the_plan),
    };
    const struct CMUnitTest of_all[] = {
        cmocka_unit_test(a_kernel_asks_for_its_nodes),
        cmocka_unit_test(cheap_nodes_keep_leaves_apart),
        cmocka_unit_test(all_ways_make_one_layout),
    };
    int failed = open_devices(NULL);
    if (first_form() == CPU_FORM && failed == 0)
        failed = cmocka_run_group_tests(of_all, NULL, NULL);
    for (int form = first_form(); form < FORMS && failed == 0; form += LEVELS_FORM) {
        device = devices[form];
        failed = cmocka_run_group_tests(tests, NULL, NULL);
    }
    close_devices(NULL);
    return failed;
}
