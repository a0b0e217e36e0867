/* A disguised scene is another input of the same kind in the same place; what is taken off, or
 * written into and found, is as it was, bit for bit. */
#include "framework/scene/disguise.h"
#include "framework/scene/prim.h"
#include "framework/scene/seal.h"
#include "tests/device_fixture.h"
#include "tests/scene_files.h"

#include <math.h>

static const char *const specs[] = {"random:n=1000",        "spheres:n=1000", "blocks:side=5",
                                    "soup:n=3000,copies=3", "terrain:n=2000", "cube",
                                    "sphere-mesh:n=4"};
enum { SPECS = sizeof specs / sizeof specs[0] };

static bb_scene *load_there(const char *spec)
{
    bb_scene *scene = load_scene(spec);
    ASSERT_OK(bb_scene_upload(scene, device));
    return scene;
}

static void expect_same(double a, double b, const char *what, const char *spec)
{
    if (!(fabs(a - b) <= 1e-4 * fmax(fabs(a), fabs(b))))
        fail_msg("%s: %s was %g and is %g", spec, what, a, b);
}

static void expect_alike(const bb_scene *is, const bb_scene *was, const char *spec)
{
    const bb_profile *a = &was->profile, *b = &is->profile;
    assert_int_equal(is->prim_count, was->prim_count);
    for (int axis = 0; axis < 3; axis++) {
        expect_same(was->bounds.lo[axis], is->bounds.lo[axis], "its lower end", spec);
        expect_same(was->bounds.hi[axis], is->bounds.hi[axis], "its upper end", spec);
    }
    assert_int_equal(a->duplicate_boxes, b->duplicate_boxes);
    expect_same(a->size_min, b->size_min, "its smallest size", spec);
    expect_same(a->size_median, b->size_median, "its median size", spec);
    expect_same(a->size_max, b->size_max, "its largest size", spec);
}

static bool has_box(const bb_scene *scene, const bb_box *box)
{
    bool there = false;
    for (uint32_t i = 0; i < scene->prim_count; i++)
        there = there || memcmp(&scene->boxes[i], box, sizeof *box) == 0;
    return there;
}

/* Not a permutation alone: whoever knows all boxes knows no tree. */
static void expect_other_boxes(const bb_scene *is, const bb_scene *was, const char *spec)
{
    uint32_t known = 0;
    for (uint32_t i = 0; i < is->prim_count; i++)
        known += has_box(was, &is->boxes[i]);
    if (is->prim_count >= 1000 && known > is->prim_count / 2)
        fail_msg("%s: %u of %u boxes are known", spec, known, is->prim_count);
}

static void a_disguise_is_alike_and_comes_off(void **state)
{
    (void)state;
    for (int s = 0; s < SPECS; s++) {
        bb_disguise disguise = {0};
        bb_random random = bb_random_make(seed, (uint64_t)s);
        bb_scene *scene = load_there(specs[s]), *was = load_scene(specs[s]);
        const void *vertices = scene->vertices, *boxes = scene->boxes;
        uint64_t hashes[4];
        for (int k = 0; k < 4; k++) {
            const char *changed;
            ASSERT_OK(bb_disguise_put_on(&disguise, &random, scene));
            assert_ptr_equal(scene->vertices, vertices);
            assert_ptr_equal(scene->boxes, boxes);
            assert_true(scene->hash != was->hash);
            hashes[k] = scene->hash;
            for (int before = 0; before < k; before++)
                assert_true(hashes[before] != hashes[k]);
            ASSERT_OK(bb_scene_check_seal(scene, &changed)); /* the device has it too */
            assert_null(changed);
            expect_other_boxes(scene, was, specs[s]);
            ASSERT_OK(bb_scene_profile(scene));
            expect_alike(scene, was, specs[s]);
            ASSERT_OK(bb_disguise_take_off(&disguise, scene));
            assert_true(scene->hash == was->hash);
            assert_memory_equal(scene->boxes, was->boxes, was->prim_count * sizeof(bb_box));
        }
        bb_disguise_end(&disguise);
        bb_scene_free(scene);
        bb_scene_free(was);
    }
}

/* A flat scene has axes that are not worth mirroring, and a symmetric one may look like itself. */
static void a_draw_that_changes_nothing_is_drawn_again(void **state)
{
    (void)state;
    static const char *const small[] = {"single", "cube"};
    for (size_t s = 0; s < sizeof small / sizeof small[0]; s++) {
        bb_disguise disguise = {0};
        bb_random random = bb_random_make(seed, s);
        bb_scene *scene = load_there(small[s]);
        const uint64_t hash = scene->hash;
        for (int k = 0; k < 100; k++) {
            ASSERT_OK(bb_disguise_put_on(&disguise, &random, scene));
            assert_true(scene->hash != hash);
        }
        ASSERT_OK(bb_disguise_take_off(&disguise, scene));
        bb_disguise_end(&disguise);
        bb_scene_free(scene);
    }
}

/* One box is its own mirror image; side arrays of volumes and tetrahedra are not renumbered. */
static void what_cannot_be_disguised_stays(void **state)
{
    (void)state;
    static const char *const kept[] = {"blocks:side=1", "blocks:side=5,mixed=yes"};
    for (size_t s = 0; s < sizeof kept / sizeof kept[0]; s++) {
        bb_disguise disguise = {0};
        bb_random random = bb_random_make(seed, s);
        bb_scene *scene = load_there(kept[s]);
        const uint64_t hash = scene->hash;
        assert_int_equal(bb_disguise_put_on(&disguise, &random, scene), BB_UNSUPPORTED);
        ASSERT_OK(bb_disguise_take_off(&disguise, scene));
        assert_true(scene->hash == hash);
        bb_disguise_end(&disguise);
        bb_scene_free(scene);
    }
}

/* ---- seals ---- */

static void expect_found(bb_scene *scene, const char *what)
{
    const char *changed;
    ASSERT_OK(bb_scene_check_seal(scene, &changed));
    if (changed == NULL || strcmp(changed, what) != 0)
        fail_msg("%s: its %s were changed, but '%s' was found", scene->name, what, changed);
    ASSERT_OK(bb_scene_check_seal(scene, &changed));
    assert_null(changed); /* put back */
}

/* Turns the sign of the last word. */
static void scratch(void *memory, size_t bytes)
{
    ((unsigned char *)memory)[bytes - 1] ^= 0x80;
}

static void scratch_buffer(bb_buffer *buffer, size_t bytes)
{
    unsigned char word[4];
    ASSERT_OK(bb_buffer_read(buffer, bytes - 4, 4, word));
    scratch(word, 4);
    ASSERT_OK(bb_buffer_write(buffer, bytes - 4, 4, word));
}

static void whoever_writes_into_a_scene_is_found(void **state)
{
    (void)state;
    for (int s = 0; s <= SPECS; s++) {
        const char *spec = s < SPECS ? specs[s] : "blocks:side=5,mixed=yes";
        bb_scene *scene = load_there(spec), *was = load_scene(spec);
        bb_scene_device *there = &scene->on_device;
        const char *changed;
        ASSERT_OK(bb_scene_check_seal(scene, &changed));
        assert_null(changed);
        const size_t boxes = scene->prim_count * sizeof(bb_box),
                     vertices = scene->vertex_count * 12;
        size_t prims = 0;
        scratch(scene->boxes, boxes);
        expect_found(scene, "boxes");
        scratch_buffer(&there->boxes, boxes);
        expect_found(scene, "boxes on the device");
        for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++) {
            const size_t bytes = scene->prims[kind].count * bb_prim_bytes(kind);
            prims += bytes;
            if (bytes == 0)
                continue;
            scratch(scene->prims[kind].data, bytes);
            expect_found(scene, "primitives");
        }
        scratch_buffer(&there->prims, prims);
        expect_found(scene, "primitives on the device");
        if (vertices > 0) {
            scratch(scene->vertices, vertices);
            expect_found(scene, "vertices");
            scratch_buffer(&there->vertices, vertices);
            expect_found(scene, "vertices on the device");
            assert_memory_equal(scene->vertices, was->vertices, vertices);
        }
        assert_memory_equal(scene->boxes, was->boxes, boxes);
        bb_scene_free(scene);
        bb_scene_free(was);
    }
}

/* A scene that is not what its name says cannot be put back, and nobody may use it any more. */
static void what_cannot_be_put_back_is_said_each_time(void **state)
{
    (void)state;
    bb_scene *scene = load_there("random:n=100");
    const char *changed;
    snprintf(scene->name, sizeof scene->name, "random:n=101");
    scratch(scene->vertices, 12);
    assert_int_equal(bb_scene_check_seal(scene, &changed), BB_FAILED);
    assert_string_equal(changed, "vertices");
    assert_int_equal(bb_scene_check_seal(scene, &changed), BB_FAILED);
    assert_null(changed);
    bb_scene_free(scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_disguise_is_alike_and_comes_off),
        cmocka_unit_test(a_draw_that_changes_nothing_is_drawn_again),
        cmocka_unit_test(what_cannot_be_disguised_stays),
        cmocka_unit_test(whoever_writes_into_a_scene_is_found),
        cmocka_unit_test(what_cannot_be_put_back_is_said_each_time),
    };
    return cmocka_run_group_tests(tests, open_device, close_device);
}
