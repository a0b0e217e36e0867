/* sbvh: cuts that lose nothing, both searches and the partition against plain readings of the paper
 * for few references; memory, determinism, degenerate and extreme inputs, kinds; what is refused.
 * Seed: BVHBENCH_TEST_SEED. */
#include "builders/sbvh/sbvh_split.h"
#include "framework/builder/instance.h"
#include "framework/tree/tree_cover.h"
#include "tests/builder_fixture.h"
#include "tests/quality_inputs.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { CORNERS = 9, FEW = 64 };

/* ---- cuts ---- */

static bb_box box_of(const sb_bounds *bounds)
{
    bb_box box = {0};
    memcpy(box.lo, bounds->lo, sizeof box.lo);
    memcpy(box.hi, bounds->hi, sizeof box.hi);
    return box;
}

static sb_bounds bounds_of(const bb_box *box)
{
    sb_bounds bounds;
    memcpy(bounds.lo, box->lo, sizeof bounds.lo);
    memcpy(bounds.hi, box->hi, sizeof bounds.hi);
    return bounds;
}

/* Cut at random into up to 32 parts; they cover primitive 0. Returns their area together, relative
 * to the whole's. */
static double cut_at_random(const bb_scene *scene, bb_random *random, uint32_t run)
{
    enum { PARTS = 32 };
    sb_ref parts[PARTS] = {{bounds_of(&scene->boxes[0]), 0}};
    uint32_t count = 1;
    for (uint32_t tries = 0; tries < 4 * PARTS && count < PARTS; tries++) {
        sb_ref *part = &parts[bb_random_below(random, count)];
        int axis = (int)bb_random_below(random, 3);
        float plane = (float)bb_random_range(random, part->box.lo[axis], part->box.hi[axis]);
        sb_bounds sides[2];
        if (!(part->box.lo[axis] < plane && plane < part->box.hi[axis]))
            continue;
        sb_cut(scene, part, axis, plane, sides);
        for (int k = 0; k < 3; k++)
            for (int side = 0; side < 2; side++)
                if (sides[side].lo[0] <= sides[side].hi[0]) {
                    assert_true(sides[side].lo[k] >= part->box.lo[k]);
                    assert_true(sides[side].hi[k] <= part->box.hi[k]);
                    assert_true(sides[side].lo[k] <= sides[side].hi[k]);
                }
        assert_true(sides[0].hi[axis] <= plane && sides[1].lo[axis] >= plane);
        bool two = sides[0].lo[0] <= sides[0].hi[0] && sides[1].lo[0] <= sides[1].hi[0];
        part->box = sides[0].lo[0] <= sides[0].hi[0] ? sides[0] : sides[1];
        if (two)
            parts[count++] = (sb_ref){sides[1], 0};
    }
    bb_box boxes[PARTS];
    double point[3], sum = 0;
    bool covered;
    for (uint32_t i = 0; i < count; i++) {
        boxes[i] = box_of(&parts[i].box);
        sum += sb_area(&parts[i].box);
    }
    ASSERT_OK(bb_cover_primitive(scene, 0, boxes, count, &covered, point));
    if (!covered)
        fail_msg("run %u, seed %llu: (%.9g %.9g %.9g) is in no part", run, (unsigned long long)seed,
                 point[0], point[1], point[2]);
    return sum / bb_half_area(scene->boxes[0].lo, scene->boxes[0].hi);
}

static void cuts_lose_nothing(void **state)
{
    (void)state;
    enum { RUNS = 3000 };
    bb_random random = bb_random_make(seed, 1);
    double kept = 0;
    for (uint32_t run = 0; run < RUNS; run++) {
        float corners[CORNERS];
        double away = pow(10, bb_random_range(&random, -3, 6)), thin = run % 3 == 0 ? 1e-6 : 1;
        double scale = run % 7 == 0 ? 0x1p-130 : run % 7 == 1 ? 0x1p90 : 1;
        for (int i = 0; i < CORNERS; i++)
            corners[i] =
                (float)(scale * ((run % 2) * away +
                                 bb_random_unit(&random) * (i % 3 == (int)(run % 5) ? thin : 1)));
        bb_scene *scene = make_scene(corners, 1, NULL, 0);
        kept += fmin(cut_at_random(scene, &random, run), 32) / RUNS;
        free_scene(scene);
    }
    assert_true(kept < 4);
}

static void cuts_of_tetrahedra_and_boxes_lose_nothing(void **state)
{
    (void)state;
    static const char *const scenes[] = {"tets:side=1", "blocks:side=1"};
    bb_random random = bb_random_make(seed, 2);
    for (size_t s = 0; s < sizeof scenes / sizeof scenes[0]; s++) {
        bb_scene *scene;
        ASSERT_OK(bb_scene_load(scenes[s], &scene));
        for (uint32_t run = 0; run < 100; run++)
            cut_at_random(scene, &random, run);
        bb_scene_free(scene);
    }
}

/* ---- few references, by definition ---- */

typedef struct few {
    bb_scene *scene;
    sb_ref refs[2 * FEW], scratch[FEW];
    uint32_t count;
    sb_bounds box;
} few;

/* Triangles of many sizes, some of them cut before. */
static void open_few(few *f, bb_random *random, uint32_t count)
{
    float corners[FEW * CORNERS];
    for (uint32_t i = 0; i < count; i++) {
        double centre[3], size = ldexp(1, -(int)bb_random_below(random, 6));
        for (int k = 0; k < 3; k++)
            centre[k] = bb_random_range(random, -1, 1);
        for (int c = 0; c < CORNERS; c++)
            corners[CORNERS * i + c] =
                (float)(centre[c % 3] + size * bb_random_range(random, -1, 1));
    }
    f->scene = make_scene(corners, count, NULL, 0);
    f->count = count;
    f->box = sb_nothing();
    for (uint32_t i = 0; i < count; i++) {
        sb_bounds sides[2];
        f->refs[i] = (sb_ref){bounds_of(&f->scene->boxes[i]), i};
        const int axis = (int)(i % 3);
        sb_cut(f->scene, &f->refs[i], axis, sb_centroid(&f->refs[i], axis), sides);
        if (i % 4 == 0)
            f->refs[i].box = sides[i % 8 == 0 ? 0 : 1];
        sb_grow(&f->box, &f->refs[i].box);
    }
}

/* Each plane by itself: who is below it by the middle of its box. */
static void objects_are_split_where_it_costs_least(void **state)
{
    (void)state;
    bb_random random = bb_random_make(seed, 3);
    for (uint32_t run = 0; run < 200; run++) {
        few f;
        const uint32_t bins = 2 + bb_random_below(&random, 40);
        open_few(&f, &random, 2 + bb_random_below(&random, FEW - 2));
        double best = INFINITY;
        for (int axis = 0; axis < 3; axis++) {
            double low = INFINITY, high = -INFINITY;
            for (uint32_t i = 0; i < f.count; i++) {
                low = fmin(low, sb_centroid(&f.refs[i], axis));
                high = fmax(high, sb_centroid(&f.refs[i], axis));
            }
            for (uint32_t k = 1; k < bins; k++) {
                sb_bounds sides[2] = {sb_nothing(), sb_nothing()};
                uint32_t counts[2] = {0, 0};
                for (uint32_t i = 0; i < f.count; i++) {
                    double bin = (sb_centroid(&f.refs[i], axis) - low) * (bins / (high - low));
                    int side = !(floor(bin) < k);
                    sb_grow(&sides[side], &f.refs[i].box);
                    counts[side]++;
                }
                double cost = sb_area(&sides[0]) * counts[0] + sb_area(&sides[1]) * counts[1];
                if (counts[0] > 0 && counts[1] > 0)
                    best = fmin(best, cost);
            }
        }
        sb_split split = sb_find_object(f.refs, f.count, bins);
        if (split.left + split.right != f.count || fabs(split.cost - best) > 1e-12 * best)
            fail_msg("run %u, seed %llu: cost %.17g, should be %.17g", run,
                     (unsigned long long)seed, split.cost, best);
        sb_part_object(f.refs, f.count, &split, bins, f.scratch);
        sb_bounds sides[2] = {sb_nothing(), sb_nothing()};
        for (uint32_t i = 0; i < f.count; i++)
            sb_grow(&sides[i < split.right], &f.refs[i].box);
        assert_memory_equal(sides, split.sides, sizeof sides);
        free_scene(f.scene);
    }
}

/* The part of a reference between two planes, cut at one, then at the other, from below. */
static sb_bounds part_between(const bb_scene *scene, sb_ref ref, int axis, const float *planes,
                              uint32_t slab, uint32_t bins)
{
    for (uint32_t k = 1; k <= slab + 1 && k < bins; k++) {
        sb_bounds sides[2];
        if (ref.box.lo[0] > ref.box.hi[0])
            break;
        if (ref.box.hi[axis] <= planes[k]) /* all below: of a slab before, or of this */
            return k <= slab && ref.box.lo[axis] < planes[k] ? sb_nothing() : ref.box;
        if (ref.box.lo[axis] >= planes[k]) {
            if (k == slab + 1)
                return sb_nothing();
            continue;
        }
        sb_cut(scene, &ref, axis, planes[k], sides);
        if (k == slab + 1)
            return sides[0];
        ref.box = sides[1];
    }
    return ref.box;
}

/* Each plane by itself: parts of all references in all slabs below and above. */
static void space_is_split_where_it_costs_least(void **state)
{
    (void)state;
    bb_random random = bb_random_make(seed, 4);
    uint32_t tight = 0;
    for (uint32_t run = 0; run < 60; run++) {
        few f;
        const uint32_t bins = 2 + bb_random_below(&random, 14);
        open_few(&f, &random, 2 + bb_random_below(&random, FEW - 2));
        const uint32_t spare = run % 2 == 0 ? f.count : bb_random_below(&random, 4);
        double best = INFINITY;
        for (int axis = 0; axis < 3; axis++) {
            float planes[SB_BINS_MAX + 1];
            const double low = f.box.lo[axis], extent = (double)f.box.hi[axis] - low;
            for (uint32_t k = 0; k <= bins; k++)
                planes[k] = (float)(low + extent * k / bins);
            for (uint32_t k = 1; k < bins; k++) {
                sb_bounds sides[2] = {sb_nothing(), sb_nothing()};
                uint32_t counts[2] = {0, 0};
                for (uint32_t i = 0; i < f.count; i++) {
                    bool has[2] = {false, false};
                    for (uint32_t slab = 0; slab < bins; slab++) {
                        sb_bounds part = part_between(f.scene, f.refs[i], axis, planes, slab, bins);
                        if (part.lo[0] > part.hi[0])
                            continue;
                        sb_grow(&sides[slab >= k], &part);
                        has[slab >= k] = true;
                    }
                    counts[0] += has[0];
                    counts[1] += has[1];
                }
                double cost = sb_area(&sides[0]) * counts[0] + sb_area(&sides[1]) * counts[1];
                if (counts[0] > 0 && counts[1] > 0 && counts[0] + counts[1] - f.count <= spare)
                    best = fmin(best, cost);
            }
        }
        sb_split split = sb_find_spatial(f.scene, f.refs, f.count, &f.box, bins, spare);
        tight += spare < f.count;
        if (split.left == 0 ? isfinite(best) : fabs(split.cost - best) > 1e-12 * best)
            fail_msg("run %u, seed %llu, %u slabs, %u to spare: cost %.17g, should be %.17g", run,
                     (unsigned long long)seed, bins, spare, split.left == 0 ? NAN : split.cost,
                     best);
        free_scene(f.scene);
    }
    assert_true(tight > 20);
}

/* Each reference is on one side whole, or in two parts that cover it; those across the plane are
 * where the paper's three costs are least, given who came before. */
static void references_go_where_they_cost_least(void **state)
{
    (void)state;
    bb_random random = bb_random_make(seed, 5);
    uint32_t cut = 0, unsplit = 0;
    for (uint32_t run = 0; run < 300; run++) {
        few f;
        open_few(&f, &random, 2 + bb_random_below(&random, FEW - 2));
        sb_split split = sb_find_spatial(f.scene, f.refs, f.count, &f.box, 8, f.count);
        if (split.left == 0) {
            free_scene(f.scene);
            continue;
        }
        sb_ref before[FEW], side[2][FEW];
        memcpy(before, f.refs, f.count * sizeof *before);
        uint32_t counts[2] = {0, 0}, at[2] = {0, 0};
        sb_bounds boxes[2] = {sb_nothing(), sb_nothing()};
        for (uint32_t i = 0; i < f.count; i++) {
            bool right = before[i].box.lo[split.axis] >= split.plane;
            if (right || before[i].box.hi[split.axis] <= split.plane) {
                sb_grow(&boxes[right], &before[i].box);
                counts[right]++;
            }
        }
        for (uint32_t i = 0; i < f.count; i++) {
            const sb_ref *ref = &before[i];
            sb_bounds parts[2], grown[2][2];
            if (ref->box.lo[split.axis] >= split.plane || ref->box.hi[split.axis] <= split.plane) {
                bool right = ref->box.lo[split.axis] >= split.plane;
                side[right][at[right]++] = *ref;
                continue;
            }
            sb_cut(f.scene, ref, split.axis, split.plane, parts);
            for (int s = 0; s < 2; s++) {
                grown[s][0] = grown[s][1] = boxes[s];
                sb_grow(&grown[s][0], &ref->box);
                sb_grow(&grown[s][1], &parts[s]);
            }
            const double l = counts[0], r = counts[1];
            const double both = sb_area(&grown[0][1]) * (l + 1) + sb_area(&grown[1][1]) * (r + 1);
            const double left = sb_area(&grown[0][0]) * (l + 1) + sb_area(&boxes[1]) * r;
            const double right = sb_area(&boxes[0]) * l + sb_area(&grown[1][0]) * (r + 1);
            const bool no_left = parts[0].lo[0] > parts[0].hi[0];
            const bool no_right = parts[1].lo[0] > parts[1].hi[0];
            const bool splits = !no_left && !no_right && both < left && both < right;
            const int whole = no_left ? 1 : no_right ? 0 : left <= right ? 0 : 1;
            for (int s = 0; s < 2; s++)
                if (splits || s == whole) {
                    side[s][at[s]++] = (sb_ref){splits ? parts[s] : ref->box, ref->prim};
                    boxes[s] = grown[s][splits];
                    counts[s]++;
                }
            cut += splits;
            unsplit += !splits;
        }
        sb_part_spatial(f.scene, f.refs, f.count, &split, f.scratch);
        assert_int_equal(split.left, at[0]);
        assert_int_equal(split.right, at[1]);
        assert_memory_equal(f.refs, side[1], at[1] * sizeof(sb_ref));
        assert_memory_equal(f.refs + at[1], side[0], at[0] * sizeof(sb_ref));
        free_scene(f.scene);
    }
    assert_true(cut > 100 && unsplit > 100);
}

/* ---- trees ---- */

static bb_scene *load(const char *name)
{
    bb_scene *scene;
    ASSERT_OK(bb_scene_load(name, &scene));
    return scene;
}

/* Two builds: the same tree, valid, within the budget of references and memory. */
static void build_twice(made *m, const bb_scene *scene, double budget)
{
    build(m, scene);
    const uint64_t hash = hash_of(m), most = (uint64_t)(budget * scene->prim_count);
    build(m, scene);
    assert_true(hash_of(m) == hash);
    assert_true(m->tree.info.ref_count >= scene->prim_count && m->tree.info.ref_count <= most);
    assert_int_equal(m->tree.duplicated, m->tree.info.ref_count > scene->prim_count);
    const uint64_t nodes = 2 * most * sizeof(bb_node), refs = most * sizeof(uint32_t);
    const uint64_t own = (most + scene->prim_count) * sizeof(sb_ref);
    assert_true(m->account.peak <= nodes + refs + own + 1000000);
}

static void trees_are_covered_and_within_the_budget(void **state)
{
    (void)state;
    static const char *const scenes[] = {
        "interior:n=3000", "hairball:n=300",          "slivers:aspect=40",
        "random:n=1000",   "spheres:n=1000",          "blocks:side=6,mixed=yes",
        "tets:side=4",     "awkward:kind=axis,n=500", "awkward:kind=zeros,n=500",
        "single"};
    static const double budgets[] = {1, 1.1, 2, 5};
    for (size_t s = 0; s < sizeof scenes / sizeof scenes[0]; s++) {
        bb_scene *scene = load(scenes[s]);
        for (size_t i = 0; i < sizeof budgets / sizeof budgets[0]; i++) {
            char text[64];
            made m;
            snprintf(text, sizeof text, "sbvh:alpha=0,budget=%g,leaf=%d", budgets[i],
                     i % 2 == 0 ? 1 : 4);
            open_builder(text, &m);
            build_twice(&m, scene, budgets[i]);
            if (scene->kinds == BB_SPHERES)
                assert_int_equal(m.tree.info.ref_count, scene->prim_count);
            close_builder(&m);
        }
        bb_scene_free(scene);
    }
}

/* What forbids splits of space gives the tree of objects, whichever way; splits lower the cost of
 * what lies askew. */
static void splits_pay_where_boxes_are_empty(void **state)
{
    (void)state;
    bb_scene *scene = load("slivers:aspect=40");
    made none, budget, split;
    open_builder("sbvh:alpha=1", &none);
    open_builder("sbvh:budget=1", &budget);
    open_builder("sbvh", &split);
    build(&none, scene);
    build(&budget, scene);
    build(&split, scene);
    assert_true(hash_of(&none) == hash_of(&budget));
    assert_int_equal(event(&none, "spatial"), 0);
    assert_true(event(&split, "spatial") > 10);
    assert_true(bb_tree_sah(&split.tree) < 0.7 * bb_tree_sah(&none.tree));
    close_builder(&none);
    close_builder(&budget);
    close_builder(&split);
    bb_scene_free(scene);
}

/* Triangles from corner to corner of boxes that are awkward. */
static void degenerate_inputs_end(void **state)
{
    (void)state;
    static const uint32_t counts[] = {1, 2, 3, 50, 600};
    for (size_t k = 0; k < QUALITY_INPUTS; k++)
        for (size_t c = 0; c < sizeof counts / sizeof counts[0]; c++) {
            const uint32_t count = counts[c];
            bb_box *boxes = make_boxes(quality_inputs, k, count);
            float *corners = triangles_of_boxes(boxes, count);
            bb_scene *scene = make_scene(corners, count, NULL, 0);
            made m;
            open_builder("sbvh:alpha=0", &m);
            build_twice(&m, scene, 2);
            assert_true(m.tree.info.depth < 200);
            close_builder(&m);
            free_scene(scene);
            free(corners);
            free(boxes);
        }
}

/* Of triangles that lie on each other no split saves anything: a leaf takes as many as it may. */
static void leaves_are_as_large_as_they_may_be(void **state)
{
    (void)state;
    static const uint32_t leaves[] = {1, 2, 7, 255};
    for (size_t i = 0; i < sizeof leaves / sizeof leaves[0]; i++)
        for (uint32_t count = leaves[i]; count <= leaves[i] + 1; count++) {
            float *corners = malloc(CORNERS * (size_t)count * sizeof *corners);
            for (uint32_t c = 0; c < CORNERS * count; c++)
                corners[c] = (float)(c % CORNERS * (c % CORNERS));
            bb_scene *scene = make_scene(corners, count, NULL, 0);
            char text[32];
            made m;
            snprintf(text, sizeof text, "sbvh:alpha=1,leaf=%u", leaves[i]);
            open_builder(text, &m);
            build_twice(&m, scene, 2);
            assert_int_equal(m.tree.info.node_count, count == leaves[i] ? 1 : 3);
            close_builder(&m);
            free_scene(scene);
            free(corners);
        }
}

/* Node by node of the preorder: how deep it is. */
static uint32_t *depths_of(const bb_tree *tree)
{
    uint32_t *depths = calloc(tree->info.node_count, sizeof *depths);
    for (uint32_t i = 0; i < tree->info.node_count; i++)
        if (!bb_node_is_leaf(&tree->nodes[i]))
            for (uint32_t c = i + 1; c != tree->nodes[i].skip; c = tree->nodes[c].skip)
                depths[c] = depths[i] + 1;
    return depths;
}

/* Below the depth at which splits of space end, no primitive is in two leaves of one node. Heaps of
 * slivers, each 16 times as large as the one before, make a deep tree with work at its end. */
static void splits_of_space_end_somewhere(void **state)
{
    (void)state;
    enum { COUNT = 360, HEAP = 6, DEEPEST = 48 };
    bb_random random = bb_random_make(seed, 6);
    float corners[CORNERS * COUNT];
    for (uint32_t i = 0; i < CORNERS * COUNT; i++) {
        const int octave = 4 * (int)(i / CORNERS / HEAP) - 2 * COUNT / HEAP;
        const double place = i % CORNERS < 6 ? bb_random_range(&random, 1, 2) : 0.01;
        corners[i] = ldexpf((float)place, octave) + (i % CORNERS < 6 ? 0 : corners[i - 6]);
    }
    bb_scene *scene = make_scene(corners, COUNT, NULL, 0);
    bb_tree tree;
    made m;
    open_builder("sbvh:alpha=0,budget=16", &m);
    build(&m, scene);
    bb_tree_init(&tree, NULL);
    ASSERT_OK(bb_tree_preorder(&m.tree, &tree));
    uint32_t *depths = depths_of(&tree), seen[COUNT] = {0}, deep = 0;
    for (uint32_t i = 0, top = 0; i < tree.info.node_count; i++) {
        top = depths[i] == DEEPEST ? i + 1 : top;
        if (depths[i] < DEEPEST || !bb_node_is_leaf(&tree.nodes[i]))
            continue;
        const uint32_t prim = tree.refs[tree.nodes[i].first & BB_INDEX_MASK] & BB_INDEX_MASK;
        if (seen[prim] == top)
            fail_msg("seed %llu: primitive %u is twice below node %u", (unsigned long long)seed,
                     prim, top - 1);
        seen[prim] = top;
        deep += depths[i] > DEEPEST;
    }
    free(depths);
    bb_tree_release(&tree);
    close_builder(&m);
    free_scene(scene);
    assert_true(deep > 20);
}

/* The sides of a node overlap by no more than its own area: below nodes of less than alpha of the
 * root's no primitive is in two leaves, if splits by objects are found everywhere. */
static void alpha_is_a_share_of_the_roots_area(void **state)
{
    (void)state;
    const double alpha = 0.02;
    bb_scene *scene = load("soup:n=1000,edge=6,aspect=100");
    bb_tree tree;
    made m;
    open_builder("sbvh:alpha=0.02,budget=4", &m);
    build(&m, scene);
    assert_true(event(&m, "spatial") > 10);
    bb_tree_init(&tree, NULL);
    ASSERT_OK(bb_tree_preorder(&m.tree, &tree));
    const bb_node *nodes = tree.nodes;
    const double least = alpha * bb_half_area(nodes[0].lo, nodes[0].hi);
    uint32_t *seen = calloc(scene->prim_count, sizeof *seen);
    for (uint32_t i = 0, end = 0, top = 0; i < tree.info.node_count; i++) {
        if (i >= end && bb_half_area(nodes[i].lo, nodes[i].hi) < least) {
            end = nodes[i].skip == BB_NONE ? tree.info.node_count : nodes[i].skip;
            top = i + 1;
        }
        if (i >= end || !bb_node_is_leaf(&nodes[i]))
            continue;
        const uint32_t prim = tree.refs[nodes[i].first & BB_INDEX_MASK] & BB_INDEX_MASK;
        if (seen[prim] == top)
            fail_msg("primitive %u is twice below node %u", prim, top - 1);
        seen[prim] = top;
    }
    free(seen);
    bb_tree_release(&tree);
    close_builder(&m);
    bb_scene_free(scene);
}

/* Thinner than any slab can be: no plane between two floats. */
static void slabs_thinner_than_floats_are_none(void **state)
{
    (void)state;
    float corners[8 * CORNERS];
    for (int i = 0; i < 8 * CORNERS; i++)
        corners[i] = i % 3 == 0 && i % 2 == 0 ? nextafterf(1e6f, INFINITY) : 1e6f;
    bb_scene *scene = make_scene(corners, 8, NULL, 0);
    sb_ref refs[8];
    sb_bounds box = sb_nothing();
    for (uint32_t i = 0; i < 8; i++) {
        refs[i] = (sb_ref){bounds_of(&scene->boxes[i]), i};
        sb_grow(&box, &refs[i].box);
    }
    assert_int_equal(sb_find_spatial(scene, refs, 8, &box, 16, 8).left, 0);
    made m;
    open_builder("sbvh:alpha=0", &m);
    build_twice(&m, scene, 2);
    assert_int_equal(m.tree.info.ref_count, 8);
    close_builder(&m);
    free_scene(scene);
}

/* ---- what is refused, and what comes after ---- */

static void bad_options_and_orders_are_refused(void **state)
{
    (void)state;
    static const char *const options[][2] = {
        {"sbvh:alpha=2", "must be a number from 0 to 1"},
        {"sbvh:budget=0.5", "must be a number from 1 to 16"},
        {"sbvh:slabs=1", "'slabs'"},
        {"sbvh:bins=257", "'bins'"},
        {"sbvh:leaf=0", "'leaf'"},
    };
    static const char *const orders[][2] = {
        {"presplit+sbvh", "reads the primitives' geometry"},
        {"lbvh+sbvh", "takes no tree"},
        {"sbvh+presplit", "can only come first"},
        {"rotate+sbvh", "takes another builder's tree"},
        {"sbvh+sbvh", "takes no tree"},
    };
    for (size_t i = 0; i < sizeof options / sizeof options[0]; i++) {
        made m;
        assert_int_equal(try_builder(options[i][0], &m), BB_INVALID);
        assert_non_null(strstr(bb_message(), options[i][1]));
        assert_null(m.self);
    }
    for (size_t i = 0; i < sizeof orders / sizeof orders[0]; i++) {
        assert_int_equal(bb_instance_check(orders[i][0]), BB_INVALID);
        if (strstr(bb_message(), orders[i][1]) == NULL || strchr(bb_message(), '\n') != NULL)
            fail_msg("'%s': expected '%s' in '%s'", orders[i][0], orders[i][1], bb_message());
    }
}

/* An optimiser takes its tree; a refit can't follow it, and the harness builds again. */
static void later_stages_take_duplicates(void **state)
{
    (void)state;
    static const char *const builders[] = {
        "sbvh",          "sbvh+rotate",        "sbvh+refit", "sbvh+trbvh", "sbvh+atrbvh+rotate",
        "sbvh+reinsert", "sbvh+reinsert+trbvh"};
    for (size_t i = 0; i < sizeof builders / sizeof builders[0]; i++) {
        bb_scene *scene = load("wave:n=800,strips=6,frames=3");
        bb_instance instance;
        bb_update_way way;
        uint32_t changed;
        ASSERT_OK(bb_scene_upload(scene, device));
        ASSERT_OK(bb_instance_create(device, builders[i], scene, 1, &instance));
        ASSERT_OK(bb_instance_build(&instance, scene, false, NULL));
        ASSERT_OK(bb_scene_set_frame(scene, 1, &changed));
        ASSERT_OK(bb_instance_update(&instance, scene, changed, false, &way, NULL));
        ASSERT_OK(bb_tree_download(&instance.tree, NULL));
        if (bb_tree_check(&instance.tree, scene) != BB_OK)
            fail_msg("%s: %s", builders[i], bb_message());
        assert_int_equal(way, BB_REBUILT);
        assert_true(instance.tree.duplicated);
        bb_instance_destroy(&instance);
        bb_scene_free(scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cuts_lose_nothing),
        cmocka_unit_test(cuts_of_tetrahedra_and_boxes_lose_nothing),
        cmocka_unit_test(objects_are_split_where_it_costs_least),
        cmocka_unit_test(space_is_split_where_it_costs_least),
        cmocka_unit_test(references_go_where_they_cost_least),
        cmocka_unit_test(trees_are_covered_and_within_the_budget),
        cmocka_unit_test(splits_pay_where_boxes_are_empty),
        cmocka_unit_test(degenerate_inputs_end),
        cmocka_unit_test(leaves_are_as_large_as_they_may_be),
        cmocka_unit_test(splits_of_space_end_somewhere),
        cmocka_unit_test(alpha_is_a_share_of_the_roots_area),
        cmocka_unit_test(slabs_thinner_than_floats_are_none),
        cmocka_unit_test(bad_options_and_orders_are_refused),
        cmocka_unit_test(later_stages_take_duplicates),
    };
    return cmocka_run_group_tests_name("sbvh", tests, open_device, close_device);
}
