/* A row of primitives, seen along it, with every kernel: what it must find is known without any
 * other code. Those that say so visit children near to far; of hits at one distance the lowest
 * primitive wins; only what lies in the ray's interval counts. */
#include "framework/judge/queries.h"
#include "tests/hand_scene.h"
#include "tests/trace_fixture.h"

/* FEW: orders that tell the near half of a node from the far one take less. */
enum { ROW = 64, FEW = ROW / 2 };

/* Triangles across an axis, at 0, 1, 2 ... of it, each `times` over: i, i + ROW, ...; those from
 * number `turned` on are the other halves of their boxes. */
static bb_scene *make_row_along(uint32_t axis, uint32_t times, uint32_t turned)
{
    static const float corners[2][3][2] = {{{-1, -1}, {3, -1}, {-1, 3}},
                                           {{3, 3}, {-1, 3}, {3, -1}}};
    bb_scene *scene = hand_scene(times * ROW, 0);
    for (uint32_t i = 0; i < times * ROW; i++)
        for (uint32_t c = 0; c < 3; c++) {
            float *vertex = scene->vertices + 3 * (3 * (size_t)i + c);
            vertex[axis] = (float)(i % ROW);
            vertex[(axis + 1) % 3] = corners[i >= turned][c][0];
            vertex[(axis + 2) % 3] = corners[i >= turned][c][1];
        }
    hand_finish(scene);
    return scene;
}

static bb_scene *make_row(uint32_t times, uint32_t turned)
{
    return make_row_along(0, times, turned);
}

static void look(bed *b, const char *kernel, bool ordered, const bb_ray rays[2])
{
    bb_hit hits[2];
    bb_count counts[2];
    choose_kernel(b, kernel, 1);
    trace(b, "exact", rays, 2, &bb_query_closest, hits, counts);
    print_message("%-20s %s: %u and %u primitives, %u and %u boxes\n", kernel,
                  ordered ? "ordered" : "       ", counts[0].prims, counts[1].prims,
                  counts[0].nodes, counts[1].nodes);
    assert_true(hits[0].prim == 0 && hits[1].prim == ROW - 1);
    if (!ordered) /* one end or the other: else the row could not tell */
        assert_true(counts[0].prims + counts[1].prims > ROW);
    for (int end = 0; end < 2 && ordered; end++)
        assert_true(counts[end].prims < FEW && counts[end].overflow == 0);
}

static void look_along(uint32_t axis)
{
    static const char *const by_octant[] = {"stack8:order=octant", "stack8q:order=octant",
                                            "stack8i:order=octant"};
    bb_ray rays[2] = {{.tmax = INFINITY}, {.tmax = INFINITY}};
    rays[0].o[axis] = -1;
    rays[0].d[axis] = 1;
    rays[1].o[axis] = ROW;
    rays[1].d[axis] = -1;
    bed b;
    open_bed(&b, make_row_along(axis, 1, ROW), "lbvh", "stack", 1);
    for (const bb_kernel *const *k = bb_kernels; *k != NULL; k++)
        look(&b, (*k)->name, (*k)->ordered, rays);
    for (size_t i = 0; i < sizeof by_octant / sizeof by_octant[0]; i++)
        look(&b, by_octant[i], true, rays);
    close_bed(&b);
}

static void the_nearer_child_comes_first(void **state)
{
    (void)state;
    for (uint32_t axis = 0; axis < 3; axis++)
        look_along(axis);
}

/* Of rays that start at x = -1, by each kernel that answers the query, with leaves of one primitive
 * and of several. */
static void expect_hits(bed *b, const bb_query *query, const bb_ray *rays, const uint32_t *prims,
                        uint32_t count)
{
    uint32_t asked = 0;
    for (const bb_kernel *const *k = bb_kernels; *k != NULL; k++)
        for (uint32_t leaf = 1; leaf <= 8; leaf += 7) {
            bb_hit hits[ROW];
            if (((*k)->queries & query->way) == 0)
                continue;
            asked++;
            choose_kernel(b, (*k)->name, leaf);
            trace(b, "exact", rays, count, query, hits, NULL);
            for (uint32_t i = 0; i < count; i++) {
                uint32_t prim = hits[i].prim;
                bool is_right = query->any && prims[i] != BB_NONE
                                    ? prim < ROW && (float)prim + 1 > rays[i].tmin &&
                                          (float)prim + 1 < rays[i].tmax
                                    : prim == prims[i];
                if (!is_right)
                    fail_msg("%s:leaf=%u, query %s, ray %u: primitive %u, not %u", (*k)->name, leaf,
                             query->name, i, prim, prims[i]);
            }
        }
    assert_true(asked > 0);
}

/* One after the other, each by the ray that begins before it: no child and no lane is left out. */
static void each_is_found(void **state)
{
    (void)state;
    bb_ray rays[ROW];
    uint32_t prims[ROW];
    bed b;
    for (uint32_t i = 0; i < ROW; i++) {
        rays[i] = (bb_ray){{-1, 0, 0}, (float)i + 0.5f, {1, 0, 0}, INFINITY};
        prims[i] = i;
    }
    open_bed(&b, make_row(1, ROW), "lbvh", "stack", 1);
    expect_hits(&b, &bb_query_closest, rays, prims, ROW);
    close_bed(&b);
}

/* As small as areas may be, from as far as rays may come: all are at one distance. */
static void a_tiny_row_is_found_from_afar(void **state)
{
    (void)state;
    const bb_ray rays[2] = {{{-0x1p91f, 0, 0}, 0, {1, 0, 0}, INFINITY},
                            {{0x1p91f, 0, 0}, 0, {-1, 0, 0}, INFINITY}};
    const uint32_t prims[2] = {0, 0};
    bb_scene *scene = make_row(1, ROW);
    for (uint32_t i = 0; i < 9 * ROW; i++)
        scene->vertices[i] *= 0x1p-49f;
    hand_finish(scene);
    bed b;
    open_bed(&b, scene, "lbvh", "stack", 1);
    expect_hits(&b, &bb_query_closest, rays, prims, 2);
    close_bed(&b);
}

/* The last of five that have one box, and so are in one leaf. */
static void the_last_of_a_leaf_is_found(void **state)
{
    (void)state;
    bb_ray rays[ROW];
    uint32_t prims[ROW];
    bed b;
    for (uint32_t i = 0; i < ROW; i++) {
        rays[i] = (bb_ray){{-1, 2, 2}, (float)i + 0.5f, {1, 0, 0}, INFINITY};
        prims[i] = 4 * ROW + i;
    }
    open_bed(&b, make_row(5, 4 * ROW), "lbvh", "stack", 1);
    expect_hits(&b, &bb_query_closest, rays, prims, ROW);
    close_bed(&b);
}

/* Spheres around the places of the triangles are entered, or left by a ray from within. */
static void spheres_are_entered(void **state)
{
    (void)state;
    const bb_ray rays[2] = {{{-1, 0, 0}, 0, {1, 0, 0}, INFINITY},
                            {{3, 0, 0}, 0, {1, 0, 0}, INFINITY}};
    bb_scene *scene = hand_scene(0, ROW);
    bed b;
    for (uint32_t i = 0; i < ROW; i++)
        memcpy(bb_scene_floats(scene, BB_SPHERE) + 4 * i, (float[]){(float)i, 0, 0, 0.25f},
               4 * sizeof(float));
    hand_finish(scene);
    open_bed(&b, scene, "lbvh", "stack", 1);
    for (const bb_kernel *const *k = bb_kernels; *k != NULL; k++) {
        bb_hit hits[2];
        choose_kernel(&b, (*k)->name, 1);
        trace(&b, "exact", rays, 2, &bb_query_closest, hits, NULL);
        assert_true(hits[0].prim == 0 && hits[0].t == 0.75f);
        assert_true(hits[1].prim == 3 && hits[1].t == 0.25f);
    }
    close_bed(&b);
}

static void the_lowest_of_equals_wins(void **state)
{
    (void)state;
    const bb_ray rays[2] = {{{-1, 0, 0}, 0, {1, 0, 0}, INFINITY},
                            {{ROW, 0, 0}, 0, {-1, 0, 0}, INFINITY}};
    const uint32_t prims[2] = {0, ROW - 1};
    bed b;
    open_bed(&b, make_row(5, 5 * ROW), "lbvh", "stack", 1);
    expect_hits(&b, &bb_query_closest, rays, prims, 2);
    close_bed(&b);
}

/* The interval is open at both ends. */
static void only_the_interval_counts(void **state)
{
    (void)state;
    const bb_ray rays[] = {{{-1, 0, 0}, 0, {1, 0, 0}, 0.5f},     {{-1, 0, 0}, 0, {1, 0, 0}, 1},
                           {{-1, 0, 0}, 0, {1, 0, 0}, 1.5f},     {{-1, 0, 0}, 2.5f, {1, 0, 0}, 99},
                           {{-1, 0, 0}, 3, {1, 0, 0}, INFINITY}, {{-1, 0, 0}, 3.5f, {1, 0, 0}, 4},
                           {{-1, 0, 0}, 64.5f, {1, 0, 0}, 1e30f}};
    const uint32_t prims[] = {BB_NONE, BB_NONE, 0, 2, 3, BB_NONE, BB_NONE};
    bed b;
    open_bed(&b, make_row(1, ROW), "lbvh", "stack", 1);
    expect_hits(&b, &bb_query_closest, rays, prims, 7);
    expect_hits(&b, &bb_query_any, rays, prims, 7);
    close_bed(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_nearer_child_comes_first),
        cmocka_unit_test(each_is_found),
        cmocka_unit_test(a_tiny_row_is_found_from_afar),
        cmocka_unit_test(the_last_of_a_leaf_is_found),
        cmocka_unit_test(spheres_are_entered),
        cmocka_unit_test(the_lowest_of_equals_wins),
        cmocka_unit_test(only_the_interval_counts),
    };
    return cmocka_run_group_tests(tests, open_device, close_device);
}
