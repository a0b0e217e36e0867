/* Whether a claim of a paper held. Times are noisy: by them a claim holds, or does not, only where
 * a whole 95 % interval says so. A direction is less than a size: who claims eight times and gets
 * 1.5 has the direction only.
 */
#include "framework/papers/reproduce.h"

#include <math.h>

/* `held` and `failed`: what the ends of the interval say, if there is one. */
static bb_claim_verdict by_interval(bb_estimate e, bool held, bool failed)
{
    return isnan(e.value)                  ? BB_NOT_TESTED
           : isnan(e.low) || isnan(e.high) ? BB_TOO_FEW_ROUNDS
           : held                          ? BB_HELD
           : failed                        ? BB_NOT_HELD
                                           : BB_OPEN;
}

static bb_claim_verdict on_side(bb_estimate range, bb_test_side side, double bound)
{
    switch (side) {
    case BB_BELOW:
        return by_interval(range, range.high < bound, range.low >= bound);
    case BB_ABOVE:
        return by_interval(range, range.low > bound, range.high <= bound);
    case BB_AT_MOST:
        return by_interval(range, range.high <= bound, range.low > bound);
    default:
        return by_interval(range, range.low >= bound, range.high < bound);
    }
}

/* As far as claimed, by the margin. */
static bb_claim_verdict by_size(bb_estimate range, bb_test_side side, double claimed)
{
    const double less = claimed * (1 - BB_CLAIM_MARGIN), more = claimed * (1 + BB_CLAIM_MARGIN);
    if (side == BB_EQUAL)
        return by_interval(range, range.low >= less && range.high <= more,
                           range.high < less || range.low > more);
    return on_side(range, side, side == BB_BELOW || side == BB_AT_MOST ? more : less);
}

bb_claim_verdict bb_verdict_at(bb_estimate e, bool timed, bb_test_side side, double bound,
                               double claimed)
{
    const bb_estimate range = {.value = e.value + 0 * bound + 0 * claimed,
                               .low = timed ? e.low : e.value,
                               .high = timed ? e.high : e.value};
    const bb_test_side right = side != BB_EQUAL ? side : claimed > bound ? BB_ABOVE : BB_BELOW;
    if (claimed == 0)
        return on_side(range, side, bound);
    const bb_claim_verdict size = by_size(range, side, claimed);
    if (size == BB_HELD || bound == 0)
        return size;
    const bb_claim_verdict direction = on_side(range, right, bound);
    return direction == BB_HELD ? BB_DIRECTION : direction;
}

bb_claim_verdict bb_all(const bb_claim_verdict *each, size_t count)
{
    bb_claim_verdict worst = count > 0 ? BB_HELD : BB_NOT_TESTED;
    for (size_t i = 0; i < count; i++)
        worst = each[i] > worst ? each[i] : worst;
    return worst;
}

bb_claim_verdict bb_most(const bb_claim_verdict *each, size_t count)
{
    size_t counts[BB_NOT_HELD + 1] = {0};
    for (size_t i = 0; i < count; i++)
        counts[each[i]]++;
    size_t known = count - counts[BB_NOT_TESTED];
    return known == 0                                             ? BB_NOT_TESTED
           : 2 * counts[BB_HELD] > known                          ? BB_HELD
           : 2 * (counts[BB_HELD] + counts[BB_DIRECTION]) > known ? BB_DIRECTION
           : 2 * counts[BB_NOT_HELD] >= known                     ? BB_NOT_HELD
           : counts[BB_TOO_FEW_ROUNDS] > 0                        ? BB_TOO_FEW_ROUNDS
                                                                  : BB_OPEN;
}

const char *bb_verdict_words(bb_claim_verdict verdict)
{
    static const char *const words[] = {
        [BB_HELD] = "held",
        [BB_DIRECTION] = "direction only",
        [BB_OPEN] = "cannot be told: a 95 % interval reaches to both sides",
        [BB_TOO_FEW_ROUNDS] = "cannot be told: too few rounds",
        [BB_NOT_TESTED] = "cannot be told: not measured here",
        [BB_NOT_HELD] = "not held",
    };
    return words[verdict];
}
