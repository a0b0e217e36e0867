/* Who is fastest for how many rays per frame: a method's frame takes a + b * count by each of its
 * kernels, whose answers are all right. */
#include "framework/tasks/animate.h"

#include <math.h>
#include <stdlib.h>

/* Time of a frame is a + b * count, by a kernel; NAN if it has given wrong answers, which may well
 * take less time. */
typedef struct line {
    double a, b;
} line;

static line line_of(const bb_animate_result *result, const bb_animate_sums *sums, uint32_t kernel,
                    uint32_t rays)
{
    if (sums->kernel_wrong[kernel] > 0)
        return (line){NAN, NAN};
    return (line){bb_animate_median(result, sums->update) +
                      bb_animate_median(result, sums->transfer) +
                      bb_animate_median(result, sums->layout[kernel]),
                  bb_animate_median(result, sums->traces[kernel][rays]) / sums->rays[rays]};
}

/* The same line in one round alone, whatever the answers. */
static line round_line(const bb_animate_sums *sums, uint32_t kernel, uint32_t rays, uint32_t round)
{
    return (line){sums->update[round] + sums->transfer[round] + sums->layout[kernel][round],
                  sums->traces[kernel][rays][round] / sums->rays[rays]};
}

double bb_animate_frame_ms(const bb_animate_result *result, const bb_animate_method *method,
                           uint32_t rays, double count, uint32_t *kernel)
{
    double best = NAN;
    if (method->refused[0] != '\0' || method->done < 2)
        return NAN;
    bb_animate_sums sums = bb_animate_sum(result, method);
    for (uint32_t k = 0; k < result->kernel_count; k++) {
        line time = line_of(result, &sums, k, rays);
        double ms = time.a + count * time.b;
        if (isnan(best) || ms < best) {
            best = ms;
            if (kernel != NULL)
                *kernel = k;
        }
    }
    return best;
}

bool bb_animate_is_faster(const bb_animate_result *result, const bb_animate_method *method,
                          const bb_animate_method *with, uint32_t rays, double count)
{
    uint32_t kernels[2] = {0};
    double own = bb_animate_frame_ms(result, method, rays, count, &kernels[0]);
    double other = bb_animate_frame_ms(result, with, rays, count, &kernels[1]);
    if (!(own * (1 + BB_ANIMATE_TIE) < other))
        return false;
    const bb_animate_sums ours = bb_animate_sum(result, method),
                          theirs = bb_animate_sum(result, with);
    for (uint32_t r = 1; r <= result->rounds; r++) {
        line x = round_line(&ours, kernels[0], rays, r);
        line y = round_line(&theirs, kernels[1], rays, r);
        if (x.a + count * x.b >= y.a + count * y.b)
            return false;
    }
    return true;
}

static int compare_numbers(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

typedef struct crossings {
    uint32_t count;
    double at[BB_ANIMATE_INTERVALS_MAX]; /* the first is 0 */
} crossings;

/* Where x, times `factor`, and y cross. */
static void add_crossing(line x, double factor, line y, crossings *c)
{
    double at = (y.a - factor * x.a) / (factor * x.b - y.b);
    if (at > 0 && isfinite(at))
        c->at[c->count++] = at;
}

/* All counts at which bb_animate_is_faster() may change its mind: where two of the lines cross that
 * it compares, or a method's best kernel changes. */
static void find_crossings(const bb_animate_result *result, const bb_animate_method *method,
                           const bb_animate_method *with, uint32_t rays, crossings *c)
{
    const bb_animate_sums ours = bb_animate_sum(result, method),
                          theirs = bb_animate_sum(result, with);
    c->count = 0;
    c->at[c->count++] = 0;
    for (uint32_t i = 0; i < result->kernel_count; i++)
        for (uint32_t k = 0; k < result->kernel_count; k++) {
            line x = line_of(result, &ours, i, rays), y = line_of(result, &theirs, k, rays);
            add_crossing(x, 1, line_of(result, &ours, k, rays), c);
            add_crossing(line_of(result, &theirs, i, rays), 1, y, c);
            add_crossing(x, 1 + BB_ANIMATE_TIE, y, c);
            for (uint32_t r = 1; r <= result->rounds; r++)
                add_crossing(round_line(&ours, i, rays, r), 1, round_line(&theirs, k, rays, r), c);
        }
    qsort(c->at, c->count, sizeof *c->at, compare_numbers);
}

uint32_t bb_animate_faster(const bb_animate_result *result, const bb_animate_method *method,
                           const bb_animate_method *with, uint32_t rays,
                           bb_animate_interval intervals[BB_ANIMATE_INTERVALS_MAX])
{
    crossings c;
    uint32_t count = 0;
    find_crossings(result, method, with, rays, &c);
    for (uint32_t i = 0; i < c.count; i++) {
        double end = i + 1 < c.count ? c.at[i + 1] : INFINITY;
        double within = isinf(end) ? 2 * c.at[i] + 1 : (c.at[i] + end) / 2;
        if (!bb_animate_is_faster(result, method, with, rays, within))
            continue;
        if (count > 0 && intervals[count - 1].to == c.at[i])
            intervals[count - 1].to = end;
        else
            intervals[count++] = (bb_animate_interval){c.at[i], end};
    }
    return count;
}

const bb_animate_method *bb_animate_rebuilder(const bb_animate_result *result)
{
    for (uint32_t m = 0; m < result->method_count; m++) {
        const bb_animate_method *method = &result->methods[m];
        uint32_t ways[BB_REBUILT + 1] = {0};
        for (uint32_t f = 1; f < method->done && method->refused[0] == '\0'; f++)
            ways[method->frames[f].way]++;
        if (ways[BB_REBUILT] > 0 && ways[BB_UPDATED] == 0)
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

bool bb_animate_ties(const bb_animate_result *result, uint32_t winner, uint32_t m, uint32_t rays,
                     double count)
{
    const bb_animate_method *method = &result->methods[m];
    return m != winner && !isnan(bb_animate_frame_ms(result, method, rays, count, NULL)) &&
           !bb_animate_is_faster(result, &result->methods[winner], method, rays, count);
}
