/* What is drawn from frames: means, drift, and who wins. */
#include "framework/tasks/animate.h"

#include <math.h>
#include <stdlib.h>

double bb_animate_median(const bb_animate_result *result, const bb_rounds rounds)
{
    bb_samples samples = {0};
    bb_samples_add(&samples, 0); /* the first counts for nothing */
    for (uint32_t r = 1; r <= result->rounds; r++)
        if (!isnan(rounds[r]))
            bb_samples_add(&samples, rounds[r]);
    return samples.count > 1 ? bb_samples_median(&samples) : NAN;
}

uint64_t bb_animate_wrong(const bb_animate_result *result)
{
    uint64_t wrong = 0;
    for (uint32_t m = 0; m < result->method_count; m++)
        wrong += bb_animate_sum(result, &result->methods[m]).wrong;
    return wrong;
}

uint32_t bb_animate_failed(const bb_animate_result *result)
{
    uint32_t failed = 0;
    for (uint32_t m = 0; m < result->method_count; m++)
        failed += result->methods[m].failed;
    return failed;
}

static void add(const bb_animate_result *result, const bb_rounds rounds, bb_rounds sum)
{
    for (uint32_t r = 0; r <= result->rounds; r++)
        sum[r] += rounds[r];
}

static void divide(const bb_animate_result *result, bb_rounds sum, double count)
{
    for (uint32_t r = 0; r <= result->rounds; r++)
        sum[r] /= count;
}

/* Adds a frame but the first. */
static void add_frame(const bb_animate_result *result, const bb_animate_frame *frame,
                      const bb_animate_state *state, bb_animate_sums *sums)
{
    const double ms = bb_animate_median(result, frame->update);
    sums->frames++;
    sums->ways[frame->way]++;
    if (isnan(sums->worst_update) || ms > sums->worst_update) {
        sums->worst_update = ms;
        sums->worst_frame = state->frame;
    }
    add(result, frame->update, sums->update);
    add(result, frame->update_cpu, sums->update_cpu);
    add(result, frame->transfer, sums->transfer);
    for (uint32_t k = 0; k < result->kernel_count; k++) {
        const bb_animate_trace *trace = &frame->traces[k];
        sums->in_place[k] += trace->in_place;
        add(result, trace->layout, sums->layout[k]);
        for (uint32_t i = 0; i < result->ray_count; i++)
            if (state->rays[i] > 0)
                add(result, trace->rays[i], sums->traces[k][i]);
    }
}

/* Makes means of the sums. */
static void finish_times(const bb_animate_result *result, const bb_animate_method *method,
                         bb_animate_sums *sums)
{
    double with_rays[BB_ANIMATE_RAYS_MAX] = {0};
    for (uint32_t i = 0; i < result->ray_count; i++) {
        for (uint32_t f = 1; f < method->done; f++) {
            sums->rays[i] += result->states[f].rays[i];
            with_rays[i] += result->states[f].rays[i] > 0;
        }
        sums->rays[i] /= with_rays[i];
    }
    divide(result, sums->update, sums->frames);
    divide(result, sums->update_cpu, sums->frames);
    divide(result, sums->transfer, sums->frames);
    for (uint32_t k = 0; k < result->kernel_count; k++) {
        divide(result, sums->layout[k], sums->frames);
        for (uint32_t i = 0; i < result->ray_count; i++)
            divide(result, sums->traces[k][i], with_rays[i]);
    }
}

/* What the mean and the drift of the cost are made of. */
typedef struct costs {
    double frames, f, f2, ratio, f_ratio; /* their number, and sums */
} costs;

/* A frame whose root has no area has no ratio. */
static void add_cost(const bb_animate_result *result, const bb_animate_frame *frame,
                     const bb_animate_state *state, uint32_t f, bb_animate_sums *sums, costs *c)
{
    for (uint32_t i = 0; i < result->yardstick_count; i++) {
        double over = frame->sah / state->fresh[i];
        if (isfinite(over))
            sums->fresh_most[i] = fmax(sums->fresh_most[i], over);
    }
    double ratio = frame->sah / state->fresh_best;
    if (!isfinite(ratio))
        return;
    sums->sah_most = fmax(sums->sah_most, ratio);
    sums->sah_last = ratio;
    c->frames++;
    c->f += f;
    c->f2 += (double)f * f;
    c->ratio += ratio;
    c->f_ratio += f * ratio;
}

static void finish_costs(const costs *c, bb_animate_sums *sums)
{
    if (c->frames == 0)
        return;
    double spread = c->f2 - c->f * c->f / c->frames;
    sums->sah_mean = c->ratio / c->frames;
    sums->drift = spread > 0 ? (c->f_ratio - c->f * sums->sah_mean) / spread : 0;
}

bb_animate_sums bb_animate_sum(const bb_animate_result *result, const bb_animate_method *method)
{
    bb_animate_sums sums = {
        .worst_update = NAN, .sah_mean = NAN, .sah_most = NAN, .sah_last = NAN, .drift = NAN};
    costs c = {0};
    for (uint32_t i = 0; i < BB_ANIMATE_YARDSTICKS_MAX; i++)
        sums.fresh_most[i] = NAN;
    for (uint32_t f = 0; f < method->done; f++) {
        const bb_animate_frame *frame = &method->frames[f];
        for (uint32_t k = 0; k < result->kernel_count; k++) {
            sums.kernel_wrong[k] += frame->traces[k].wrong;
            sums.wrong += frame->traces[k].wrong;
            sums.checked += frame->traces[k].checked;
        }
        if (f > 0) {
            add_frame(result, frame, &result->states[f], &sums);
            add_cost(result, frame, &result->states[f], f, &sums, &c);
        }
    }
    finish_times(result, method, &sums);
    finish_costs(&c, &sums);
    return sums;
}
static double round_ms(const bb_animate_result *result, const bb_animate_frame *frame,
                       const bb_animate_state *state, uint32_t kernel, uint32_t parts,
                       uint32_t round)
{
    const bb_animate_trace *trace = &frame->traces[kernel];
    double ms = parts & BB_ANIMATE_UPDATE ? frame->update[round] : 0;
    ms += parts & BB_ANIMATE_TRANSFER ? frame->transfer[round] : 0;
    ms += parts & BB_ANIMATE_LAYOUT ? trace->layout[round] : 0;
    for (uint32_t i = 0; i < result->ray_count && (parts & BB_ANIMATE_TRACE); i++)
        ms += state->rays[i] > 0 ? trace->rays[i][round] : 0;
    return ms;
}

bb_samples bb_animate_samples(const bb_animate_result *result, const bb_animate_method *method,
                              uint32_t kernel, uint32_t parts)
{
    bb_samples samples = {.count = 0};
    if (method->refused[0] != '\0' || method->done < result->frame_count || method->done < 2)
        return samples;
    for (uint32_t round = 0; round <= result->rounds; round++) {
        double ms = 0;
        for (uint32_t f = 1; f < method->done; f++)
            ms += round_ms(result, &method->frames[f], &result->states[f], kernel, parts, round);
        bb_samples_add(&samples, ms);
    }
    return samples;
}
