/* Computes the interval of a ratio of medians from the intervals of both medians.
 *
 * On logarithms the ratio is a difference. Each logarithm's median m has an interval [l, u] by
 * order statistics (framework/base/statistics.h). The width of such an interval to each side is the
 * uncertainty there, and the uncertainties of two independent estimates add up in squares (Zou and
 * Donner: Construction of confidence limits about effect measures, Statistics in Medicine 27,
 * 2008):
 *
 *     low  = m2 - m1 - sqrt((m2 - l2)^2 + (u1 - m1)^2)
 *     high = m2 - m1 + sqrt((u2 - m2)^2 + (m1 - l1)^2)
 *
 * The method assumes no common shape of the distributions, as ranks would, and no symmetry.
 * tests/test_compare_statistics.c measures the coverage. */
#include "framework/compare/effect.h"

#include <math.h>

static const bb_effect unknown = {NAN, NAN, NAN};

static bb_estimate of_logarithms(const bb_samples *ms)
{
    bb_samples logarithms = {0};
    for (uint32_t i = 0; i < ms->count; i++)
        bb_samples_add(&logarithms, log(ms->values[i])); /* not finite for 0 and below */
    return bb_samples_estimate(&logarithms);
}

bb_effect bb_effect_of_runs(const bb_samples *before, const bb_samples *after)
{
    if (before->count == 0 || after->count == 0)
        return unknown;
    bb_estimate a = of_logarithms(before), b = of_logarithms(after);
    if (!isfinite(a.value) || !isfinite(b.value))
        return unknown;
    double d = b.value - a.value;
    return (bb_effect){exp(d), exp(d - hypot(b.value - b.low, a.high - a.value)),
                       exp(d + hypot(b.high - b.value, a.value - a.low))};
}

bb_effect bb_effect_of_pairs(const bb_samples *ratios)
{
    if (ratios->count == 0)
        return unknown;
    bb_estimate e = of_logarithms(ratios);
    return (bb_effect){exp(e.value), exp(e.low), exp(e.high)};
}

bool bb_effect_excludes_one(const bb_effect *effect)
{
    return effect->low > 1 || effect->high < 1;
}
