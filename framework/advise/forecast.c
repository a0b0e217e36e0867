/* Predicts times and memory of heats from the scouts'. */
#include "framework/advise/forecast.h"

#include "framework/advise/turns.h"
#include "framework/base/number.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *builder_of(const bb_contender *who)
{
    return who->builder;
}

static const char *kernel_of(const bb_contender *who)
{
    return who->kernel;
}

/* ---- time ---- */

static const bb_tried_figures *scout_of(const bb_entered *scouts, const char *name,
                                        const char *(*name_of)(const bb_contender *who))
{
    for (uint32_t i = 0; i < scouts->count; i++)
        if (scouts->figures[i].measured && strcmp(name_of(&scouts->who[i]), name) == 0)
            return &scouts->figures[i];
    return NULL;
}

/* Returns the time of builds, layouts and traces. Contenders with the same builder share its build.
 * `factor`: 1 for the whole scene, else that of the sample. */
static double ms_of(const bb_advice *advice, const bb_entered *field, const bb_forecast_heat *heat,
                    double factor)
{
    double ms = 0;
    for (uint32_t i = 0; i < field->count; i++) {
        const bb_contender *who = &field->who[i];
        const bb_tried_figures *build = scout_of(&advice->builders, who->builder, builder_of);
        const bb_tried_figures *kernel = scout_of(&advice->scouts, who->kernel, kernel_of);
        build = build != NULL ? build : &field->figures[i];
        kernel = kernel != NULL ? kernel : build;
        const bool first = i == 0 || strcmp(field->who[i - 1].builder, who->builder) != 0;
        ms += first ? build->build_ms / factor * (heat->rounds + 2) : 0;
        ms += kernel->layout_ms / factor * (heat->rounds + 1);
        ms += kernel->trace_ms / advice->request->image_rays * kernel->rays * heat->rays *
              heat->rounds;
    }
    return ms;
}

static double step_ms(const bb_results *document, const char *name)
{
    const double ms = bb_results_step_ms(document, name);
    return isfinite(ms) ? ms : 0;
}

double bb_forecast_compiled_ms(const bb_results *document)
{
    return step_ms(document, "compile builders") + step_ms(document, "compile kernels") +
           step_ms(document, "compile, allocate, first builds");
}

/* ---- memory ---- */

/* Returns the number of turns of a first heat. *bytes: the memory of the largest. */
static uint32_t turns_of(const bb_advice *advice, double *bytes)
{
    const bb_entered *field = &advice->field;
    bool *in = calloc(field->count + 1, sizeof *in), *done = calloc(field->count + 1, sizeof *done);
    uint32_t turns = 0;
    *bytes = 0;
    while (in != NULL && done != NULL && field->count > 0 &&
           bb_turn(field, 0, &advice->sizes, done, in) > 0) {
        double sum = 0;
        turns++;
        for (uint32_t i = 0; i < field->count; i++) {
            done[i] = done[i] || in[i];
            const bool first =
                in[i] && (i == 0 || !in[i - 1] ||
                          strcmp(field->who[i - 1].builder, field->who[i].builder) != 0);
            if (in[i])
                sum += bb_size_of_layout(&advice->sizes, field->who[i].kernel);
            if (first)
                sum += bb_size_of_build(&advice->sizes, field->who[i].builder);
        }
        *bytes = fmax(*bytes, sum);
    }
    free(in);
    free(done);
    return turns;
}

bb_takings bb_forecast(const bb_advice *advice, const bb_forecast_heat *heats, uint32_t count,
                       const bb_bench_times *scouted, const bb_results *document, double host_bytes)
{
    bb_takings takings = {.seconds = NAN};
    const double compiled = bb_forecast_compiled_ms(document);
    const bb_forecast_heat same = {heats[0].rounds, 1};
    /* all other work is assumed to grow like builds, layouts and traces */
    const double beside = (scouted->total_ms - compiled) /
                          ms_of(advice, &advice->builders, &same, advice->sample.factor);
    double held, left = 1, ms = 0;
    const uint32_t turns = turns_of(advice, &held);
    for (uint32_t h = 0; h < count; h++) {
        ms += left * ms_of(advice, &advice->field, &heats[h], 1);
        left /= 4;
    }
    takings.seconds = (ms * beside + turns * compiled) / 1e3;
    takings.held_bytes = held;
    takings.device_bytes = (double)advice->whole.scene->on_device.account.bytes + held;
    takings.host_bytes = host_bytes + held;
    return takings;
}

void bb_takings_say(const bb_takings *takings, char *text, size_t capacity)
{
    char time[BB_TIME_TEXT];
    snprintf(text, capacity,
             "%s, %.2f GB of host memory and %.2f GB on the device, %.2f GB of it for trees and "
             "layouts",
             bb_time_words(takings->seconds, time), takings->host_bytes / 1e9,
             takings->device_bytes / 1e9, takings->held_bytes / 1e9);
}
