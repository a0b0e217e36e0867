/* Statistics: samples of a time with the interval of their median, paired ratios, the interval of a
 * rate of wrong rays, and selection by rank.
 */
#ifndef BB_STATISTICS_H
#define BB_STATISTICS_H

#include <stddef.h>
#include <stdint.h>

enum {
    BB_SAMPLES_MAX = 256,
    /* Rounds that count, of which a median has a 95 % interval: with 5, even the interval from the
     * least to the most covers it in 93.75 % of all cases only. */
    BB_INTERVAL_ROUNDS = 6,
};

/* Samples of one quantity, one per round. Sample 0 is of the first round, which pays for page
 * faults and cold caches: it is kept in the file and counts for nothing, unless it is the only one.
 */
typedef struct bb_samples {
    uint32_t count;
    double values[BB_SAMPLES_MAX];
} bb_samples;

/* What is drawn from samples. NAN: there is no such figure. */
typedef struct bb_estimate {
    double value;       /* the median */
    double low, high;   /* its 95 % interval; NAN for fewer than BB_INTERVAL_ROUNDS rounds */
    double least, most; /* of the rounds that count; NAN for fewer than two */
} bb_estimate;

extern const bb_estimate bb_not_measured; /* all NAN */

/* At most BB_SAMPLES_MAX values: the caller limits its repeats. */
void bb_samples_add(bb_samples *samples, double value);

/* Median of the samples that count; NAN if there is none. */
double bb_samples_median(const bb_samples *samples);
/* The least of them, which is how long it takes when nothing else is at work; NAN if there is none,
 * or one that is no finite number. */
double bb_samples_least(const bb_samples *samples);

/* Median, interval and range of the samples that count, which are taken as independent. All NAN if
 * there is none, or one that is no finite number. */
bb_estimate bb_samples_estimate(const bb_samples *samples);

/* a/b, round by round, which pairs what was measured next to each other: noise that both share in
 * a round is not in their ratio. Empty if the two have not the same number of rounds. */
bb_samples bb_samples_ratio(const bb_samples *a, const bb_samples *b);

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
