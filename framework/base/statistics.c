/* Statistics: interval of a median, paired ratio, rate of wrong rays, selection.
 *
 * The interval of a median is that of Hettmansperger and Sheather (Confidence intervals based on
 * interpolated order statistics, Statistics & Probability Letters 4, 1986). Derived again:
 *
 * x(1) <= ... <= x(n) are independent samples of a continuous distribution with median m. B of them
 * lie below m, and B is binomial (n, 1/2) whatever the distribution. m lies below x(d) if B < d,
 * and as often above x(n+1-d), so the interval from x(d) to x(n+1-d) covers m with probability
 *
 *     g(d) = 1 - 2 P(B < d),        g(d) - g(d+1) = 2 P(B = d).
 *
 * There are few such probabilities: g(1) = 0.969 and g(2) = 0.781 for n = 6. Take the d with
 * g(d) >= 0.95 > g(d+1), and go from each end inwards by a share s of the way to the next sample:
 * low = x(d) + s (x(d+1) - x(d)), and likewise from above. What m loses by that is the case that
 * exactly d samples lie below m and m lies below `low`. Given B = d, m - x(d) is the least distance
 * from m of d samples and x(d+1) - m that of the other n - d. Where the density hardly changes
 * between x(d) and x(d+1), these two are exponential with rates in proportion to d and n - d (for
 * the double exponential distribution exactly so), and
 *
 *     P(m < low | B = d) = P((1-s) (m - x(d)) < s (x(d+1) - m)) = d s / (d s + (n - d) (1 - s)).
 *
 * Both ends together cover m with probability g(d) - (g(d) - g(d+1)) times that. Solved for 0.95:
 *
 *     i = (g(d) - 0.95) / (g(d) - g(d+1)),        s = (n - d) i / (d + (n - 2 d) i).
 *
 * Whatever the distribution, the interval covers at least as often as its inner neighbour, g(d+1),
 * and at most as often as its outer one, g(d). tests/test_statistics.c measures how often.
 */
#include "framework/base/statistics.h"
#include "framework/base/random.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

const bb_estimate bb_not_measured = {NAN, NAN, NAN, NAN, NAN};

/* ---- samples ---- */

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

/* Sorts the samples that count; returns their number, or 0 if one is not finite. */
static uint32_t sort_counted(const bb_samples *samples, double sorted[BB_SAMPLES_MAX])
{
    uint32_t first = samples->count > 1 ? 1 : 0, count = samples->count - first;
    memcpy(sorted, samples->values + first, count * sizeof *sorted);
    for (uint32_t i = 0; i < count; i++)
        if (!isfinite(sorted[i]))
            return 0;
    qsort(sorted, count, sizeof *sorted, compare);
    return count;
}

/* The names are those at the top of this file; g(1) > 0.95 from n = BB_INTERVAL_ROUNDS on. */
static void set_interval(bb_estimate *e, const double *sorted, uint32_t n)
{
    const double wanted = 0.95;
    uint32_t d = 1;
    double none = ldexp(1, -(int)n), chance = n * none; /* P(B = 0), P(B = d) */
    double g = 1 - 2 * none;
    while (g - 2 * chance >= wanted) {
        g -= 2 * chance;
        d++;
        chance *= (double)(n - d + 1) / d;
    }
    double i = (g - wanted) / (2 * chance);
    double s = (n - d) * i / (d + (n - 2.0 * d) * i);
    e->low = sorted[d - 1] + s * (sorted[d] - sorted[d - 1]);
    e->high = sorted[n - d] - s * (sorted[n - d] - sorted[n - d - 1]);
}

bb_estimate bb_samples_estimate(const bb_samples *samples)
{
    double sorted[BB_SAMPLES_MAX];
    uint32_t count = sort_counted(samples, sorted), half = count / 2;
    bb_estimate e = bb_not_measured;
    if (count == 0)
        return e;
    e.value = count % 2 ? sorted[half] : 0.5 * (sorted[half - 1] + sorted[half]);
    if (count > 1) {
        e.least = sorted[0];
        e.most = sorted[count - 1];
    }
    if (count >= BB_INTERVAL_ROUNDS)
        set_interval(&e, sorted, count);
    return e;
}

double bb_samples_median(const bb_samples *samples)
{
    return bb_samples_estimate(samples).value;
}

double bb_samples_least(const bb_samples *samples)
{
    const bb_estimate e = bb_samples_estimate(samples);
    return isfinite(e.least) ? e.least : e.value; /* a single sample has no range */
}

bb_samples bb_samples_ratio(const bb_samples *a, const bb_samples *b)
{
    bb_samples ratios = {0};
    for (uint32_t i = 0; i < a->count && a->count == b->count; i++)
        bb_samples_add(&ratios, a->values[i] / b->values[i]);
    return ratios;
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

/* Quickselect (Hoare: Algorithm 65, Find, CACM 4, 1961). Pivots are at random places, so no order
 * of the values is a bad case, and values equal to the pivot are set apart. */
float bb_select(float *values, size_t count, size_t rank)
{
    bb_random random = bb_random_make(count, 0);
    size_t low = 0, high = count; /* in sorted order, values[rank] is in [low, high) */
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

double bb_kendall(const double *a, const double *b, size_t count)
{
    double sum = 0, pairs = 0;
    for (size_t i = 0; i < count; i++)
        for (size_t k = 0; k < i; k++) {
            const double product = (a[i] - a[k]) * (b[i] - b[k]);
            if (!isfinite(a[i] - a[k]) || !isfinite(b[i] - b[k]))
                continue;
            pairs++;
            sum += product > 0 ? 1 : product < 0 ? -1 : 0;
        }
    return pairs >= 3 ? sum / pairs : (double)NAN;
}
