/* Linking of nodes of a binary tree: preorder index, prefixes and trees against the definition; and
 * what the formulas of Gu, Jendersie, Grosch 2018 give, as printed and as corrected. Seed:
 * BVHBENCH_TEST_SEED. BVHBENCH_TEST_SMALL: fewer inputs (for oclgrind). */
#include "builders/common/radix_tree.h"
#include "framework/base/random.h"
#include "tests/device_forms.h"
#include "tests/fixture.h"
#include "tests/loose_reference.h"

#include <stdio.h>

enum { NODES_MAX = 600 };

/* Nodes in preorder, all different. */
typedef struct input {
    uint32_t length, count;
    loose_node nodes[NODES_MAX];
} input;

/* ---- formulas ---- */

static uint64_t preorder_index(loose_node node)
{
    return 2 * node.path - (uint32_t)__builtin_popcountll(node.path) + node.level;
}

/* Equation 4 as printed. */
static uint64_t preorder_index_printed(loose_node node)
{
    return 2 * node.path - (uint32_t)__builtin_popcountll(node.path) - node.level;
}

static int shared_bits(const input *in, int64_t i, int64_t j)
{
    uint64_t differ = in->nodes[i].path ^ in->nodes[j].path;
    return differ == 0 ? (int)in->length : (int)in->length - 64 + __builtin_clzll(differ);
}

/* theta of section 3.3.3; as printed it takes the level of j. */
static int theta(const input *in, int64_t i, int64_t j, bool printed)
{
    if (j < 0 || j >= in->count)
        return j < 0 ? -1 : -2;
    int shared = shared_bits(in, i, j);
    int level = (int)in->nodes[printed || j < i ? j : i].level;
    return level < shared ? level : shared;
}

/* Level of the lowest common ancestor, by climbing. */
static int common_level(const input *in, int64_t i, int64_t j)
{
    loose_node a = in->nodes[i], b = in->nodes[j];
    while (a.level != b.level || a.path != b.path) {
        loose_node *deeper = a.level >= b.level ? &a : &b;
        deeper->level--;
        uint64_t kept = in->length - deeper->level;
        deeper->path = kept > 63 ? 0 : deeper->path >> kept << kept;
    }
    return (int)a.level;
}

static uint64_t walk(const input *in, loose_node node, uint64_t index)
{
    assert_int_equal(preorder_index(node), index);
    if (node.level == in->length)
        return index + 1;
    loose_node right = {node.path | (uint64_t)1 << (in->length - 1 - node.level), node.level + 1};
    index = walk(in, (loose_node){node.path, node.level + 1}, index + 1);
    return walk(in, right, index);
}

static void keys_are_the_preorder(void **state)
{
    (void)state;
    for (uint32_t length = 0; length <= 15; length++) {
        input in = {.length = length};
        assert_int_equal(walk(&in, (loose_node){0, 0}, 0), ((uint64_t)1 << (length + 1)) - 1);
    }
    /* the last of the longest there are: the largest key that a u64 takes but one */
    assert_true(preorder_index((loose_node){UINT64_MAX >> 1, 63}) == UINT64_MAX - 1);
    /* as printed: a child before its parent, and two nodes of one key */
    assert_true(preorder_index_printed((loose_node){4, 1}) >
                preorder_index_printed((loose_node){4, 3}));
    assert_true(preorder_index_printed((loose_node){0, 2}) ==
                preorder_index_printed((loose_node){1, 3}));
}

/* ---- inputs ---- */

static int compare_nodes(const void *a, const void *b)
{
    uint64_t x = preorder_index(*(const loose_node *)a), y = preorder_index(*(const loose_node *)b);
    return x < y ? -1 : x > y;
}

/* Dense: most nodes of a small tree, with parents and children; else chains of ancestors here and
 * there. */
static void make_input(bb_random *random, uint32_t length, uint32_t want, input *in)
{
    *in = (input){.length = length};
    uint64_t path = 0, last = length == 0 ? 0 : UINT64_MAX >> (64 - length);
    for (uint32_t i = 0; i < want; i++) {
        if (i % 4 == 0)
            path = (bb_random_u64(random) >> bb_random_below(random, 3) * 20) & last;
        uint32_t level = bb_random_below(random, length + 1), dropped = length - level;
        in->nodes[i] = (loose_node){dropped > 63 ? 0 : path >> dropped << dropped, level};
    }
    qsort(in->nodes, want, sizeof in->nodes[0], compare_nodes);
    for (uint32_t i = 0; i < want; i++)
        if (i == 0 || compare_nodes(&in->nodes[i], &in->nodes[in->count - 1]) != 0)
            in->nodes[in->count++] = in->nodes[i];
}

static void thetas_are_common_ancestors(void **state)
{
    (void)state;
    bb_random random = bb_random_make(seed, 1);
    for (uint32_t t = 0; t < 400; t++) {
        input in;
        make_input(&random, 1 + t % 63, 2 + t % 40, &in);
        for (uint32_t i = 0; i < in.count; i++)
            for (uint32_t j = 0; j < in.count; j++)
                if (i != j)
                    assert_int_equal(theta(&in, i, j, false), common_level(&in, i, j));
    }
}

/* ---- algorithm 1 ---- */

typedef struct split {
    uint32_t at, left_end, right_end;
} split;

/* Lines 2 to 20 for inner node i, theta corrected or as printed; line 17 counts from sigma, which
 * is printed l. */
static split algorithm_1(const input *in, int64_t i, bool printed)
{
    int64_t d = theta(in, i, i + 1, printed) >= theta(in, i, i - 1, printed) ? 1 : -1;
    int least = theta(in, i, i - d, printed) - (d > 0 ? 1 : 0);
    int64_t bound = 2, sigma = 0, s = 0;
    while (theta(in, i, i + bound * d, printed) > least)
        bound *= 2;
    for (int64_t t = bound / 2; t >= 1; t /= 2)
        if (theta(in, i, i + (sigma + t) * d, printed) > least)
            sigma += t;
    int64_t j = i + sigma * d, low = i < j ? i : j, high = i < j ? j : i;
    int common = theta(in, i, j, printed);
    if ((int)in->nodes[low].level == common)
        return (split){(uint32_t)low, (uint32_t)low, (uint32_t)high};
    int64_t t = sigma;
    do {
        t = (t + 1) / 2;
        if (theta(in, i, i + (s + t) * d, printed) > common)
            s += t;
    } while (t > 1);
    return (split){(uint32_t)(i + s * d + (d < 0 ? -1 : 0)), (uint32_t)low, (uint32_t)high};
}

/* Follows the splits from the root and compares with the reference's preorder. `r` at the node that
 * covers `from` to `to`. */
static bool follows(const input *in, bool printed, const loose_reference *r, uint32_t n,
                    uint32_t inner, uint32_t from, uint32_t to)
{
    bool leaf = bb_node_is_leaf(&r->nodes[n]);
    if (leaf || from == to)
        return leaf && from == to;
    split s = algorithm_1(in, inner, printed);
    uint32_t second = r->ends[n + 1];
    return s.left_end == from && s.right_end == to && s.at >= from && s.at < to &&
           follows(in, printed, r, n + 1, s.at, from, s.at) &&
           follows(in, printed, r, second, s.at + 1, s.at + 1, to);
}

/* Has algorithm 1 the tree of the definition? */
static bool algorithm_1_holds(const input *in, bool printed)
{
    bb_box boxes[NODES_MAX] = {{{0}, 0, {0}, 0}};
    loose_reference r;
    loose_reference_make(&r, boxes, in->nodes, in->count, in->length, 0);
    bool holds = follows(in, printed, &r, 0, 0, 0, in->count - 1);
    loose_reference_release(&r);
    return holds;
}

static void algorithm_1_as_corrected(void **state)
{
    (void)state;
    const input example = {.length = 3, .count = 3, .nodes = {{0, 0}, {0, 3}, {1, 3}}};
    assert_true(algorithm_1_holds(&example, false));
    assert_false(algorithm_1_holds(&example, true));
    bb_random random = bb_random_make(seed, 2);
    uint32_t lost = 0;
    for (uint32_t t = 0; t < 4000; t++) {
        input in;
        make_input(&random, 1 + t % 12, 2 + t % 40, &in);
        if (!algorithm_1_holds(&in, false))
            fail_msg("input %u, seed %llu", t, (unsigned long long)seed);
        lost += !algorithm_1_holds(&in, true);
    }
    assert_true(lost > 0);
}

/* ---- the device ---- */

static void random_box(bb_random *random, bb_box *box)
{
    *box = (bb_box){{0}, 0, {0}, 0};
    for (int k = 0; k < 3; k++) {
        box->lo[k] = (float)bb_random_range(random, -1, 1);
        box->hi[k] = box->lo[k] + (float)bb_random_unit(random);
    }
}

static bb_status link_nodes(bb_device *device, bb_radix_tree *radix, const input *in,
                            uint32_t key_bytes, const bb_box *boxes, bb_tree *preorder)
{
    uint64_t wide[NODES_MAX];
    uint32_t narrow[NODES_MAX], values[NODES_MAX];
    for (uint32_t i = 0; i < in->count; i++) {
        uint64_t sentinel = (uint64_t)1 << (in->length - in->nodes[i].level);
        wide[i] = (2 * in->nodes[i].path + sentinel) << (63 - in->length);
        narrow[i] = (uint32_t)(wide[i] >> 32);
        values[i] = i;
    }
    bb_tree tree;
    bb_buffer buffers[3] = {{0}}; /* keys, values, boxes */
    const void *data[3] = {key_bytes == 8 ? (const void *)wide : narrow, values, boxes};
    size_t bytes[3] = {in->count * key_bytes, in->count * sizeof *values,
                       in->count * sizeof *boxes};
    bb_tree_init(&tree, NULL);
    bb_status status = BB_OK;
    for (int k = 0; k < 3 && status == BB_OK; k++) {
        status = bb_buffer_reserve(device, NULL, bytes[k], "test", &buffers[k]);
        if (status == BB_OK)
            status = bb_buffer_write(&buffers[k], 0, bytes[k], data[k]);
    }
    if (status == BB_OK)
        status = bb_radix_tree_link(radix, &buffers[0], NULL, &buffers[1], &buffers[2], in->count,
                                    &tree);
    if (status == BB_OK)
        status = bb_tree_fetch_info(&tree);
    if (status == BB_OK)
        status = bb_tree_download(&tree, NULL);
    if (status == BB_OK)
        status = bb_tree_preorder(&tree, preorder);
    for (int k = 0; k < 3; k++)
        bb_buffer_release(&buffers[k]);
    bb_tree_release(&tree);
    return status;
}

/* Dense parent and child sets, in each form, by both ways of linking. */
static void trees_are_those_of_the_definition(void **state)
{
    (void)state;
    uint32_t inputs = getenv("BVHBENCH_TEST_SMALL") != NULL ? 12 : 1000;
    for (uint32_t way = 4 * (uint32_t)first_form(); way < 4 * FORMS; way++) {
        bb_radix_tree *radix;
        bb_device *device = devices[way / 4];
        bb_radix_kind kind = {.key_bytes = (way & 1) != 0 ? 8 : 4,
                              .linking = (way & 2) != 0 ? BB_LINK_KARRAS : BB_LINK_APETREI,
                              .nodes = true};
        assert_int_equal(bb_radix_tree_create(device, NULL, kind, &radix), BB_OK);
        bb_random random = bb_random_make(seed, 3 + way);
        uint32_t longest = kind.key_bytes == 8 ? 63 : 31;
        for (uint32_t t = 0; t < inputs; t++) {
            input in;
            bb_box boxes[NODES_MAX];
            uint32_t length = t % 3 == 0 ? 1 + t % longest : 1 + t % 9;
            make_input(&random, length, t % 50 == 49 ? NODES_MAX : 1 + t % 60, &in);
            for (uint32_t i = 0; i < in.count; i++)
                random_box(&random, &boxes[i]);
            loose_reference r;
            bb_tree preorder;
            bb_tree_init(&preorder, NULL);
            loose_reference_make(&r, boxes, in.nodes, in.count, in.length, 0);
            if (link_nodes(device, radix, &in, kind.key_bytes, boxes, &preorder) != BB_OK)
                fail_msg("%s", bb_message());
            if (!loose_reference_equals(&r, &preorder))
                fail_msg("way %u, input %u, seed %llu: not the tree of the definition", way, t,
                         (unsigned long long)seed);
            loose_reference_release(&r);
            bb_tree_release(&preorder);
        }
        bb_radix_tree_destroy(radix);
    }
}

int main(void)
{
    seed = seed_or(20181010);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(keys_are_the_preorder),
        cmocka_unit_test(thetas_are_common_ancestors),
        cmocka_unit_test(algorithm_1_as_corrected),
        cmocka_unit_test(trees_are_those_of_the_definition),
    };
    return cmocka_run_group_tests(tests, open_devices, close_devices);
}
