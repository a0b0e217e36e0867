/* What is drawn from frames: means, drift, and who wins. */
#include "framework/animate/animate.h"

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
    for (uint32_t m = 0; m < result->method_count; m++) {
        const bb_animate_method *method = &result->methods[m];
        wrong += method->failed;
        for (uint32_t f = 0; f < method->done; f++)
            for (uint32_t k = 0; k < result->kernel_count; k++)
                wrong += method->frames[f].traces[k].wrong;
    }
    return wrong;
}

static void add_traces(const bb_animate_result *result, const bb_animate_frame *frame,
                       const bb_animate_state *state, bb_animate_sums *sums)
{
    for (uint32_t k = 0; k < result->kernel_count; k++) {
        const bb_animate_trace *trace = &frame->traces[k];
        sums->layout[k] += bb_animate_median(result, trace->layout);
        sums->in_place[k] += trace->in_place;
        for (uint32_t i = 0; i < result->ray_count; i++)
            if (state->rays[i] > 0)
                sums->rays_ms[k][i] += bb_animate_median(result, trace->rays[i]);
    }
}

static void add_cost(const bb_animate_result *result, const bb_animate_frame *frame,
                     const bb_animate_state *state, uint32_t f, bb_animate_sums *sums,
                     double moments[3])
{
    double ratio = frame->sah / state->fresh_best;
    sums->sah_mean += ratio;
    sums->sah_most = fmax(sums->sah_most, ratio);
    sums->sah_last = ratio;
    for (uint32_t i = 0; i < result->yardstick_count; i++)
        sums->fresh_most[i] = fmax(sums->fresh_most[i], frame->sah / state->fresh[i]);
    moments[0] += f;
    moments[1] += (double)f * f;
    moments[2] += f * ratio;
}

bb_animate_sums bb_animate_sum(const bb_animate_result *result, const bb_animate_method *method)
{
    bb_animate_sums sums = {.worst_update = NAN};
    double moments[3] = {0};
    for (uint32_t f = 0; f < method->done; f++)
        for (uint32_t k = 0; k < result->kernel_count; k++) {
            sums.wrong += method->frames[f].traces[k].wrong;
            sums.checked += method->frames[f].traces[k].checked;
        }
    for (uint32_t f = 1; f < method->done; f++) {
        const bb_animate_frame *frame = &method->frames[f];
        const bb_animate_state *state = &result->states[f];
        double update = bb_animate_median(result, frame->update);
        sums.frames++;
        sums.ways[frame->way]++;
        sums.update += update;
        if (isnan(sums.worst_update) || update > sums.worst_update) {
            sums.worst_update = update;
            sums.worst_frame = state->frame;
        }
        sums.transfer += bb_animate_median(result, frame->transfer);
        for (uint32_t i = 0; i < result->ray_count; i++)
            sums.rays[i] += state->rays[i];
        add_traces(result, frame, state, &sums);
        add_cost(result, frame, state, f, &sums, moments);
    }
    double n = sums.frames;
    if (n == 0)
        return sums;
    double spread = moments[1] - moments[0] * moments[0] / n;
    sums.drift = spread > 0 ? (moments[2] - moments[0] * sums.sah_mean / n) / spread : 0;
    sums.update /= n;
    sums.transfer /= n;
    sums.sah_mean /= n;
    for (uint32_t k = 0; k < result->kernel_count; k++)
        sums.layout[k] /= n;
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

/* Time of a frame is a + b * count, by a kernel. */
typedef struct line {
    double a, b;
} line;

static line line_of(const bb_animate_sums *sums, uint32_t kernel, uint32_t rays)
{
    return (line){sums->update + sums->transfer + sums->layout[kernel],
                  sums->rays_ms[kernel][rays] / sums->rays[rays]};
}

double bb_animate_frame_ms(const bb_animate_result *result, const bb_animate_method *method,
                           uint32_t rays, double count, uint32_t *kernel)
{
    double best = NAN;
    if (method->refused[0] != '\0' || method->done < 2)
        return NAN;
    bb_animate_sums sums = bb_animate_sum(result, method);
    for (uint32_t k = 0; k < result->kernel_count; k++) {
        line time = line_of(&sums, k, rays);
        double ms = time.a + count * time.b;
        if (isnan(best) || ms < best) {
            best = ms;
            if (kernel != NULL)
                *kernel = k;
        }
    }
    return best;
}

static int compare_numbers(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

uint32_t bb_animate_faster(const bb_animate_result *result, const bb_animate_method *method,
                           const bb_animate_method *with, uint32_t rays,
                           bb_animate_interval intervals[BB_ANIMATE_INTERVALS_MAX])
{
    bb_animate_sums ours = bb_animate_sum(result, method), theirs = bb_animate_sum(result, with);
    double ends[BB_ANIMATE_INTERVALS_MAX + 1] = {0};
    uint32_t crossings = 0, count = 0;
    /* each is the least of a few lines: they can change places only where two of those cross */
    for (uint32_t i = 0; i < result->kernel_count; i++)
        for (uint32_t k = 0; k < result->kernel_count; k++) {
            line x = line_of(&ours, i, rays), y = line_of(&theirs, k, rays);
            double crossing = (y.a - x.a) / (x.b - y.b);
            if (crossing > 0 && isfinite(crossing))
                ends[++crossings] = crossing;
        }
    qsort(ends + 1, crossings, sizeof *ends, compare_numbers);
    for (uint32_t i = 0; i <= crossings; i++) {
        double end = i < crossings ? ends[i + 1] : INFINITY;
        double within = isinf(end) ? 2 * ends[i] + 1 : (ends[i] + end) / 2;
        if (!(bb_animate_frame_ms(result, method, rays, within, NULL) <
              bb_animate_frame_ms(result, with, rays, within, NULL)))
            continue;
        if (count > 0 && intervals[count - 1].to == ends[i])
            intervals[count - 1].to = end;
        else
            intervals[count++] = (bb_animate_interval){ends[i], end};
    }
    return count;
}

const bb_animate_method *bb_animate_rebuilder(const bb_animate_result *result)
{
    for (uint32_t m = 0; m < result->method_count; m++) {
        const bb_animate_method *method = &result->methods[m];
        bool rebuilds = method->refused[0] == '\0' && method->done > 1;
        for (uint32_t f = 1; f < method->done; f++)
            rebuilds = rebuilds && method->frames[f].way == BB_REBUILT;
        if (rebuilds)
            return method;
    }
    return NULL;
}

uint32_t bb_animate_winner(const bb_animate_result *result, uint32_t rays, double count)
{
    uint32_t winner = BB_NONE;
    double best = INFINITY;
    for (uint32_t m = 0; m < result->method_count; m++) {
        double ms = bb_animate_frame_ms(result, &result->methods[m], rays, count, NULL);
        if (ms < best) {
            best = ms;
            winner = m;
        }
    }
    return winner;
}
