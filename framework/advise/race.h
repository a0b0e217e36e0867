/* Racing finds the fastest of many contenders whose costs are noisy. Each heat drops those that are
 * certainly too slow, so that the rest can be measured longer (Maron, Moore 1997, "The Racing
 * Algorithm: Model Selection for Lazy Learners"). Heats have more and more rays, as in successive
 * halving (Jamieson, Talwalkar 2016), but rank alone drops nobody.
 *
 * A heat measures all racing contenders side by side, round by round. A contender is dropped if its
 * ratio to the one with the lowest median is above the slack in every round that counts. So each
 * dropped contender is slower than some other by more than the slack, whoever is truly the fastest.
 * The lower end of the 95 % interval would not be enough: the lowest median is partly luck, and
 * there are many comparisons. If the true median ratio is within the slack, all n rounds are above
 * it with probability 2^-n at most. With fewer than BB_INTERVAL_ROUNDS rounds nobody is dropped.
 * tests/test_advise_race.c simulates races.
 *
 * The race does not know what is measured, or how.
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
    BB_TOO_WRONG, /* set by the measurement */
    BB_NOT_RUN,   /* set by the measurement: refused, unsupported or failed */
} bb_racer_state;

typedef struct bb_racer {
    bb_racer_state state;
    bb_samples cost;  /* of the last heat that it ran in; sample 0 is the warm-up */
    uint32_t heats;   /* that it ran in */
    uint32_t behind;  /* too slow: against whom; else BB_NO_RACER */
    bb_samples ratio; /* of its cost to that racer's, by rounds */
} bb_racer;

/* Measures the racers that are BB_RACING, and sets their costs or states. */
typedef bb_status bb_heat_fn(void *user, uint32_t heat, bb_racer *racers, uint32_t count);

/* Returns the ratio of the costs of a and b, paired by rounds. */
bb_estimate bb_race_ratio(const bb_racer *a, const bb_racer *b);

/* Returns the first racing one with the lowest median cost, or BB_NO_RACER. */
uint32_t bb_race_best(const bb_racer *racers, uint32_t count);

/* Returns the racing one that beats most others by its median ratio, the one with the lower median
 * cost of several, or BB_NO_RACER. The lowest median alone may be luck: a shown ratio to it could
 * be below 1. */
uint32_t bb_race_fastest(const bb_racer *racers, uint32_t count);

/* Drops racers that are slower by more than `slack` (1.05: 5 %). Returns the number left. */
uint32_t bb_race_drop(bb_racer *racers, uint32_t count, double slack);

/* Does the same by least costs, for a generous slack. Disturbances only lengthen times, so a
 * disturbed round of the best one cannot save a racer that is slower by far. A racer close to the
 * slack may or may not be dropped. */
uint32_t bb_race_drop_least(bb_racer *racers, uint32_t count, double slack);

/* Initialises all racers and runs heats 0 .. heats - 1, with drops after each heat except the last.
 * Stops if `measure` fails. */
bb_status bb_race_run(bb_racer *racers, uint32_t count, uint32_t heats, double slack,
                      bb_heat_fn *measure, void *user);

#endif
