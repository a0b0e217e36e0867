/* For tests of a builder's tree against its definition: scenes that are boxes alone, and trees of
 * them. */
#ifndef BB_TEST_BOX_FIXTURE_H
#define BB_TEST_BOX_FIXTURE_H

#include "framework/builder/instance.h"
#include "tests/device_fixture.h"

#include <string.h>

static inline bb_scene scene_of(const bb_box *boxes, uint32_t count)
{
    return (bb_scene){.name = "test",
                      .kinds = BB_TRIANGLES,
                      .prim_count = count,
                      .prims = {[BB_TRIANGLE] = {.count = count}},
                      .boxes = (bb_box *)boxes};
}

static inline bb_status upload_boxes(bb_scene *scene, bb_device *on)
{
    size_t bytes = scene->prim_count * sizeof(bb_box);
    scene->on_device.device = on;
    BB_TRY(bb_buffer_reserve(on, NULL, bytes, "boxes", &scene->on_device.boxes));
    return bb_buffer_write(&scene->on_device.boxes, 0, bytes, scene->boxes);
}

typedef struct box_build {
    bb_scene scene;
    bb_instance instance;
    bb_tree preorder; /* of its tree */
} box_build;

/* Builds twice, since a second build must work, and holds the tree to what all trees promise. */
static inline void open_box_build(box_build *b, bb_device *on, const char *builder,
                                  const bb_box *boxes, uint32_t count, const char *what)
{
    memset(b, 0, sizeof *b);
    b->scene = scene_of(boxes, count);
    bb_tree_init(&b->preorder, NULL);
    bb_status status = upload_boxes(&b->scene, on);
    if (status == BB_OK)
        status = bb_instance_create(on, builder, &b->scene, 1, &b->instance);
    for (int i = 0; i < 2 && status == BB_OK; i++)
        status = bb_instance_build(&b->instance, &b->scene, false, NULL);
    if (status == BB_OK)
        status = bb_tree_download(&b->instance.tree, NULL);
    if (status == BB_OK)
        status = bb_tree_check(&b->instance.tree, &b->scene);
    if (status == BB_OK)
        status = bb_tree_preorder(&b->instance.tree, &b->preorder);
    if (status != BB_OK)
        fail_msg("%s, %s, %u boxes, seed %llu: %s", builder, what, count, (unsigned long long)seed,
                 bb_message());
}

static inline void close_box_build(box_build *b)
{
    bb_tree_release(&b->preorder);
    bb_instance_destroy(&b->instance);
    bb_buffer_release(&b->scene.on_device.boxes);
}

/* A build that does not fit into the device's memory is refused, gives back what it took, and the
 * same object builds once there is room. `needed`: bytes per box that are surely too few. */
static inline void expect_refusals_for_room(bb_device *on, const char *builder, const bb_box *boxes,
                                            uint32_t count, uint32_t needed)
{
    bb_scene scene = scene_of(boxes, count);
    ASSERT_OK(upload_boxes(&scene, on));
    const uint64_t before = on->bytes, global = on->global_bytes;
    for (uint64_t room = 100; room < (uint64_t)needed * count; room *= 3) {
        bb_instance instance = {0};
        ASSERT_OK(bb_instance_create(on, builder, &scene, 1, &instance));
        on->global_bytes = on->bytes + room;
        if (bb_instance_build(&instance, &scene, false, NULL) != BB_REFUSED)
            fail_msg("%s: %llu bytes: not refused", builder, (unsigned long long)room);
        assert_non_null(strstr(bb_message(), "bytes"));
        on->global_bytes = global;
        ASSERT_OK(bb_instance_build(&instance, &scene, false, NULL)); /* and it goes on */
        bb_instance_destroy(&instance);
        assert_true(on->bytes == before);
    }
    bb_buffer_release(&scene.on_device.boxes);
}

#endif
