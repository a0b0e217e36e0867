/* PLOC and H-PLOC against their definitions, pair by pair, in all forms, bit for bit; few rounds on
 * grids and nests. The order along the curve, and the radix tree that H-PLOC follows, are those of
 * lbvh. Seed: BVHBENCH_TEST_SEED. BVHBENCH_TEST_SMALL keeps the inputs small (for oclgrind). */
#include "framework/base/random.h"
#include "tests/box_fixture.h"
#include "tests/device_forms.h"
#include "tests/fixture.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- the definition ---- */

typedef struct cluster {
    bb_box box;
    uint32_t count, prim;         /* prim: of a leaf */
    struct cluster *left, *right; /* NULL: a leaf */
} cluster;

typedef struct reference {
    const bb_box *boxes;
    cluster *pool;
    uint32_t made;
    uint32_t radius, goal;
    bb_node *nodes; /* in preorder */
    uint32_t *refs;
    uint32_t node_count, ref_count, depth;
} reference;

static bb_box join_of(const bb_box *a, const bb_box *b)
{
    bb_box box = {{0}, 0, {0}, 0};
    for (int k = 0; k < 3; k++) {
        box.lo[k] = a->lo[k] < b->lo[k] ? a->lo[k] : b->lo[k];
        box.hi[k] = a->hi[k] > b->hi[k] ? a->hi[k] : b->hi[k];
    }
    return box;
}

typedef struct pair_key {
    uint32_t area, offset, odd; /* smaller first */
} pair_key;

static pair_key key_of(cluster *const *list, uint32_t i, uint32_t j, bool forced)
{
    bb_box box = join_of(&list[i]->box, &list[j]->box);
    float x = box.hi[0] - box.lo[0], y = box.hi[1] - box.lo[1], z = box.hi[2] - box.lo[2];
    float area = x * y + y * z + z * x;
    area = area < FLT_MAX ? area : FLT_MAX;
    area = area > 0 ? area : 0; /* not -0 */
    pair_key key = {0, j - i, i / (j - i) % 2};
    memcpy(&key.area, &area, sizeof key.area);
    if (forced)
        key.area &= 0x7f800000u;
    return key;
}

static bool is_nearer(pair_key a, pair_key b)
{
    return a.area != b.area       ? a.area < b.area
           : a.offset != b.offset ? a.offset < b.offset
                                  : a.odd < b.odd;
}

static uint32_t nearest_of(const reference *r, cluster *const *list, uint32_t count, uint32_t i,
                           bool forced)
{
    uint32_t nearest = BB_NONE;
    pair_key least = {UINT32_MAX, UINT32_MAX, UINT32_MAX};
    for (uint32_t j = i > r->radius ? i - r->radius : 0; j < count && j <= i + r->radius; j++) {
        if (j == i)
            continue;
        pair_key key = key_of(list, i < j ? i : j, i < j ? j : i, forced);
        if (is_nearer(key, least)) {
            least = key;
            nearest = j;
        }
    }
    return nearest;
}

/* Rounds until at most `goal` are left; returns how many. */
static uint32_t reduce(reference *r, cluster **list, uint32_t count, uint32_t goal)
{
    uint32_t *nearest = malloc(count * sizeof *nearest);
    bool forced = false;
    while (count > goal) {
        uint32_t left = 0;
        for (uint32_t i = 0; i < count; i++)
            nearest[i] = nearest_of(r, list, count, i, forced);
        for (uint32_t i = 0; i < count; i++) {
            uint32_t j = nearest[i];
            bool mutual = nearest[j] == i;
            if (mutual && j < i)
                continue;
            cluster *c = list[i];
            if (mutual) {
                c = &r->pool[r->made++];
                *c = (cluster){join_of(&list[i]->box, &list[j]->box),
                               list[i]->count + list[j]->count, BB_NONE, list[i], list[j]};
            }
            list[left++] = c;
        }
        assert_true(left < count);
        /* less than 5 %, rounded down in PLOC's list, up in H-PLOC's windows */
        forced = count - left < (count + (r->goal > 0 ? 19 : 0)) / 20;
        count = left;
    }
    free(nearest);
    return count;
}

static cluster *make_leaf(reference *r, uint32_t prim)
{
    cluster *c = &r->pool[r->made++];
    *c = (cluster){join_of(&r->boxes[prim], &r->boxes[prim]), 1, prim, NULL, NULL};
    return c;
}

/* H-PLOC: the clusters of node n of the radix tree, into list[]; returns how many. */
static uint32_t clusters_of(reference *r, const bb_tree *radix, uint32_t n, cluster **list,
                            uint32_t *held)
{
    const bb_node *node = &radix->nodes[n];
    if (bb_node_is_leaf(node)) {
        *held = 1;
        list[0] = make_leaf(r, radix->refs[node->first & ~BB_LEAF_BIT] & BB_INDEX_MASK);
        return 1;
    }
    uint32_t right;
    uint32_t count = clusters_of(r, radix, node->first, list, held);
    count += clusters_of(r, radix, radix->nodes[node->first].skip, list + count, &right);
    *held += right;
    if (n == radix->info.root)
        return reduce(r, list, count, 1);
    return *held > r->goal ? reduce(r, list, count, r->goal) : count;
}

/* Node n in preorder; it, then the left child. */
static void write_nodes(reference *r, const cluster *c, uint32_t skip, uint32_t depth)
{
    bb_node *node = &r->nodes[r->node_count++];
    memcpy(node->lo, c->box.lo, sizeof node->lo);
    memcpy(node->hi, c->box.hi, sizeof node->hi);
    node->skip = skip;
    r->depth = depth > r->depth ? depth : r->depth;
    if (c->left == NULL) {
        node->first = BB_LEAF_BIT | r->ref_count;
        r->refs[r->ref_count++] = c->prim | BB_LAST_BIT;
        return;
    }
    node->first = r->node_count;
    write_nodes(r, c->left, r->node_count + 2 * c->left->count - 1, depth + 1);
    write_nodes(r, c->right, skip, depth + 1);
}

/* `radix`: lbvh's tree in preorder, whose references are the order along the curve. `goal` 0: PLOC.
 */
static void make_reference(reference *r, const bb_box *boxes, const bb_tree *radix, uint32_t radius,
                           uint32_t goal)
{
    uint32_t count = radix->info.ref_count, held;
    *r = (reference){.boxes = boxes, .radius = radius, .goal = goal};
    r->pool = calloc(2 * (size_t)count, sizeof *r->pool);
    r->nodes = calloc(2 * (size_t)count, sizeof *r->nodes);
    r->refs = calloc(count, sizeof *r->refs);
    cluster **list = calloc(count, sizeof *list);
    if (goal > 0) {
        clusters_of(r, radix, radix->info.root, list, &held);
    } else {
        for (uint32_t i = 0; i < count; i++)
            list[i] = make_leaf(r, radix->refs[i] & BB_INDEX_MASK);
        reduce(r, list, count, 1);
    }
    write_nodes(r, list[0], BB_NONE, 0);
    free(list);
}

static void free_reference(reference *r)
{
    free(r->pool);
    free(r->nodes);
    free(r->refs);
}

/* ---- the comparison ---- */

/* A builder, the definition it follows, and the tree that gives the order. */
typedef struct way {
    const char *builder, *order;
    uint32_t radius, goal;
} way;

static const way usual[] = {
    {"ploc", "lbvh:code=mc64", 8, 0},
    {"hploc", "lbvh:code=mc64", 8, 16},
};

static const way unusual[] = {
    {"ploc:code=mc32,radius=3", "lbvh:code=mc32", 3, 0},
    {"ploc:radius=19", "lbvh:code=mc64", 19, 0},
    {"hploc:code=emc32-var,radius=11,window=6", "emc:code=emc32-var", 11, 3},
    {"hploc:radius=1,window=40", "lbvh:code=mc64", 1, 20},
};

/* In all forms before `last`. */
static void compare(const way *w, const bb_box *boxes, uint32_t count, const char *what, int last)
{
    box_build order, b;
    reference r;
    open_box_build(&order, devices[first_form()], w->order, boxes, count, what);
    make_reference(&r, boxes, &order.preorder, w->radius, w->goal);
    close_box_build(&order);
    for (int form = first_form(); form < last; form++) {
        open_box_build(&b, devices[form], w->builder, boxes, count, what);
        const bb_tree *tree = &b.preorder;
        if (tree->info.depth != r.depth || tree->info.node_count != 2 * count - 1 ||
            memcmp(tree->nodes, r.nodes, tree->info.node_count * sizeof(bb_node)) != 0 ||
            memcmp(tree->refs, r.refs, count * sizeof(uint32_t)) != 0)
            fail_msg("%s, form %d, %s, %u boxes, seed %llu: not the tree of the definition",
                     w->builder, form, what, count, (unsigned long long)seed);
        close_box_build(&b);
    }
    free_reference(&r);
}

/* ---- inputs ---- */

enum { KINDS = 12 };
static const char *const kind_names[KINDS] = {
    "random", "one box",   "one middle", "row",     "nests",    "gaps",
    "flat",   "two sizes", "points",     "one big", "infinite", "tiny",
};

static bb_box box_around(const float middle[3], const float half[3])
{
    bb_box box = {{0}, 0, {0}, 0};
    for (int k = 0; k < 3; k++) {
        box.lo[k] = middle[k] - half[k];
        box.hi[k] = middle[k] + half[k];
    }
    return box;
}

static bb_box make_box(int kind, uint32_t i, uint32_t count, bb_random *random)
{
    float at = (float)i, m[3], h[3];
    for (int k = 0; k < 3; k++) {
        m[k] = (float)bb_random_range(random, -1, 1);
        h[k] = (float)(0.1 * pow(bb_random_unit(random), 4));
    }
    switch (kind) {
    case 1:
        return box_around((float[]){1, 2, 3}, (float[]){1, 1, 1});
    case 2:
        return box_around((float[]){1, 2, 3}, h);
    case 3:
        return box_around((float[]){at, 0, 0}, (float[]){0.5f, 0.5f, 0.5f});
    case 4:
        return box_around((float[]){0, 0, 0}, (float[]){1 + at, 1 + at, 1 + at});
    case 5:
        return box_around((float[]){at * at, 0, 0}, (float[]){0.25f, 0.25f, 0.25f});
    case 6:
        return box_around((float[]){m[0], m[1], 0}, (float[]){h[0], h[1], 0});
    case 7:
        return box_around((float[]){0, 0, 0},
                          (float[]){1.0f + (float)(i % 2), 1.0f, 1.0f + (float)(i % 2)});
    case 8:
        return box_around(m, (float[]){0, 0, 0});
    case 9:
        return i == count / 2 ? box_around((float[]){0, 0, 0}, (float[]){9, 9, 9})
                              : box_around(m, h);
    case 10:
        return box_around((float[]){1e38f * m[0], 1e38f * m[1], 1e38f * m[2]},
                          (float[]){2e38f, 2e38f, i % 3 == 0 ? 0 : 2e38f});
    case 11:
        return box_around((float[]){1e-18f * m[0], 1e-18f * m[1], 1e-18f * m[2]},
                          (float[]){1e-20f * h[0], 1e-20f * h[1], 1e-20f * h[2]});
    default:
        return box_around(m, h);
    }
}

static void compare_kind(const way *w, int kind, uint32_t count, bb_random *random, int last)
{
    bb_box *boxes = malloc(count * sizeof *boxes);
    for (uint32_t i = 0; i < count; i++)
        boxes[i] = make_box(kind, i, count, random);
    compare(w, boxes, count, kind_names[kind], last);
    free(boxes);
}

static void trees_are_those_of_the_definition(void **state)
{
    (void)state;
    const bool small = getenv("BVHBENCH_TEST_SMALL") != NULL;
    static const uint32_t counts[] = {1, 2, 3, 16, 17, 33, 64, 700}, few[] = {3, 33};
    const uint32_t *sizes = small ? few : counts;
    bb_random random = bb_random_make(seed, 1);
    for (int kind = 0; kind < (small ? 2 : KINDS); kind++)
        for (size_t c = 0; c < (small ? sizeof few : sizeof counts) / sizeof *sizes; c++)
            for (size_t w = 0; w < sizeof usual / sizeof *usual; w++)
                compare_kind(&usual[w], kind, sizes[c], &random, FORMS);
}

static void parameters_change_the_definition(void **state)
{
    (void)state;
    const bool small = getenv("BVHBENCH_TEST_SMALL") != NULL;
    bb_random random = bb_random_make(seed, 2);
    for (size_t w = 0; w < sizeof unusual / sizeof *unusual; w++)
        for (int kind = 0; kind < (small ? 1 : 2); kind++)
            compare_kind(&unusual[w], kind, small ? 50 : 900, &random,
                         small ? first_form() + 1 : FORMS);
}

/* Several chunks and tiles, and the last in one work-item. */
static void chunks_do_not_show(void **state)
{
    (void)state;
    const bool small = getenv("BVHBENCH_TEST_SMALL") != NULL;
    static const int kinds[] = {0, 3, 7};
    bb_random random = bb_random_make(seed, 3);
    for (size_t k = 0; k < (small ? 1 : sizeof kinds / sizeof *kinds); k++)
        for (size_t w = 0; w < sizeof usual / sizeof *usual; w++)
            compare_kind(&usual[w], kinds[k], small ? 1100 : 5000, &random,
                         small ? first_form() + 1 : FORMS);
}

/* ---- rounds ---- */

static uint64_t rounds_of(const bb_box *boxes, uint32_t count, const char *what)
{
    box_build b;
    open_box_build(&b, devices[first_form()], "ploc", boxes, count, what);
    assert_int_equal(b.instance.steps[0].phases.event_count, 1);
    assert_string_equal(b.instance.steps[0].phases.event_names[0], "rounds");
    uint64_t rounds = b.instance.steps[0].phases.events[0];
    close_box_build(&b);
    return rounds;
}

static void rounds_are_few(void **state)
{
    (void)state;
    const bool small = getenv("BVHBENCH_TEST_SMALL") != NULL;
    const struct {
        int kind;
        uint32_t count;
        uint64_t most;
    } cases[] = {{1, 512, 9}, {3, 512, 9}, {4, 512, 40}, {5, 512, 40}, {7, 512, 25}};
    bb_random random = bb_random_make(seed, 4);
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        bb_box boxes[512];
        for (uint32_t i = 0; i < cases[c].count; i++)
            boxes[i] = make_box(cases[c].kind, i, cases[c].count, &random);
        uint64_t rounds = rounds_of(boxes, cases[c].count, kind_names[cases[c].kind]);
        if (rounds > cases[c].most)
            fail_msg("%s: %u rounds", kind_names[cases[c].kind], (unsigned)rounds);
    }
    if (small)
        return;
    const uint32_t side = 100, count = side * side * side;
    bb_box *grid = malloc(count * sizeof *grid);
    for (uint32_t i = 0; i < count; i++)
        grid[i] = box_around(
            (float[]){(float)(i % side), (float)(i / side % side), (float)(i / side / side)},
            (float[]){0.5f, 0.5f, 0.5f});
    uint64_t rounds = rounds_of(grid, count, "grid");
    print_message("grid: %u rounds\n", (unsigned)rounds);
    assert_true(rounds <= 40);
    free(grid);
}

/* ---- what is refused ---- */

static void bad_options_are_refused(void **state)
{
    (void)state;
    static const char *const bad[] = {"ploc:radius=0",    "ploc:radius=128", "hploc:radius=0",
                                      "hploc:window=2",   "hploc:window=33", "hploc:window=258",
                                      "hploc:radius=128", "ploc:window=32"};
    const bb_box box = {{0}, 0, {0}, 0};
    const bb_scene scene = scene_of(&box, 1);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        bb_instance instance = {0};
        assert_int_equal(bb_instance_create(devices[first_form()], bad[i], &scene, 1, &instance),
                         BB_INVALID);
        bb_instance_destroy(&instance);
    }
}

int main(void)
{
    seed = seed_or(seed);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(trees_are_those_of_the_definition),
        cmocka_unit_test(parameters_change_the_definition),
        cmocka_unit_test(chunks_do_not_show),
        cmocka_unit_test(rounds_are_few),
        cmocka_unit_test(bad_options_are_refused),
    };
    return cmocka_run_group_tests(tests, open_devices, close_devices);
}
