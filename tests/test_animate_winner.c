/* Who is fastest, and what is written of it, on figures made up here. */
#include "framework/record/put.h"
#include "tests/animate_figures.h"

#include <math.h>

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

/* ---- the record ---- */

static double number_at(const cJSON *object, const char *list, int at)
{
    const cJSON *item = cJSON_GetArrayItem(cJSON_GetObjectItem(object, list), at);
    if (!cJSON_IsNumber(item))
        fail_msg("%s[%d] is no number", list, at);
    return item->valuedouble;
}

static double number_of(const cJSON *object, const char *name)
{
    const cJSON *item = cJSON_GetObjectItem(object, name);
    if (!cJSON_IsNumber(item))
        fail_msg("%s is no number", name);
    return item->valuedouble;
}

/* Each figure another, so that none can stand for its neighbour. */
static bb_animate_result *make_distinct(void)
{
    bb_animate_result *result = make_result(1);
    bb_animate_method *method = &result->methods[0];
    fill(method, BB_UPDATED, 3, 1, 100);
    strcpy(method->builder, "a");
    strcpy(result->kernels[0], "k0");
    strcpy(result->kernels[1], "k1");
    strcpy(result->rays[0], "r");
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
    }
    return result;
}

static void the_record_has_each_figure_in_its_place(void **state)
{
    (void)state;
    bb_animate_result *result = make_distinct();
    cJSON *root = bb_animate_json(result);
    assert_non_null(root);
    const cJSON *method = cJSON_GetArrayItem(cJSON_GetObjectItem(root, "methods"), 0);
    const cJSON *kernels = cJSON_GetObjectItem(method, "kernels");
    for (int f = 0; f < FRAMES; f++) {
        assert_true(number_at(root, "frames", f) == 10 + f);
        assert_true(number_at(root, "primitives", f) == 1000 + f);
        assert_true(number_at(root, "sah_fresh_best", f) == 4 + f);
        assert_true(number_at(method, "update_ms", f) == 100 + f);
        assert_true(number_at(method, "update_cpu_ms", f) == 200 + f);
        assert_true(number_at(method, "transfer_ms", f) == 300 + f);
        assert_true(number_at(method, "sah", f) == 400 + f);
        assert_true(number_at(method, "nodes", f) == 500 + f);
        assert_true(number_at(method, "depth", f) == 600 + f);
        assert_true(number_at(method, "tree_bytes", f) == 700 + f);
        for (int k = 0; k < 2; k++) {
            const cJSON *kernel = cJSON_GetArrayItem(kernels, k);
            assert_true(number_at(kernel, "layout_ms", f) == 800 + 10 * k + f);
            assert_true(number_at(cJSON_GetObjectItem(kernel, "rays_ms"), "r", f) ==
                        900 + 10 * k + f);
            assert_true(number_at(kernel, "wrong", f) == (k == 1 ? 20 + f : 0));
        }
    }
    const cJSON *sums = cJSON_GetObjectItem(method, "sums");
    assert_true(number_of(sums, "update_ms") == 102 && number_of(sums, "worst_frame") == 13);
    assert_true(number_of(sums, "wrong") == 20 + 21 + 22 + 23);
    assert_true(cJSON_IsFalse(cJSON_GetObjectItem(method, "failed")));
    /* by the kernel that is right: update, transfer, layout, and 1e5 rays at 3 * 1000 in 901 + 902
     * + 903 ms */
    const cJSON *winner = cJSON_GetArrayItem(cJSON_GetObjectItem(root, "winners"), 0);
    assert_string_equal(cJSON_GetObjectItem(winner, "kernel")->valuestring, "k0");
    assert_true(number_of(winner, "count") == 1e5);
    assert_true(fabs(number_of(winner, "frame_ms") - (102 + 302 + 802 + 1e5 * 2706 / 3000)) < 1e-6);
    cJSON_Delete(root);
    strcpy(result->methods[0].refused, "frame 13: it is broken");
    result->methods[0].failed = true;
    root = bb_animate_json(result);
    method = cJSON_GetArrayItem(cJSON_GetObjectItem(root, "methods"), 0);
    assert_true(cJSON_IsTrue(cJSON_GetObjectItem(method, "failed")));
    assert_int_equal(cJSON_GetArraySize(cJSON_GetObjectItem(root, "winners")), 0);
    cJSON_Delete(root);
    destroy(result);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(methods_change_places_where_times_cross),
        cmocka_unit_test(noise_decides_nothing),
        cmocka_unit_test(what_is_wrong_wins_nothing),
        cmocka_unit_test(who_keeps_still_frames_rebuilds),
        cmocka_unit_test(the_record_has_each_figure_in_its_place),
    };
    return cmocka_run_group_tests_name("animate_winner", tests, NULL, NULL);
}
