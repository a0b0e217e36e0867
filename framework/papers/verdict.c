/* Whether a claim of a paper held. Times are noisy: by them a claim holds, or does not, only where
 * a whole 95 % interval says so.
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

bb_claim_verdict bb_verdict_at(bb_estimate e, bool timed, bb_test_side side, double bound,
                               double most)
{
    const double low = timed ? e.low : e.value, high = timed ? e.high : e.value;
    const bb_estimate range = {.value = e.value + 0 * bound, .low = low, .high = high};
    switch (side) {
    case BB_BELOW:
        return by_interval(range, high < bound, low >= bound);
    case BB_ABOVE:
        return by_interval(range, low > bound, high <= bound);
    case BB_AT_MOST:
        return by_interval(range, high <= bound, low > bound);
    case BB_AT_LEAST:
        return by_interval(range, low >= bound, high < bound);
    default:
        return by_interval(range, low > bound && high < most, high <= bound || low >= most);
    }
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
    return known == 0                         ? BB_NOT_TESTED
           : 2 * counts[BB_HELD] > known      ? BB_HELD
           : 2 * counts[BB_NOT_HELD] >= known ? BB_NOT_HELD
           : counts[BB_TOO_FEW_ROUNDS] > 0    ? BB_TOO_FEW_ROUNDS
                                              : BB_OPEN;
}

const char *bb_verdict_words(bb_claim_verdict verdict)
{
    static const char *const words[] = {
        [BB_HELD] = "held",
        [BB_OPEN] = "undecided: a 95 % interval reaches to both sides",
        [BB_TOO_FEW_ROUNDS] = "undecided: too few rounds",
        [BB_NOT_TESTED] = "cannot be tested here",
        [BB_NOT_HELD] = "not held",
    };
    return words[verdict];
}
