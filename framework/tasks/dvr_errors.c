/* The accuracy of a march: the distance of samples against the error, and against the time. */
#include "framework/tasks/dvr_private.h"

#include "framework/base/interrupt.h"
#include "framework/bench/turns.h"
#include "framework/device/stopwatch.h"

#include <math.h>
#include <string.h>

enum { FINER = 8, ROUNDS = 6 }; /* of the reference, beside the shortest step that is asked for */

typedef struct study {
    bb_dvr *dvr;
    const bb_contest_runner *runner, *reference_runner;
    bb_contest_answers answers;
    bb_light *reference, *lights;
    bb_count *counts;
} study;

static bb_status set_step(const study *s, double step)
{
    const bb_march_settings settings = {.step = (float)(step * s->dvr->unit), .cutoff = 0};
    BB_TRY(bb_march_check(s->dvr->scene, &s->dvr->rays, settings.step));
    return s->dvr->set(s->dvr, &settings);
}

static bb_status march_reference(const study *s, bb_light *lights)
{
    const bb_contest_answers answers = {s->answers.items, NULL, NULL};
    BB_TRY(s->dvr->task.ask(s->dvr, s->reference_runner, answers));
    return bb_buffer_read(answers.items, 0, s->dvr->pixels * sizeof *lights, lights);
}

static bb_status march(const study *s, bb_dvr_error *error)
{
    const uint32_t pixels = s->dvr->pixels;
    BB_TRY(s->dvr->task.ask(s->dvr, s->runner, s->answers));
    BB_TRY(bb_buffer_read(s->answers.items, 0, pixels * sizeof *s->lights, s->lights));
    BB_TRY(bb_buffer_read(s->answers.counts, 0, pixels * sizeof *s->counts, s->counts));
    for (uint32_t i = 0; i < pixels; i++)
        error->samples += (double)s->counts[i].prims / ((double)pixels * s->dvr->task.questions);
    return BB_OK;
}

float bb_dvr_finest_step(const bb_dvr *dvr)
{
    const bb_dvr_request *request = dvr->request;
    return (float)(request->steps[request->step_count - 1] / FINER * dvr->unit);
}

/* Adds the squares to error->rms, for the time being. */
static void add_error(const study *s, const bb_light *lights, bb_dvr_error *error)
{
    for (uint32_t i = 0; i < s->dvr->pixels; i++) {
        const bb_light *a = &s->reference[i], *b = &lights[i];
        const float apart[4] = {a->rgb[0] - b->rgb[0], a->rgb[1] - b->rgb[1], a->rgb[2] - b->rgb[2],
                                a->left - b->left};
        for (int k = 0; k < 4; k++) {
            double size = fabs((double)apart[k]);
            error->most = bb_dvr_most(error->most, size);
            error->rms += size * size;
        }
    }
}

static bb_status study_view(const study *s, bb_dvr_error *coarser)
{
    const bb_dvr_request *request = s->dvr->request;
    const double finest = request->steps[request->step_count - 1] / FINER;
    BB_TRY(set_step(s, finest));
    BB_TRY(march_reference(s, s->reference));
    BB_TRY(set_step(s, 2 * finest));
    BB_TRY(march_reference(s, s->lights));
    add_error(s, s->lights, coarser);
    for (uint32_t i = 0; i < request->step_count && !bb_interrupted(); i++) {
        bb_dvr_error *error = &s->dvr->errors[i];
        error->step = request->steps[i];
        BB_TRY(set_step(s, request->steps[i]));
        BB_TRY(march(s, error));
        add_error(s, s->lights, error);
    }
    return BB_OK;
}

static bb_status take_turn(void *self, uint32_t who, uint32_t round, double *ms)
{
    const study *s = self;
    bb_dvr_error *error = &s->dvr->errors[who];
    bb_stopwatch watch;
    bb_timing timing;
    (void)round;
    if (bb_interrupted())
        return BB_OK;
    BB_TRY(set_step(s, error->step));
    BB_TRY(bb_stopwatch_start(s->dvr->device, &watch));
    /* counting, as the pictures were: the same kernel for all */
    bb_status status = s->dvr->task.ask(s->dvr, s->runner, s->answers);
    BB_TRY(bb_stopwatch_stop(&watch, status, &timing));
    bb_samples_add(&error->march, timing.ms);
    *ms += timing.ms;
    return BB_OK;
}

static bb_status time_steps(study *s)
{
    bb_random random = bb_random_make(s->dvr->request->contest.seed, 1);
    bb_turns turns = {.device = s->dvr->device,
                      .random = &random,
                      .count = s->dvr->error_count,
                      .self = s,
                      .turn = take_turn};
    for (uint32_t round = 0; round <= ROUNDS && !bb_interrupted(); round++)
        BB_TRY(bb_turns_round(&turns, round));
    return BB_OK;
}

static bb_status study_all(study *s)
{
    bb_dvr *dvr = s->dvr;
    bb_dvr_error coarser = {0};
    const double values = 4.0 * dvr->pixels * dvr->task.questions;
    BB_TRY(bb_host_alloc(NULL, dvr->pixels * sizeof *s->reference, "pictures", &s->reference));
    BB_TRY(bb_host_alloc(NULL, dvr->pixels * sizeof *s->lights, "pictures", &s->lights));
    BB_TRY(bb_host_alloc(NULL, dvr->pixels * sizeof *s->counts, "counts", &s->counts));
    for (uint32_t v = 0; v < dvr->task.questions && !bb_interrupted(); v++) {
        BB_TRY(bb_dvr_take_view(dvr, v));
        BB_TRY(study_view(s, &coarser));
    }
    if (bb_interrupted())
        return BB_OK; /* errors are of all pictures, or none */
    dvr->error_count = dvr->request->step_count;
    for (uint32_t i = 0; i < dvr->error_count; i++)
        dvr->errors[i].rms = sqrt(dvr->errors[i].rms / values);
    dvr->converged = coarser.most;
    return time_steps(s);
}

bb_status bb_dvr_measure_errors(void *self, const bb_contest_runner *runner,
                                bb_contest_answers answers)
{
    static const bb_contest_runner no_tree = {.without = true};
    bb_dvr *dvr = self;
    if (dvr->request->step_count == 0)
        return BB_OK;
    study s = {.dvr = dvr, .runner = runner != NULL ? runner : &no_tree, .answers = answers};
    s.reference_runner = dvr->scene->volume != NULL ? &no_tree : s.runner;
    bb_status status = study_all(&s);
    bb_host_free(s.reference);
    bb_host_free(s.lights);
    bb_host_free(s.counts);
    return status;
}
