/* refit:partial: parts of a tree that are built again in place, against a plain reference; what
 * they keep; and that all forms of a device make the same tree. BVHBENCH_TEST_SMALL keeps scenes
 * small (for oclgrind). */
#include "builders/refit/parts_shared.h"
#include "framework/base/random.h"
#include "framework/builder/instance.h"
#include "tests/device_forms.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { BINS = BB_PART_BINS, PART_LEAVES = BB_PART_LEAVES, FRAMES = 5 };

typedef struct moving {
    bb_scene *scene;
    bb_instance instance;
} moving;

static void start(moving *m, bb_device *on, const char *scene, const char *builder)
{
    ASSERT_OK(bb_scene_load(scene, &m->scene));
    ASSERT_OK(bb_scene_upload(m->scene, on));
    ASSERT_OK(bb_instance_create(on, builder, m->scene, 1, &m->instance));
    ASSERT_OK(bb_instance_build(&m->instance, m->scene, false, NULL));
    ASSERT_OK(bb_tree_download(&m->instance.tree, NULL));
}

static void stop(moving *m)
{
    bb_instance_destroy(&m->instance);
    bb_scene_free(m->scene);
}

/* Updates, although nothing may have moved. Returns how many parts it says it has rebuilt. */
static uint64_t update(moving *m)
{
    bb_update_way way;
    ASSERT_OK(bb_instance_update(&m->instance, m->scene, BB_CHANGED_POSITIONS, false, &way, NULL));
    assert_int_equal(way, BB_UPDATED);
    ASSERT_OK(bb_tree_download(&m->instance.tree, NULL));
    ASSERT_OK(bb_tree_check(&m->instance.tree, m->scene));
    for (uint32_t step = 0; step < m->instance.step_count; step++) {
        const bb_phases *phases = &m->instance.steps[step].phases;
        for (uint32_t i = 0; i < phases->event_count; i++)
            if (strcmp(phases->event_names[i], "rebuilt") == 0)
                return phases->events[i];
    }
    return 0;
}

static uint64_t go_to(moving *m, uint32_t frame)
{
    uint32_t changed;
    ASSERT_OK(bb_scene_set_frame(m->scene, frame, &changed));
    return update(m);
}

static bool has_links_of(const bb_tree *a, const bb_tree *b)
{
    for (uint32_t n = 0; n < a->info.node_count; n++)
        if (a->nodes[n].first != b->nodes[n].first || a->nodes[n].skip != b->nodes[n].skip)
            return false;
    return true;
}

/* ---- a plain reference ---- */

/* The leaves below n; how many. */
static uint32_t list_leaves(const bb_tree *tree, uint32_t n, uint32_t *leaves)
{
    uint32_t end = tree->nodes[n].skip, count = 0;
    while (n != end) {
        bool leaf = bb_node_is_leaf(&tree->nodes[n]);
        if (leaf)
            leaves[count++] = n;
        n = leaf ? tree->nodes[n].skip : tree->nodes[n].first;
    }
    return count;
}

typedef struct side {
    float lo[3], hi[3];
    uint32_t count;
} side;

static void grow(side *s, const bb_node *leaf)
{
    for (int axis = 0; axis < 3; axis++) {
        s->lo[axis] = s->count == 0 ? leaf->lo[axis] : fminf(s->lo[axis], leaf->lo[axis]);
        s->hi[axis] = s->count == 0 ? leaf->hi[axis] : fmaxf(s->hi[axis], leaf->hi[axis]);
    }
    s->count++;
}

/* In float, as the device has it: bb_half_area() is in double. */
static float area_of(const side *s)
{
    float x = s->hi[0] - s->lo[0], y = s->hi[1] - s->lo[1], z = s->hi[2] - s->lo[2];
    return x * y + y * z + z * x;
}

static float cost_of(const side *a, const side *b)
{
    if (a->count == 0 || b->count == 0)
        return INFINITY;
    return area_of(a) * (float)a->count + area_of(b) * (float)b->count;
}

static float cost_of_plane(const bb_tree *tree, const uint32_t *leaves, uint32_t count, int axis,
                           float plane)
{
    side sides[2] = {{.count = 0}, {.count = 0}};
    for (uint32_t i = 0; i < count; i++) {
        const bb_node *leaf = &tree->nodes[leaves[i]];
        grow(&sides[leaf->lo[axis] + leaf->hi[axis] >= plane], leaf);
    }
    return cost_of(&sides[0], &sides[1]);
}

/* Of all planes that there are for these leaves, each tried by itself. */
static float least_cost(const bb_tree *tree, const uint32_t *leaves, uint32_t count)
{
    float least = INFINITY;
    for (int axis = 0; axis < 3; axis++) {
        float lo = INFINITY, hi = -INFINITY;
        for (uint32_t i = 0; i < count; i++) {
            const bb_node *leaf = &tree->nodes[leaves[i]];
            lo = fminf(lo, leaf->lo[axis] + leaf->hi[axis]);
            hi = fmaxf(hi, leaf->lo[axis] + leaf->hi[axis]);
        }
        for (int k = 1; k < BINS; k++)
            least = fminf(least, cost_of_plane(tree, leaves, count, axis,
                                               lo + (hi - lo) * ((float)k / BINS)));
    }
    return least;
}

static void check_division(const bb_tree *tree, uint32_t n)
{
    uint32_t leaves[PART_LEAVES], a = tree->nodes[n].first, b = tree->nodes[a].skip;
    uint32_t first = list_leaves(tree, a, leaves);
    uint32_t count = first + list_leaves(tree, b, leaves + first);
    side sides[2] = {{.count = 0}, {.count = 0}};
    for (uint32_t i = 0; i < count; i++)
        grow(&sides[i >= first], &tree->nodes[leaves[i]]);
    float least = least_cost(tree, leaves, count);
    if (count == 2)
        return;
    if (least == INFINITY)
        assert_int_equal(first, count / 2);
    else
        assert_true(cost_of(&sides[0], &sides[1]) == least);
}

/* One part: it is divided at each node as nothing divides it better, or left as it is where that
 * would cost more. */
static void parts_are_divided_best(void **state)
{
    (void)state;
    uint32_t rebuilt = 0, kept = 0;
    for (int form = first_form(); form < FORMS; form++)
        for (uint32_t run = 0; run < 10; run++) {
            char name[96];
            moving m, plain;
            snprintf(name, sizeof name, "crowd:kind=%s,n=%u,frames=3,seed=%u",
                     run % 3 == 0 ? "origin" : "explode", 3 + 25 * run, run);
            start(&m, devices[form], name, "lbvh+refit:partial=1");
            start(&plain, devices[form], name, "lbvh+refit");
            uint64_t parts = go_to(&m, 2);
            go_to(&plain, 2);
            const bb_tree *tree = &m.instance.tree, *before = &plain.instance.tree;
            assert_true(parts <= 1);
            assert_memory_equal(tree->refs, before->refs, tree->info.ref_count * sizeof(uint32_t));
            if (parts == 0)
                assert_memory_equal(tree->nodes, before->nodes,
                                    tree->info.node_count * sizeof(bb_node));
            else
                assert_true(bb_tree_sah(tree) < bb_tree_sah(before));
            for (uint32_t n = 0; n < tree->info.node_count && parts == 1; n++)
                if (!bb_node_is_leaf(&tree->nodes[n]))
                    check_division(tree, n);
            rebuilt += parts == 1;
            kept += parts == 0;
            stop(&m);
            stop(&plain);
        }
    print_message("%u rebuilt, %u kept\n", rebuilt, kept);
    assert_true(rebuilt > 0 && kept > 0);
}

/* ---- many parts ---- */

static uint32_t crowd(void)
{
    return getenv("BVHBENCH_TEST_SMALL") != NULL ? 700 : 5000;
}

/* A number for the set of references below n, the same in whatever order they are. */
static uint64_t set_of(const bb_tree *tree, uint32_t n, uint32_t *leaves, uint32_t *count)
{
    uint64_t sum = 0;
    *count = list_leaves(tree, n, leaves);
    for (uint32_t i = 0; i < *count; i++)
        for (uint32_t r = tree->nodes[leaves[i]].first & BB_INDEX_MASK;; r++) {
            bb_random random = bb_random_make(tree->refs[r] & BB_INDEX_MASK, 0);
            sum += bb_random_u64(&random);
            if ((tree->refs[r] & BB_LAST_BIT) != 0)
                break;
        }
    return sum;
}

static bool has_set(const uint64_t *sets, uint32_t count, uint64_t set)
{
    for (uint32_t i = 0; i < count; i++)
        if (sets[i] == set)
            return true;
    return false;
}

/* Each part of `before` is below one node of `after` too, with all of its primitives. */
static void expect_parts(const bb_tree *before, const bb_tree *after)
{
    uint32_t nodes = before->info.node_count, count, parts = 0;
    uint32_t *leaves = malloc(nodes * sizeof *leaves);
    uint64_t *sets = malloc(nodes * sizeof *sets);
    for (uint32_t n = 0; n < nodes; n++)
        sets[n] = set_of(after, n, leaves, &count);
    for (uint32_t n = 0; n < nodes; n++) {
        if (list_leaves(before, n, leaves) <= PART_LEAVES)
            continue;
        for (uint32_t c = before->nodes[n].first; c != before->nodes[n].skip;
             c = before->nodes[c].skip) {
            uint64_t set = set_of(before, c, leaves, &count);
            if (count > PART_LEAVES)
                continue;
            assert_true(has_set(sets, nodes, set));
            parts++;
        }
    }
    assert_true(parts >= 3);
    free(leaves);
    free(sets);
}

/* Forwards and back again, and once more where nothing has moved. */
static void parts_keep_their_primitives(void **state)
{
    (void)state;
    static const char *const kinds[] = {"rigid", "explode", "shuffle"};
    static const uint32_t frames[] = {1, 2, 4, 2, 0};
    for (uint32_t k = 0; k < sizeof kinds / sizeof kinds[0]; k++) {
        char name[96];
        uint64_t rebuilt = 0;
        bb_node *first[sizeof frames / sizeof frames[0]] = {NULL};
        snprintf(name, sizeof name, "crowd:kind=%s,n=%u,frames=%u", kinds[k], crowd(), FRAMES);
        for (int form = first_form(); form < FORMS; form++) {
            moving m, plain;
            start(&m, devices[form], name, "lbvh+refit:partial=1.2");
            start(&plain, devices[form], name, "lbvh+refit");
            const bb_tree *tree = &m.instance.tree;
            size_t bytes = tree->info.node_count * sizeof(bb_node);
            for (uint32_t i = 0; i < sizeof frames / sizeof frames[0]; i++) {
                rebuilt += go_to(&m, frames[i]);
                expect_parts(&plain.instance.tree, tree);
                if (first[i] == NULL) {
                    first[i] = malloc(bytes);
                    memcpy(first[i], tree->nodes, bytes);
                }
                assert_memory_equal(tree->nodes, first[i], bytes); /* in all forms */
                assert_int_equal(update(&m), 0);
                assert_memory_equal(tree->nodes, first[i], bytes);
            }
            stop(&m);
            stop(&plain);
        }
        for (uint32_t i = 0; i < sizeof frames / sizeof frames[0]; i++)
            free(first[i]);
        print_message("%s: %u rebuilt\n", kinds[k], (uint32_t)rebuilt);
        assert_true(rebuilt > 0);
    }
}

/* What has not become so bad is refitted, as without parts. */
static void parts_that_are_good_stay(void **state)
{
    (void)state;
    for (int form = first_form(); form < FORMS; form++) {
        char name[96];
        moving m, plain;
        snprintf(name, sizeof name, "crowd:kind=explode,n=%u,frames=3", crowd());
        start(&m, devices[form], name, "lbvh+refit:partial=1e9");
        start(&plain, devices[form], name, "lbvh+refit");
        uint64_t links = m.instance.tree.links;
        assert_int_equal(go_to(&m, 1), 0);
        go_to(&plain, 1);
        assert_true(m.instance.tree.links == links);
        assert_true(has_links_of(&m.instance.tree, &plain.instance.tree));
        assert_memory_equal(m.instance.tree.nodes, plain.instance.tree.nodes,
                            plain.instance.tree.info.node_count * sizeof(bb_node));
        stop(&m);
        stop(&plain);
    }
}

/* ---- options ---- */

static void what_partial_does_not_take_is_refused(void **state)
{
    (void)state;
    static const struct {
        const char *builder, *words;
    } cases[] = {
        {"lbvh+refit:partial=0.9", "partial"},
        {"lbvh+refit:partial=much", "partial"},
        {"lbvh+refit:partial=nan", "partial"},
        {"lbvh+refit:partial=2,rotate=yes", "takes neither rotations nor"},
        {"lbvh+refit:partial=2,trigger=sah:1.5", "takes neither rotations nor"},
        {"lbvh+refit:partial=2,trigger=ratio:1", "takes neither rotations nor"},
    };
    bb_device *on = devices[LEVELS_FORM];
    bb_scene *scene;
    ASSERT_OK(bb_scene_load("crowd:kind=rigid,n=100,frames=2", &scene));
    ASSERT_OK(bb_scene_upload(scene, on));
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        bb_instance instance;
        assert_int_equal(bb_instance_create(on, cases[i].builder, scene, 1, &instance), BB_INVALID);
        if (strstr(bb_message(), cases[i].words) == NULL)
            fail_msg("expected '%s' in '%s'", cases[i].words, bb_message());
        bb_instance_destroy(&instance);
    }
    bb_instance wide;
    ASSERT_OK(bb_instance_create(on, "lobvh+refit:partial=2", scene, 1, &wide));
    assert_int_equal(bb_instance_build(&wide, scene, false, NULL), BB_UNSUPPORTED);
    bb_instance_destroy(&wide);
    bb_scene_free(scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(parts_are_divided_best),
        cmocka_unit_test(parts_keep_their_primitives),
        cmocka_unit_test(parts_that_are_good_stay),
        cmocka_unit_test(what_partial_does_not_take_is_refused),
    };
    return cmocka_run_group_tests_name("parts", tests, open_devices, close_devices);
}
