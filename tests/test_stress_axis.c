/* Axes: what their files may hold, the values along them; and the search for thresholds, on methods
 * whose thresholds are made up. */
#include "framework/builder/pipeline.h"
#include "framework/stress/search.h"
#include "tests/fixture.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- files ---- */

static const char *const whole =
    "{\"name\": \"a-1\", \"title\": \"t\", \"parameter\": \"p\", \"why\": \"w\","
    " \"scene\": \"soup:n={n},edge={x}\", \"rays\": [\"random\", \"edges:jitter={x}\"],"
    " \"from\": 1, \"to\": 1e6, \"builder\": \"lbvh\", \"kernel\": \"stack\"}";

static const char *const five_rays_and_frames =
    "{\"name\": \"a\", \"title\": \"t\", \"parameter\": \"p\", \"why\": \"w\", \"frames\": 2,"
    " \"scene\": \"twist:n={x}\", \"rays\": [\"ao\", \"ao\", \"ao\", \"ao\", \"ao\"],"
    " \"from\": 1, \"to\": 1e6, \"builder\": \"lbvh\", \"kernel\": \"stack\"}";

static void reads_an_axis(void **state)
{
    (void)state;
    bb_axis axis;
    ASSERT_OK(bb_axis_parse(whole, "x", &axis));
    assert_string_equal(axis.name, "a-1");
    assert_int_equal(axis.ray_count, 2);
    assert_int_equal(axis.steps, BB_STEPS_LOG);
    assert_int_equal(axis.intervals, 4);
    assert_string_equal(axis.known, "");
    assert_string_equal(axis.text, whole);
    assert_int_equal(axis.frames, 0);
    bb_axis_free(&axis);
}

/* `whole` with `before` replaced. */
static const char *with(const char *before, const char *after)
{
    static char text[2048];
    const char *at = strstr(whole, before);
    assert_non_null(at);
    snprintf(text, sizeof text, "%.*s%s%s", (int)(at - whole), whole, after, at + strlen(before));
    return text;
}

static void an_axis_without_a_builder_takes_the_usual_one(void **state)
{
    (void)state;
    bb_axis axis;
    ASSERT_OK(bb_axis_parse(with("\"builder\": \"lbvh\", ", ""), "x", &axis));
    assert_string_equal(axis.builder, bb_usual_builder(BB_ALL_KINDS)->name);
    bb_axis_free(&axis);
    ASSERT_OK(bb_axis_parse(with("\"lbvh\"", "\"sah\""), "x", &axis));
    assert_string_equal(axis.builder, "sah");
    bb_axis_free(&axis);
}

static void refuses_what_is_no_axis(void **state)
{
    (void)state;
    const struct {
        const char *text, *words;
    } cases[] = {
        {"", "no JSON object"},
        {"[1]", "no JSON object"},
        {"{} x", "no JSON object"},
        {"{}", "\"name\" must be a text"},
        {with("\"a-1\"", "\"A 1\""), "lower-case"},
        {NULL, NULL},
    };
    for (size_t i = 0; cases[i].text != NULL; i++) {
        bb_axis axis;
        assert_int_equal(bb_axis_parse(cases[i].text, "x", &axis), BB_INVALID);
        if (strstr(bb_message(), cases[i].words) == NULL)
            fail_msg("%s: '%s', not '%s'", cases[i].text, bb_message(), cases[i].words);
        bb_axis_free(&axis);
    }
    const struct {
        const char *before, *after, *words;
    } edits[] = {
        {"\"t\"", "\"\"", "\"title\""},
        {"\"t\"", "3", "\"title\""},
        {"\"w\"", "null", "\"why\""},
        {"[\"random\", \"edges:jitter={x}\"]", "[]", "\"rays\""},
        {"[\"random\", \"edges:jitter={x}\"]", "\"random\"", "\"rays\""},
        {"\"random\",", "7,", "\"rays\""},
        {"1e6", "\"1e6\"", "\"to\""},
        {"1e6", "1", "must differ"},
        {"1e6", "-1", "above 0"},
        {"1e6", "0", "above 0"},
        {"1e6", "1e6, \"steps\": \"cubic\"", "log, linear, whole or count"},
        {"1e6", "1e6, \"also\": [1, 2, 3, 4, 5]", "up to 4"},
        {"1e6", "1e6, \"also\": [\"0\"]", "numbers"},
        {"\"t\"", "\"a\\u001b[2J\"", "printable"},
        {"\"random\",", "\"ran\\u0007dom\",", "printable"},
        {"1e6", "1e6, \"intervals\": 0", "\"intervals\""},
        {"1e6", "1e6, \"intervals\": 1000", "\"intervals\""},
        {"1e6", "1e6, \"n\": 0", "\"n\""},
        {"1e6", "1e6, \"frames\": 1", "from 2 on"},
        {"1e6", "1e6, \"frames\": 2.5", "from 2 on"},
        {"1e6", "1e6, \"frames\": 65", "\"frames\""},
        {"1e6", "1e6, \"frames\": 2", NULL},
        {"\"random\",", "\"ao\", \"ao\", \"ao\", \"ao\",", NULL},
        {"1e6", "1e6, \"colour\": 1", "no axis has"},
        {"1e6", "1e6, \"from\": 2", "no axis has"},
        {"soup:n={n},edge={x}", "cube", NULL}, /* the rays still have {x} */
    };
    for (size_t i = 0; i < sizeof edits / sizeof edits[0]; i++) {
        bb_axis axis;
        bb_status status = bb_axis_parse(with(edits[i].before, edits[i].after), "x", &axis);
        if (edits[i].words == NULL
                ? status != BB_OK
                : status != BB_INVALID || strstr(bb_message(), edits[i].words) == NULL)
            fail_msg("%s: '%s', not '%s'", edits[i].after, bb_message(),
                     edits[i].words != NULL ? edits[i].words : "");
        bb_axis_free(&axis);
    }
    bb_axis axis;
    assert_int_equal(bb_axis_parse(five_rays_and_frames, "x", &axis), BB_INVALID);
    assert_non_null(strstr(bb_message(), "at most 4"));
    bb_axis_free(&axis);
    char *none = strdup(whole);
    for (char *at; (at = strstr(none, "{x}")) != NULL;)
        memcpy(at, "111", 3);
    assert_int_equal(bb_axis_parse(none, "x", &axis), BB_INVALID);
    assert_non_null(strstr(bb_message(), "has {x}"));
    bb_axis_free(&axis);
    free(none);
}

static void built_in_axes_are_in_order(void **state)
{
    (void)state;
    uint32_t count = 0;
    for (const bb_axis_source *s = bb_axis_sources; s->name != NULL; s++, count++) {
        bb_axis axis;
        double values[BB_AXIS_POINTS_MAX + 4];
        ASSERT_OK(bb_axis_load(s->name, &axis));
        assert_string_equal(axis.name, s->name); /* the file's name */
        assert_true(bb_axis_values(&axis, axis.intervals, values) >= 3);
        assert_true(values[0] == axis.from);
        bb_axis_free(&axis);
    }
    assert_true(count >= 20);
}

static void fills_and_halves(void **state)
{
    (void)state;
    char out[64];
    double values[BB_AXIS_POINTS_MAX + 4], x;
    ASSERT_OK(bb_axis_fill("a:n={n},x={x},{y}", 1e-7, 12, out, sizeof out));
    assert_string_equal(out, "a:n=12,x=1e-07,{y}");
    assert_int_equal(bb_axis_fill("{x}{x}{x}", 1.2345678e-7, 1, out, 20), BB_INVALID);

    bb_axis log = {.from = 1, .to = 1e6, .steps = BB_STEPS_LOG, .also = {0}, .also_count = 1};
    assert_int_equal(bb_axis_values(&log, 3, values), 5);
    assert_true(values[1] == 100 && values[2] == 10000 && values[3] == 1e6 && values[4] == 0);
    assert_true(bb_axis_middle(&log, 100, 10000, &x) && x == 1000);
    assert_false(bb_axis_middle(&log, 1e6, 0, &x));
    assert_false(bb_axis_middle(&log, 1.00, 1.01, &x)); /* three digits */

    bb_axis down = {.from = 1, .to = 1e-6, .steps = BB_STEPS_LOG};
    assert_int_equal(bb_axis_values(&down, 2, values), 3);
    assert_true(values[1] == 1e-3);
    assert_true(bb_axis_middle(&down, 1e-3, 1e-5, &x) && x == 1e-4);

    bb_axis corners = {.from = 0, .to = 100, .steps = BB_STEPS_COUNT};
    assert_int_equal(bb_axis_values(&corners, 3, values), 4);
    assert_true(values[1] == 33 && values[2] == 67);
    assert_true(bb_axis_middle(&corners, 0, 3, &x) && x == 2);
    assert_false(bb_axis_middle(&corners, 0, 1, &x));

    bb_axis number = {.from = 1, .to = 4, .steps = BB_STEPS_WHOLE};
    assert_int_equal(bb_axis_values(&number, 8, values), 4); /* no value twice */
    assert_false(bb_axis_middle(&number, 3, 4, &x));
}

/* ---- the search ---- */

enum { METHODS = 6 };

/* Method 0 is wrong from 3e3 on; 1 takes three times the time from 50 on; 2 crashes from 7e5 on; 3
 * is wrong everywhere, 4 has a slow spell in its first measurement of 1e4 only, 5 is wrong from 20
 * to 5e3 only. */
typedef struct made_up {
    uint32_t calls, spells;
} made_up;

static bb_point_figures answer(made_up *m, uint32_t method, double x)
{
    bb_point_figures f = {.outcome = BB_MEASURED,
                          .prims = 10,
                          .build_ms = 1,
                          .trace_ms = 30,
                          .rays = 1000,
                          .tests = 30,
                          .bytes = 100,
                          .metric = 5,
                          .checked = 1000};
    if (method == 0 || method == 3)
        f.wrong = method == 3 || x >= 3e3 ? 7 : 0;
    if (method == 1 && x >= 50)
        f.trace_ms = f.tests = 90;
    if (method == 2 && x >= 7e5)
        f = (bb_point_figures){.outcome = BB_OUT_CRASHED};
    if (method == 4 && x == 1e4 && m->spells++ == 0)
        f.build_ms = 10;
    if (method == 5)
        f.wrong = x >= 20 && x < 5e3;
    return f;
}

static bb_status measure_made_up(void *user, bb_wish *wishes, uint32_t count, bool again)
{
    made_up *m = user;
    assert_true(!again || wishes[0].x == 1); /* beside the normal value */
    m->calls++;
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t k = 0; k < METHODS; k++)
            if (wishes[i].wanted[k])
                wishes[i].figures[k] = answer(m, k, wishes[i].x);
    return BB_OK;
}

static void finds_thresholds(void **state)
{
    (void)state;
    bb_axis axis = {.name = "x", .from = 1, .to = 1e6, .steps = BB_STEPS_LOG};
    made_up m = {0};
    bb_search *s = calloc(1, sizeof *s);
    assert_non_null(s);
    *s = (bb_search){.axis = &axis,
                     .method_count = METHODS,
                     .intervals = 3,
                     .bisections = 9,
                     .times = true,
                     .measure = measure_made_up,
                     .user = &m};
    ASSERT_OK(bb_search_run(s));
    const bb_threshold *t = &s->thresholds[0][BB_MANNER_WRONG];
    assert_true(t->found && !t->from_start && !t->returns);
    assert_true(t->below < 3e3 && t->at >= 3e3 && t->at / t->below < 1.02);
    t = &s->thresholds[1][BB_MANNER_SLOW_TRACE];
    assert_true(t->found && t->below < 50 && t->at >= 50 && t->at / t->below < 1.03);
    assert_true(t->ratio > 2.9);
    t = &s->thresholds[1][BB_MANNER_MORE_TESTS];
    assert_true(t->found && t->below < 50 && t->at >= 50);
    t = &s->thresholds[2][BB_MANNER_CRASHED];
    assert_true(t->found && t->below < 7e5 && t->at >= 7e5);
    t = &s->thresholds[3][BB_MANNER_WRONG];
    assert_true(t->found && t->from_start && isnan(t->below));
    assert_false(s->thresholds[4][BB_MANNER_SLOW_BUILD].found); /* it did not show again */
    t = &s->thresholds[5][BB_MANNER_WRONG];
    assert_true(t->found && t->returns && t->below < 20 && t->at >= 20);
    /* nothing else was found */
    uint32_t found = 0;
    for (uint32_t k = 0; k < METHODS; k++)
        for (uint32_t f = 0; f < BB_MANNERS; f++)
            found += s->thresholds[k][f].found;
    assert_int_equal(found, 6);
    /* in the order of the axis, and what was measured together was asked for together */
    for (uint32_t i = 1; i < s->probe_count; i++)
        assert_true(s->probes[i - 1].x < s->probes[i].x);
    assert_true(m.calls <= 2 + 2 * 9);
    bb_search_free(s);
    free(s);
}

/* Method 0 has two gaps; in one of them the first stage sees nothing, and the search for method 1
 * comes by. */
static bb_status measure_gaps(void *user, bb_wish *wishes, uint32_t count, bool again)
{
    (void)user;
    (void)again;
    for (uint32_t i = 0; i < count; i++) {
        const double x = wishes[i].x;
        for (uint32_t k = 0; k < 2; k++)
            wishes[i].figures[k] = (bb_point_figures){
                .outcome = BB_MEASURED,
                .wrong = k == 0 ? (x > 5 && x < 50) || x > 5e4 : 0,
                .overflowed = x >= 20, /* both: the same values are measured for both */
            };
    }
    return BB_OK;
}

static void tells_of_all_values(void **state)
{
    (void)state;
    bb_axis axis = {.name = "x", .from = 1, .to = 1e6, .steps = BB_STEPS_LOG};
    bb_search *s = calloc(1, sizeof *s);
    assert_non_null(s);
    *s = (bb_search){
        .axis = &axis, .method_count = 2, .intervals = 3, .bisections = 2, .measure = measure_gaps};
    ASSERT_OK(bb_search_run(s));
    const bb_threshold *t = &s->thresholds[0][BB_MANNER_WRONG];
    assert_true(t->found && t->at == 10 && t->below > 3 && t->below < 5 && t->returns);
    bb_search_free(s);
    free(s);
}

/* Slow from 10 on; from 1e4 on, one of the two ray sets cannot be traced. */
static bb_status measure_fewer_rays(void *user, bb_wish *wishes, uint32_t count, bool again)
{
    (void)user;
    (void)again;
    for (uint32_t i = 0; i < count; i++) {
        wishes[i].figures[0] = bb_no_figures(BB_MEASURED);
        wishes[i].figures[0].ray_sets = wishes[i].x >= 1e4 ? 1 : 3;
        wishes[i].figures[0].tests = wishes[i].x >= 1e4 || wishes[i].x < 10 ? 30 : 90;
    }
    return BB_OK;
}

static void what_cannot_be_compared_tells_nothing(void **state)
{
    (void)state;
    bb_axis axis = {.name = "x", .from = 1, .to = 1e6, .steps = BB_STEPS_LOG};
    bb_search *s = calloc(1, sizeof *s);
    assert_non_null(s);
    *s = (bb_search){.axis = &axis,
                     .method_count = 1,
                     .intervals = 3,
                     .bisections = 2,
                     .measure = measure_fewer_rays};
    ASSERT_OK(bb_search_run(s));
    const bb_threshold *t = &s->thresholds[0][BB_MANNER_MORE_TESTS];
    assert_true(t->found && t->at == 10 && !t->returns);
    bb_search_free(s);
    free(s);
}

/* Method 0 is built again in a third of the frames from 100 on, 1 always, 2 twice as often as
 * normally, and its updates take no time where nothing moves. */
static bb_status measure_rebuilt(void *user, bb_wish *wishes, uint32_t count, bool again)
{
    (void)user;
    (void)again;
    for (uint32_t i = 0; i < count; i++) {
        const bool late = wishes[i].x >= 100;
        for (uint32_t k = 0; k < 3; k++) {
            bb_point_figures *f = &wishes[i].figures[k];
            *f = bb_no_figures(BB_MEASURED);
            f->prims = 10;
            f->build_ms = late ? 1 : 0;
            f->rebuilt = k == 1 ? 1 : k == 2 ? (late ? 0.5 : 0.25) : late ? 1.0 / 3 : 0;
        }
    }
    return BB_OK;
}

static void updates_that_give_up_are_told(void **state)
{
    (void)state;
    bb_axis axis = {.name = "x", .from = 1, .to = 1e6, .steps = BB_STEPS_LOG};
    bb_search *s = calloc(1, sizeof *s);
    assert_non_null(s);
    *s = (bb_search){.axis = &axis,
                     .method_count = 3,
                     .intervals = 3,
                     .bisections = 5,
                     .times = true,
                     .measure = measure_rebuilt};
    ASSERT_OK(bb_search_run(s));
    const bb_threshold *t = &s->thresholds[0][BB_MANNER_REBUILT];
    assert_true(t->found && !t->from_start && !t->returns);
    assert_true(t->below < 100 && t->at >= 100 && isinf(t->ratio));
    for (uint32_t k = 1; k < 3; k++)
        assert_false(s->thresholds[k][BB_MANNER_REBUILT].found);
    for (uint32_t k = 0; k < 3; k++) /* nothing is normal to compare with */
        assert_false(s->thresholds[k][BB_MANNER_SLOW_BUILD].found);
    bb_search_free(s);
    free(s);
}

static bb_status fail_to_measure(void *user, bb_wish *wishes, uint32_t count, bool again)
{
    (void)again;
    (void)user;
    (void)wishes;
    (void)count;
    return bb_fail(BB_FAILED, "as told");
}

static void passes_failures_up(void **state)
{
    (void)state;
    bb_axis axis = {.name = "x", .from = 1, .to = 1e6, .steps = BB_STEPS_LOG};
    bb_search *s = calloc(1, sizeof *s);
    assert_non_null(s);
    *s = (bb_search){.axis = &axis, .method_count = 2, .intervals = 3, .measure = fail_to_measure};
    assert_int_equal(bb_search_run(s), BB_FAILED);
    assert_string_equal(bb_message(), "as told");
    bb_search_free(s);
    free(s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reads_an_axis),
        cmocka_unit_test(an_axis_without_a_builder_takes_the_usual_one),
        cmocka_unit_test(refuses_what_is_no_axis),
        cmocka_unit_test(built_in_axes_are_in_order),
        cmocka_unit_test(fills_and_halves),
        cmocka_unit_test(finds_thresholds),
        cmocka_unit_test(tells_of_all_values),
        cmocka_unit_test(what_cannot_be_compared_tells_nothing),
        cmocka_unit_test(updates_that_give_up_are_told),
        cmocka_unit_test(passes_failures_up),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
