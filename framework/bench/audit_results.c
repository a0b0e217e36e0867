#include "framework/bench/audit_results.h"

#include <math.h>
#include <stdio.h>

/* Checks that the printed median is at least the time that the device saw. */
static void audit_median(bb_audit *audit, const bb_entry *entry, bb_field_id field)
{
    bool is_build = bb_fields[field].part == BB_IN_BUILD;
    double shown = bb_get_number(entry, field);
    bb_samples events;
    bb_get_samples(entry, is_build ? BB_F_BUILD_EVENT_SAMPLES : BB_F_TRACE_EVENT_MS, &events);
    double seen = bb_samples_median(&events);
    if (events.count > 0 && bb_audit_exceeds(seen, shown))
        bb_audit_complain(audit,
                          "%.60s on %.60s: %.30s is %.3f, but the device's own clock saw %.3f ms",
                          bb_get_text(entry, is_build ? BB_F_BUILD_BUILDER : BB_F_TRACE_BUILDER),
                          bb_get_text(entry, is_build ? BB_F_BUILD_SCENE : BB_F_TRACE_SCENE),
                          bb_fields[field].name, shown, seen);
}

/* Reads the results themselves, so that the audit covers all steps from the clock to the printed
 * figure. */
void bb_audit_rates(bb_audit *audit, bb_results *results)
{
    bb_each(trace, bb_results_section(results, BB_TRACES))
    {
        if (!bb_is_ok(trace))
            continue;
        audit->rates++;
        audit_median(audit, trace, BB_F_TRACE_MS_MEDIAN);
        double judged = bb_get_number(trace, BB_F_ACCURACY_CHECKED);
        double shown = bb_get_number(trace, BB_F_TRACE_RATE);
        double ms = bb_get_number(trace, BB_F_TRACE_MS_MEDIAN);
        if (!(judged == bb_get_number(trace, BB_F_TRACE_COUNT) &&
              fabs(shown * ms * 1e3 - judged) <= 1e-6 * judged))
            bb_audit_complain(
                audit,
                "%.60s on %.60s, %.40s by %.60s: %g Mrays/s in %g ms are %.0f rays, but %.0f "
                "were judged",
                bb_get_text(trace, BB_F_TRACE_BUILDER), bb_get_text(trace, BB_F_TRACE_SCENE),
                bb_get_text(trace, BB_F_TRACE_RAYS), bb_get_text(trace, BB_F_TRACE_KERNEL), shown,
                ms, shown * ms * 1e3, isfinite(judged) ? judged : 0);
    }
    bb_each(build, bb_results_section(results, BB_BUILDS))
    {
        if (bb_is_ok(build))
            audit_median(audit, build, BB_F_BUILD_MS_MEDIAN);
    }
}

bb_status bb_results_set_audit(bb_results *results, const bb_audit *audit)
{
    char texts[BB_COMPLAINTS_MAX * (sizeof audit->texts[0] + 2)] = "";
    size_t used = 0;
    for (uint32_t i = 0; i < audit->complaints && i < BB_COMPLAINTS_MAX; i++)
        used += (size_t)snprintf(texts + used, sizeof texts - used, "%s%s", i > 0 ? "; " : "",
                                 audit->texts[i]);
    const double figures[] = {(double)audit->timings, (double)audit->rates, audit->rest_ms,
                              audit->complaints};
    for (int i = 0; i < 4; i++)
        BB_TRY(bb_results_set_number(results, BB_F_CONTEXT_AUDIT_TIMINGS + i, figures[i]));
    return bb_results_set_text(results, BB_F_CONTEXT_AUDIT_TEXTS, texts);
}
