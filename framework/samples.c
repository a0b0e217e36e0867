/* Samples of one quantity: median and bootstrap interval.
 *
 * The interval is the percentile bootstrap of Efron (1979): the median of 1000 resamples with
 * replacement, of which the middle 95 % are kept. Sample 0 belongs to the first round, which pays
 * for page faults and cold caches; it is left out of both.
 */
#include "framework/random.h"
#include "framework/record.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { RESAMPLES = 1000 };

void bb_samples_add(bb_samples *samples, double value)
{
    assert(samples->count < BB_SAMPLES_MAX);
    if (samples->count < BB_SAMPLES_MAX)
        samples->values[samples->count++] = value;
}

static int compare(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Sorts `values`. */
static double median_of(double *values, uint32_t count)
{
    qsort(values, count, sizeof *values, compare);
    uint32_t half = count / 2;
    return count % 2 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

/* The samples that count: without the first, unless it is the only one. */
static uint32_t counted(const bb_samples *samples, const double **values)
{
    uint32_t skip = samples->count > 1 ? 1 : 0;
    *values = samples->values + skip;
    return samples->count - skip;
}

double bb_samples_median(const bb_samples *samples)
{
    const double *values;
    uint32_t count = counted(samples, &values);
    if (count == 0)
        return NAN;
    double sorted[BB_SAMPLES_MAX];
    memcpy(sorted, values, count * sizeof *values);
    return median_of(sorted, count);
}

void bb_samples_interval(const bb_samples *samples, uint64_t seed, double *low, double *high)
{
    *low = *high = bb_samples_median(samples);
    const double *values;
    uint32_t count = counted(samples, &values);
    if (samples->count < 3 || count < 2)
        return;
    bb_random random = bb_random_make(seed, 0);
    double medians[RESAMPLES], drawn[BB_SAMPLES_MAX];
    for (uint32_t r = 0; r < RESAMPLES; r++) {
        for (uint32_t i = 0; i < count; i++)
            drawn[i] = values[bb_random_below(&random, count)];
        medians[r] = median_of(drawn, count);
    }
    qsort(medians, RESAMPLES, sizeof *medians, compare);
    *low = medians[RESAMPLES * 25 / 1000];
    *high = medians[RESAMPLES - 1 - RESAMPLES * 25 / 1000];
}

bb_estimate bb_samples_ratio(const bb_samples *a, const bb_samples *b, uint64_t seed)
{
    bb_estimate ratio = {NAN, NAN, NAN};
    if (a->count != b->count)
        return ratio;
    bb_samples ratios = {0};
    for (uint32_t i = 0; i < a->count; i++)
        bb_samples_add(&ratios, a->values[i] / b->values[i]);
    ratio.value = bb_samples_median(&ratios);
    bb_samples_interval(&ratios, seed, &ratio.low, &ratio.high);
    return ratio;
}
