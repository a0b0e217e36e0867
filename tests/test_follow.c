/* Layouts that follow a tree in place, there and back again: as they were, bit for bit.
 * BVHBENCH_TEST_SMALL keeps the scenes small (for oclgrind). */
#include "framework/builder/instance.h"
#include "tests/device_forms.h"
#include "tests/layout_leaf.h"
#include "traversal/traversal.h"

enum { FRAMES = 4 };

typedef struct bytes {
    uint32_t root, stack_need, count;
    size_t sizes[BB_LAYOUT_BUFFERS_MAX];
    char *data[BB_LAYOUT_BUFFERS_MAX];
} bytes;

static bytes read_layout(const bb_layout_data *layout)
{
    bytes read = {layout->root, layout->stack_need, layout->buffer_count, {0}, {NULL}};
    for (uint32_t i = 0; i < layout->buffer_count; i++) {
        read.sizes[i] = layout->buffers[i].bytes;
        read.data[i] = malloc(read.sizes[i]);
        assert_non_null(read.data[i]);
        ASSERT_OK(bb_buffer_read(&layout->buffers[i], 0, read.sizes[i], read.data[i]));
    }
    return read;
}

static bool is_equal(const bytes *a, const bytes *b)
{
    bool equal = a->root == b->root && a->stack_need == b->stack_need && a->count == b->count;
    for (uint32_t i = 0; i < a->count && equal; i++)
        equal = a->sizes[i] == b->sizes[i] && memcmp(a->data[i], b->data[i], a->sizes[i]) == 0;
    return equal;
}

static void release(bytes *read)
{
    for (uint32_t i = 0; i < read->count; i++)
        free(read->data[i]);
}

typedef struct moving {
    bb_scene *scene;
    bb_instance instance;
} moving;

static void start(moving *m, bb_device *device, const char *scene, const char *builder)
{
    ASSERT_OK(bb_scene_load(scene, &m->scene));
    ASSERT_OK(bb_scene_upload(m->scene, device));
    ASSERT_OK(bb_instance_create(device, builder, m->scene, 1, &m->instance));
    ASSERT_OK(bb_instance_build(&m->instance, m->scene, false, NULL));
}

static void go_to(moving *m, uint32_t frame)
{
    bb_update_way way;
    uint32_t changed;
    ASSERT_OK(bb_scene_set_frame(m->scene, frame, &changed));
    ASSERT_OK(bb_instance_update(&m->instance, m->scene, changed, false, &way, NULL));
    assert_int_equal(way, BB_UPDATED);
}

static void stop(moving *m)
{
    bb_instance_destroy(&m->instance);
    bb_scene_free(m->scene);
}

static const bb_layout_wish planned = {.plan = BB_PLAN_OPTIMAL}, greedy = {.plan = BB_PLAN_GREEDY},
                            native = {.plan = BB_PLAN_NATIVE}, by_tree = {.plan = BB_PLAN_BY_TREE};

static void come_back(bb_device *device, const char *scene, const char *builder, const char *layout,
                      uint32_t leaf, bb_layout_wish wish)
{
    moving m;
    bb_layout_maker maker;
    bb_layout_data data = {0};
    bool in_place;
    leaf = leaf_for(bb_layout_find(layout), leaf);
    start(&m, device, scene, builder);
    ASSERT_OK(bb_layout_maker_create(bb_layout_find(layout), device, &maker));
    maker.wish = wish;
    ASSERT_OK(bb_layout_maker_make(&maker, m.scene, &m.instance.tree, leaf, 0, &data));
    if (wish.plan == BB_PLAN_BY_TREE) /* the optimiser hands on what the builder says */
        assert_string_equal(data.name, "wide8:plan=native");
    bytes before = read_layout(&data);
    for (uint32_t frame = 1; frame <= FRAMES; frame++) {
        go_to(&m, frame % FRAMES);
        ASSERT_OK(
            bb_layout_maker_follow(&maker, m.scene, &m.instance.tree, leaf, 0, &data, &in_place));
        assert_true(in_place);
        bytes now = read_layout(&data);
        if (is_equal(&before, &now) != (frame == FRAMES))
            fail_msg("%s, %s: layout %s of leaves of %u in frame %u", scene, builder, layout, leaf,
                     frame % FRAMES);
        release(&now);
    }
    release(&before);
    bb_layout_data_release(&data);
    bb_layout_maker_destroy(&maker);
    stop(&m);
}

static const char *const layouts[] = {"pair", "skip", "wide4", "wide8", "quant8", "cwbvh"};
enum { LAYOUTS = sizeof layouts / sizeof layouts[0] };

static const char *scene_of(const char *small, const char *usual)
{
    return getenv("BVHBENCH_TEST_SMALL") != NULL ? small : usual;
}

/* Binary trees, with leaves of one and of several primitives. */
static void layouts_come_back(void **state)
{
    (void)state;
    for (int i = 0; i < LAYOUTS; i++)
        for (uint32_t leaf = 1; leaf <= 4; leaf += 3)
            come_back(
                devices[CPU_FORM],
                scene_of("crowd:kind=explode,n=100,frames=4", "crowd:kind=explode,n=2000,frames=4"),
                "lbvh+refit", layouts[i], leaf, planned);
}

/* Nodes of many children: several pairs of a node, and sides that are made of several children. */
static void layouts_of_many_children_come_back(void **state)
{
    (void)state;
    for (int i = 0; i < LAYOUTS; i++)
        come_back(devices[CPU_FORM], scene_of("twist:n=100,frames=4", "twist:n=1500,frames=4"),
                  "loose-bvh+refit", layouts[i], 1, planned);
}

/* Nodes that were opened greedily, straight from the tree and by way of pairs. */
static void greedy_nodes_come_back(void **state)
{
    (void)state;
    const char *scene = scene_of("twist:n=100,frames=4", "twist:n=1500,frames=4");
    come_back(devices[CPU_FORM], scene, "lbvh+refit", "wide8", 4, greedy);
    come_back(devices[CPU_FORM], scene, "loose-bvh+refit", "wide4", 1, greedy);
    come_back(devices[CPU_FORM], scene, "lbvh+refit", "cwbvh", 3, greedy);
}

/* The tree's own nodes: of 8 children with leaves of several primitives or of one, and of two. */
static void native_nodes_come_back(void **state)
{
    (void)state;
    const char *scene = scene_of("twist:n=100,frames=4", "twist:n=1500,frames=4");
    for (int form = first_form(); form < FORMS; form += LEVELS_FORM) {
        come_back(devices[form], scene, "lbvh:arity=8+refit", "wide8", 1, native);
        come_back(devices[form], scene, "lbvh:arity=8+refit", "wide8", 8, by_tree);
        come_back(devices[form], scene, "lbvh:arity=8,leaf=1+refit", "quant8", 1, native);
        come_back(devices[form], scene, "lbvh+refit", "wide4", 3, native);
    }
}

/* A tree that is one leaf, and one of a single inner node. */
static void small_layouts_come_back(void **state)
{
    (void)state;
    for (int i = 0; i < LAYOUTS; i++)
        for (uint32_t leaf = 1; leaf <= 64; leaf += 63)
            come_back(devices[CPU_FORM], "crowd:kind=flow,n=2,frames=4", "lbvh+refit", layouts[i],
                      leaf, planned);
}

/* A new tree of another number of nodes: what was known of the old one is forgotten. */
static void a_new_tree_is_followed_too(void **state)
{
    (void)state;
    bb_device *device = devices[CPU_FORM];
    for (int i = 0; i < LAYOUTS; i++) {
        moving small, large;
        bb_layout_maker maker;
        bb_layout_data data = {0};
        bool in_place;
        start(&small, device, "twist:n=50,frames=4", "lbvh+refit");
        start(&large, device, scene_of("twist:n=150,frames=4", "twist:n=2000,frames=4"),
              "loose-bvh+refit");
        ASSERT_OK(bb_layout_maker_create(bb_layout_find(layouts[i]), device, &maker));
        ASSERT_OK(bb_layout_maker_make(&maker, small.scene, &small.instance.tree, 1, 0, &data));
        go_to(&small, 1);
        ASSERT_OK(bb_layout_maker_follow(&maker, small.scene, &small.instance.tree, 1, 0, &data,
                                         &in_place));
        assert_true(in_place);
        ASSERT_OK(bb_layout_maker_follow(&maker, large.scene, &large.instance.tree, 1, 0, &data,
                                         &in_place));
        assert_false(in_place);
        bytes before = read_layout(&data);
        for (uint32_t frame = 0; frame < 2; frame++) {
            go_to(&large, 1 - frame);
            ASSERT_OK(bb_layout_maker_follow(&maker, large.scene, &large.instance.tree, 1, 0, &data,
                                             &in_place));
            assert_true(in_place);
        }
        bytes now = read_layout(&data);
        assert_true(is_equal(&before, &now));
        release(&now);
        release(&before);
        bb_layout_data_release(&data);
        bb_layout_maker_destroy(&maker);
        stop(&small);
        stop(&large);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(layouts_come_back),
        cmocka_unit_test(layouts_of_many_children_come_back),
        cmocka_unit_test(greedy_nodes_come_back),
        cmocka_unit_test(native_nodes_come_back),
        cmocka_unit_test(small_layouts_come_back),
        cmocka_unit_test(a_new_tree_is_followed_too),
    };
    return cmocka_run_group_tests_name("follow", tests, open_devices, close_devices);
}
