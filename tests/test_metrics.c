/* SAH and EPO against cases solved by hand; the derivations are beside them. Ct = 1.2, Ci = 1. */
#include "framework/builder/metric.h"
#include "framework/scene/prim.h"
#include "tests/tree_fixture.h"

static const uint64_t SEED = 7;

static bb_status measure(const char *name, const bb_tree *tree, const bb_scene *scene,
                         uint64_t samples, bb_metric_value *out)
{
    return bb_metric_compute(bb_metrics[bb_metric_find(name)], tree, scene, samples, SEED, out);
}

enum { SAMPLES = 200000 };

/* Root [0,2] x [0,1] x [0,1], half area 2*1 + 1*1 + 1*2 = 5; two unit cubes of half area 3.
 * Inner: Ct 2/2 * 5 = 6. Leaves with 1 and 3 references: 3 + 9. (6 + 12) / 5 = 3.6 */
static void test_sah_binary(void **state)
{
    (void)state;
    const bb_node nodes[] = {
        make_node(V(0, 0, 0), V(2, 1, 1), 1, BB_NONE),
        make_node(V(0, 0, 0), V(1, 1, 1), BB_LEAF_BIT | 0, 2),
        make_node(V(1, 0, 0), V(2, 1, 1), BB_LEAF_BIT | 1, BB_NONE),
    };
    const uint32_t refs[] = {0 | BB_LAST_BIT, 1, 2, 3 | BB_LAST_BIT};
    bb_tree tree;
    make_tree(&tree, nodes, 3, refs, 4, 2, 1);
    ASSERT_NEAR(bb_tree_sah(&tree), 3.6, 1e-14);
    bb_tree_release(&tree);
}

/* Root [0,4] x [0,1] x [0,1], half area 4 + 1 + 4 = 9, with four unit cubes as children.
 * Inner: Ct 4/2 * 9 = 21.6. Leaves: 4 * 3. (21.6 + 12) / 9 = 3.7333... */
static void test_sah_wide(void **state)
{
    (void)state;
    bb_tree tree;
    make_row(&tree);
    ASSERT_NEAR(bb_tree_sah(&tree), 33.6 / 9, 1e-14);
    bb_tree_release(&tree);
}

/* A single leaf costs its references: 3. Nothing to divide by: NAN, as for links that lead nowhere.
 */
static void test_sah_leaf(void **state)
{
    (void)state;
    const bb_node leaf = make_node(V(0, 0, 0), V(1, 0, 1), BB_LEAF_BIT | 0, BB_NONE);
    const uint32_t refs[] = {0, 1, 2 | BB_LAST_BIT};
    bb_tree tree;
    make_tree(&tree, &leaf, 1, refs, 3, 0, 0);
    ASSERT_NEAR(bb_tree_sah(&tree), 3, 0);
    tree.nodes[0].hi[0] = 0;
    assert_true(isnan(bb_tree_sah(&tree)));
    tree.nodes[0].hi[0] = 1;
    tree.nodes[0].skip = 0;
    assert_true(isnan(bb_tree_sah(&tree)));
    bb_tree_release(&tree);
}

/* Largest and smallest boxes that floats can hold: half area of the root 3 (2^128)^2, the leaves
 * are nothing to it. */
static void test_sah_extremes(void **state)
{
    (void)state;
    const float big = 0x1p127f, tiny = 0x1p-149f;
    const bb_node nodes[] = {
        make_node(V(-big, -big, -big), V(big, big, big), 1, BB_NONE),
        make_node(V(-big, -big, -big), V(big, big, big), BB_LEAF_BIT | 0, 2),
        make_node(V(0, 0, 0), V(tiny, tiny, tiny), BB_LEAF_BIT | 1, BB_NONE),
    };
    const uint32_t refs[] = {0 | BB_LAST_BIT, 1 | BB_LAST_BIT};
    bb_tree tree;
    make_tree(&tree, nodes, 3, refs, 2, 2, 1);
    ASSERT_NEAR(bb_tree_sah(&tree), 2.2, 1e-14);
    for (uint32_t i = 0; i < 2; i++)
        tree.nodes[i] =
            make_node(V(0, 0, 0), V(tiny, tiny, tiny), tree.nodes[i].first, tree.nodes[i].skip);
    ASSERT_NEAR(bb_tree_sah(&tree), 3.2, 1e-14);
    bb_tree_release(&tree);
}

/* The mean must be within five half intervals of the exact figure, and the interval as wide as the
 * variance says. */
static void expect_epo(const bb_tree *tree, const bb_scene *scene, double exact, double variance)
{
    bb_metric_value epo, again;
    ASSERT_OK(bb_tree_check(tree, scene));
    ASSERT_OK(measure("epo", tree, scene, SAMPLES, &epo));
    double expected = 1.96 * sqrt(variance / SAMPLES);
    if (!(fabs(epo.value - exact) <= 2.5 * expected + 1e-12) ||
        fabs(epo.half - expected) > 0.05 * expected)
        fail_msg("EPO %g +- %g, expected %g +- %g", epo.value, epo.half, exact, expected);
    ASSERT_OK(measure("epo", tree, scene, SAMPLES, &again));
    assert_memory_equal(&epo, &again, sizeof epo); /* whatever the threads did */
}

/* Three triangles in the plane z = 0. A: (0,0) (2,0) (0,2), area 2, box [0,2]^2. B: (2,2) (1,2)
 * (2,1), area 1/2, box [1,2]^2, inside of A's. C: (10,0) (11,0) (10,1), area 1/2, far away. Tree:
 * root { N { A, C }, B }; N's box is [0,11] x [0,2].
 *
 * Points of A: in B's box only where x >= 1 and y >= 1, a single point of A: 0. Points of C: in no
 * other node: 0. Points of B: in the leaf of A (Ci = 1) and in N (Ct 2/2 = 1.2), neither holds
 * B: 2.2. The root holds all: never counted. EPO = 2.2 * 0.5 / 3 = 0.36667; variance = 2.2^2 p (1 -
 * p) with p = 1/6. */
static void test_epo_triangles(void **state)
{
    (void)state;
    const float triangles[] = {0, 0, 0, 2, 0,       0, 0, 2,  0, /**/ 2, 2,  0, 1, 2,
                               0, 2, 1, 0, /**/ 10, 0, 0, 11, 0, 0,      10, 1, 0};
    bb_scene *scene = make_scene(triangles, 3, NULL, 0);
    const bb_node nodes[] = {
        make_node(V(0, 0, 0), V(11, 2, 0), 1, BB_NONE),
        make_node(V(0, 0, 0), V(11, 2, 0), 2, 4),
        make_node(V(0, 0, 0), V(2, 2, 0), BB_LEAF_BIT | 0, 3),
        make_node(V(10, 0, 0), V(11, 1, 0), BB_LEAF_BIT | 1, 4),
        make_node(V(1, 1, 0), V(2, 2, 0), BB_LEAF_BIT | 2, BB_NONE),
    };
    const uint32_t refs[] = {0 | BB_LAST_BIT, 2 | BB_LAST_BIT, 1 | BB_LAST_BIT};
    bb_tree tree;
    make_tree(&tree, nodes, 5, refs, 3, 2, 2);
    expect_epo(&tree, scene, 2.2 / 6, 2.2 * 2.2 * 5 / 36);
    bb_tree_release(&tree);
    free_scene(scene);
}

/* Two triangles that make the unit square, in a plane of constant z that no product of it hits by
 * rounding: every point is in the other's box, which is flat. EPO = 1 exactly. Both in one leaf: 0.
 */
static void test_epo_flat(void **state)
{
    (void)state;
    const float z = 0.1f, triangles[] = {0, 0, z, 1, 0, z, 0, 1, z, /**/ 1, 1, z, 0, 1, z, 1, 0, z};
    bb_scene *scene = make_scene(triangles, 2, NULL, 0);
    const bb_node nodes[] = {
        make_node(V(0, 0, z), V(1, 1, z), 1, BB_NONE),
        make_node(V(0, 0, z), V(1, 1, z), BB_LEAF_BIT | 0, 2),
        make_node(V(0, 0, z), V(1, 1, z), BB_LEAF_BIT | 1, BB_NONE),
    };
    const bb_node leaf = make_node(V(0, 0, z), V(1, 1, z), BB_LEAF_BIT | 0, BB_NONE);
    const uint32_t refs[] = {0 | BB_LAST_BIT, 1 | BB_LAST_BIT}, both[] = {0, 1 | BB_LAST_BIT};
    bb_tree tree;
    make_tree(&tree, nodes, 3, refs, 2, 2, 1);
    expect_epo(&tree, scene, 1, 0);
    bb_tree_release(&tree);
    make_tree(&tree, &leaf, 1, both, 2, 0, 0);
    expect_epo(&tree, scene, 0, 0);
    bb_tree_release(&tree);
    free_scene(scene);
}

/* Unit spheres at x = 0 and x = 1.5. The part of the first in the second's box, x >= 0.5, is a cap
 * of area 2 pi 0.5, a quarter of 4 pi; the other way round the same. Each leaf costs 1: EPO = 1/4,
 * variance 3/16. (The boxes are larger by one rounding.) */
static void test_epo_spheres(void **state)
{
    (void)state;
    const float spheres[] = {0, 0, 0, 1, 1.5f, 0, 0, 1};
    bb_scene *scene = make_scene(NULL, 0, spheres, 2);
    const bb_box *boxes = scene->boxes;
    const bb_node nodes[] = {
        make_node(boxes[0].lo, V(boxes[1].hi[0], boxes[0].hi[1], boxes[0].hi[2]), 1, BB_NONE),
        make_node(boxes[0].lo, boxes[0].hi, BB_LEAF_BIT | 0, 2),
        make_node(boxes[1].lo, boxes[1].hi, BB_LEAF_BIT | 1, BB_NONE),
    };
    const uint32_t refs[] = {0 | BB_LAST_BIT, 1 | BB_LAST_BIT};
    bb_tree tree;
    make_tree(&tree, nodes, 3, refs, 2, 2, 1);
    expect_epo(&tree, scene, 0.25, 3.0 / 16);
    bb_tree_release(&tree);
    free_scene(scene);
}

/* A and B of test_epo_triangles; A is listed by two leaves, [0,1] x [0,2] and [1,2] x [0,2], B by
 * one. Points of B are in the second leaf of A: 1. Points of A are in leaves of A only. Three
 * children. EPO = 0.5 / 2.5 = 0.2, variance 0.16. If the second leaf lists B too, no point is in a
 * node without its primitive: 0, but the leaf of [0,1] x [0,2] costs the points of B nothing. */
static void test_epo_duplicated(void **state)
{
    (void)state;
    const float triangles[] = {0, 0, 0, 2, 0, 0, 0, 2, 0, /**/ 2, 2, 0, 1, 2, 0, 2, 1, 0};
    bb_scene *scene = make_scene(triangles, 2, NULL, 0);
    const bb_node nodes[] = {
        make_node(V(0, 0, 0), V(2, 2, 0), 1, BB_NONE),
        make_node(V(0, 0, 0), V(1, 2, 0), BB_LEAF_BIT | 0, 2),
        make_node(V(1, 0, 0), V(2, 2, 0), BB_LEAF_BIT | 1, 3),
        make_node(V(1, 1, 0), V(2, 2, 0), BB_LEAF_BIT | 2, BB_NONE),
    };
    const uint32_t refs[] = {0 | BB_LAST_BIT, 0 | BB_LAST_BIT, 1 | BB_LAST_BIT};
    const uint32_t with_b[] = {0 | BB_LAST_BIT, 0, 1 | BB_LAST_BIT, 1 | BB_LAST_BIT};
    bb_tree tree;
    make_tree(&tree, nodes, 4, refs, 3, 3, 1);
    tree.duplicated = true;
    expect_epo(&tree, scene, 0.2, 0.16);
    bb_tree_release(&tree);
    make_tree(&tree, nodes, 4, with_b, 4, 3, 1);
    tree.nodes[3].first = BB_LEAF_BIT | 3;
    tree.duplicated = true;
    expect_epo(&tree, scene, 0, 0);
    bb_tree_release(&tree);
    free_scene(scene);
}

static void test_epo_without_area(void **state)
{
    (void)state;
    const float triangle[] = {0, 0, 0, 1, 0, 0, 2, 0, 0};
    bb_scene *scene = make_scene(triangle, 1, NULL, 0);
    const bb_node leaf = make_node(V(0, 0, 0), V(2, 0, 0), BB_LEAF_BIT | 0, BB_NONE);
    const uint32_t refs[] = {0 | BB_LAST_BIT};
    bb_tree tree;
    bb_metric_value epo;
    make_tree(&tree, &leaf, 1, refs, 1, 0, 0);
    ASSERT_OK(measure("epo", &tree, scene, 100, &epo));
    assert_true(isnan(epo.value) && isnan(epo.half));
    assert_int_equal(measure("epo", &tree, scene, 0, &epo), BB_INVALID);
    bb_tree_release(&tree);
    free_scene(scene);
}

static void expect_quick(const bb_tree *tree, const bb_scene *scene, uint64_t points)
{
    bb_metric_value quick, exact;
    ASSERT_OK(measure("epo_quick", tree, scene, 1000000, &quick));
    ASSERT_OK(measure("epo", tree, scene, points, &exact));
    assert_memory_equal(&quick, &exact, sizeof quick);
}

/* The estimate is EPO by 65,536 points, or by as many as 2^25 visited nodes allow: here each point
 * is in all leaves, and visits them and the root. */
static void test_epo_quick(void **state)
{
    (void)state;
    enum { LEAVES = 50000 };
    const float pair[] = {0, 0, 0, 2, 0, 0, 0, 2, 0, /**/ 2, 2, 0, 1, 2, 0, 2, 1, 0};
    const bb_node nodes[] = {
        make_node(V(0, 0, 0), V(2, 2, 0), 1, BB_NONE),
        make_node(V(0, 0, 0), V(2, 2, 0), BB_LEAF_BIT | 0, 2),
        make_node(V(1, 1, 0), V(2, 2, 0), BB_LEAF_BIT | 1, BB_NONE),
    };
    const uint32_t two[] = {0 | BB_LAST_BIT, 1 | BB_LAST_BIT};
    bb_scene *scene = make_scene(pair, 2, NULL, 0);
    bb_tree tree;
    make_tree(&tree, nodes, 3, two, 2, 2, 1);
    expect_quick(&tree, scene, 65536);
    bb_tree_release(&tree);
    free_scene(scene);

    float *triangles = malloc(LEAVES * 9 * sizeof *triangles);
    bb_node *all = malloc((LEAVES + 1) * sizeof *all);
    uint32_t *refs = malloc(LEAVES * sizeof *refs);
    all[0] = make_node(V(0, 0, 0), V(2, 2, 0), 1, BB_NONE);
    for (uint32_t i = 0; i < LEAVES; i++) {
        memcpy(triangles + (size_t)9 * i, pair, 9 * sizeof *pair);
        all[i + 1] =
            make_node(V(0, 0, 0), V(2, 2, 0), BB_LEAF_BIT | i, i + 1 < LEAVES ? i + 2 : BB_NONE);
        refs[i] = i | BB_LAST_BIT;
    }
    scene = make_scene(triangles, LEAVES, NULL, 0);
    make_tree(&tree, all, LEAVES + 1, refs, LEAVES, LEAVES, 1);
    expect_quick(&tree, scene, (1 << 25) / (LEAVES + 2));
    bb_tree_release(&tree);
    free_scene(scene);
    free(triangles);
    free(all);
    free(refs);
}

/* ---- random trees, by recursion over all nodes ---- */

/* Adds up the surface area heuristic, times the half area of the root, and marks the nodes whose
 * subtrees hold the primitive. */
static bool walk_all(const bb_tree *tree, uint32_t n, uint32_t prim, bool *holds, double *cost,
                     double *sah)
{
    const bb_node *node = &tree->nodes[n];
    const double x = (double)node->hi[0] - node->lo[0], y = (double)node->hi[1] - node->lo[1],
                 z = (double)node->hi[2] - node->lo[2];
    holds[n] = false;
    cost[n] = 0;
    if (bb_node_is_leaf(node)) {
        bool last = false;
        for (uint32_t at = node->first & BB_INDEX_MASK; !last; at++) {
            last = (tree->refs[at] & BB_LAST_BIT) != 0;
            holds[n] = holds[n] || (tree->refs[at] & BB_INDEX_MASK) == prim;
            cost[n] += 1;
        }
    } else {
        for (uint32_t c = node->first; c != node->skip; c = tree->nodes[c].skip) {
            const bool below = walk_all(tree, c, prim, holds, cost, sah);
            holds[n] = holds[n] || below;
            cost[n] += 0.6;
        }
    }
    *sah += cost[n] * (x * y + y * z + z * x);
    return holds[n];
}

/* The same points, each against all nodes. */
static double naive_epo(const bb_tree *tree, const bb_scene *scene, uint32_t points)
{
    const uint32_t count = tree->info.node_count;
    bool *holds = malloc(count * sizeof *holds);
    double *cost = malloc(count * sizeof *cost), total = 0, sum = 0, sah = 0;
    const bb_prim_kind *kind = bb_prim_kinds[BB_TRIANGLE];
    for (uint32_t i = 0; i < scene->prim_count; i++)
        total += kind->area(scene, i);
    for (uint32_t sample = 0; sample < points; sample++) {
        bb_random random = bb_random_make(SEED, sample);
        double at = bb_random_unit(&random) * total, below = 0, p[3], normal[3];
        uint32_t prim = 0;
        for (;; prim++) {
            below += kind->area(scene, prim);
            if (below > at || prim + 1 == scene->prim_count)
                break;
        }
        kind->sample(scene, prim, &random, p, normal);
        walk_all(tree, tree->info.root, prim, holds, cost, &sah);
        for (uint32_t n = 0; n < count; n++) {
            bool inside = !holds[n];
            for (int k = 0; k < 3; k++)
                inside = inside && tree->nodes[n].lo[k] <= p[k] && p[k] <= tree->nodes[n].hi[k];
            sum += inside ? cost[n] : 0;
        }
    }
    free(holds);
    free(cost);
    return sum / points;
}

static void test_random_trees(void **state)
{
    (void)state;
    enum { POINTS = 5000, RUNS = 12 };
    for (uint32_t run = 0; run < RUNS; run++) {
        bb_random random = bb_random_make(SEED, 1000 + run);
        const uint32_t count = 1 + bb_random_below(&random, run < 3 ? 3 : 120);
        float *v = malloc(9 * (size_t)count * sizeof *v);
        for (uint32_t i = 0; i < 9 * count; i++)
            v[i] = (float)bb_random_range(&random, -100, 100);
        bb_scene *scene = make_scene(v, count, NULL, 0);
        free(v);
        bb_tree tree;
        make_random_tree(scene, 2 + bb_random_below(&random, 8), 1 + bb_random_below(&random, 4),
                         &random, &tree);
        if (run % 3 == 2) { /* as if trees had split primitives: some are listed again */
            for (uint32_t i = 0; i < count / 2; i++) {
                uint32_t *ref = &tree.refs[bb_random_below(&random, count)];
                *ref = (*ref & BB_LAST_BIT) | bb_random_below(&random, count);
            }
            tree.duplicated = true;
        }
        bb_metric_value epo;
        ASSERT_OK(measure("epo", &tree, scene, POINTS, &epo));
        const double expected = naive_epo(&tree, scene, POINTS);
        ASSERT_NEAR(epo.value, expected, 1e-10 * expected);
        bool *holds = malloc(tree.info.node_count * sizeof *holds);
        double *cost = malloc(tree.info.node_count * sizeof *cost), sah = 0;
        walk_all(&tree, tree.info.root, 0, holds, cost, &sah);
        const bb_node *root = &tree.nodes[tree.info.root];
        const double x = (double)root->hi[0] - root->lo[0], y = (double)root->hi[1] - root->lo[1],
                     z = (double)root->hi[2] - root->lo[2];
        sah /= x * y + y * z + z * x;
        ASSERT_NEAR(bb_tree_sah(&tree), sah, 1e-12 * sah);
        free(holds);
        free(cost);
        bb_tree_release(&tree);
        free_scene(scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sah_binary),       cmocka_unit_test(test_sah_wide),
        cmocka_unit_test(test_sah_leaf),         cmocka_unit_test(test_sah_extremes),
        cmocka_unit_test(test_epo_triangles),    cmocka_unit_test(test_epo_flat),
        cmocka_unit_test(test_epo_spheres),      cmocka_unit_test(test_epo_duplicated),
        cmocka_unit_test(test_epo_without_area), cmocka_unit_test(test_epo_quick),
        cmocka_unit_test(test_random_trees),
    };
    return cmocka_run_group_tests_name("metrics", tests, NULL, NULL);
}
