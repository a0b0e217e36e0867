#include "framework/bench/audit.h"

#include "framework/record/record.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* Tolerances: by how much two clocks may differ, and how long starting and stopping them takes. */
static const double clock_share = 0.01, clock_ms = 0.05;

/* Time that may remain unaccounted for: reading clocks, shuffling, keeping records. */
static const double rest_share = 0.02, rest_ms = 200;

static void complain(bb_audit *audit, const char *format, ...)
{
    if (audit->complaints < BB_COMPLAINTS_MAX) {
        va_list arguments;
        va_start(arguments, format);
        vsnprintf(audit->texts[audit->complaints], sizeof audit->texts[0], format, arguments);
        va_end(arguments);
    }
    audit->complaints++;
}

void bb_audit_timing(bb_audit *audit, const char *what, const bb_timing *timing, bool seen)
{
    audit->timings++;
    if (!(timing->ms > 0))
        complain(audit, "%s: took %g ms by the wall clock", what, timing->ms);
    else if (timing->event_ms > timing->ms * (1 + clock_share) + clock_ms)
        complain(audit, "%s: the work itself took %.3f ms, the clock around it saw %.3f ms", what,
                 timing->event_ms, timing->ms);
    else if (seen && !(timing->event_ms > 0))
        complain(audit, "%s: %.3f ms by the wall clock, but no work was seen in them", what,
                 timing->ms);
}

void bb_audit_outer(bb_audit *audit, const char *what, double ms, double outer_ms)
{
    audit->timings++;
    if (!(ms > 0) || outer_ms > 2 * ms + 1)
        complain(audit, "%s: took %.3f ms, but who called waited for %.3f ms", what, ms, outer_ms);
}

void bb_audit_launches(bb_audit *audit, const char *what, uint64_t timed, uint64_t launched,
                       uint64_t count)
{
    if (timed != count || launched != count)
        complain(audit, "%s: of %llu rays the clock saw %llu launched, of %llu in all", what,
                 (unsigned long long)count, (unsigned long long)timed,
                 (unsigned long long)launched);
}

/* Checks that the printed median is at least the time that the device saw. */
static void audit_median(bb_audit *audit, const bb_entry *entry, bb_field_id field)
{
    bool is_build = bb_fields[field].part == BB_IN_BUILD;
    double shown = bb_get_number(entry, field);
    bb_samples events;
    bb_get_samples(entry, is_build ? BB_F_BUILD_EVENT_SAMPLES : BB_F_TRACE_EVENT_SAMPLES, &events);
    double seen = bb_samples_median(&events);
    if (events.count > 0 && seen > shown * (1 + clock_share) + clock_ms)
        complain(audit, "%.60s on %.60s: %.30s is %.3f, but the device's own clock saw %.3f ms",
                 bb_get_text(entry, is_build ? BB_F_BUILD_BUILDER : BB_F_TRACE_BUILDER),
                 bb_get_text(entry, is_build ? BB_F_BUILD_SCENE : BB_F_TRACE_SCENE),
                 bb_fields[field].name, shown, seen);
}

/* Reads the document itself, so that the audit covers all steps from the clock to the printed
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
            complain(audit,
                     "%.60s on %.60s, %.40s by %.60s: %g Mrays/s in %g ms are %.0f rays, but %.0f "
                     "were judged",
                     bb_get_text(trace, BB_F_TRACE_BUILDER), bb_get_text(trace, BB_F_TRACE_SCENE),
                     bb_get_text(trace, BB_F_TRACE_RAYS), bb_get_text(trace, BB_F_TRACE_KERNEL),
                     shown, ms, shown * ms * 1e3, isfinite(judged) ? judged : 0);
    }
    bb_each(build, bb_results_section(results, BB_BUILDS))
    {
        if (bb_is_ok(build))
            audit_median(audit, build, BB_F_BUILD_MS_MEDIAN);
    }
}

void bb_audit_add(bb_audit *sum, const bb_audit *more)
{
    sum->timings += more->timings;
    sum->rates += more->rates;
    for (uint32_t i = 0; i < more->complaints; i++)
        complain(sum, "%s", i < BB_COMPLAINTS_MAX ? more->texts[i] : "");
}

void bb_audit_total(bb_audit *audit, double build_ms, double trace_ms, double steps_ms,
                    double total_ms)
{
    audit->rest_ms = total_ms - build_ms - trace_ms - steps_ms;
    if (fabs(audit->rest_ms) > rest_share * total_ms + rest_ms)
        complain(audit,
                 "builds (%.0f ms), traces (%.0f ms) and steps (%.0f ms) do not add up to the %.0f "
                 "ms of the run",
                 build_ms, trace_ms, steps_ms, total_ms);
}

bb_status bb_results_add_audit(bb_results *results, const bb_audit *audit)
{
    cJSON *root = bb_results_json(results);
    cJSON_DeleteItemFromObjectCaseSensitive(root, "audit");
    cJSON *entry = cJSON_AddObjectToObject(root, "audit");
    bool ok = entry != NULL &&
              cJSON_AddNumberToObject(entry, "timings", (double)audit->timings) != NULL &&
              cJSON_AddNumberToObject(entry, "rates", (double)audit->rates) != NULL &&
              cJSON_AddNumberToObject(entry, "rest_ms", audit->rest_ms) != NULL &&
              cJSON_AddNumberToObject(entry, "complaints", audit->complaints) != NULL;
    cJSON *texts = ok ? cJSON_AddArrayToObject(entry, "texts") : NULL;
    ok = ok && texts != NULL;
    for (uint32_t i = 0; ok && i < audit->complaints && i < BB_COMPLAINTS_MAX; i++) {
        cJSON *text = cJSON_CreateString(audit->texts[i]);
        ok = text != NULL && cJSON_AddItemToArray(texts, text);
        if (!ok)
            cJSON_Delete(text);
    }
    return ok ? BB_OK : bb_fail(BB_FAILED, "result document: no memory");
}
