/* Early split clipping (presplit:saves=, presplit_esc.c) against a search through all boxes; clips
 * of primitives, whose parts cover. */
#include "builders/presplit/clip.h"
#include "framework/builder/tree_cover.h"
#include "tests/pipeline_fixture.h"

static void splits_are_covered_and_within_the_budget(void **state)
{
    (void)state;
    static const char *const scenes[] = {"interior:n=3000",   "hairball:n=1000",
                                         "random:n=1000",     "spheres:n=1000,state=initial",
                                         "slivers:aspect=40", "awkward:kind=axis,n=500",
                                         "blocks:side=6",     "blocks:side=6,mixed=yes"};
    static const char *const builders[] = {"sah", "lbvh", "llbvh", "lobvh"};
    for (size_t s = 0; s < sizeof scenes / sizeof scenes[0]; s++) {
        bb_scene *scene = load(scenes[s]);
        for (size_t i = 0; i < sizeof builders / sizeof builders[0]; i++) {
            char text[128];
            built b;
            snprintf(text, sizeof text, "presplit:budget=3,above=0.1,saves=-1+%s", builders[i]);
            build(scene, text, &b);
            assert_int_equal(b.instance.tree.info.ref_count, b.instance.references.count);
            if (scene->kinds == BB_SPHERES) /* they stay whole */
                assert_int_equal(b.instance.references.count, scene->prim_count);
            else
                assert_true(b.instance.references.count > scene->prim_count);
            assert_true(b.instance.references.count <= 3 * scene->prim_count);
            assert_int_equal(b.instance.tree.duplicated, scene->kinds != BB_SPHERES);
            bb_instance_destroy(&b.instance);
        }
        bb_scene_free(scene);
    }
}

/* Halves reference `index` as presplit_esc.c says, or leaves it. */
static bool halve(const bb_scene *scene, bb_box *boxes, const uint32_t *prims, uint32_t index,
                  uint32_t count, double saves)
{
    const bb_prims *spheres = &scene->prims[BB_SPHERE];
    bb_box halves[2] = {boxes[index], boxes[index]};
    int axis = 0;
    for (int k = 1; k < 3; k++)
        if ((double)halves[0].hi[k] - halves[0].lo[k] >
            (double)halves[0].hi[axis] - halves[0].lo[axis])
            axis = k;
    const float middle = 0.5f * halves[0].lo[axis] + 0.5f * halves[0].hi[axis];
    if (prims[index] - spheres->first < spheres->count || !(halves[0].lo[axis] < middle) ||
        !(middle < halves[0].hi[axis]))
        return false;
    halves[0].hi[axis] = halves[1].lo[axis] = middle;
    double sum = 0;
    for (int i = 0; i < 2; i++) {
        bb_clip_primitive(scene, prims[index], &halves[i]);
        sum += bb_half_area(halves[i].lo, halves[i].hi);
    }
    if (sum > (1 - saves) * bb_half_area(boxes[index].lo, boxes[index].hi))
        return false;
    boxes[index] = halves[0];
    boxes[count] = halves[1];
    return true;
}

/* The largest box first, the first of several, found by looking at all of them. */
static void the_largest_boxes_are_split_first(void **state)
{
    (void)state;
    static const char *const scenes[] = {"slivers:aspect=40", "interior:n=1000", "blinds:n=10",
                                         "blocks:side=4,mixed=yes"};
    const double above = 0.1, saves = 0.05;
    for (size_t s = 0; s < sizeof scenes / sizeof scenes[0]; s++) {
        bb_scene *scene = load(scenes[s]);
        const uint32_t most = (uint32_t)(1.25 * scene->prim_count);
        bb_box *boxes = malloc(most * sizeof *boxes);
        uint32_t *prims = malloc(most * sizeof *prims), count = scene->prim_count, largest;
        bool *done = calloc(most, sizeof *done);
        double sum = 0, area;
        built b;
        for (uint32_t i = 0; i < count; i++) {
            boxes[i] = scene->boxes[i];
            prims[i] = i;
            sum += bb_half_area(boxes[i].lo, boxes[i].hi);
        }
        const double least = above * sum / count;
        do {
            largest = BB_NONE;
            double most_area = least;
            for (uint32_t i = 0; i < count; i++) {
                area = bb_half_area(boxes[i].lo, boxes[i].hi);
                if (!done[i] && area > most_area) {
                    most_area = area;
                    largest = i;
                }
            }
            if (largest == BB_NONE)
                break;
            if (halve(scene, boxes, prims, largest, count, saves))
                prims[count++] = prims[largest];
            else
                done[largest] = true;
        } while (count < most);
        build(scene, "presplit:budget=1.25,above=0.1,saves=0.05+sah", &b);
        const bb_references *made = &b.instance.references;
        assert_true(count > scene->prim_count + 10);
        assert_int_equal(made->count, count);
        for (uint32_t i = 0; i < count; i++) {
            assert_memory_equal(made->boxes[i].lo, boxes[i].lo, sizeof boxes[i].lo);
            assert_memory_equal(made->boxes[i].hi, boxes[i].hi, sizeof boxes[i].hi);
            assert_int_equal(made->prims[i], prims[i]);
        }
        bb_instance_destroy(&b.instance);
        free(boxes);
        free(prims);
        free(done);
        bb_scene_free(scene);
    }
}

/* Triangles cut in two again and again, also far from the origin and thin beside it: the parts
 * cover. */
static void clips_lose_nothing(void **state)
{
    (void)state;
    enum { RUNS = 3000, PARTS = 32 };
    bb_random random = bb_random_make(SEED, 1);
    double kept = 0;
    for (uint32_t run = 0; run < RUNS; run++) {
        float corners[9];
        double away = pow(10, bb_random_range(&random, -3, 6)), thin = run % 3 == 0 ? 1e-6 : 1;
        for (int i = 0; i < 9; i++)
            corners[i] = (float)((run % 2) * away +
                                 bb_random_unit(&random) * (i % 3 == (int)(run % 5) ? thin : 1));
        bb_scene *scene = make_scene(corners, 1, NULL, 0);
        bb_box parts[PARTS] = {scene->boxes[0]};
        double whole = bb_half_area(parts[0].lo, parts[0].hi), sum = 0;
        uint32_t count = 1;
        while (count < PARTS) {
            bb_box *box = &parts[bb_random_below(&random, count)], *other = &parts[count++];
            int axis = (int)bb_random_below(&random, 3);
            *other = *box;
            float middle = 0.5f * box->lo[axis] + 0.5f * box->hi[axis];
            box->hi[axis] = other->lo[axis] = middle;
            bb_clip_primitive(scene, 0, box);
            bb_clip_primitive(scene, 0, other);
            assert_true(box->lo[0] <= box->hi[0] && other->lo[2] <= other->hi[2]);
        }
        bool covered;
        double point[3];
        ASSERT_OK(bb_cover_primitive(scene, 0, parts, count, &covered, point));
        if (!covered)
            fail_msg("run %u: (%.9g %.9g %.9g) is in no part", run, point[0], point[1], point[2]);
        for (uint32_t i = 0; i < count; i++)
            sum += bb_half_area(parts[i].lo, parts[i].hi);
        kept += sum / whole / RUNS;
        free_scene(scene);
    }
    assert_true(kept < 2); /* else nothing was cut off: 32 boxes of a third of the area and more */
}

/* What lies askew is cut, and makes the better tree; a wall's box is as full in halves. */
static void splits_are_made_where_they_save(void **state)
{
    (void)state;
    bb_scene *scene = load("slivers:aspect=40");
    built whole, split;
    build(scene, "sah", &whole);
    build(scene, "presplit:budget=2+sah", &split);
    assert_int_equal(split.instance.references.count, 2 * scene->prim_count);
    assert_true(split.sah < 0.7 * whole.sah);
    bb_instance_destroy(&whole.instance);
    bb_instance_destroy(&split.instance);
    bb_scene_free(scene);

    scene = load("interior:n=3000");
    build(scene, "presplit+sah", &split);
    assert_int_equal(split.instance.references.count, scene->prim_count);
    bb_instance_destroy(&split.instance);
    bb_scene_free(scene);
}

/* A part that is cut too small is found by the tree's check. */
static void a_wrong_clip_is_found(void **state)
{
    (void)state;
    bb_scene *scene = load("interior:n=3000");
    built b;
    build(scene, "presplit:saves=-1+sah", &b);
    bb_tree *tree = &b.instance.tree;
    uint32_t found = 0, tried = 0;
    uint32_t *uses = calloc(scene->prim_count, sizeof *uses);
    for (uint32_t i = 0; i < tree->info.ref_count; i++)
        uses[tree->refs[i] & BB_INDEX_MASK]++;
    for (uint32_t n = 0; n < tree->info.node_count; n++) {
        bb_node *node = &tree->nodes[n];
        if (!bb_node_is_leaf(node) ||
            uses[tree->refs[node->first & BB_INDEX_MASK] & BB_INDEX_MASK] < 2)
            continue;
        int axis = 0;
        for (int k = 1; k < 3; k++)
            axis = node->hi[k] - node->lo[k] > node->hi[axis] - node->lo[axis] ? k : axis;
        float hi = node->hi[axis];
        node->hi[axis] = nextafterf(node->hi[axis] - 1e-3f * (hi - node->lo[axis]), -INFINITY);
        tried++;
        found += bb_tree_check(tree, scene) == BB_FAILED &&
                 strstr(bb_message(), "is not covered by its") != NULL;
        node->hi[axis] = hi;
        if (tried == 20)
            break;
    }
    assert_int_equal(tried, 20);
    assert_int_equal(found, tried);
    free(uses);
    bb_instance_destroy(&b.instance);
    bb_scene_free(scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(splits_are_covered_and_within_the_budget),
        cmocka_unit_test(the_largest_boxes_are_split_first),
        cmocka_unit_test(clips_lose_nothing),
        cmocka_unit_test(splits_are_made_where_they_save),
        cmocka_unit_test(a_wrong_clip_is_found),
    };
    return cmocka_run_group_tests_name("presplit_esc", tests, open_device, close_device);
}
