/* Side arrays of trees: reserved and booked by a builder, copied with the tree, renumbered and
 * hashed with it, gone when it is reserved again; and asked for by a layout. */
#include "tests/device_fixture.h"
#include "tests/tree_fixture.h"
#include "traversal/traversal.h"

enum { SEED = 31, PRIMS = 300 };

/* A layout whose nodes are what the tree's array "marks" says of each. */
static bb_status create(bb_device *on, bb_account *account, void **self)
{
    (void)on;
    *self = account;
    return BB_OK;
}

static bb_status make(void *self, const bb_layout_source *source, bb_layout_data *data)
{
    size_t count = source->tree->info.node_count;
    uint32_t *marks = malloc(count * sizeof *marks);
    data->buffer_count = 1;
    data->keeps_shape = true;
    bb_status status =
        bb_buffer_reserve(device, self, count * sizeof *marks, "marks", &data->buffers[0]);
    if (status == BB_OK)
        status = bb_buffer_read(source->array, 0, count * sizeof *marks, marks);
    if (status == BB_OK)
        status = bb_buffer_write(&data->buffers[0], 0, count * sizeof *marks, marks);
    free(marks);
    return status;
}

static void destroy(void *self)
{
    (void)self;
}

static const bb_layout marked = {
    .name = "marked",
    .summary = "for this test",
    .width = 2,
    .block = 1,
    .array = {.name = "marks", .stride = sizeof(uint32_t)},
    .create = create,
    .make = make,
    .destroy = destroy,
};

typedef struct bed {
    bb_scene *scene;
    bb_account account;
    bb_tree tree; /* on the host, of binary nodes in random order */
    uint32_t *marks;
} bed;

static void add_marks(bed *b, uint32_t salt)
{
    bb_tree_array *array;
    ASSERT_OK(bb_tree_reserve_array(&b->tree, NULL, "marks", false, sizeof(uint32_t), &array));
    b->marks = array->host;
    for (uint32_t i = 0; i < b->tree.info.node_count; i++)
        b->marks[i] = i * 2654435761u + salt;
}

static void open_bed(bed *b)
{
    bb_random random = bb_random_make(SEED, 0);
    bb_tree random_tree;
    memset(b, 0, sizeof *b);
    b->scene = make_random_scene(PRIMS, &random);
    make_random_tree(b->scene, 2, 1, &random, &random_tree);
    bb_tree_init(&b->tree, &b->account);
    const bb_tree_info info = random_tree.info;
    ASSERT_OK(bb_tree_reserve(&b->tree, NULL, BB_ON_HOST, info.node_count, info.ref_count));
    memcpy(b->tree.nodes, random_tree.nodes, info.node_count * sizeof(bb_node));
    memcpy(b->tree.refs, random_tree.refs, info.ref_count * sizeof(uint32_t));
    b->tree.info = info;
    bb_tree_release(&random_tree);
}

static void close_bed(bed *b)
{
    bb_tree_release(&b->tree);
    assert_int_equal(b->account.bytes, 0);
    free_scene(b->scene);
}

static void they_are_booked_and_counted(void **state)
{
    (void)state;
    bed b;
    open_bed(&b);
    uint64_t booked = b.account.bytes, bytes = bb_tree_bytes(&b.tree);
    uint32_t nodes = b.tree.info.node_count;
    add_marks(&b, 0);
    assert_int_equal(b.account.bytes, booked + nodes * sizeof(uint32_t));
    assert_int_equal(bb_tree_bytes(&b.tree), bytes + nodes * sizeof(uint32_t));
    assert_non_null(bb_tree_find_array(&b.tree, "marks"));
    assert_null(bb_tree_find_array(&b.tree, "others"));

    /* what is reserved anew has no arrays; the next one of the name takes the memory of the last */
    const bb_tree_info info = b.tree.info;
    ASSERT_OK(bb_tree_reserve(&b.tree, NULL, BB_ON_HOST, info.node_count, info.ref_count));
    assert_null(bb_tree_find_array(&b.tree, "marks"));
    b.tree.info = info;
    assert_int_equal(bb_tree_bytes(&b.tree), bytes);
    const uint32_t *before = b.marks;
    add_marks(&b, 0);
    assert_ptr_equal(b.marks, before);
    bb_tree_array *array;
    static const char *const names[] = {"a", "b", "c", "d"};
    for (int i = 0; i < 4; i++)
        assert_int_equal(bb_tree_reserve_array(&b.tree, NULL, names[i], true, 4, &array),
                         i < BB_TREE_ARRAYS_MAX - 1 ? BB_OK : BB_FAILED);
    assert_int_equal(bb_tree_reserve_array(&b.tree, NULL, "marks", true, 3, &array), BB_FAILED);
    bb_tree empty;
    bb_tree_init(&empty, NULL);
    assert_int_equal(bb_tree_reserve_array(&empty, NULL, "marks", true, 4, &array), BB_FAILED);
    close_bed(&b);
}

static void they_go_with_the_nodes(void **state)
{
    (void)state;
    bed b;
    uint64_t plain, with, other;
    bb_tree preorder;
    open_bed(&b);
    ASSERT_OK(bb_tree_hash(&b.tree, &plain));
    add_marks(&b, 0);
    ASSERT_OK(bb_tree_hash(&b.tree, &with));
    b.marks[5] ^= 1;
    ASSERT_OK(bb_tree_hash(&b.tree, &other));
    assert_true(plain != with && with != other);
    b.marks[5] ^= 1;
    bb_tree_init(&preorder, NULL);
    ASSERT_OK(bb_tree_preorder(&b.tree, &preorder));
    const uint32_t *moved = bb_tree_find_array(&preorder, "marks")->host;
    for (uint32_t i = 0, n = b.tree.info.root; n != BB_NONE; i++) {
        const bb_node *node = &b.tree.nodes[n];
        assert_int_equal(moved[i], b.marks[n]);
        n = bb_node_is_leaf(node) ? node->skip : node->first;
    }
    ASSERT_OK(bb_tree_hash(&preorder, &other)); /* renumbered, it is the same tree */
    assert_true(other == with);
    bb_tree_release(&preorder);
    close_bed(&b);
}

static void a_layout_reads_the_one_that_it_asks_for(void **state)
{
    (void)state;
    bed b;
    bb_layout_maker maker;
    bb_layout_data data = {0};
    open_bed(&b);
    size_t bytes = b.scene->prim_count * sizeof(bb_box);
    ASSERT_OK(bb_buffer_reserve(device, NULL, bytes, "boxes", &b.scene->on_device.boxes));
    ASSERT_OK(bb_layout_maker_create(&marked, device, &maker));
    ASSERT_OK(bb_tree_upload(&b.tree, device, NULL));
    assert_int_equal(bb_layout_maker_make(&maker, b.scene, &b.tree, 1, BB_FORMAT_VERTICES, &data),
                     BB_UNSUPPORTED);
    assert_non_null(strstr(bb_message(), "layout marked reads the side array 'marks', which this "
                                         "tree does not have"));
    for (uint32_t salt = 0; salt < 2; salt++) {
        uint32_t *made = malloc(b.tree.info.node_count * sizeof *made);
        add_marks(&b, salt); /* makes the copy on the device stale */
        ASSERT_OK(bb_tree_upload(&b.tree, device, NULL));
        ASSERT_OK(bb_layout_maker_make(&maker, b.scene, &b.tree, 1, BB_FORMAT_VERTICES, &data));
        ASSERT_OK(bb_buffer_read(&data.buffers[0], 0, b.tree.info.node_count * sizeof *made, made));
        assert_memory_equal(made, b.marks, b.tree.info.node_count * sizeof *made);
        free(made);
    }
    assert_int_equal(bb_layout_maker_make(&maker, b.scene, &b.tree, 4, BB_FORMAT_VERTICES, &data),
                     BB_UNSUPPORTED);
    assert_non_null(strstr(bb_message(), "leaf collapse"));
    bb_tree_array *array;
    ASSERT_OK(bb_tree_reserve_array(&b.tree, NULL, "marks", true, 8, &array));
    memset(array->host, 0, b.tree.info.ref_count * 8);
    ASSERT_OK(bb_tree_upload(&b.tree, device, NULL));
    assert_int_equal(bb_layout_maker_make(&maker, b.scene, &b.tree, 1, BB_FORMAT_VERTICES, &data),
                     BB_UNSUPPORTED);
    assert_non_null(
        strstr(bb_message(), "as 4 bytes per node, this tree has 8 bytes per reference"));
    bb_layout_data_release(&data);
    bb_layout_maker_destroy(&maker);
    bb_buffer_release(&b.scene->on_device.boxes);
    close_bed(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(they_are_booked_and_counted),
        cmocka_unit_test(they_go_with_the_nodes),
        cmocka_unit_test(a_layout_reads_the_one_that_it_asks_for),
    };
    return cmocka_run_group_tests_name("side_arrays", tests, open_device, close_device);
}
