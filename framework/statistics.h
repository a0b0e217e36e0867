/* Statistics: samples of a time with the interval of their median, paired ratios, the interval of a
 * rate of wrong rays, and selection by rank.
 */
#ifndef BB_STATISTICS_H
#define BB_STATISTICS_H

#include <stddef.h>
#include <stdint.h>

enum { BB_SAMPLES_MAX = 256 };

/* Samples of one quantity; sample 0 is the first round (kept in the file, dropped from the median).
 */
typedef struct bb_samples {
    uint32_t count;
    double values[BB_SAMPLES_MAX];
} bb_samples;

/* At most BB_SAMPLES_MAX values: the caller limits its repeats. */
void bb_samples_add(bb_samples *samples, double value);
/* Median of the samples without the first (of all, if there is only one); NAN if there is none. */
double bb_samples_median(const bb_samples *samples);
/* Bootstrap 95 % interval of the median, seeded; low = high = median for fewer than three samples.
 */
void bb_samples_interval(const bb_samples *samples, uint64_t seed, double *low, double *high);

/* A figure and its 95 % interval. */
typedef struct bb_estimate {
    double value, low, high;
} bb_estimate;

/* Median of a/b over the rounds, which pairs what was measured next to each other, with its bootstrap
 * interval. NAN if the two have not the same rounds, or none. */
bb_estimate bb_samples_ratio(const bb_samples *a, const bb_samples *b, uint64_t seed);

/* A rate of wrong rays, in rays per million: k of n rays were wrong. */
typedef struct bb_wrong_rate {
    double ppm;       /* where a mark stands: k/n; 3/n if k = 0; NAN if nothing was checked */
    double low, high; /* 95 % interval; if k = 0: 0 and 3/n */
} bb_wrong_rate;

/* k = 0: the rule of three (Hanley and Lippman-Hand, JAMA 249, 1983); else the interval of a
 * Poisson count by Byar's approximation (Breslow and Day, Statistical Methods in Cancer Research
 * II, 1987, section 2.3). Rays are taken as independent. */
bb_wrong_rate bb_wrong_rate_of(double wrong, double checked);

/* The value that would be values[rank] if they were sorted; changes their order. rank < count, no
 * NAN. */
float bb_select(float *values, size_t count, size_t rank);

#endif
