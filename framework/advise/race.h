/* Racing: of many contenders, whose cost can only be measured with noise, those that are surely too
 * slow are dropped after each heat, so that the rest can be measured longer (Maron, Moore 1997,
 * "The Racing Algorithm: Model Selection for Lazy Learners"; heats with more and more rays as in
 * successive halving, Jamieson, Talwalkar 2016, but without dropping anybody by rank alone).
 *
 * A heat measures all that are left side by side, round by round. What drops a contender is the
 * ratio of its cost to that of the contender with the lowest median, round by round: if it is above
 * the slack in every round that counts, it is out. So what is out is slower than somebody by more
 * than the slack, whoever the best is in truth. The lower end of the 95 % interval would not do:
 * the one with the lowest median has had luck, and there are many comparisons. Of one whose median
 * ratio is within the slack, n rounds are all above it with a chance of 2^-n at most. With fewer
 * than BB_INTERVAL_ROUNDS rounds nobody is dropped. tests/test_advise_race.c simulates races.
 *
 * Nothing here knows what is measured, or how.
 */
#ifndef BB_RACE_H
#define BB_RACE_H

#include "framework/base/statistics.h"
#include "framework/base/status.h"

#include <stdbool.h>

enum { BB_NO_RACER = UINT32_MAX };

typedef enum bb_racer_state {
    BB_RACING,
    BB_TOO_SLOW,
    BB_TOO_WRONG, /* set by who measures */
    BB_NOT_RUN,   /* refused, unsupported or failed: likewise */
} bb_racer_state;

typedef struct bb_racer {
    bb_racer_state state;
    bb_samples cost;  /* of the last heat that it ran in; sample 0 is the warm-up */
    uint32_t heats;   /* that it ran in */
    uint32_t behind;  /* too slow: against whom; else BB_NO_RACER */
    bb_samples ratio; /* of its cost to that one's, by rounds */
} bb_racer;

/* Measures the racers that are BB_RACING: sets their costs, or their states. */
typedef bb_status bb_heat_fn(void *user, uint32_t heat, bb_racer *racers, uint32_t count);

/* The ratio of the costs of a and b, paired by rounds. */
bb_estimate bb_race_ratio(const bb_racer *a, const bb_racer *b);

/* Of those in the race the one of the lowest median cost, the first of several; BB_NO_RACER. */
uint32_t bb_race_best(const bb_racer *racers, uint32_t count);

/* Of those in the race the fastest by pairs: the one that beats most of the others round by round,
 * of several the one of the lowest median cost. The lowest median alone may be luck: the ratio of
 * another one to it, which is what is shown, could be below 1. BB_NO_RACER. */
uint32_t bb_race_fastest(const bb_racer *racers, uint32_t count);

/* Drops who is too slow by more than `slack` (1.05: 5 %); returns how many are left. */
uint32_t bb_race_drop(bb_racer *racers, uint32_t count, double slack);

/* The same by the least cost of each, for a slack with room in it: what disturbs a time lengthens
 * it, so on a busy machine a round of the best that was disturbed does not save one that is slower
 * by far. One at the very slack may be dropped as well as not. */
uint32_t bb_race_drop_least(bb_racer *racers, uint32_t count, double slack);

/* Heats 0 .. heats - 1, each followed by drops, the last one by none: until then, or until one is
 * left after the least number of heats, or `measure` fails. Sets all racers up. */
bb_status bb_race_run(bb_racer *racers, uint32_t count, uint32_t heats, double slack,
                      bb_heat_fn *measure, void *user);

#endif
