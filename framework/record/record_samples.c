/* Statistics of the samples of a build or a trace. For a time or rate NAME, NAME_lo and NAME_hi are
 * the 95 % interval of the median, and NAME_least and NAME_most the range of the counting rounds.
 * They are null if there are too few rounds.
 */
#include "framework/record/record_private.h"

#include <math.h>

/* Puts interval and range into `low` and the three fields that follow it. */
static bool put_spread(cJSON *entry, bb_field_id low, bb_estimate e)
{
    const double ends[] = {e.low, e.high, e.least, e.most};
    for (size_t i = 0; i < sizeof ends / sizeof ends[0]; i++)
        if (!bb_put_number(entry, bb_fields[low + i].name, ends[i]))
            return false;
    return true;
}

bool bb_put_build_spread(cJSON *build, const bb_samples *ms)
{
    return put_spread(build, BB_F_BUILD_MS_LO, bb_samples_estimate(ms));
}

/* Puts the spread of a rate: the longest time gives the lowest rate. */
bool bb_put_rate_spread(cJSON *trace, const bb_samples *ms)
{
    bb_estimate e = bb_samples_estimate(ms);
    double rays = bb_get_number(trace, BB_F_TRACE_COUNT) / 1e3;
    return put_spread(trace, BB_F_TRACE_RATE_LO,
                      (bb_estimate){.value = rays / e.value,
                                    .low = rays / e.high,
                                    .high = rays / e.low,
                                    .least = rays / e.most,
                                    .most = rays / e.least});
}
