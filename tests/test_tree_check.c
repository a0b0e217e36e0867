/* The checker of the common tree must find every kind of corruption by itself, call it by its name,
 * and never crash. Built with sanitizers, this test says that nothing is read out of bounds. */
#include "framework/builder/metric.h"
#include "framework/builder/tree_cover.h"
#include "tests/tree_fixture.h"

static const uint64_t SEED = 20240608;

/* ---- the checker ---- */

typedef struct target {
    bb_tree *tree;
    bb_scene *scene;
    bb_random *random;
    uint32_t leaf,
        inner; /* a random one of each; inner is not the root unless it is the only one */
} target;

static uint32_t leaf_ref(const target *t)
{
    return t->tree->nodes[t->leaf].first & BB_INDEX_MASK;
}

static void box_nan(target *t)
{
    t->tree->nodes[t->leaf].lo[bb_random_below(t->random, 3)] = NAN;
}
static void box_infinite(target *t)
{
    t->tree->nodes[t->tree->info.root].hi[bb_random_below(t->random, 3)] = INFINITY;
}
static void box_inverted(target *t)
{
    bb_node *node = &t->tree->nodes[t->leaf];
    node->lo[1] = nextafterf(node->hi[1], INFINITY);
}
static void leaf_too_small(target *t)
{
    bb_node *node = &t->tree->nodes[t->leaf];
    node->hi[2] = nextafterf(node->hi[2], -INFINITY);
}
static void inner_too_small(target *t)
{
    bb_node *node = &t->tree->nodes[t->inner];
    node->lo[0] = nextafterf(node->lo[0], INFINITY);
}
static void child_too_large(target *t)
{
    t->tree->nodes[t->leaf].hi[0] = 1e6f;
}
static void skip_to_self(target *t)
{
    t->tree->nodes[t->leaf].skip = t->leaf;
}
static void skip_to_root(target *t)
{
    t->tree->nodes[t->leaf].skip = t->tree->info.root;
}
static void skip_out_of_range(target *t)
{
    t->tree->nodes[t->leaf].skip = t->tree->info.node_count;
}
static void skip_ends_early(target *t)
{
    for (uint32_t i = 0; i < t->tree->info.node_count; i++)
        if (bb_node_is_leaf(&t->tree->nodes[i]) && t->tree->nodes[i].skip != BB_NONE) {
            t->tree->nodes[i].skip = BB_NONE;
            return;
        }
}
static void root_skips(target *t)
{
    t->tree->nodes[t->tree->info.root].skip = t->leaf;
}
static void first_is_self(target *t)
{
    t->tree->nodes[t->inner].first = t->inner;
}
static void first_is_root(target *t)
{
    t->tree->nodes[t->inner].first = t->tree->info.root;
}
static void first_out_of_range(target *t)
{
    t->tree->nodes[t->inner].first = t->tree->info.node_count + 7;
}
static void no_child(target *t)
{
    uint32_t inner = t->inner;
    t->tree->nodes[inner].first = t->tree->nodes[inner].skip;
    if (t->tree->nodes[inner].skip == BB_NONE)
        t->tree->nodes[inner].first = BB_INDEX_MASK;
}
static void child_left_out(target *t)
{
    bb_node *node = &t->tree->nodes[t->inner];
    node->first = t->tree->nodes[node->first].skip;
}
static void leaf_empty(target *t)
{
    t->tree->nodes[t->leaf].first = BB_LEAF_BIT | t->tree->info.ref_count;
}
static void leaf_index_huge(target *t)
{
    t->tree->nodes[t->leaf].first = BB_LEAF_BIT | BB_INDEX_MASK;
}
static void leaf_not_closed(target *t)
{
    t->tree->refs[t->tree->info.ref_count - 1] &= BB_INDEX_MASK;
}
static void last_bit_missing(target *t)
{
    uint32_t ref = leaf_ref(t);
    while (!(t->tree->refs[ref] & BB_LAST_BIT))
        ref++;
    t->tree->refs[ref] &= BB_INDEX_MASK;
}
static void two_leaves_share(target *t)
{
    for (uint32_t i = 0; i < t->tree->info.node_count; i++)
        if (i != t->leaf && bb_node_is_leaf(&t->tree->nodes[i]))
            t->tree->nodes[i].first = t->tree->nodes[t->leaf].first;
}
static void reference_orphan(target *t)
{
    t->tree->info.ref_count++; /* the copy has room for one more */
    t->tree->refs[t->tree->info.ref_count - 1] = 0 | BB_LAST_BIT;
}
static void node_orphan(target *t)
{
    t->tree->nodes[t->tree->info.node_count++] = t->tree->nodes[t->leaf];
}
static void prim_out_of_range(target *t)
{
    t->tree->refs[leaf_ref(t)] = t->scene->prim_count | (t->tree->refs[leaf_ref(t)] & BB_LAST_BIT);
}
static void prim_twice(target *t)
{
    uint32_t *ref = &t->tree->refs[leaf_ref(t)];
    *ref = (*ref & BB_LAST_BIT) | ((*ref & BB_INDEX_MASK) + 1) % t->scene->prim_count;
}
static void root_out_of_range(target *t)
{
    t->tree->info.root = t->tree->info.node_count;
}
static void root_elsewhere(target *t)
{
    t->tree->info.root = t->leaf;
}
static void node_count_wrong(target *t)
{
    t->tree->info.node_count--;
}
static void node_count_huge(target *t)
{
    t->tree->info.node_count = BB_NONE;
}
static void node_count_zero(target *t)
{
    t->tree->info.node_count = 0;
}
static void leaf_count_wrong(target *t)
{
    t->tree->info.leaf_count++;
}
static void ref_count_wrong(target *t)
{
    t->tree->info.ref_count--;
}
static void ref_count_huge(target *t)
{
    t->tree->info.ref_count = BB_NONE;
}
static void arity_wrong(target *t)
{
    t->tree->info.arity--;
}
static void depth_wrong(target *t)
{
    t->tree->info.depth++;
}
static void prim_missing(target *t)
{
    t->scene->prim_count++; /* the scene has room for one more box */
}

static const struct {
    const char *name;
    void (*apply)(target *t);
    const char *message; /* a part of it; NULL: depends on what else the corruption breaks first */
} corruptions[] = {
    {"box_nan", box_nan, "box of node"},
    {"box_infinite", box_infinite, "box of node"},
    {"box_inverted", box_inverted, "box of node"},
    {"leaf_too_small", leaf_too_small, NULL},
    {"inner_too_small", inner_too_small, "does not contain its child"},
    {"child_too_large", child_too_large, "does not contain its child"},
    {"skip_to_self", skip_to_self, NULL},
    {"skip_to_root", skip_to_root, "reached twice"},
    {"skip_out_of_range", skip_out_of_range, "is node"},
    {"skip_ends_early", skip_ends_early, NULL},
    {"root_skips", root_skips, "skip of the root"},
    {"first_is_self", first_is_self, "reached twice"},
    {"first_is_root", first_is_root, "reached twice"},
    {"first_out_of_range", first_out_of_range, "is node"},
    {"no_child", no_child, NULL},
    {"child_left_out", child_left_out, NULL},
    {"leaf_empty", leaf_empty, "is empty"},
    {"leaf_index_huge", leaf_index_huge, "is empty"},
    {"leaf_not_closed", leaf_not_closed, NULL},
    {"last_bit_missing", last_bit_missing, NULL},
    {"two_leaves_share", two_leaves_share, "belongs to another leaf"},
    {"reference_orphan", reference_orphan, "is an orphan"},
    {"node_orphan", node_orphan, "is an orphan"},
    {"prim_out_of_range", prim_out_of_range, "references primitive"},
    {"prim_twice", prim_twice, NULL},
    {"root_out_of_range", root_out_of_range, "the root is node"},
    {"root_elsewhere", root_elsewhere, NULL},
    {"node_count_wrong", node_count_wrong, NULL},
    {"node_count_huge", node_count_huge, "it has room for"},
    {"node_count_zero", node_count_zero, "the root is node"},
    {"leaf_count_wrong", leaf_count_wrong, "declares leaf_count"},
    {"ref_count_wrong", ref_count_wrong, NULL},
    {"ref_count_huge", ref_count_huge, "it has room for"},
    {"arity_wrong", arity_wrong, "declares arity"},
    {"depth_wrong", depth_wrong, "declares depth"},
    {"prim_missing", prim_missing, "is in no leaf"},
};

static void choose(target *t)
{
    const bb_tree *tree = t->tree;
    do
        t->leaf = bb_random_below(t->random, tree->info.node_count);
    while (!bb_node_is_leaf(&tree->nodes[t->leaf]));
    do
        t->inner = bb_random_below(t->random, tree->info.node_count);
    while (bb_node_is_leaf(&tree->nodes[t->inner]));
}

/* A copy with room for one more node, reference and primitive. */
static void give_room(const bb_tree *from, bb_tree *to, bb_scene *scene)
{
    bb_tree_init(to, NULL);
    ASSERT_OK(
        bb_tree_reserve(to, NULL, BB_ON_HOST, from->info.node_count + 1, from->info.ref_count + 1));
    memcpy(to->nodes, from->nodes, from->info.node_count * sizeof *to->nodes);
    memcpy(to->refs, from->refs, from->info.ref_count * sizeof *to->refs);
    to->info = from->info;
    scene->boxes = realloc(scene->boxes, (scene->prim_count + 1) * sizeof *scene->boxes);
    assert_non_null(scene->boxes);
    scene->boxes[scene->prim_count] = scene->boxes[0];
}

static void test_checker_finds_each_corruption(void **state)
{
    (void)state;
    for (size_t kind = 0; kind < sizeof corruptions / sizeof *corruptions; kind++)
        for (uint32_t run = 0; run < 60; run++) {
            bb_random random = bb_random_make(SEED + 2 + kind, run);
            bb_scene *scene = make_random_scene(3 + bb_random_below(&random, 200), &random);
            bb_tree valid, tree;
            make_random_tree(scene, 2 + bb_random_below(&random, 7), 3, &random, &valid);
            give_room(&valid, &tree, scene);
            bb_tree_release(&valid);
            if (tree.info.node_count == 1) { /* no inner node to spoil */
                bb_tree_release(&tree);
                free_scene(scene);
                continue;
            }
            ASSERT_OK(bb_tree_check(&tree, scene));
            target t = {.tree = &tree, .scene = scene, .random = &random};
            choose(&t);
            corruptions[kind].apply(&t);
            if (bb_tree_check(&tree, scene) != BB_FAILED)
                fail_msg("%s was not found: seed %llu run %u", corruptions[kind].name,
                         (unsigned long long)SEED, run);
            const char *part = corruptions[kind].message;
            if (part != NULL && strstr(bb_message(), part) == NULL)
                fail_msg("%s was called '%s': run %u", corruptions[kind].name, bb_message(), run);
            bb_tree_release(&tree);
            free_scene(scene);
        }
}

/* Random bits of a valid tree are flipped: whatever comes out, nothing crashes, loops or reads out
 * of bounds. */
static void test_fuzzed_trees_do_no_harm(void **state)
{
    (void)state;
    for (uint32_t run = 0; run < 3000; run++) {
        bb_random random = bb_random_make(SEED + 3, run);
        bb_scene *scene = make_random_scene(1 + bb_random_below(&random, 40), &random);
        bb_tree tree;
        make_random_tree(scene, 2 + bb_random_below(&random, 7), 3, &random, &tree);
        tree.duplicated = bb_random_below(&random, 2);
        tree.disjoint = bb_random_below(&random, 2);
        scene->prims[BB_TRIANGLE].count = 0; /* as spheres, which fuzzed coverage can look at */
        scene->prims[BB_SPHERE].count = scene->prim_count;
        scene->prims[BB_SPHERE].data = calloc(4 * (size_t)scene->prim_count, sizeof(float));
        for (uint32_t flips = 1 + bb_random_below(&random, 4); flips > 0; flips--) {
            uint32_t bit = 1u << bb_random_below(&random, bb_random_below(&random, 2) ? 7 : 32);
            uint32_t words = tree.info.node_count * 8, refs = tree.info.ref_count;
            if (words / 8 > tree.node_capacity || refs > tree.ref_capacity)
                break;
            uint32_t at = bb_random_below(&random, words + refs + 6);
            if (at < words)
                ((uint32_t *)tree.nodes)[at] ^= bit;
            else if (at < words + refs)
                tree.refs[at - words] ^= bit;
            else
                ((uint32_t *)&tree.info)[at - words - refs] ^= bit;
        }
        uint64_t hash;
        bb_metric_value epo;
        (void)bb_tree_check(&tree, scene);
        (void)bb_tree_hash(&tree, &hash);
        (void)bb_tree_sah(&tree);
        (void)bb_metric_compute(bb_metrics[bb_metric_find("epo")], &tree, scene, 1, 1, &epo);
        bb_tree_release(&tree);
        free_scene(scene);
    }
}

static void test_disjoint_siblings(void **state)
{
    (void)state;
    bb_scene *scene = make_box_scene(3);
    const float boxes[3][2][3] = {
        {{0, 0, 0}, {1, 1, 1}}, {{1, 0, 0}, {2, 1, 1}}, {{0, 1, 0}, {2, 2, 1}}};
    bb_node nodes[4] = {make_node((float[]){0, 0, 0}, (float[]){2, 2, 1}, 1, BB_NONE)};
    const uint32_t refs[] = {0 | BB_LAST_BIT, 1 | BB_LAST_BIT, 2 | BB_LAST_BIT};
    for (uint32_t i = 0; i < 3; i++) {
        memcpy(scene->boxes[i].lo, boxes[i][0], sizeof boxes[i][0]);
        memcpy(scene->boxes[i].hi, boxes[i][1], sizeof boxes[i][1]);
        nodes[i + 1] =
            make_node(boxes[i][0], boxes[i][1], BB_LEAF_BIT | i, i < 2 ? i + 2 : BB_NONE);
    }
    bb_tree tree;
    make_tree(&tree, nodes, 4, refs, 3, 3, 1);
    tree.disjoint = true;
    ASSERT_OK(bb_tree_check(&tree, scene)); /* touching is no shared volume */
    tree.nodes[2].hi[1] = nextafterf(1, 2);
    assert_int_equal(bb_tree_check(&tree, scene), BB_FAILED);
    assert_non_null(strstr(bb_message(), "nodes 2 and 3, children of 0, share volume"));
    tree.disjoint = false;
    ASSERT_OK(bb_tree_check(&tree, scene));
    bb_tree_release(&tree);
    free_scene(scene);
}

/* A, at the left on the sweep's axis, shares volume with C, and with B between them none. */
static void test_siblings_further_on(void **state)
{
    (void)state;
    const bb_node nodes[] = {
        make_node(V(0, 0, 0), V(4, 2, 1), 1, BB_NONE),
        make_node(V(0, 0, 0), V(4, 1, 1), BB_LEAF_BIT | 0, 2),
        make_node(V(1, 1, 0), V(2, 2, 1), BB_LEAF_BIT | 1, 3),
        make_node(V(2, 0, 0), V(3, 2, 1), BB_LEAF_BIT | 2, BB_NONE),
    };
    const uint32_t refs[] = {0 | BB_LAST_BIT, 1 | BB_LAST_BIT, 2 | BB_LAST_BIT};
    bb_scene *scene = make_box_scene(3);
    bb_tree tree;
    for (uint32_t i = 0; i < 3; i++) {
        memcpy(scene->boxes[i].lo, nodes[i + 1].lo, sizeof nodes[0].lo);
        memcpy(scene->boxes[i].hi, nodes[i + 1].hi, sizeof nodes[0].hi);
    }
    make_tree(&tree, nodes, 4, refs, 3, 3, 1);
    ASSERT_OK(bb_tree_check(&tree, scene));
    tree.disjoint = true;
    assert_int_equal(bb_tree_check(&tree, scene), BB_FAILED);
    assert_non_null(strstr(bb_message(), "nodes 1 and 3, children of 0, share volume"));
    bb_tree_release(&tree);
    free_scene(scene);
}

/* ---- duplicated references ---- */

/* All primitives are there, and one of them once more. */
static void test_one_too_many(void **state)
{
    (void)state;
    bb_scene *scene = make_box_scene(3);
    bb_tree tree;
    make_row(&tree);
    for (uint32_t i = 0; i < 3; i++) {
        memcpy(scene->boxes[i].lo, tree.nodes[i + 1].lo, sizeof scene->boxes[i].lo);
        memcpy(scene->boxes[i].hi, tree.nodes[i + 1].hi, sizeof scene->boxes[i].hi);
    }
    memcpy(tree.nodes[4].lo, tree.nodes[3].lo, sizeof tree.nodes[4].lo);
    tree.refs[3] = 2 | BB_LAST_BIT;
    assert_int_equal(bb_tree_check(&tree, scene), BB_FAILED);
    assert_non_null(strstr(bb_message(), "primitive 2 is referenced twice"));
    bb_tree_release(&tree);
    free_scene(scene);
}

/* Cuts the box [lo, hi] at random planes into `count` boxes (at least) that together fill it. */
static uint32_t cut_box(const bb_box *box, uint32_t count, bb_random *random, bb_box *out)
{
    uint32_t made = 1;
    out[0] = *box;
    while (made < count) {
        uint32_t which = bb_random_below(random, made), axis = bb_random_below(random, 3);
        float lo = out[which].lo[axis], hi = out[which].hi[axis];
        float plane = (float)bb_random_range(random, lo, hi);
        plane = fminf(fmaxf(plane, lo), hi);
        out[made] = out[which];
        out[which].hi[axis] = out[made++].lo[axis] = plane;
    }
    return made;
}

static bool is_covered(const bb_scene *scene, const bb_box *boxes, uint32_t count)
{
    bool covered;
    double point[3];
    ASSERT_OK(bb_cover_primitive(scene, 0, boxes, count, &covered, point));
    return covered;
}

static bb_scene *random_primitive(bb_random *random)
{
    float triangle[9], sphere[4];
    double scale = pow(10, bb_random_range(random, -3, 3));
    uint32_t kind = bb_random_below(random, 4);
    for (int i = 0; i < 9; i++)
        triangle[i] = (float)(scale * bb_random_range(random, -1, 1));
    for (int i = 0; i < 4; i++)
        sphere[i] = (float)(scale * bb_random_unit(random));
    if (kind == 1) /* in a plane of constant coordinate */
        triangle[1] = triangle[4] = triangle[7];
    if (kind == 2) /* a segment */
        memcpy(triangle + 3, triangle, 3 * sizeof(float));
    return kind == 3 ? make_scene(NULL, 0, sphere, 1) : make_scene(triangle, 1, NULL, 0);
}

/* Boxes that fill the primitive's box cover it; without one of them, it is covered only if no point
 * of it is in there alone: a dense sample of the primitive decides. */
static void test_cover(void **state)
{
    (void)state;
    uint32_t found = 0;
    for (uint32_t run = 0; run < 2000; run++) {
        bb_random random = bb_random_make(SEED + 4, run);
        bb_scene *scene = random_primitive(&random);
        bb_box boxes[32];
        uint32_t count =
            cut_box(&scene->boxes[0], 1 + bb_random_below(&random, 30), &random, boxes);
        if (!is_covered(scene, boxes, count))
            fail_msg("seed %llu run %u: covered, but not found so", (unsigned long long)SEED, run);
        uint32_t gone = bb_random_below(&random, count);
        boxes[gone] = boxes[--count];
        bool covered = is_covered(scene, boxes, count), outside = false;
        for (uint32_t i = 0; i < 400 && !outside; i++) {
            double p[3], u = bb_random_unit(&random), v = bb_random_unit(&random), d[3];
            bb_random_direction(&random, d);
            for (int axis = 0; axis < 3; axis++) {
                const float *t = scene->vertices, *s = bb_scene_floats(scene, BB_SPHERE);
                p[axis] = scene->prims[BB_SPHERE].count > 0 ? s[axis] + s[3] * d[axis]
                          : u + v > 1 ? t[axis] + (1 - u) * ((double)t[axis + 3] - t[axis]) +
                                            (1 - v) * ((double)t[axis + 6] - t[axis])
                                      : t[axis] + u * ((double)t[axis + 3] - t[axis]) +
                                            v * ((double)t[axis + 6] - t[axis]);
            }
            outside = true;
            for (uint32_t k = 0; k < count && outside; k++) {
                bool in = true;
                for (int axis = 0; axis < 3; axis++) {
                    double slack = 1e-9 * (fabs(p[axis]) + 1e-3);
                    in = in && boxes[k].lo[axis] - slack <= p[axis] &&
                         p[axis] <= boxes[k].hi[axis] + slack;
                }
                outside = !in;
            }
        }
        if (outside && covered)
            fail_msg("seed %llu run %u: a gap was not found", (unsigned long long)SEED, run);
        found += !covered;
        free_scene(scene);
    }
    assert_in_range(found, 200, 1990); /* both answers were put to the test */
}

/* A triangle in many boxes: a lattice of them, without or with their neighbours' room, and thinner
 * than the margin, all over one line. Work must not grow with the square, or worse, of their
 * number, which only the test's limit of time would show. */
static void test_cover_of_many_boxes(void **state)
{
    (void)state;
    enum { SIDE = 64, COUNT = SIDE * SIDE };
    const float triangle[9] = {0, 0, 0, 2 * SIDE, 0, 1, 0, 2 * SIDE, 1};
    bb_scene *scene = make_scene(triangle, 1, NULL, 0);
    bb_box *boxes = calloc(COUNT, sizeof *boxes);
    for (int room = 0; room < 5; room += 2) {
        for (int i = 0; i < COUNT; i++) {
            float x = (float)(2 * (i % SIDE)), y = (float)(2 * (i / SIDE)), more = (float)room;
            boxes[i] =
                (bb_box){.lo = {x - more, y - more, 0}, .hi = {x + 2 + more, y + 2 + more, 1}};
        }
        assert_true(is_covered(scene, boxes, COUNT));
        boxes[10 * SIDE + 10] = boxes[0]; /* others' room holds what it held */
        assert_int_equal(is_covered(scene, boxes, COUNT), room > 0);
    }
    free_scene(scene);

    const float far[9] = {1e9f, 1e9f, 0, 1e9f, 1e9f, 1, 1e9f, 1e9f + 64, 0.5f};
    scene = make_scene(far, 1, NULL, 0);
    for (int i = 0; i < COUNT; i++) {
        boxes[i] = scene->boxes[0];
        boxes[i].lo[2] = (float)i / COUNT;
        boxes[i].hi[2] = (float)(i + 1) / COUNT;
    }
    assert_true(is_covered(scene, boxes, COUNT));
    free(boxes);
    free_scene(scene);
}

/* A gap of one float between two boxes is found. */
static void test_cover_finds_one_ulp(void **state)
{
    (void)state;
    const float triangle[9] = {0, 0, 0, 4, 0, 1, 0, 4, 2};
    bb_scene *scene = make_scene(triangle, 1, NULL, 0);
    bb_box boxes[2] = {scene->boxes[0], scene->boxes[0]};
    boxes[0].hi[0] = boxes[1].lo[0] = 1.3f;
    assert_true(is_covered(scene, boxes, 2));
    boxes[1].lo[0] = nextafterf(1.3f, 2);
    assert_false(is_covered(scene, boxes, 2));
    free_scene(scene);
}

/* One triangle in two leaves; then a leaf is cut short, and then the declaration is withdrawn. */
static void test_check_duplicated(void **state)
{
    (void)state;
    const float triangle[9] = {0, 0, 0, 2, 0, 0, 0, 2, 0};
    bb_scene *scene = make_scene(triangle, 1, NULL, 0);
    const bb_node nodes[] = {
        make_node((float[]){0, 0, 0}, (float[]){2, 2, 0}, 1, BB_NONE),
        make_node((float[]){0, 0, 0}, (float[]){1, 2, 0}, BB_LEAF_BIT | 0, 2),
        make_node((float[]){1, 0, 0}, (float[]){2, 1, 0}, BB_LEAF_BIT | 1, BB_NONE),
    };
    const uint32_t refs[] = {0 | BB_LAST_BIT, 0 | BB_LAST_BIT};
    bb_tree tree;
    make_tree(&tree, nodes, 3, refs, 2, 2, 1);
    tree.duplicated = true;
    ASSERT_OK(bb_tree_check(&tree, scene));
    tree.nodes[2].hi[1] = 0.75f;
    assert_int_equal(bb_tree_check(&tree, scene), BB_FAILED);
    assert_non_null(strstr(bb_message(), "primitive 0 is not covered by its 2 leaves"));
    tree.nodes[2].hi[1] = 1;
    tree.duplicated = false;
    assert_int_equal(bb_tree_check(&tree, scene), BB_FAILED);
    bb_tree_release(&tree);
    free_scene(scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_checker_finds_each_corruption),
        cmocka_unit_test(test_fuzzed_trees_do_no_harm),
        cmocka_unit_test(test_disjoint_siblings),
        cmocka_unit_test(test_siblings_further_on),
        cmocka_unit_test(test_one_too_many),
        cmocka_unit_test(test_cover),
        cmocka_unit_test(test_cover_of_many_boxes),
        cmocka_unit_test(test_cover_finds_one_ulp),
        cmocka_unit_test(test_check_duplicated),
    };
    return cmocka_run_group_tests_name("tree_check", tests, NULL, NULL);
}
