/* The ratio of two medians with its 95 % interval. */
#ifndef BB_EFFECT_H
#define BB_EFFECT_H

#include "framework/base/statistics.h"

#include <stdbool.h>

typedef struct bb_effect {
    double ratio;     /* new / old; NAN: not known */
    double low, high; /* 95 %; NAN: too few rounds */
} bb_effect;

/* Returns the ratio of the medians of two separate runs. An interval needs BB_INTERVAL_ROUNDS
 * counting rounds on both sides. All is NAN if a time is not above 0. */
bb_effect bb_effect_of_runs(const bb_samples *before, const bb_samples *after);

/* Returns the median of the ratios of pairs, of which the first does not count. */
bb_effect bb_effect_of_pairs(const bb_samples *ratios);

/* Returns whether the interval excludes 1. */
bool bb_effect_excludes_one(const bb_effect *effect);

#endif
