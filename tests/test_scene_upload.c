/* A scene on the device: the bytes that come back, a second upload, and the refusal of what does
 * not fit. */
#include "framework/scene/prim.h"
#include "tests/device_fixture.h"
#include "tests/scene_files.h"

static void expect_bytes(const bb_buffer *buffer, const void *expected, size_t at, size_t size)
{
    unsigned char *bytes = malloc(size + 1);
    assert_non_null(bytes);
    assert_true(buffer->bytes >= at + size);
    if (size > 0) {
        assert_int_equal(bb_buffer_read(buffer, at, size, bytes), BB_OK);
        assert_memory_equal(bytes, expected, size);
    }
    free(bytes);
}

static void test_round_trip(void **state)
{
    (void)state;
    static const char *const specs[] = {"random:n=1000", "spheres:n=1000", "ground",
                                        "blocks:side=5,mixed=yes"};
    for (int i = 0; i < 4; i++) {
        bb_scene *scene = load_scene(specs[i]);
        uint64_t before = device->bytes;
        assert_int_equal(bb_scene_upload(scene, device), BB_OK);
        const bb_scene_device *there = &scene->on_device;
        expect_bytes(&there->boxes, scene->boxes, 0, scene->prim_count * sizeof(bb_box));
        if (scene->vertex_count > 0)
            expect_bytes(&there->vertices, scene->vertices, 0, scene->vertex_count * 12);
        size_t at = 0;
        for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++) {
            size_t bytes = scene->prims[kind].count * bb_prim_bytes(kind);
            expect_bytes(&there->prims, scene->prims[kind].data, at, bytes);
            at += bytes;
        }
        assert_non_null(there->vertices.mem); /* none stays without a buffer */
        assert_non_null(there->prims.mem);
        uint64_t bytes = device->bytes;
        assert_true(bytes > before && there->account.bytes == bytes - before);
        assert_int_equal(bb_scene_upload(scene, device), BB_OK);
        assert_int_equal(device->bytes, bytes);
        bb_scene_free(scene);
        assert_int_equal(device->bytes, before);
    }
}

/* 1000 spheres: 32000 bytes of boxes and 16000 of spheres. */
static void test_refusal(void **state)
{
    (void)state;
    bb_scene *scene = load_scene("spheres:n=1000");
    uint64_t global = device->global_bytes, largest = device->largest_allocation;
    device->global_bytes = device->bytes + 47999;
    assert_int_equal(bb_scene_upload(scene, device), BB_REFUSED);
    assert_non_null(strstr(bb_message(), "48000 bytes"));
    assert_non_null(strstr(bb_message(), "smaller scene"));
    device->global_bytes = global;
    device->largest_allocation = 31999;
    assert_int_equal(bb_scene_upload(scene, device), BB_REFUSED);
    assert_non_null(strstr(bb_message(), "32000 bytes"));
    device->largest_allocation = largest;
    assert_null(scene->on_device.boxes.mem);
    assert_int_equal(bb_scene_upload(scene, device), BB_OK);
    bb_scene_free(scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_round_trip),
        cmocka_unit_test(test_refusal),
    };
    return cmocka_run_group_tests_name("scene_upload", tests, open_device, close_device);
}
