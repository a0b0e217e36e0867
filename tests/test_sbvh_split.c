/* What sbvh splits: cuts that lose nothing; both searches and the partition against plain readings
 * of the paper for few references. Trees: test_sbvh.c. Seed: BVHBENCH_TEST_SEED. */
#include "builders/sbvh/sbvh_split.h"
#include "framework/builder/tree_cover.h"
#include "tests/tree_fixture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { CORNERS = 9, FEW = 64 };

static uint64_t seed = 20261121;

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
 * where the three costs are least, given who came before; none is cut once no more references may
 * be added. */
static void references_go_where_they_cost_least(void **state)
{
    (void)state;
    bb_random random = bb_random_make(seed, 5);
    uint32_t cut = 0, unsplit = 0, refused = 0;
    for (uint32_t run = 0; run < 600; run++) {
        few f;
        open_few(&f, &random, 2 + bb_random_below(&random, FEW - 2));
        sb_split split = sb_find_spatial(f.scene, f.refs, f.count, &f.box, 8, f.count);
        if (split.left == 0) {
            free_scene(f.scene);
            continue;
        }
        sb_ref before[FEW], side[2][FEW];
        memcpy(before, f.refs, f.count * sizeof *before);
        const uint32_t spare = run % 3 == 0 ? bb_random_below(&random, 3) : f.count;
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
            const bool cheaper = !no_left && !no_right && both < left && both < right;
            const bool splits = cheaper && at[0] + at[1] - i < spare;
            const int whole = no_left ? 1 : no_right ? 0 : left <= right ? 0 : 1;
            for (int s = 0; s < 2; s++)
                if (splits || s == whole) {
                    side[s][at[s]++] = (sb_ref){splits ? parts[s] : ref->box, ref->prim};
                    boxes[s] = grown[s][splits];
                    counts[s]++;
                }
            cut += splits;
            unsplit += !splits;
            refused += cheaper && !splits;
        }
        sb_part_spatial(f.scene, f.refs, f.count, spare, &split, f.scratch);
        assert_int_equal(split.left, at[0]);
        assert_int_equal(split.right, at[1]);
        assert_memory_equal(f.refs, side[1], at[1] * sizeof(sb_ref));
        assert_memory_equal(f.refs + at[1], side[0], at[0] * sizeof(sb_ref));
        free_scene(f.scene);
    }
    assert_true(cut > 100 && unsplit > 100 && refused > 30);
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
    free_scene(scene);
}

int main(void)
{
    seed = seed_or(seed);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cuts_lose_nothing),
        cmocka_unit_test(cuts_of_tetrahedra_and_boxes_lose_nothing),
        cmocka_unit_test(objects_are_split_where_it_costs_least),
        cmocka_unit_test(space_is_split_where_it_costs_least),
        cmocka_unit_test(references_go_where_they_cost_least),
        cmocka_unit_test(slabs_thinner_than_floats_are_none),
    };
    return cmocka_run_group_tests_name("sbvh_split", tests, NULL, NULL);
}
