/* `reproduce dynamic` on made-up sequences: which claims hold, which pairing decides over them, and
 * the paper's figures beside ours. That it runs: test_reproduce.c. */
#include "framework/papers/dynamic.h"
#include "tests/paper_fixture.h"

#include <math.h>
#include <stdlib.h>

enum { FRAMES = 3, ROUNDS = 7, RAYS = 100 };

/* The methods, in order. */
enum {
    REBUILD,
    REBUILD_SHUFFLED,
    UPDATE,
    UPDATE_SHUFFLED,
    COLLECTED,
    COLLECTED_LISTED,
    LOOSEN,
    LOOSEN_SORTED,
    LOOSEN_CUBE,
    LOOSEN_NOW,
    LINEAR
};

/* Of a method in each frame, ms. */
typedef struct times {
    double update, trace;
} times;

static void fill_method(bb_animate_method *method, times t)
{
    method->frames = NULL;
    ASSERT_OK(bb_host_alloc(NULL, FRAMES * sizeof *method->frames, "frames", &method->frames));
    memset(method->frames, 0, FRAMES * sizeof *method->frames);
    method->done = FRAMES;
    for (int f = 0; f < FRAMES; f++) {
        bb_animate_frame *frame = &method->frames[f];
        frame->sah = 2;
        frame->event_count = 1;
        snprintf(frame->events[0], sizeof frame->events[0], "moved");
        frame->event_numbers[0] = 60;
        for (int r = 0; r <= ROUNDS; r++) { /* a machine that is slower in every other round */
            frame->update[r] = t.update * (1 + r % 2);
            frame->traces[0].rays[0][r] = t.trace * (1 + r % 2);
        }
    }
}

static void fill_result(bb_animate_result *result, const times *t, uint32_t methods)
{
    result->frame_count = FRAMES;
    result->rounds = ROUNDS;
    result->method_count = methods;
    result->kernel_count = result->ray_count = 1;
    result->states = calloc(FRAMES, sizeof *result->states);
    assert_non_null(result->states);
    for (uint32_t f = 0; f < FRAMES; f++)
        result->states[f] =
            (bb_animate_state){.frame = f, .prims = 600, .rays = {RAYS}, .fresh_best = 1};
    for (uint32_t m = 0; m < methods; m++)
        fill_method(&result->methods[m], t[m]);
}

/* Sequences of all scenes, and those of refitted trees in small pictures. */
typedef struct made_up {
    bb_animate_result scenes[BB_DYNAMIC_SCENES], small[BB_DYNAMIC_SCENES];
} made_up;

/* The same times in all scenes. */
static made_up *make(const times t[BB_DYNAMIC_METHODS], double refit_trace)
{
    const times small[BB_DYNAMIC_SMALL_METHODS] = {{1, 1}, {0.5, refit_trace}};
    made_up *d = calloc(1, sizeof *d);
    assert_non_null(d);
    for (int s = 0; s < BB_DYNAMIC_SCENES; s++) {
        fill_result(&d->scenes[s], t, BB_DYNAMIC_METHODS);
        fill_result(&d->small[s], small, BB_DYNAMIC_SMALL_METHODS);
    }
    return d;
}

static const cJSON *evaluate(const made_up *d, bb_results *results)
{
    char *names[BB_DYNAMIC_SCENES];
    bb_findings f = {.scenes = names, .scene_count = BB_DYNAMIC_SCENES};
    ASSERT_OK(bb_table_create("reproduce", &f.table));
    for (int s = 0; s < BB_DYNAMIC_SCENES; s++) {
        names[s] = (char *)(uintptr_t)bb_dynamic_scenes[s].name;
        bb_dynamic_add(f.table, (bb_dynamic_scene)s, &d->scenes[s], 0, 64, 48);
        bb_dynamic_add(f.table, (bb_dynamic_scene)s, &d->small[s], BB_DYNAMIC_METHODS, 8, 6);
    }
    const cJSON *r = reproduce("dynamic", &f, results);
    bb_table_free(f.table);
    return r;
}

static void release(made_up *d)
{
    for (int s = 0; s < BB_DYNAMIC_SCENES; s++) {
        bb_animate_release(&d->scenes[s]);
        bb_animate_release(&d->small[s]);
    }
    free(d);
}

static bool held(const cJSON *reproduction, const char *words)
{
    return cJSON_IsTrue(claim_with(reproduction, words));
}

/* Not undecided. */
static bool refuted(const cJSON *reproduction, const char *words)
{
    return cJSON_IsFalse(claim_with(reproduction, words));
}

static const char
    *const few = "two orders of magnitude",
           *const parts = "collections with trees of their own", *const many = "six to eight times",
           *const loose = "more than an order", *const even = "almost the same time",
           *const untouched = "almost untouched", *const faster = "even faster",
           *const shuffled = "rebuilds are shuffled too",
           *const kitchen = "small things in a large room", *const fall = "Objects of one size",
           *const refit = "simple refit", *const both = "superior to a rebuild";

/* As in the paper, where only the first tree of what is updated is shuffled: rebuilt in the order
 * of the file, trees are traced in twice the time. */
static void a_shuffle_decides(void **state)
{
    (void)state;
    const times t[BB_DYNAMIC_METHODS] = {
        [REBUILD] = {100, 40},   [REBUILD_SHUFFLED] = {100, 19},
        [UPDATE] = {1, 44},      [UPDATE_SHUFFLED] = {1, 20},
        [COLLECTED] = {0.5, 44}, [COLLECTED_LISTED] = {0.1, 44},
        [LOOSEN] = {2, 5},       [LOOSEN_SORTED] = {1, 5},
        [LOOSEN_CUBE] = {2, 10}, [LOOSEN_NOW] = {2, 10},
        [LINEAR] = {3, 12},
    };
    made_up *d = make(t, 30);
    bb_results *results = new_results();
    const cJSON *r = evaluate(d, results);
    assert_true(held(r, few) && held(r, parts) && held(r, many));
    assert_true(held(r, loose) && held(r, even));
    assert_true(held(r, untouched) && held(r, faster) && held(r, both) && held(r, refit));
    assert_true(refuted(r, shuffled));
    assert_true(refuted(r, kitchen)); /* faster than rebuilt trees, here */
    assert_true(held(r, fall));
    assert_non_null(strstr(json_text(claim_of(r, few), "why"), "60 of 600 objects move"));
    bb_results_destroy(results);
    release(d);
}

static void slow_updates_are_told(void **state)
{
    (void)state;
    const times t[BB_DYNAMIC_METHODS] = {
        [REBUILD] = {100, 40},         [REBUILD_SHUFFLED] = {100, 40}, [UPDATE] = {50, 40},
        [UPDATE_SHUFFLED] = {110, 60}, [LOOSEN] = {110, 80},           [LOOSEN_SORTED] = {110, 80},
        [LOOSEN_CUBE] = {2, 10},       [LOOSEN_NOW] = {2, 10},         [LINEAR] = {3, 12},
        [COLLECTED] = {110, 40},       [COLLECTED_LISTED] = {1, 40},
    };
    made_up *d = make(t, 0.9);
    for (int round = 0; round <= ROUNDS; round++) /* one frame takes four times as long */
        d->scenes[BB_DYNAMIC_FALL].methods[LOOSEN].frames[2].update[round] *= 4;
    bb_results *results = new_results();
    const cJSON *r = evaluate(d, results);
    assert_true(refuted(r, parts) && refuted(r, few) && refuted(r, many));
    assert_true(refuted(r, loose) && refuted(r, even));
    assert_true(refuted(r, untouched) && refuted(r, faster) && refuted(r, shuffled));
    assert_true(refuted(r, both) && refuted(r, refit) && refuted(r, fall));
    assert_true(held(r, kitchen));
    bb_results_destroy(results);
    release(d);
}

/* How even updates are is told by times, too: not by a round or two. */
static void few_rounds_tell_no_evenness(void **state)
{
    (void)state;
    times t[BB_DYNAMIC_METHODS];
    for (int m = 0; m < BB_DYNAMIC_METHODS; m++)
        t[m] = (times){1, 1};
    made_up *d = make(t, 2);
    for (int s = 0; s < BB_DYNAMIC_SCENES; s++)
        d->scenes[s].rounds = 2;
    bb_results *results = new_results();
    assert_string_equal(verdict_with(evaluate(d, results), even), "cannot be told: too few rounds");
    bb_results_destroy(results);
    release(d);
}

static double cell(const cJSON *table, int row, int column)
{
    const cJSON *rows = cJSON_GetObjectItem(table, "rows");
    const cJSON *item = cJSON_GetArrayItem(cJSON_GetArrayItem(rows, row), column);
    return cJSON_IsNumber(item) ? item->valuedouble : (double)NAN;
}

static void tables_have_the_paper_beside_ours(void **state)
{
    (void)state;
    times t[BB_DYNAMIC_METHODS];
    for (int m = 0; m < BB_DYNAMIC_METHODS; m++)
        t[m] = (times){1 + m, 10};
    made_up *d = make(t, 2);
    d->scenes[0].methods[LINEAR].refusal = BB_REFUSED;
    snprintf(d->scenes[0].methods[LINEAR].refused, 32, "too large");
    d->scenes[1].methods[1].frames[2].traces[0].wrong = 3;
    bb_results *results = new_results();
    const cJSON *r = evaluate(d, results);
    const cJSON *ratios = cJSON_GetArrayItem(cJSON_GetObjectItem(r, "tables"), 1),
                *frames = cJSON_GetArrayItem(cJSON_GetObjectItem(r, "tables"), 2);
    /* the paper's pairing, shuffled against not: 1 / 4; its update, tracing and both */
    assert_true(cell(ratios, 0, 3) == 103.471 && cell(ratios, 0, 7) == 1.010 &&
                cell(ratios, 0, 11) == 1.295);
    assert_true(cell(ratios, 0, 4) == 0.25 && cell(ratios, 0, 8) == 1);
    assert_true(cell(ratios, 0, 5) == 0.25 && cell(ratios, 0, 6) == 0.25); /* its interval */
    assert_true(fabs(cell(ratios, 0, 12) - 11.0 / 14) < 0.001);
    assert_true(isnan(cell(ratios, 1, 3)) && cell(ratios, 1, 4) == 0.5);
    assert_true(cell(ratios, 5, 3) == 11.204 && fabs(cell(ratios, 5, 4) - 1.0 / 7) < 0.001);
    assert_true(isnan(cell(ratios, 11, 4)));                             /* refused */
    assert_true(cell(ratios, 10, 4) == 2 && cell(ratios, 10, 8) == 0.5); /* refitted */
    /* figure 7: two frames of each scene */
    const cJSON *series = cJSON_GetArrayItem(cJSON_GetObjectItem(r, "tables"), 3);
    assert_int_equal(cJSON_GetArraySize(cJSON_GetObjectItem(series, "rows")),
                     BB_DYNAMIC_SCENES * (FRAMES - 1));
    assert_true(cell(series, 0, 2) == 2 && cell(series, 1, 3) == 8 && cell(series, 1, 4) == 14);
    assert_true(cell(series, 0, 5) == 20);
    /* 13 rows to a scene; the times are 1, 2, 1 ... of seven rounds, whose median is 2 */
    const int rows = BB_DYNAMIC_METHODS + BB_DYNAMIC_SMALL_METHODS;
    assert_true(cell(frames, 0, 2) == 2 && cell(frames, 0, 3) == 20);
    assert_true(isnan(cell(frames, LINEAR, 2)));
    assert_true(cell(frames, rows + 1, 12) == 3);
    bb_results_destroy(results);
    release(d);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_shuffle_decides),
        cmocka_unit_test(slow_updates_are_told),
        cmocka_unit_test(few_rounds_tell_no_evenness),
        cmocka_unit_test(tables_have_the_paper_beside_ours),
    };
    return cmocka_run_group_tests_name("reproduce_dynamic", tests, NULL, NULL);
}
