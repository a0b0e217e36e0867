/* The ratio of two medians with its 95 % interval. */
#ifndef BB_EFFECT_H
#define BB_EFFECT_H

#include "framework/base/statistics.h"

#include <stdbool.h>

typedef struct bb_effect {
    double ratio;     /* new by old; NAN: not known */
    double low, high; /* 95 %; NAN: too few rounds */
} bb_effect;

/* Of two runs by themselves: the ratio of their medians. Each needs BB_INTERVAL_ROUNDS rounds that
 * count for an interval. All NAN if there is a time that is not above 0. */
bb_effect bb_effect_of_runs(const bb_samples *before, const bb_samples *after);

/* Of pairs, measured next to each other: the median of their ratios, the first of which does not
 * count. */
bb_effect bb_effect_of_pairs(const bb_samples *ratios);

/* Whether the interval excludes 1. */
bool bb_effect_excludes_one(const bb_effect *effect);

#endif
