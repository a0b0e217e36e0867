/* Kernels that say so visit children near to far: along a row of primitives, from either end, the
 * first hit is found first, and what lies behind it is culled. */
#include "tests/hand_scene.h"
#include "tests/trace_fixture.h"

#include "framework/judge/queries.h"

enum { ROW = 64, FEW = 16 }; /* FEW: what wide leaves and rough orders may take */

/* Triangles across the x axis, at x = 0, 1, 2 ... */
static bb_scene *make_row(void)
{
    static const float corners[3][2] = {{-1, -1}, {3, -1}, {-1, 3}};
    bb_scene *scene = hand_scene(ROW, 0);
    for (uint32_t i = 0; i < ROW; i++)
        for (uint32_t c = 0; c < 3; c++) {
            float *vertex = scene->vertices + 3 * (3 * (size_t)i + c);
            vertex[0] = (float)i;
            vertex[1] = corners[c][0];
            vertex[2] = corners[c][1];
        }
    hand_finish(scene);
    return scene;
}

static void the_nearer_child_comes_first(void **state)
{
    (void)state;
    const bb_ray rays[2] = {{{-1, 0, 0}, 0, {1, 0, 0}, INFINITY},
                            {{ROW, 0, 0}, 0, {-1, 0, 0}, INFINITY}};
    uint32_t ordered = 0;
    bed b;
    open_bed(&b, make_row(), "lbvh", "stack", 1);
    for (const bb_kernel *const *k = bb_kernels; *k != NULL; k++) {
        bb_hit hits[2];
        bb_count counts[2];
        choose_kernel(&b, (*k)->name, 1);
        trace(&b, "exact", rays, 2, &bb_query_closest, hits, counts);
        print_message("%-12s %s: %u and %u primitives, %u and %u boxes\n", (*k)->name,
                      (*k)->ordered ? "ordered" : "       ", counts[0].prims, counts[1].prims,
                      counts[0].nodes, counts[1].nodes);
        assert_true(hits[0].prim == 0 && hits[1].prim == ROW - 1);
        if (!(*k)->ordered) {
            /* one end or the other: else the row could not tell */
            assert_true(counts[0].prims + counts[1].prims > ROW);
            continue;
        }
        ordered++;
        for (int end = 0; end < 2; end++)
            assert_true(counts[end].prims <= FEW && counts[end].overflow == 0);
    }
    close_bed(&b);
    assert_true(ordered > 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(the_nearer_child_comes_first)};
    return cmocka_run_group_tests(tests, open_device, close_device);
}
