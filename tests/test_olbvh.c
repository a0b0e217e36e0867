/* OLBVH: its arrays against a recursive octree made from the definition, in all forms of the
 * device; equation 9 at the first node of each level; the depth of equations 11 and 12; flags
 * against loops; more references than there is memory for. BVHBENCH_TEST_SMALL keeps the inputs
 * small (for oclgrind). */
#include "builders/olbvh/olbvh.h"
#include "framework/builder/instance.h"
#include "framework/scene/tets.h"
#include "kernels/cell_grid_shared.h"
#include "tests/device_forms.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static bool small;

/* ---- the octree, from the definition ---- */

typedef struct cells {
    bb_box bounds;
    uint32_t bits;
} cells;

static float plane(const cells *grid, int axis, uint32_t i)
{
    float lo = grid->bounds.lo[axis], hi = grid->bounds.hi[axis];
    float step = ldexpf(hi - lo, -(int)grid->bits);
    if (!isnormal(step))
        step = 0;
    return i >= 1u << grid->bits || (i > 0 && step == 0) ? hi : fminf(hi, lo + step * (float)i);
}

static uint32_t cell_of(const cells *grid, int axis, float x)
{
    uint32_t i = (1u << grid->bits) - 1;
    float hi = grid->bounds.hi[axis], lo = grid->bounds.lo[axis];
    if (!isnormal(ldexpf(hi - lo, -(int)grid->bits)))
        return 0;
    while (i > 0 && plane(grid, axis, i) > x)
        i--;
    return i;
}

/* A node as the recursion finds it; nodes of a level one after the other, levels likewise. */
typedef struct reference {
    uint32_t nodes, inner, references;
    uint32_t level_ends[BB_CELL_BITS_MAX + 1];
    uint32_t *refs;                              /* of all leaves, in their order */
    uint32_t *begin, *end, *children, *boundary; /* boundary: how many references */
    bb_box *boxes;
} reference;

static bool is_boundary(const bb_scene *scene, uint32_t prim)
{
    const bb_prims *tets = &scene->prims[BB_TETRAHEDRON];
    return tets->count == 0 || (scene->tets->flags[prim - tets->first] & BB_TET_BOUNDARY) != 0;
}

static bool lists(const bb_scene *scene, const cells *grid, uint32_t prim, uint32_t level,
                  const uint32_t at[3])
{
    bool listed = true;
    for (int axis = 0; axis < 3; axis++) {
        uint32_t shift = grid->bits - level;
        uint32_t from = cell_of(grid, axis, scene->boxes[prim].lo[axis]) >> shift;
        uint32_t to = cell_of(grid, axis, scene->boxes[prim].hi[axis]) >> shift;
        listed = listed && from <= at[axis] && at[axis] <= to;
    }
    return listed;
}

/* Depth first, over the primitives that the node lists; sizes and boxes come back up. */
static void descend(const bb_scene *scene, const cells *grid, const uint32_t *prims, uint32_t count,
                    uint32_t level, const uint32_t at[3], uint32_t *numbers, reference *tree,
                    bb_box *box)
{
    uint32_t node = numbers[level]++, *inside = calloc(count + 1, sizeof *inside);
    tree->begin[node] = tree->references;
    tree->boundary[node] = 0;
    if (level == grid->bits) {
        for (int marked = 1; marked >= 0; marked--) /* those of the boundary first */
            for (uint32_t i = 0; i < count; i++)
                if (is_boundary(scene, prims[i]) == (marked == 1))
                    tree->refs[tree->references++] = prims[i];
        for (int axis = 0; axis < 3; axis++) {
            box->lo[axis] = plane(grid, axis, at[axis]);
            box->hi[axis] = plane(grid, axis, at[axis] + 1);
        }
        for (uint32_t i = 0; i < count; i++)
            tree->boundary[node] += is_boundary(scene, prims[i]);
    }
    bool first = true;
    for (uint32_t octant = 0; octant < 8 && level < grid->bits; octant++) {
        const uint32_t child[3] = {2 * at[0] + (octant >> 2), 2 * at[1] + (octant >> 1 & 1),
                                   2 * at[2] + (octant & 1)};
        uint32_t found = 0, number = numbers[level + 1];
        bb_box part;
        for (uint32_t i = 0; i < count; i++)
            if (lists(scene, grid, prims[i], level + 1, child))
                inside[found++] = prims[i];
        if (found == 0)
            continue;
        descend(scene, grid, inside, found, level + 1, child, numbers, tree, &part);
        tree->boundary[node] += tree->boundary[number];
        tree->children[node]++;
        for (int axis = 0; axis < 3; axis++) {
            box->lo[axis] = first ? part.lo[axis] : fminf(box->lo[axis], part.lo[axis]);
            box->hi[axis] = first ? part.hi[axis] : fmaxf(box->hi[axis], part.hi[axis]);
        }
        first = false;
    }
    tree->end[node] = tree->references;
    tree->boxes[node] = *box;
    free(inside);
}

static uint32_t bits_by_size(const bb_scene *scene, double alpha)
{
    uint64_t sum = 0;
    for (uint32_t i = 0; i < scene->prim_count; i++) {
        float most = 0;
        for (int axis = 0; axis < 3; axis++) {
            float side = scene->boxes[i].hi[axis] - scene->boxes[i].lo[axis];
            float step = ldexpf(scene->bounds.hi[axis] - scene->bounds.lo[axis], -10);
            if (isnormal(step))
                most = fmaxf(most, side / step);
        }
        uint32_t wide = (uint32_t)fminf(most, 1024);
        while (wide > 1) {
            wide /= 2;
            sum++;
        }
    }
    double bits = floor(10.5 - ((double)sum / scene->prim_count + alpha));
    return (uint32_t)fmin(fmax(bits, 0), 10);
}

enum { NODES_MAX = 1 << 20 };

static void make_reference(const bb_scene *scene, uint32_t bits, reference *tree)
{
    const cells grid = {scene->bounds, bits};
    const uint32_t at[3] = {0, 0, 0};
    uint32_t numbers[BB_CELL_BITS_MAX + 2];
    uint32_t *prims = calloc(scene->prim_count, sizeof *prims);
    bb_box box;
    *tree = (reference){0};
    tree->refs = calloc(NODES_MAX, sizeof *tree->refs);
    tree->begin = calloc(NODES_MAX, sizeof *tree->begin);
    tree->end = calloc(NODES_MAX, sizeof *tree->end);
    tree->children = calloc(NODES_MAX, sizeof *tree->children);
    tree->boundary = calloc(NODES_MAX, sizeof *tree->boundary);
    tree->boxes = calloc(NODES_MAX, sizeof *tree->boxes);
    for (uint32_t i = 0; i < scene->prim_count; i++)
        prims[i] = i;
    /* how many there are of each level, then in breadth-first order */
    for (int pass = 0; pass < 2; pass++) {
        uint32_t from = 0;
        for (uint32_t level = 0; level <= bits; level++) {
            uint32_t count = pass == 0 ? NODES_MAX / (bits + 1) : tree->level_ends[level];
            numbers[level] = from;
            from += count;
        }
        tree->references = 0;
        memset(tree->children, 0, NODES_MAX * sizeof *tree->children);
        uint32_t starts[BB_CELL_BITS_MAX + 1];
        memcpy(starts, numbers, sizeof starts);
        descend(scene, &grid, prims, scene->prim_count, 0, at, numbers, tree, &box);
        for (uint32_t level = 0; level <= bits; level++)
            tree->level_ends[level] = numbers[level] - starts[level];
    }
    for (uint32_t level = 1; level <= bits; level++)
        tree->level_ends[level] += tree->level_ends[level - 1];
    tree->nodes = tree->level_ends[bits];
    tree->inner = bits > 0 ? tree->level_ends[bits - 1] : 0;
    free(prims);
}

static void free_reference(reference *tree)
{
    free(tree->refs);
    free(tree->begin);
    free(tree->end);
    free(tree->children);
    free(tree->boundary);
    free(tree->boxes);
}

/* ---- comparison ---- */

static uint32_t *read_words(const bb_buffer *buffer, uint32_t count)
{
    uint32_t *words = calloc(count, sizeof *words);
    ASSERT_OK(bb_buffer_read(buffer, 0, count * sizeof *words, words));
    return words;
}

/* One of the tree's side arrays of words, and `last` behind it. */
static uint32_t *read_array(const bb_tree *tree, const char *name, uint32_t last)
{
    const bb_tree_array *array = bb_tree_find_array(tree, name);
    const uint32_t count = tree->info.node_count;
    assert_non_null(array);
    uint32_t *words = calloc((size_t)count + 1, sizeof *words);
    ASSERT_OK(bb_buffer_read(&array->buffer, 0, count * sizeof *words, words));
    words[count] = last;
    return words;
}

static void expect_arrays(const bb_tree *tree, const olbvh_arrays *arrays,
                          const reference *expected)
{
    uint32_t *co = read_array(tree, "co", 0);
    uint32_t *po = read_array(tree, "po", expected->references);
    uint32_t *no = read_words(arrays->no, arrays->levels);
    assert_memory_equal(no, expected->level_ends, arrays->levels * sizeof *no);
    uint32_t child = 1;
    assert_int_equal(co[0], 0);
    for (uint32_t i = 0; i < expected->nodes; i++) {
        /* equation 9, with >= */
        uint32_t begin = po[i] >= po[i + 1] ? 0 : po[i];
        assert_int_equal(begin, expected->begin[i]);
        assert_int_equal(po[i + 1], expected->end[i]);
        if (i >= expected->inner)
            continue;
        assert_int_equal(co[i] + 1, child); /* equation 7 */
        child += expected->children[i];
        assert_int_equal(co[i + 1] + 1, child);
    }
    for (uint32_t level = 0; level < arrays->levels; level++) {
        uint32_t first = level == 0 ? 0 : no[level - 1];
        assert_true(po[first] >= po[first + 1] || first == 0); /* where a level begins */
        assert_int_equal(expected->begin[first], 0);
    }
    free(co);
    free(po);
    free(no);
}

static void expect_tree(const bb_scene *scene, bb_tree *tree, const reference *expected)
{
    check(bb_tree_download(tree, NULL), "download");
    assert_int_equal(tree->info.node_count, expected->nodes);
    assert_int_equal(tree->info.ref_count, expected->references);
    const bb_tree_array *marks = bb_tree_find_array(tree, "cells");
    assert_non_null(marks);
    for (uint32_t i = 0; i < expected->references; i++)
        assert_int_equal(tree->refs[i] & BB_INDEX_MASK, expected->refs[i]);
    for (uint32_t i = 0; i < expected->nodes; i++) {
        const bb_node *node = &tree->nodes[i];
        assert_memory_equal(node->lo, expected->boxes[i].lo, sizeof node->lo);
        assert_memory_equal(node->hi, expected->boxes[i].hi, sizeof node->hi);
        assert_int_equal(((const uint32_t *)marks->host)[i] >> BB_CELL_MARKED_SHIFT,
                         expected->boundary[i]);
    }
    check(bb_tree_check(tree, scene), "tree");
}

static void compare(bb_device *on, const char *name, const char *options, double alpha, int bits)
{
    bb_scene *scene = NULL;
    bb_instance instance = {0};
    reference expected;
    olbvh_arrays arrays;
    char builder[64];
    snprintf(builder, sizeof builder, "olbvh%s%s", options[0] != '\0' ? ":" : "", options);
    check(bb_scene_load(name, &scene), name);
    check(bb_scene_upload(scene, on), name);
    uint32_t deep = bits >= 0 ? (uint32_t)bits : bits_by_size(scene, alpha);
    make_reference(scene, deep, &expected);
    check(bb_instance_create(on, builder, scene, 1, &instance), builder);
    check(bb_instance_build(&instance, scene, false, NULL), builder);
    olbvh_arrays_of(instance.stages[0].self, &arrays);
    if (arrays.levels != deep + 1)
        fail_msg("%s of %s: %u levels, not %u", builder, name, arrays.levels, deep + 1);
    assert_int_equal(arrays.nodes, expected.nodes);
    assert_int_equal(arrays.references, expected.references);
    expect_arrays(&instance.tree, &arrays, &expected);
    expect_tree(scene, &instance.tree, &expected);
    bb_instance_destroy(&instance);
    free_reference(&expected);
    bb_scene_free(scene);
}

static void arrays_are_those_of_a_recursive_octree(void **state)
{
    (void)state;
    for (int form = first_form(); form < FORMS; form++) {
        bb_device *on = devices[form];
        compare(on, "tets:side=3", "", 0, -1);
        compare(on, "tets:side=1,shape=block,jitter=0", "", 0, -1);
        compare(on, "tets:side=3,shape=shell,jitter=0", "alpha=1", 1, -1);
        compare(on, "cube", "bits=0", 0, 0);
        compare(on, "cube", "bits=2", 0, 2);
        compare(on, "blocks:side=3", "bits=3", 0, 3);
        compare(on, "tets:side=3,shape=block,thin=130", "bits=3", 0, 3); /* as good as flat */
        if (small)
            continue;
        compare(on, "tets:side=8", "", 0, -1);
        compare(on, "tets:side=8,shape=shell", "alpha=2", 2, -1);
        compare(on, "tets:side=6,flip=3,flat=5,twins=7", "alpha=0.5", 0.5, -1);
        compare(on, "tets:side=9,grade=4,jitter=0.1", "", 0, -1); /* 4^8 times as wide */
        compare(on, "sphere-mesh:n=12", "", 0, -1);
        compare(on, "terrain:n=12", "bits=5", 0, 5);
        compare(on, "single", "bits=6", 0, 6);
    }
}

/* References are counted before there is room for any. */
static void too_many_references_are_refused(void **state)
{
    (void)state;
    if (small)
        return;
    bb_scene *scene = NULL;
    bb_instance instance = {0};
    bb_device *on = devices[CPU_FORM];
    check(bb_scene_load("tets:side=6,shape=block,twins=1", &scene), "scene");
    check(bb_scene_upload(scene, on), "scene");
    uint64_t before = on->bytes;
    check(bb_instance_create(on, "olbvh:bits=10", scene, 1, &instance), "olbvh");
    uint64_t had = on->global_bytes;
    on->global_bytes = on->bytes + (256u << 20);
    assert_int_equal(bb_instance_build(&instance, scene, false, NULL), BB_REFUSED);
    assert_non_null(strstr(bb_message(), "references of 2592 primitives"));
    assert_non_null(strstr(bb_message(), "take fewer (alpha=2, or bits=8)"));
    on->global_bytes = had;
    bb_instance_destroy(&instance);
    assert_true(on->bytes == before);
    bb_scene_free(scene);
}

static int set_up(void **state)
{
    small = getenv("BVHBENCH_TEST_SMALL") != NULL;
    return open_devices(state);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(arrays_are_those_of_a_recursive_octree),
        cmocka_unit_test(too_many_references_are_refused),
    };
    return cmocka_run_group_tests(tests, set_up, close_devices);
}
