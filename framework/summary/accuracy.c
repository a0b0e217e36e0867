/* Intersectors beside each other: how often each is wrong, and what its speed gains, on the same
 * rays, trees and kernels. */
#include "framework/summary/summary_private.h"

#include <cjson/cJSON.h>
#include <stdlib.h>
#include <string.h>

static bool usable(const cJSON *trace, const bb_summary_choice *choice)
{
    return bb_is_ok(trace) && !bb_get_true(trace, BB_F_TRACE_REFERENCE) &&
           bb_get_number(trace, BB_F_ACCURACY_CHECKED) > 0 &&
           isfinite(bb_get_number(trace, BB_F_ACCURACY_WRONG_PPM)) &&
           bb_get_number(trace, BB_F_TRACE_RATE) > 0 &&
           bb_choice_takes(choice, bb_get_text(trace, BB_F_TRACE_SCENE),
                           bb_get_text(trace, BB_F_TRACE_RAYS));
}

/* They differ in the intersector alone. */
static bool beside(const cJSON *a, const cJSON *b)
{
    return bb_get_number(a, BB_F_TRACE_BUILD) == bb_get_number(b, BB_F_TRACE_BUILD) &&
           bb_same_text(a, b, BB_F_TRACE_RAYS_HASH) && bb_same_text(a, b, BB_F_TRACE_RAYS) &&
           bb_same_text(a, b, BB_F_TRACE_VIEW) && bb_same_text(a, b, BB_F_TRACE_KERNEL) &&
           !bb_same_text(a, b, BB_F_TRACE_INTERSECTOR);
}

static bb_summary_accuracy *entry_of(bb_summary *s, const char *intersector)
{
    for (uint32_t i = 0; i < s->accuracy_count; i++)
        if (strcmp(s->accuracy[i].intersector, intersector) == 0)
            return &s->accuracy[i];
    bb_summary_accuracy *grown =
        realloc(s->accuracy, (s->accuracy_count + 1) * sizeof *s->accuracy);
    if (grown == NULL)
        return NULL;
    s->accuracy = grown;
    grown[s->accuracy_count] = (bb_summary_accuracy){.intersector = intersector};
    return &grown[s->accuracy_count++];
}

/* The cell of `exact` beside it; itself if it is that; NULL if there is none, or if nothing at all
 * is beside it. */
static const cJSON *exact_beside(const cJSON *traces, const cJSON *trace,
                                 const bb_summary_choice *choice)
{
    const cJSON *other;
    bool exact = bb_get_true(trace, BB_F_TRACE_COUNTS);
    cJSON_ArrayForEach(other, traces)
    {
        if (!usable(other, choice) || !beside(trace, other))
            continue;
        if (exact)
            return trace;
        if (bb_get_true(other, BB_F_TRACE_COUNTS))
            return other;
    }
    return NULL;
}

static int by_wrong(const void *a, const void *b)
{
    const bb_summary_accuracy *x = a, *y = b;
    double p = x->wrong / x->checked, q = y->wrong / y->checked;
    if (p != q)
        return p < q ? -1 : 1;
    return strcmp(x->intersector, y->intersector);
}

/* Whether there is more than one intersector: else nothing is searched. */
static bool has_several(const cJSON *traces)
{
    const cJSON *trace;
    cJSON_ArrayForEach(trace, traces)
    {
        if (!bb_get_true(trace, BB_F_TRACE_REFERENCE) && !bb_get_true(trace, BB_F_TRACE_COUNTS))
            return true;
    }
    return false;
}

bb_status bb_summary_accuracies(const bb_results *results, const bb_summary_choice *choice,
                                bb_summary *summary)
{
    const cJSON *trace, *traces = bb_results_section(results, "traces");
    if (!has_several(traces))
        return BB_OK;
    cJSON_ArrayForEach(trace, traces)
    {
        const cJSON *exact = usable(trace, choice) ? exact_beside(traces, trace, choice) : NULL;
        if (exact == NULL)
            continue;
        bb_summary_accuracy *a = entry_of(summary, bb_get_text(trace, BB_F_TRACE_INTERSECTOR));
        if (a == NULL)
            return bb_fail(BB_FAILED, "summary: no memory");
        double checked = bb_get_number(trace, BB_F_ACCURACY_CHECKED);
        a->wrong += round(bb_get_number(trace, BB_F_ACCURACY_WRONG_PPM) * checked / 1e6);
        a->checked += checked;
        a->wrong_t += bb_get_number(trace, BB_F_ACCURACY_WRONG_T);
        a->speed +=
            log(bb_get_number(trace, BB_F_TRACE_RATE) / bb_get_number(exact, BB_F_TRACE_RATE));
        a->cells++;
    }
    for (uint32_t i = 0; i < summary->accuracy_count; i++)
        summary->accuracy[i].speed = exp(summary->accuracy[i].speed / summary->accuracy[i].cells);
    qsort(summary->accuracy, summary->accuracy_count, sizeof *summary->accuracy, by_wrong);
    return BB_OK;
}
