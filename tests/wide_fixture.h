/* For tests of wide layouts: a layout read back, as the host sees it, scenes of floats biased to
 * extremes, and the tests run on a device in each of its forms. */
#ifndef BB_TEST_WIDE_FIXTURE_H
#define BB_TEST_WIDE_FIXTURE_H

#include "tests/device_forms.h"
#include "tests/padding_reference.h"
#include "tests/tree_fixture.h"
#include "traversal/traversal.h"

static const uint64_t SEED = 20240701;
static bb_device *device;

static inline bool small(void)
{
    return getenv("BVHBENCH_TEST_SMALL") != NULL; /* under oclgrind */
}

typedef struct wide {
    const bb_scene *scene;
    uint32_t width;
    bool quantised, octants;
    uint8_t *nodes;
    uint32_t *blocks;
    uint32_t words, lanes;                 /* of a block */
    uint32_t *seen;                        /* per primitive */
    uint32_t stack_need, said_need, inner; /* inner: nodes met */
} wide;

static inline const uint32_t *links_of(const wide *w, uint32_t node, uint32_t *count)
{
    if (w->quantised) {
        const bb_quant8 *n = (const bb_quant8 *)w->nodes + node;
        *count = n->count;
        return n->links;
    }
    if (w->width == 4) {
        const bb_wide4 *n = (const bb_wide4 *)w->nodes + node;
        *count = n->count;
        return n->links;
    }
    const bb_wide8 *n = (const bb_wide8 *)w->nodes + node;
    *count = n->count;
    return n->links;
}

static inline bool is_place(const wide *w, uint32_t node, uint32_t child)
{
    if (w->quantised)
        return (((const bb_quant8 *)w->nodes + node)->places >> child & 1u) != 0;
    const float *planes = w->width == 4 ? ((const bb_wide4 *)w->nodes + node)->planes
                                        : ((const bb_wide8 *)w->nodes + node)->planes;
    return isfinite(planes[child]);
}

static inline bb_box box_of(const wide *w, uint32_t node, uint32_t child)
{
    bb_box box = {.lo = {0}};
    for (uint32_t axis = 0; axis < 3; axis++) {
        uint32_t lo = 2 * axis * w->width + child, hi = lo + w->width;
        if (w->quantised) {
            const bb_quant8 *n = (const bb_quant8 *)w->nodes + node;
            box.lo[axis] = fmaf(n->planes[lo], n->scale[axis], n->base[axis]);
            box.hi[axis] = fmaf(n->planes[hi], n->scale[axis], n->base[axis]);
        } else {
            const float *planes = w->width == 4 ? ((const bb_wide4 *)w->nodes + node)->planes
                                                : ((const bb_wide8 *)w->nodes + node)->planes;
            box.lo[axis] = planes[lo];
            box.hi[axis] = planes[hi];
        }
    }
    return box;
}

static inline void *download(const bb_buffer *buffer)
{
    void *copy = malloc(buffer->bytes);
    ASSERT_OK(bb_buffer_read(buffer, 0, buffer->bytes, copy));
    return copy;
}

/* A layout as the host sees it; *root: its link. */
static inline wide read_wide(const char *name, const bb_scene *scene, bb_tree *tree, uint32_t leaf,
                             const bb_layout_wish *wish, uint32_t *root)
{
    bb_layout_maker maker;
    bb_layout_data data = {0};
    ASSERT_OK(bb_layout_maker_create(bb_layout_find(name), device, &maker));
    maker.wish = *wish;
    ASSERT_OK(bb_layout_maker_make(&maker, scene, tree, leaf, BB_FORMAT_VERTICES, &data));
    wide w = {
        .scene = scene,
        .width = strcmp(name, "wide4") == 0 ? 4 : 8,
        .quantised = strcmp(name, "quant8") == 0,
        .octants = wish->octants,
        .nodes = download(&data.buffers[0]),
        .blocks = download(&data.buffers[1]),
        .words = data.lanes == 1 ? bb_leaf_prim_words(scene->kinds, BB_FORMAT_VERTICES)
                                 : bb_block_words(scene->kinds, BB_FORMAT_VERTICES),
        .lanes = data.lanes,
        .seen = calloc(scene->prim_count, sizeof *w.seen),
        .said_need = data.stack_need,
    };
    *root = data.root;
    assert_int_equal(strstr(data.name, "plan=greedy") != NULL, wish->plan == BB_PLAN_GREEDY);
    assert_int_equal(strstr(data.name, "plan=native") != NULL, wish->plan == BB_PLAN_NATIVE);
    bb_layout_data_release(&data);
    bb_layout_maker_destroy(&maker);
    return w;
}

static inline void free_wide(wide *w)
{
    free(w->nodes);
    free(w->blocks);
    free(w->seen);
}

/* A coordinate of any size that layouts have, near others of its kind or not. */
static inline float extreme(bb_random *random, uint32_t kind)
{
    static const float pool[] = {0.0f,  -0.0f,    1e-45f, -3e-42f, 1.2e-38f, 1e-30f, 1e-3f, 1.0f,
                                 -1.0f, 16777216, -1e7f,  1e12f,   -1e15f,   1e17f,  -2e17f};
    float sign = bb_random_below(random, 2) ? 1.0f : -1.0f;
    switch (kind) {
    case 0:
        return (float)bb_random_range(random, -100, 100);
    case 1:
        return pool[bb_random_below(random, sizeof pool / sizeof pool[0])];
    case 2: /* far away */
        return 1e7f + (float)bb_random_below(random, 64);
    case 3: /* any exponent */
        return sign * ldexpf(1.0f + (float)bb_random_unit(random) * 0.999f,
                             (int)bb_random_below(random, 207) - 149);
    default: /* denormal */
        return sign * ldexpf((float)bb_random_below(random, 1000), -149);
    }
}

/* Runs a group of tests on the device in each form that is asked for. */
#define RUN_ON_EACH_DEVICE(tests, failed)                                                          \
    for (int form = first_form(); form < FORMS && (failed) == 0; form += LEVELS_FORM) {            \
        device = devices[form];                                                                    \
        failed = cmocka_run_group_tests(tests, NULL, NULL);                                        \
    }

#endif
