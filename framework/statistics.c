/* Statistics: samples with median and bootstrap interval, rate of wrong rays, selection.
 *
 * The interval is the percentile bootstrap of Efron (1979): the median of 1000 resamples with
 * replacement, of which the middle 95 % are kept. Sample 0 belongs to the first round, which pays
 * for page faults and cold caches; it is left out of both.
 */
#include "framework/statistics.h"
#include "framework/random.h"

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

/* ---- rates ---- */

bb_wrong_rate bb_wrong_rate_of(double wrong, double checked)
{
    if (!(checked > 0) || !(wrong >= 0))
        return (bb_wrong_rate){NAN, NAN, NAN};
    double million = 1e6 / checked;
    if (wrong == 0)
        return (bb_wrong_rate){3 * million, 0, 3 * million};
    const double z = 1.959964; /* 97.5 % of a normal distribution */
    double next = wrong + 1;
    double low = wrong * pow(1 - 1 / (9 * wrong) - z / (3 * sqrt(wrong)), 3);
    double high = next * pow(1 - 1 / (9 * next) + z / (3 * sqrt(next)), 3);
    return (bb_wrong_rate){wrong * million, low * million, high * million};
}

/* ---- selection ---- */

static void swap(float *a, float *b)
{
    float value = *a;
    *a = *b;
    *b = value;
}

/* Quickselect (Hoare: Algorithm 65, Find, CACM 4, 1961). Pivots are taken at random places, so that
 * no order of the values is a bad one, and what equals the pivot is set apart. */
float bb_select(float *values, size_t count, size_t rank)
{
    bb_random random = bb_random_make(count, 0);
    size_t low = 0, high = count; /* sorted, values[rank] would be in [low, high) */
    for (;;) {
        float pivot = values[low + (size_t)(bb_random_unit(&random) * (double)(high - low))];
        size_t less = low, at = low, more = high;
        while (at < more) {
            if (values[at] < pivot)
                swap(&values[at++], &values[less++]);
            else if (values[at] > pivot)
                swap(&values[at], &values[--more]);
            else
                at++;
        }
        if (rank < less)
            high = less;
        else if (rank >= more)
            low = more;
        else
            return pivot;
    }
}
