/* Directions of views, and the order of axes that follows from them. */
#include "builders/common/view_order.h"
#include "tests/fixture.h"

#include <stdio.h>
#include <string.h>

static bb_scene scene = {
    .name = "test",
    .view_count = 4,
    .views =
        {
            {.name = "front", .eye = {1, 2, 3}, .target = {1, 2, -4}},
            {.name = "2", .eye = {0, 0, 0}, .target = {-1, 2, 3}},
            {.name = "above", .parallel = true, .eye = {0, 9, 0}, .target = {0.5, 0, 0}},
            {.name = "nowhere", .eye = {5, 5, 5}, .target = {5, 5, 5}},
        },
};

static void expect(const char *text, double x, double y, double z)
{
    double direction[3];
    if (bb_view_order(&scene, text, "builder test", direction) != BB_OK)
        fail_msg("%s: %s", text, bb_message());
    assert_true(direction[0] == x && direction[1] == y && direction[2] == z);
}

static void expect_invalid(const char *text, const char *part)
{
    double direction[3];
    assert_int_equal(bb_view_order(&scene, text, "builder test", direction), BB_INVALID);
    if (strstr(bb_message(), part) == NULL || strstr(bb_message(), "builder test: ") == NULL)
        fail_msg("%s: %s", text, bb_message());
}

static void a_view_is_named_or_numbered_or_a_direction(void **state)
{
    (void)state;
    expect("none", 0, 0, 0);
    expect("front", 0, 0, -7);
    expect("0", 0, 0, -7);
    expect("above", 0.5, -9, 0);
    expect("2", -1, 2, 3); /* the name wins over the number */
    expect("1", -1, 2, 3);
    expect("1/-2/0.5", 1, -2, 0.5);
    expect("-1e-300/0/0", -1e-300, 0, 0);
}

static void what_is_no_view_is_refused(void **state)
{
    (void)state;
    expect_invalid("back", "front, 2, above, nowhere");
    expect_invalid("", "is no view");
    expect_invalid("4", "is no view");
    expect_invalid("99999999999999999999", "is no view");
    expect_invalid("-1", "is no view");
    expect_invalid("1/2", "is no view");
    expect_invalid("1/2/3/4", "is no view");
    expect_invalid("1/2/x", "is no view");
    expect_invalid("1/inf/2", "is no view");
    expect_invalid("nan/1/2", "is no view");
    expect_invalid("0/0/0", "looks nowhere");
    expect_invalid("-0/0/0", "looks nowhere");
    expect_invalid("nowhere", "looks nowhere");

    /* as many and as long names as there can be: the list is cut, not the stack */
    bb_scene crowded = {.name = "crowded", .view_count = BB_VIEWS_MAX};
    for (uint32_t i = 0; i < BB_VIEWS_MAX; i++)
        snprintf(crowded.views[i].name, sizeof crowded.views[i].name, "view-%041u", i);
    double direction[3];
    assert_int_equal(bb_view_order(&crowded, "x", "builder test", direction), BB_INVALID);
    bb_scene blind = {.name = "blind"};
    assert_int_equal(bb_view_order(&blind, "0", "builder test", direction), BB_INVALID);
    assert_non_null(strstr(bb_message(), "it has none"));
}

static void expect_order(double x, double y, double z, const char *axes, uint32_t flips)
{
    bb_axis_order order = bb_axis_order_of((const double[]){x, y, z});
    for (int i = 0; i < 3; i++)
        if ("xyz"[order.axis[i]] != axes[i])
            fail_msg("(%g, %g, %g): axis %d is %c, not %c", x, y, z, i, "xyz"[order.axis[i]],
                     axes[i]);
    assert_int_equal(order.flips, flips);
}

static void axes_fall_by_size_and_flip_by_sign(void **state)
{
    (void)state;
    expect_order(0, 0, 0, "xyz", 0);
    expect_order(-0.0, 0, 0, "xyz", 0);
    expect_order(1, 1, 1, "xyz", 0);
    expect_order(-1, -1, -1, "xyz", 7);
    expect_order(3, 2, 1, "xyz", 0);
    expect_order(1, 2, 3, "zyx", 0);
    expect_order(-2, 3, 1, "yxz", 1);
    expect_order(2, -1, -3, "zxy", 6);
    expect_order(1, 2, -2, "yzx", 4);
    expect_order(2, 1, 2, "xzy", 0);
    expect_order(0, -1e-310, 0, "yxz", 2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_view_is_named_or_numbered_or_a_direction),
        cmocka_unit_test(what_is_no_view_is_refused),
        cmocka_unit_test(axes_fall_by_size_and_flip_by_sign),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
