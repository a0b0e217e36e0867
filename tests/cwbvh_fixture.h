/* Compressed nodes (bb_cwbvh) as the host sees them. */
#ifndef BB_TEST_CWBVH_FIXTURE_H
#define BB_TEST_CWBVH_FIXTURE_H

#include "tests/wide_fixture.h"

typedef struct compressed {
    bb_cwbvh *nodes;
    uint32_t *records;
    uint32_t words; /* of a record */
    size_t node_count, record_count;
    uint32_t root, stack_need;
} compressed;

static inline compressed read_compressed(const bb_scene *scene, bb_tree *tree, uint32_t leaf,
                                         bool greedy)
{
    bb_layout_maker maker;
    bb_layout_data data = {0};
    ASSERT_OK(bb_layout_maker_create(bb_layout_find("cwbvh"), device, &maker));
    maker.wish.plan = greedy ? BB_PLAN_GREEDY : BB_PLAN_OPTIMAL;
    ASSERT_OK(bb_layout_maker_make(&maker, scene, tree, leaf, BB_FORMAT_VERTICES, &data));
    const compressed c = {
        .nodes = download(&data.buffers[0]),
        .records = download(&data.buffers[1]),
        .words = bb_leaf_prim_words(scene->kinds, BB_FORMAT_VERTICES),
        .node_count = data.buffers[0].bytes / sizeof(bb_cwbvh),
        .record_count = data.buffers[1].bytes / sizeof(uint32_t) /
                        bb_leaf_prim_words(scene->kinds, BB_FORMAT_VERTICES),
        .root = data.root,
        .stack_need = data.stack_need,
    };
    assert_int_equal(data.lanes, 1);
    assert_false(data.keeps_shape);
    if ((data.root & BB_LEAF_BIT) == 0)
        assert_int_equal(data.bytes, data.buffers[0].bytes + data.buffers[1].bytes);
    bb_layout_data_release(&data);
    bb_layout_maker_destroy(&maker);
    return c;
}

static inline void free_compressed(compressed *c)
{
    free(c->nodes);
    free(c->records);
}

static inline double step_of(const bb_cwbvh *node, int axis)
{
    return ldexp(1, node->exponents[axis] - 127);
}

/* Primitives of the leaf at a place; 0: there is none, or a node. */
static inline uint32_t leaf_prims(const bb_cwbvh *node, uint32_t place)
{
    const uint32_t unary = node->meta[place] >> 5;
    if ((node->meta[place] & 31) >= 24)
        return 0;
    assert_true(unary == 0 || unary == 1 || unary == 3 || unary == 7);
    return unary == 7 ? 3 : unary == 3 ? 2 : unary;
}

/* The node at a place, of those of `node`; BB_NONE: there is none. */
static inline uint32_t node_at(const bb_cwbvh *node, uint32_t place)
{
    const bool inner = (node->inner >> place & 1) != 0;
    assert_int_equal(inner, node->meta[place] == (32 | (24 + place)));
    uint32_t before = 0;
    for (uint32_t p = 0; p < place; p++)
        before += node->inner >> p & 1;
    return inner ? node->nodes + before : BB_NONE;
}

/* The primitive of a record, each of which closes a leaf. */
static inline uint32_t prim_of(const compressed *c, const bb_scene *scene, uint32_t record)
{
    assert_true(record < c->record_count);
    const uint32_t tagged = c->records[(size_t)record * c->words +
                                       bb_leaf_prim_payload(scene->kinds, BB_FORMAT_VERTICES)];
    assert_int_equal(tagged & BB_LAST_BIT, BB_LAST_BIT);
    return tagged & BB_INDEX_MASK;
}

#endif
