/* The study of errors of a march ends soon after an interruption, with figures that are whole. */
#include "framework/base/interrupt.h"
#include "framework/tasks/dvr_private.h"
#include "tests/device_fixture.h"

#include <signal.h>

enum { WIDTH = 4, PIXELS = WIDTH * WIDTH, VIEWS = 2, STEPS = 3, ROUNDS = 7 };

static bb_scene *scene;
static uint32_t asked, interrupt_at; /* calls of ask(); 0: never */

static bb_status set(bb_dvr *dvr, const bb_march_settings *settings)
{
    (void)dvr;
    assert_true(settings->step > 0);
    return BB_OK;
}

static bb_status ask(void *self, const bb_contest_runner *runner, bb_contest_answers answers)
{
    (void)self;
    (void)runner;
    if (++asked == interrupt_at)
        raise(SIGTERM);
    BB_TRY(bb_buffer_fill(answers.items, PIXELS * sizeof(bb_light), 0));
    return answers.counts == NULL ? BB_OK
                                  : bb_buffer_fill(answers.counts, PIXELS * sizeof(bb_count), 0);
}

/* Studies errors with an interruption at call `at` of ask(); returns the calls. */
static uint32_t study(uint32_t at, bb_dvr *dvr)
{
    const bb_dvr_request request = {.contest = {.device = device},
                                    .width = WIDTH,
                                    .height = WIDTH,
                                    .step_count = STEPS,
                                    .steps = {4, 2, 1}};
    bb_buffer items, counts;
    *dvr = (bb_dvr){.request = &request,
                    .scene = scene,
                    .device = device,
                    .task = {.self = dvr, .questions = VIEWS, .ask = ask},
                    .pixels = PIXELS,
                    .unit = 0.1,
                    .set = set};
    for (int v = 0; v < VIEWS; v++)
        dvr->views[v] = scene->views[0];
    make_buffer(&items, NULL, PIXELS * sizeof(bb_light));
    make_buffer(&counts, NULL, PIXELS * sizeof(bb_count));
    ASSERT_OK(bb_rays_reserve(&dvr->rays, PIXELS));
    asked = 0;
    interrupt_at = at;
    ASSERT_OK(bb_dvr_measure_errors(dvr, NULL, (bb_contest_answers){&items, &counts, NULL}));
    bb_host_free(dvr->rays.rays);
    bb_buffer_release(&dvr->rays.on_device);
    bb_buffer_release(&items);
    bb_buffer_release(&counts);
    return asked;
}

static void an_interruption_ends_the_study(void **state)
{
    (void)state;
    const uint32_t pictures = VIEWS * (2 + STEPS), all = pictures + ROUNDS * STEPS;
    bb_dvr dvr;
    assert_int_equal(study(0, &dvr), all);
    assert_int_equal(dvr.error_count, STEPS);
    for (int i = 0; i < STEPS; i++)
        assert_int_equal(dvr.errors[i].march.count, ROUNDS);
    bb_interrupt_catch();
    const uint32_t at = pictures + STEPS + 1; /* within the first round that counts */
    assert_int_equal(study(at, &dvr), at);
    assert_true(bb_interrupted());
    assert_int_equal(dvr.error_count, STEPS);
    for (int i = 0; i < STEPS; i++)
        assert_in_range(dvr.errors[i].march.count, 1, 2);
    assert_int_equal(study(0, &dvr), 0); /* errors are of all pictures, or none */
    assert_int_equal(dvr.error_count, 0);
}

static int start(void **state)
{
    if (open_device(state) != 0)
        return -1;
    ASSERT_OK(bb_scene_load("spheres:n=10", &scene));
    return 0;
}

static int end(void **state)
{
    bb_scene_free(scene);
    return close_device(state);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(an_interruption_ends_the_study)};
    return cmocka_run_group_tests(tests, start, end);
}
