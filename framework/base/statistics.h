/* Statistics: samples of a time with the interval of their median, paired ratios, the interval of a
 * rate of wrong rays, and selection by rank. */
#ifndef BB_STATISTICS_H
#define BB_STATISTICS_H

#include <stddef.h>
#include <stdint.h>

enum {
    BB_SAMPLES_MAX = 256,
    /* A median has a 95 % interval from this number of counted rounds on: with 5, even the interval
     * from the least to the most covers it in only 93.75 % of all cases. */
    BB_INTERVAL_ROUNDS = 6,
};

/* Samples of one quantity, one per round. Sample 0 is from the first round, which pays for page
 * faults and cold caches: it is kept in the file but does not count, unless it is the only one. */
typedef struct bb_samples {
    uint32_t count;
    double values[BB_SAMPLES_MAX];
} bb_samples;

/* An estimate from samples. NAN: there is no such figure. */
typedef struct bb_estimate {
    double value;       /* the median */
    double low, high;   /* its 95 % interval; NAN for fewer than BB_INTERVAL_ROUNDS rounds */
    double least, most; /* of the rounds that count; NAN for fewer than two */
} bb_estimate;

extern const bb_estimate bb_not_measured; /* all NAN */

/* Adds a sample. The caller keeps to at most BB_SAMPLES_MAX. */
void bb_samples_add(bb_samples *samples, double value);

/* Returns the median of the samples that count; NAN without any. */
double bb_samples_median(const bb_samples *samples);
/* Returns the least sample that counts: the time when nothing else disturbs it. NAN without any, or
 * if one is not finite. */
double bb_samples_least(const bb_samples *samples);

/* Returns median, interval and range of the samples that count, which are assumed independent. All
 * are NAN without any, or if one is not finite. */
bb_estimate bb_samples_estimate(const bb_samples *samples);

/* Returns a/b, round by round: noise that both share in a round cancels. Empty if their numbers of
 * rounds differ. */
bb_samples bb_samples_ratio(const bb_samples *a, const bb_samples *b);

/* A rate of wrong rays, in rays per million: k of n rays were wrong. */
typedef struct bb_wrong_rate {
    double ppm;       /* as plotted: k/n; 3/n if k = 0; NAN if nothing was checked */
    double low, high; /* 95 % interval; if k = 0: 0 and 3/n */
} bb_wrong_rate;

/* Returns the rate and its interval; rays are assumed independent. k = 0: the rule of three (Hanley
 * and Lippman-Hand, JAMA 249, 1983); else the interval of a Poisson count by Byar's approximation
 * (Breslow and Day, Statistical Methods in Cancer Research II, 1987, section 2.3). */
bb_wrong_rate bb_wrong_rate_of(double wrong, double checked);

/* Returns Kendall's tau-a of two lists, over all pairs that are finite in both: 1 if they rank all
 * alike, -1 if the other way round. NAN with fewer than three such pairs. */
double bb_kendall(const double *a, const double *b, size_t count);

/* Returns the value that sorting would put at values[rank]; changes their order. rank < count, no
 * NAN. */
float bb_select(float *values, size_t count, size_t rank);

#endif
