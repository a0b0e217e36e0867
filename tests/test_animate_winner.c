/* Who is fastest, and what is written of it, on figures made up here. */
#include "framework/table/figure.h"
#include "tests/animate_figures.h"
#include "tests/table_fixture.h"

static void faster(const bb_animate_result *result, uint32_t m, uint32_t with, uint32_t count,
                   double from, double to)
{
    bb_animate_interval intervals[BB_ANIMATE_INTERVALS_MAX];
    uint32_t found =
        bb_animate_faster(result, &result->methods[m], &result->methods[with], 0, intervals);
    if (found != count)
        fail_msg("method %u with %u: %u intervals", m, with, found);
    if (count > 0 &&
        !(fabs(intervals[0].from - from) <= 1e-9 * from &&
          (isinf(to) ? isinf(intervals[0].to) : fabs(intervals[0].to - to) <= 1e-9 * to)))
        fail_msg("method %u with %u: %g to %g", m, with, intervals[0].from, intervals[0].to);
}

static void methods_change_places_where_times_cross(void **state)
{
    (void)state;
    bb_animate_result *result = make_result(6);
    bb_animate_method *m = result->methods;
    fill(&m[0], BB_UPDATED, 1, 1, 100);   /* 2 + n / 100, or 3 + n / 200 */
    fill(&m[1], BB_REBUILT, 7, 1, 1000);  /* 8 + n / 1000, or 9 + n / 2000 */
    fill(&m[2], BB_REBUILT, 9, 1, 500);   /* never better than 1 */
    fill(&m[3], BB_UPDATED, 1, 10, 150);  /* 11 + n / 150, or 21 + n / 300 */
    fill(&m[4], BB_UPDATED, 1, 0.5, 100); /* 1.5 + n / 100, or 2 + n / 200: better than 0 */
    strcpy(m[2].refused, "frame 13: no more");
    /* 1.05 (3 + n / 200) < 8 + n / 1000; 1.05 (8 + n / 1000) < 3 + n / 200 */
    faster(result, 0, 1, 1, 0, 4.85 / (0.00525 - 0.001));
    faster(result, 1, 0, 1, 5.4 / (0.005 - 0.00105), INFINITY);
    faster(result, 3, 1, 0, 0, 0);
    faster(result, 1, 3, 1, 0, INFINITY);
    faster(result, 4, 0, 1, 0, 3600); /* 1.05 (2 + n / 200) < 3 + n / 200 */
    faster(result, 0, 0, 0, 0, 0);
    faster(result, 0, 2, 0, 0, 0); /* which has no times */
    faster(result, 2, 0, 0, 0, 0);
    /* one that is faster at both ends, since its kernels are */
    fill(&m[5], BB_UPDATED, 1.2, 0, 95);
    for (uint32_t f = 1; f < FRAMES; f++) {
        m[5].frames[f].traces[1].layout[1] = 20;
        m[5].frames[f].traces[1].rays[0][1] = RAYS / 1000.0;
    }
    /* 1.05 (1.2 + n / 95) < 3 + n / 200; 1.05 (21.2 + n / 1000) < 3 + n / 200 */
    faster(result, 5, 0, 2, 0, 1.74 / (1.05 / 95.0 - 1 / 200.0));
    assert_ptr_equal(bb_animate_rebuilder(result), &m[1]);
    m[1].frames[2].way = BB_UPDATED;
    assert_null(bb_animate_rebuilder(result));
    m[1].frames[2].way = BB_REBUILT;
    /* who wins is told by the same times */
    assert_int_equal(bb_animate_winner(result, 0, 1000), 4);
    assert_int_equal(bb_animate_winner(result, 0, 1e6), 1);
    destroy(result);
}

/* What is less than 5 % apart, or the other way round in some round, is as fast. */
static void noise_decides_nothing(void **state)
{
    (void)state;
    bb_animate_result *result = make_result(4);
    bb_animate_method *m = result->methods;
    fill(&m[0], BB_UPDATED, 10, 1, 100);
    fill(&m[1], BB_UPDATED, 10.3, 1, 100);
    fill(&m[2], BB_UPDATED, 14, 1, 100);
    fill(&m[3], BB_UPDATED, 14, 1, 100);
    result->rounds = 2;
    for (uint32_t i = 0; i < 4; i++)
        for (uint32_t f = 0; f < FRAMES; f++) {
            bb_animate_frame *frame = &m[i].frames[f];
            frame->update[2] = i == 2 ? 9 : frame->update[1];
            for (uint32_t k = 0; k < 2; k++) {
                frame->traces[k].layout[2] = frame->traces[k].layout[1];
                frame->traces[k].rays[0][2] = frame->traces[k].rays[0][1];
            }
        }
    assert_int_equal(bb_animate_winner(result, 0, 1), 0);
    assert_false(bb_animate_ties(result, 0, 0, 0, 1));
    assert_true(bb_animate_ties(result, 0, 1, 0, 1));
    assert_true(bb_animate_ties(result, 0, 2, 0, 1)); /* faster in the second round */
    assert_false(bb_animate_ties(result, 0, 3, 0, 1));
    assert_true(bb_animate_ties(result, 0, 3, 0, 1e6)); /* when there are so many rays */
    faster(result, 0, 1, 0, 0, 0);
    faster(result, 0, 2, 0, 0, 0);
    /* 3 faster than one that is so only while there are few rays: in the second round by 4 ms */
    fill(&m[1], BB_UPDATED, 2, 1, 90);
    for (uint32_t f = 0; f < FRAMES; f++) {
        m[1].frames[f].update[2] = 10;
        for (uint32_t k = 0; k < 2; k++) {
            m[1].frames[f].traces[k].layout[2] = m[1].frames[f].traces[k].layout[1];
            m[1].frames[f].traces[k].rays[0][2] = m[1].frames[f].traces[k].rays[0][1];
        }
    }
    /* 10 + 2 + n / 180 < 14 + 2 + n / 200, less often than 1.05 (6 + 2 + n / 180) < 16 + n / 200 */
    faster(result, 1, 3, 1, 0, 4 / (1 / 180.0 - 1 / 200.0));
    destroy(result);
}

static void what_is_wrong_wins_nothing(void **state)
{
    (void)state;
    bb_animate_result *result = make_result(2);
    bb_animate_method *m = result->methods;
    fill(&m[0], BB_UPDATED, 1, 1, 100);
    fill(&m[1], BB_REBUILT, 7, 1, 80);
    assert_int_equal(bb_animate_winner(result, 0, 1e5), 0);
    m[0].frames[3].traces[1].wrong = 1; /* with its faster kernel */
    assert_true(bb_animate_frame_ms(result, &m[0], 0, 1e5, NULL) == 2 + 1e5 / 100);
    assert_int_equal(bb_animate_winner(result, 0, 1e5), 1);
    assert_int_equal(bb_animate_wrong(result), 1);
    m[0].frames[0].traces[0].wrong = 2;
    assert_true(isnan(bb_animate_frame_ms(result, &m[0], 0, 1e5, NULL)));
    assert_false(bb_animate_ties(result, 1, 0, 0, 1));
    assert_true(bb_animate_wrong(result) == 3 && bb_animate_failed(result) == 0);
    m[1].failed = true;
    assert_int_equal(bb_animate_failed(result), 1);
    destroy(result);
}

static void who_keeps_still_frames_rebuilds(void **state)
{
    (void)state;
    bb_animate_result *result = make_result(2);
    bb_animate_method *m = result->methods;
    fill(&m[0], BB_KEPT, 1, 1, 100);
    fill(&m[1], BB_REBUILT, 1, 1, 100);
    m[1].frames[2].way = BB_KEPT;
    assert_ptr_equal(bb_animate_rebuilder(result), &m[1]);
    destroy(result);
}

/* ---- the table ---- */

/* Each figure another, so that none can stand for its neighbour. */
static bb_animate_result *make_distinct(void)
{
    bb_animate_result *result = make_result(1);
    bb_animate_method *method = &result->methods[0];
    fill(method, BB_UPDATED, 3, 1, 100);
    strcpy(result->scene, "s");
    strcpy(method->builder, "a");
    strcpy(result->kernels[0], "k0");
    strcpy(result->kernels[1], "k1");
    strcpy(result->rays[0], "r");
    strcpy(result->yardsticks[0], "y");
    result->yardstick_count = 1;
    for (uint32_t f = 0; f < FRAMES; f++) {
        bb_animate_frame *frame = &method->frames[f];
        frame->update[1] = 100 + f;
        frame->update_cpu[1] = 200 + f;
        frame->transfer[1] = 300 + f;
        frame->sah = 400 + f;
        frame->tree.node_count = 500 + f;
        frame->tree.depth = 600 + f;
        frame->tree_bytes = 700 + f;
        for (uint32_t k = 0; k < 2; k++) {
            frame->traces[k].layout[1] = 800 + 10 * k + f;
            frame->traces[k].rays[0][1] = 900 + 10 * k + f;
            frame->traces[k].wrong = k == 1 ? 20 + f : 0;
        }
        result->states[f].prims = 1000 + f;
        result->states[f].fresh_best = 4 + f;
        result->states[f].fresh[0] = 5 + f;
        result->states[f].rays[0] = RAYS + f;
        result->states[f].moved = 0.25 * f;
        result->states[f].moved_by = f;
        result->states[f].oracle_ms = 30 + f;
        result->states[f].judge_ms = 40 + f;
    }
    return result;
}

static bb_table *table_of(const bb_animate_result *result)
{
    bb_table *table;
    ASSERT_OK(bb_table_create("animate", &table));
    bb_animate_fill(result, "strip.png", table);
    ASSERT_OK(bb_table_status(table));
    return table;
}

static const char *text(const bb_table *table, bb_cell cell, const char *column)
{
    return bb_table_get_text(table, bb_table_find(table, cell), column);
}

static void frames_have_each_figure_in_its_place(void **state)
{
    (void)state;
    bb_animate_result *result = make_distinct();
    bb_table *table = table_of(result);
    for (int f = 0; f < FRAMES; f++) {
        char frame[8];
        snprintf(frame, sizeof frame, "%d", 10 + f);
        const bb_cell all = {{[BB_SCENE] = "s", [BB_FRAME] = frame}},
                      method = {{[BB_SCENE] = "s", [BB_FRAME] = frame, [BB_BUILDER] = "a"}};
        assert_true(number(table, all, "primitives") == 1000 + f);
        assert_true(number(table, all, "sah_fresh_best") == 4 + f);
        assert_true(number(table, all, "moved_percent") == 25 * f);
        assert_true(number(table, all, "moved_by") == f);
        assert_true(number(table, all, "oracle_ms") == 30 + f);
        assert_true(number(table, all, "judge_ms") == 40 + f);
        assert_true(number(table,
                           (bb_cell){{[BB_SCENE] = "s", [BB_FRAME] = frame, [BB_QUESTION] = "r"}},
                           "rays") == RAYS + f);
        assert_true(number(table,
                           (bb_cell){{[BB_SCENE] = "s", [BB_FRAME] = frame, [BB_MAKER] = "y"}},
                           "sah_fresh") == 5 + f);
        assert_true(number(table, method, f == 0 ? "build_ms" : "update_ms") == 100 + f);
        assert_true(number(table, method, "update_cpu_ms") == 200 + f);
        assert_true(number(table, method, "transfer_ms") == 300 + f);
        assert_true(number(table, method, "tree_sah") == 400 + f);
        assert_true(number(table, method, "sah_over_best") == (400 + f) / (4.0 + f));
        assert_true(number(table, method, "nodes") == 500 + f);
        assert_true(number(table, method, "depth") == 600 + f);
        assert_true(number(table, method, "tree_bytes") == 700 + f);
        assert_string_equal(text(table, method, "way"), f == 0 ? "rebuilt" : "updated");
        for (int k = 0; k < 2; k++) {
            const char *name = result->kernels[k];
            const bb_cell kernel = {{[BB_SCENE] = "s",
                                     [BB_FRAME] = frame,
                                     [BB_BUILDER] = "a",
                                     [BB_INTERSECTOR] = name}},
                          set = {{[BB_SCENE] = "s",
                                  [BB_FRAME] = frame,
                                  [BB_QUESTION] = "r",
                                  [BB_BUILDER] = "a",
                                  [BB_INTERSECTOR] = name}};
            assert_true(number(table, kernel, "layout_ms") == 800 + 10 * k + f);
            assert_true(number(table, set, "trace_ms") == 900 + 10 * k + f);
            assert_true(number(table, kernel, "wrong") == (k == 1 ? 20 + f : 0));
        }
    }
    bb_table_free(table);
    destroy(result);
}

static void methods_have_each_figure_in_its_place(void **state)
{
    (void)state;
    bb_animate_result *result = make_distinct();
    bb_table *table = table_of(result);
    const bb_cell scene = {{[BB_SCENE] = "s"}}, method = {{[BB_SCENE] = "s", [BB_BUILDER] = "a"}};
    assert_true(number(table, scene, "first_frame") == 10 && number(table, scene, "rounds") == 1);
    assert_true(number(table, scene, "last_frame") == 13);
    assert_true(number(table, scene, "moved_percent") == 50 &&
                number(table, scene, "moved_by") == 2);
    assert_true(number(table, scene, "wrong_answers") == 20 + 21 + 22 + 23);
    assert_true(number(table, method, "update_ms") == 102);
    assert_true(number(table, method, "transfer_ms") == 302);
    assert_true(number(table, method, "worst_update_ms") == 103);
    assert_true(number(table, method, "worst_frame") == 13);
    assert_true(number(table, method, "sah_over_best_most") == 401 / 5.0);
    assert_true(number(table, (bb_cell){{[BB_SCENE] = "s", [BB_BUILDER] = "a", [BB_MAKER] = "y"}},
                       "sah_over_fresh_most") == 401 / 6.0);
    assert_true(number(table, method, "wrong_answers") == 20 + 21 + 22 + 23);
    assert_true(number(table, method, "frames_updated") == 3);
    assert_true(number(table, method, "frames_rebuilt") == 0);
    assert_string_equal(text(table, method, "status"), "");
    assert_string_equal(
        text(table, (bb_cell){{[BB_SCENE] = "s", [BB_QUESTION] = "frames"}}, "picture"),
        "strip.png");
    for (int k = 0; k < 2; k++) {
        const char *name = result->kernels[k];
        const bb_cell kernel = {{[BB_SCENE] = "s", [BB_BUILDER] = "a", [BB_INTERSECTOR] = name}},
                      set = {{[BB_SCENE] = "s",
                              [BB_QUESTION] = "r",
                              [BB_BUILDER] = "a",
                              [BB_INTERSECTOR] = name}};
        assert_true(number(table, kernel, "layout_ms") == 802 + 10 * k);
        assert_true(number(table, kernel, "wrong_answers") == (k == 1 ? 86 : 0));
        assert_true(number(table, set, "trace_ms") == 902 + 10 * k);
        assert_true(fabs(number(table, set, "mrays_per_s") - 3006 / (2706 + 30.0 * k) / 1e3) <
                    1e-12);
    }
    bb_table_free(table);
    destroy(result);
}

/* By the kernel that is right: update, transfer, layout, and 1e5 rays at 3006 in 901 + 902 + 903
 * ms. */
static void the_table_names_the_winner(void **state)
{
    (void)state;
    const bb_cell
        count = {{[BB_SCENE] = "s", [BB_FRAME] = "1e5 rays", [BB_QUESTION] = "r"}},
        own =
            {{[BB_SCENE] = "s", [BB_FRAME] = "1e5 rays", [BB_QUESTION] = "r", [BB_BUILDER] = "a"}},
        method = {{[BB_SCENE] = "s", [BB_BUILDER] = "a"}};
    bb_animate_result *result = make_distinct();
    bb_table *table = table_of(result);
    assert_string_equal(text(table, count, "fastest"), "a, k0");
    assert_string_equal(text(table, count, "as_fast"), "");
    const double ms = 102 + 302 + 802 + 1e5 * 2706 / 3006;
    assert_true(fabs(number(table, count, "least_frame_ms") - ms) < 1e-6);
    assert_true(number(table, own, "frame_ms") == number(table, count, "least_frame_ms"));
    assert_true(number(table,
                       (bb_cell){{[BB_SCENE] = "s", [BB_FRAME] = "1e9 rays", [BB_QUESTION] = "r"}},
                       "least_frame_ms") > 1e8);
    bb_table_free(table);
    strcpy(result->methods[0].refused, "frame 13: it is broken");
    result->methods[0].failed = true;
    table = table_of(result);
    assert_string_equal(text(table, method, "status"), "failed");
    assert_string_equal(text(table, method, "refused"), "frame 13: it is broken");
    assert_int_equal(bb_table_find(table, count), BB_NO_ROW);
    assert_true(bb_outline_is_wrong(&bb_animate_outline, table));
    bb_table_free(table);
    destroy(result);
}

/* Beside methods that rebuild; who is less than 5 % slower is named, too. */
static void the_table_tells_who_is_faster(void **state)
{
    (void)state;
    bb_animate_result *result = make_result(3);
    bb_animate_method *m = result->methods;
    strcpy(result->scene, "s");
    strcpy(result->rays[0], "r");
    strcpy(m[0].builder, "a");
    strcpy(m[1].builder, "b");
    strcpy(m[2].builder, "c");
    strcpy(result->kernels[0], "k0");
    strcpy(result->kernels[1], "k1");
    fill(&m[0], BB_UPDATED, 1, 1, 100);
    fill(&m[1], BB_REBUILT, 7, 1, 1000);
    fill(&m[2], BB_REBUILT, 7.01, 1, 1000);
    bb_table *table = table_of(result);
    const double at = 4.85 / (0.00525 - 0.001); /* see methods_change_places_where_times_cross() */
    char expected[64], figure[BB_FIGURE_MAX];
    snprintf(expected, sizeof expected, "below %s", bb_figure(figure, at, -1));
    assert_string_equal(text(table, (bb_cell){{[BB_SCENE] = "s"}}, "faster_than"), "b");
    assert_string_equal(text(table,
                             (bb_cell){{[BB_SCENE] = "s", [BB_QUESTION] = "r", [BB_BUILDER] = "a"}},
                             "faster_for"),
                        expected);
    assert_string_equal(text(table,
                             (bb_cell){{[BB_SCENE] = "s", [BB_QUESTION] = "r", [BB_BUILDER] = "c"}},
                             "faster_for"),
                        "none");
    assert_int_equal(
        bb_table_find(table,
                      (bb_cell){{[BB_SCENE] = "s", [BB_QUESTION] = "r", [BB_BUILDER] = "b"}}),
        BB_NO_ROW);
    assert_string_equal(
        text(table, (bb_cell){{[BB_SCENE] = "s", [BB_FRAME] = "1e6 rays", [BB_QUESTION] = "r"}},
             "as_fast"),
        "c");
    assert_int_equal(
        bb_table_find(table,
                      (bb_cell){{[BB_SCENE] = "s", [BB_FRAME] = "2e6 rays", [BB_QUESTION] = "r"}}),
        BB_NO_ROW);
    bb_table_free(table);
    destroy(result);
}

/* Rounds that a method did not get to are no figures, and one that was not timed is none. */
static void the_table_keeps_all_rounds(void **state)
{
    (void)state;
    bb_animate_result *result = make_distinct();
    bb_animate_frame *frames = result->methods[0].frames;
    result->rounds = 2;
    for (int f = 0; f < FRAMES; f++) {
        frames[f].update[2] = 7;
        frames[f].transfer[2] = f == 3 ? NAN : 8;
        frames[f].update_cpu[1] = NAN;
    }
    bb_table *table = table_of(result);
    const uint32_t frame = bb_table_find(
                       table, (bb_cell){{[BB_SCENE] = "s", [BB_FRAME] = "13", [BB_BUILDER] = "a"}}),
                   method = bb_table_find(table, (bb_cell){{[BB_SCENE] = "s", [BB_BUILDER] = "a"}});
    const bb_samples *update = bb_table_get_rounds(table, frame, "update_ms");
    assert_true(update->count == 3 && update->values[1] == 103 && update->values[2] == 7);
    update = bb_table_get_rounds(table, method, "update_ms");
    assert_true(update->count == 3 && update->values[1] == 102 && update->values[2] == 7);
    assert_int_equal(bb_table_get_rounds(table, frame, "transfer_ms")->count, 2);
    assert_int_equal(bb_table_get_rounds(table, method, "transfer_ms")->count, 2);
    assert_null(bb_table_get_rounds(table, frame, "update_cpu_ms"));
    assert_null(bb_table_get_rounds(table, method, "update_cpu_ms"));
    bb_table_free(table);
    destroy(result);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(methods_change_places_where_times_cross),
        cmocka_unit_test(noise_decides_nothing),
        cmocka_unit_test(what_is_wrong_wins_nothing),
        cmocka_unit_test(who_keeps_still_frames_rebuilds),
        cmocka_unit_test(frames_have_each_figure_in_its_place),
        cmocka_unit_test(methods_have_each_figure_in_its_place),
        cmocka_unit_test(the_table_names_the_winner),
        cmocka_unit_test(the_table_tells_who_is_faster),
        cmocka_unit_test(the_table_keeps_all_rounds),
    };
    return cmocka_run_group_tests_name("animate_winner", tests, NULL, NULL);
}
