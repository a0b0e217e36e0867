/* LBVH against slow recursive constructions from the definitions, binary and wide, in both forms,
 * both ways of linking, both code lengths; bit for bit. Seed: BVHBENCH_TEST_SEED.
 * BVHBENCH_TEST_SMALL keeps the inputs small (for oclgrind). */
#include "framework/base/random.h"
#include "framework/builder/instance.h"
#include "tests/box_fixture.h"
#include "tests/device_forms.h"
#include "tests/fixture.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- the reference ---- */

typedef struct item {
    uint64_t code;
    uint32_t prim;
} item;

typedef struct reference {
    const bb_box *boxes;
    const item *items;
    bb_node *nodes;
    uint32_t *refs;
    uint32_t node_count, ref_count, depth;
} reference;

static int compare_items(const void *a, const void *b)
{
    const item *x = a, *y = b;
    if (x->code != y->code)
        return x->code < y->code ? -1 : 1;
    return x->prim < y->prim ? -1 : 1;
}

/* Bit by bit: axis x first, highest bit first. */
static uint64_t reference_code(const bb_box *box, const float low[3], const float high[3],
                               uint32_t bits)
{
    uint64_t cells[3], code = 0;
    for (int k = 0; k < 3; k++) {
        double extent = (double)high[k] - low[k], cells_per_unit = ldexp(1, (int)bits) / extent;
        float scale = extent > 0 && cells_per_unit <= FLT_MAX ? (float)cells_per_unit : 0;
        float cell = ((0.5f * box->lo[k] + 0.5f * box->hi[k]) - low[k]) * scale;
        float last = (float)((1u << bits) - 1);
        cells[k] = (uint64_t)(cell < last ? cell : last);
    }
    for (int bit = (int)bits - 1; bit >= 0; bit--)
        for (int k = 0; k < 3; k++)
            code = code << 1 | (cells[k] >> bit & 1);
    return code;
}

/* The first of the items that has the highest differing bit set; codes are told apart by
 * position. */
static uint32_t split_of(const item *items, uint32_t from, uint32_t to)
{
    uint64_t differ = items[from].code ^ items[to - 1].code;
    bool by_code = differ != 0;
    if (!by_code)
        differ = from ^ (to - 1);
    uint64_t bit = (uint64_t)1 << (63 - __builtin_clzll(differ));
    uint32_t s = from;
    while (((by_code ? items[s].code : s) & bit) == 0)
        s++;
    return s;
}

static uint32_t reference_node(reference *r, uint32_t from, uint32_t to, uint32_t skip,
                               uint32_t depth)
{
    /* preorder: a subtree over k leaves takes 2k - 1 nodes */
    uint32_t n = r->node_count++;
    bb_node *node = &r->nodes[n];
    node->skip = skip;
    r->depth = depth > r->depth ? depth : r->depth;
    if (to - from == 1) {
        uint32_t prim = r->items[from].prim;
        node->first = BB_LEAF_BIT | r->ref_count;
        r->refs[r->ref_count++] = prim | BB_LAST_BIT;
        memcpy(node->lo, r->boxes[prim].lo, sizeof node->lo);
        memcpy(node->hi, r->boxes[prim].hi, sizeof node->hi);
        return n;
    }
    uint32_t s = split_of(r->items, from, to);
    uint32_t right = n + 1 + 2 * (s - from) - 1;
    node->first = n + 1;
    reference_node(r, from, s, right, depth + 1);
    reference_node(r, s, to, skip, depth + 1);
    for (int k = 0; k < 3; k++) {
        node->lo[k] = fminf(r->nodes[n + 1].lo[k], r->nodes[right].lo[k]);
        node->hi[k] = fmaxf(r->nodes[n + 1].hi[k], r->nodes[right].hi[k]);
    }
    return n;
}

/* The last child of a node, until the node's own skip is known. */
#define LAST_CHILD (BB_NONE - 1)

static void set_skips(reference *r, uint32_t n, uint32_t skip)
{
    r->nodes[n].skip = skip;
    if (bb_node_is_leaf(&r->nodes[n]))
        return;
    uint32_t child = r->nodes[n].first;
    while (r->nodes[child].skip != LAST_CHILD) {
        const uint32_t next = r->nodes[child].skip;
        set_skips(r, child, next);
        child = next;
    }
    set_skips(r, child, skip);
}

/* How early items are to be cut: by the first bit in which their codes differ; 0 for a leaf. */
static int rank_of(const reference *r, uint32_t from, uint32_t to, uint32_t leaf)
{
    const uint64_t differ = r->items[from].code ^ r->items[to - 1].code;
    return to - from <= leaf ? 0 : differ == 0 ? 1 : 65 - __builtin_clzll(differ);
}

/* Cuts the range whose codes differ first as long as there is one of more than `leaf`, into 8 at
 * most. */
static uint32_t cut_ranges(const reference *r, uint32_t from, uint32_t to, uint32_t leaf,
                           uint32_t ends[8])
{
    uint32_t count = 1;
    ends[0] = to;
    for (;;) {
        uint32_t largest = 0;
        int most = 0;
        for (uint32_t c = 0; c < count; c++) {
            const int rank = rank_of(r, c > 0 ? ends[c - 1] : from, ends[c], leaf);
            largest = rank > most ? c : largest;
            most = rank > most ? rank : most;
        }
        if (count == 8 || most == 0)
            return count;
        const uint32_t begin = largest > 0 ? ends[largest - 1] : from, end = ends[largest];
        for (uint32_t c = count++; c > largest; c--)
            ends[c] = ends[c - 1];
        ends[largest] = r->items[begin].code == r->items[end - 1].code
                            ? begin + (end - begin) / 2
                            : split_of(r->items, begin, end);
    }
}

static uint32_t wide_reference_node(reference *r, uint32_t from, uint32_t to, uint32_t leaf,
                                    uint32_t depth)
{
    uint32_t n = r->node_count++, ends[8], before = BB_NONE;
    bb_node *node = &r->nodes[n];
    *node = (bb_node){{INFINITY, INFINITY, INFINITY},
                      BB_LEAF_BIT | from,
                      {-INFINITY, -INFINITY, -INFINITY},
                      LAST_CHILD};
    r->depth = depth > r->depth ? depth : r->depth;
    for (uint32_t i = from; i < to; i++)
        for (int k = 0; k < 3; k++) {
            node->lo[k] = fminf(node->lo[k], r->boxes[r->items[i].prim].lo[k]);
            node->hi[k] = fmaxf(node->hi[k], r->boxes[r->items[i].prim].hi[k]);
        }
    if (to - from <= leaf) {
        for (uint32_t i = from; i < to; i++)
            r->refs[i] = r->items[i].prim | (i + 1 == to ? BB_LAST_BIT : 0);
        return n;
    }
    const uint32_t count = cut_ranges(r, from, to, leaf, ends);
    node->first = n + 1;
    for (uint32_t c = 0; c < count; c++) {
        const uint32_t child =
            wide_reference_node(r, c > 0 ? ends[c - 1] : from, ends[c], leaf, depth + 1);
        if (before != BB_NONE)
            r->nodes[before].skip = child;
        before = child;
    }
    return n;
}

/* ---- the comparison ---- */

/* leaf: most primitives of a leaf of a wide tree; 0: the tree is binary. */
static void make_reference(reference *r, const bb_box *boxes, uint32_t count, uint32_t bits,
                           uint32_t leaf)
{
    float low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (uint32_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) {
            float c = 0.5f * boxes[i].lo[k] + 0.5f * boxes[i].hi[k];
            low[k] = fminf(low[k], c);
            high[k] = fmaxf(high[k], c);
        }
    item *items = malloc(count * sizeof *items);
    for (uint32_t i = 0; i < count; i++)
        items[i] = (item){reference_code(&boxes[i], low, high, bits), i};
    qsort(items, count, sizeof *items, compare_items);
    *r = (reference){.boxes = boxes, .items = items};
    r->nodes = calloc(2 * (size_t)count, sizeof *r->nodes);
    r->refs = calloc(count, sizeof *r->refs);
    if (leaf > 0)
        set_skips(r, wide_reference_node(r, 0, count, leaf, 0), BB_NONE);
    else
        reference_node(r, 0, count, BB_NONE, 0);
    free(items);
}

static void compare(bb_device *device, const char *builder, const bb_box *boxes, uint32_t count,
                    const reference *r, const char *what)
{
    box_build b;
    open_box_build(&b, device, builder, boxes, count, what);
    if (b.preorder.info.depth != r->depth || b.preorder.info.node_count != r->node_count ||
        memcmp(b.preorder.nodes, r->nodes, b.preorder.info.node_count * sizeof(bb_node)) != 0 ||
        memcmp(b.preorder.refs, r->refs, count * sizeof(uint32_t)) != 0)
        fail_msg("%s, %s, %u boxes, seed %llu: not the tree of the definition", builder, what,
                 count, (unsigned long long)seed);
    close_box_build(&b);
}

static void compare_all(const bb_box *boxes, uint32_t count, const char *what)
{
    static const struct {
        const char *builder;
        uint32_t bits, leaf;
    } ways[] = {
        {"lbvh", 10, 0},
        {"lbvh:link=karras", 10, 0},
        {"lbvh:bits=63", 21, 0},
        {"lbvh:bits=63,link=karras", 21, 0},
        {"lbvh:arity=8", 10, 4},
        {"lbvh:arity=8,leaf=1", 10, 1},
        {"lbvh:arity=8,leaf=64", 10, 64},
        {"lbvh:arity=8,leaf=3,bits=63", 21, 3},
    };
    for (int form = first_form(); form < FORMS; form++) {
        for (size_t w = 0; w < sizeof ways / sizeof ways[0]; w++) {
            reference r;
            make_reference(&r, boxes, count, ways[w].bits, ways[w].leaf);
            compare(devices[form], ways[w].builder, boxes, count, &r, what);
            free(r.nodes);
            free(r.refs);
        }
    }
}

static void set_point(bb_box *box, const double centre[3], double size)
{
    *box = (bb_box){0};
    for (int k = 0; k < 3; k++) {
        box->lo[k] = (float)(centre[k] - size);
        box->hi[k] = (float)(centre[k] + size);
    }
}

typedef void (*fill_function)(bb_random *random, uint32_t i, uint32_t count, bb_box *box);

static void fill_uniform(bb_random *random, uint32_t i, uint32_t count, bb_box *box)
{
    (void)i;
    (void)count;
    double c[3];
    for (int k = 0; k < 3; k++)
        c[k] = bb_random_range(random, -1, 1);
    set_point(box, c, bb_random_unit(random) * 0.01);
}

static void fill_equal(bb_random *random, uint32_t i, uint32_t count, bb_box *box)
{
    (void)i;
    (void)count;
    set_point(box, (const double[]){3, -4, 5}, bb_random_unit(random));
}

static void fill_line(bb_random *random, uint32_t i, uint32_t count, bb_box *box)
{
    (void)random;
    set_point(box, (const double[]){1, (double)i / count, 1}, 0);
}

static void fill_few(bb_random *random, uint32_t i, uint32_t count, bb_box *box)
{
    (void)i;
    (void)count;
    double x = bb_random_below(random, 3);
    set_point(box, (const double[]){x, 2 * x, 0}, 0.1);
}

/* One outlier far away: all others share one code. */
static void fill_outlier(bb_random *random, uint32_t i, uint32_t count, bb_box *box)
{
    fill_uniform(random, i, count, box);
    if (i == count / 2)
        set_point(box, (const double[]){1e8, 1e8, 1e8}, 1);
}

/* Geometric series: each bit of the code splits one off, the deepest tree there is. */
static void fill_chain(bb_random *random, uint32_t i, uint32_t count, bb_box *box)
{
    (void)random;
    (void)count;
    double x = ldexp(1, -(int)(i % 40));
    set_point(box, (const double[]){x, x, x}, 0);
}

static void fill_extreme(bb_random *random, uint32_t i, uint32_t count, bb_box *box)
{
    (void)i;
    (void)count;
    double c[3];
    for (int k = 0; k < 3; k++)
        c[k] = ldexp(bb_random_range(random, -1, 1), (int)bb_random_below(random, 200) - 140);
    set_point(box, c, 0);
}

static void trees_are_those_of_the_definition(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        fill_function fill;
    } inputs[] = {
        {"uniform", fill_uniform}, {"equal", fill_equal},     {"line", fill_line},
        {"few", fill_few},         {"outlier", fill_outlier}, {"chain", fill_chain},
        {"extreme", fill_extreme},
    };
    static const uint32_t counts[] = {1, 2, 3, 4, 63, 64, 65, 1000, 2047, 2048, 2049, 30011};
    bool small = getenv("BVHBENCH_TEST_SMALL") != NULL;
    for (size_t k = 0; k < sizeof inputs / sizeof inputs[0]; k++)
        for (size_t c = 0; c < sizeof counts / sizeof counts[0]; c++) {
            if (counts[c] > 3000 && k != 0 && k != 1)
                continue;
            if (small && (counts[c] != 65 || k % 2 == 0) && !(counts[c] == 1 && k < 2))
                continue;
            bb_random random = bb_random_make(seed, k * 100 + c);
            bb_box *boxes = malloc(counts[c] * sizeof *boxes);
            for (uint32_t i = 0; i < counts[c]; i++)
                inputs[k].fill(&random, i, counts[c], &boxes[i]);
            compare_all(boxes, counts[c], inputs[k].name);
            free(boxes);
        }
}

int main(void)
{
    seed = seed_or(20261121);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(trees_are_those_of_the_definition),
    };
    return cmocka_run_group_tests(tests, open_devices, close_devices);
}
