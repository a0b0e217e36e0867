/* The accuracy of a march: the distance of samples against the error, and against the time. */
#include "framework/dvr/dvr_private.h"

#include "framework/device/stopwatch.h"

#include <math.h>
#include <string.h>

enum { FINER = 8, ROUNDS = 6 }; /* of the reference, beside the shortest step that is asked for */

typedef struct study {
    const bb_dvr_request *request;
    const bb_scene *scene;
    const bb_dvr_renderer *renderer;
    const bb_contest_runner *runner; /* NULL: without a tree */
    const bb_contest_runner *reference_runner;
    bb_dvr_pictures *pictures;
    bb_light *reference, *lights;
    bb_count *counts;
} study;

static bb_status set_step(const study *s, double step)
{
    const bb_march_settings settings = {
        .step = (float)(step * s->renderer->unit),
        .cutoff = 0,
    };
    BB_TRY(bb_march_check(s->scene, &s->pictures->rays, settings.step));
    return s->renderer->set(s->renderer->self, &settings);
}

static bb_status march_reference(const study *s, bb_light *lights)
{
    bb_dvr_pictures *p = s->pictures;
    BB_TRY(s->renderer->launch(s->renderer->self, s->reference_runner, p, false));
    return bb_buffer_read(&p->lights, 0, p->pixels * sizeof *lights, lights);
}

static bb_status march(const study *s, bb_dvr_error *error)
{
    bb_dvr_pictures *p = s->pictures;
    BB_TRY(s->renderer->launch(s->renderer->self, s->runner, p, true));
    BB_TRY(bb_buffer_read(&p->lights, 0, p->pixels * sizeof *s->lights, s->lights));
    BB_TRY(bb_buffer_read(&p->counts, 0, p->pixels * sizeof *s->counts, s->counts));
    for (uint32_t i = 0; i < p->pixels; i++)
        error->samples += (double)s->counts[i].prims / ((double)p->pixels * p->count);
    return BB_OK;
}

float bb_dvr_finest_step(const bb_dvr_request *request, double unit)
{
    return (float)(request->steps[request->step_count - 1] / FINER * unit);
}

/* Adds the squares to error->rms, for the time being. */
static void add_error(const study *s, const bb_light *lights, bb_dvr_error *error)
{
    for (uint32_t i = 0; i < s->pictures->pixels; i++) {
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

static bb_status study_view(const study *s, bb_dvr_result *result, bb_dvr_error *coarser)
{
    const bb_dvr_request *request = s->request;
    const double finest = request->steps[request->step_count - 1] / FINER;
    BB_TRY(set_step(s, finest));
    BB_TRY(march_reference(s, s->reference));
    BB_TRY(set_step(s, 2 * finest));
    BB_TRY(march_reference(s, s->lights));
    add_error(s, s->lights, coarser);
    for (uint32_t i = 0; i < request->step_count; i++) {
        bb_dvr_error *error = &result->errors[i];
        error->step = request->steps[i];
        BB_TRY(set_step(s, request->steps[i]));
        BB_TRY(march(s, error));
        add_error(s, s->lights, error);
    }
    return BB_OK;
}

/* All steps in turns. */
static bb_status time_steps(const study *s, bb_dvr_result *result)
{
    bb_dvr_pictures *p = s->pictures;
    for (uint32_t round = 0; round <= ROUNDS; round++)
        for (uint32_t i = 0; i < result->error_count; i++) {
            bb_stopwatch watch;
            bb_timing timing;
            BB_TRY(set_step(s, result->errors[i].step));
            BB_TRY(bb_stopwatch_start(s->request->device, &watch));
            /* counting, as the pictures were: the same kernel for all */
            bb_status status = s->renderer->launch(s->renderer->self, s->runner, p, true);
            bb_status stopped = bb_stopwatch_stop(&watch, &timing);
            BB_TRY(status);
            BB_TRY(stopped);
            bb_samples_add(&result->errors[i].march, timing.ms);
        }
    return BB_OK;
}

static bb_status study_all(study *s, bb_dvr_result *result)
{
    bb_dvr_pictures *p = s->pictures;
    bb_dvr_error coarser = {0};
    const double values = 4.0 * p->pixels * p->count;
    BB_TRY(bb_host_alloc(NULL, p->pixels * sizeof *s->reference, "pictures", &s->reference));
    BB_TRY(bb_host_alloc(NULL, p->pixels * sizeof *s->lights, "pictures", &s->lights));
    BB_TRY(bb_host_alloc(NULL, p->pixels * sizeof *s->counts, "counts", &s->counts));
    result->error_count = s->request->step_count;
    for (uint32_t v = 0; v < p->count; v++) {
        BB_TRY(bb_dvr_take_view(s->scene, p, v, s->request->device));
        BB_TRY(study_view(s, result, &coarser));
    }
    for (uint32_t i = 0; i < result->error_count; i++)
        result->errors[i].rms = sqrt(result->errors[i].rms / values);
    result->converged = coarser.most;
    return time_steps(s, result);
}

bb_status bb_dvr_measure_errors(const bb_dvr_request *request, const bb_scene *scene,
                                const bb_dvr_renderer *renderer, const bb_contest_runner *runner,
                                bb_dvr_pictures *pictures, bb_dvr_result *result)
{
    study s = {.request = request,
               .scene = scene,
               .renderer = renderer,
               .runner = runner,
               .reference_runner = renderer->without ? NULL : runner,
               .pictures = pictures};
    bb_status status = study_all(&s, result);
    bb_host_free(s.reference);
    bb_host_free(s.lights);
    bb_host_free(s.counts);
    return status;
}
