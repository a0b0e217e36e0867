/* A history of made-up runs: revisions of two machines, in which one kernel gets slower by 30 %,
 * another faster, and an SAH worse by 2 %. */
#ifndef BB_HISTORY_SAMPLE_H
#define BB_HISTORY_SAMPLE_H

#include "tests/record_fixture.h"

#include "framework/base/random.h"
#include "framework/compare/history.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Sets a metric of a build's tree; NAN: it was not measured. */
static inline void put_metric(bb_results *results, const bb_entry *build, const char *name,
                              double value)
{
    const bb_metric *metric = bb_metrics[bb_metric_find(name)];
    bb_table_set_number(results->table, build->row, bb_metric_column(metric, false), value);
}

static inline double metric_of(const bb_entry *build, const char *name)
{
    return bb_get_metric(build, bb_metrics[bb_metric_find(name)]);
}

/* How a revision differs. Indices of traces and of builds. */
typedef struct history_change {
    int slow_trace, fast_trace, worse_sah; /* -1: none */
} history_change;

/* The sample document as a run of `revision` on `host`, with six rounds everywhere and keys for
 * builds. */
static inline bb_results *history_run(const char *revision, const char *host, const char *date,
                                      history_change change, uint64_t seed)
{
    bb_results *results = sample_results(NULL);
    bb_random random = bb_random_make(seed, 0);
    ASSERT_OK(bb_results_set_text(results, BB_F_CONTEXT_REVISION, revision));
    ASSERT_OK(bb_results_set_text(results, BB_F_CONTEXT_HOST, host));
    ASSERT_OK(bb_results_set_text(results, BB_F_CONTEXT_DATE, date));
    ASSERT_OK(bb_results_set_text(results, BB_F_CONTEXT_CPU, "made up"));
    ASSERT_OK(bb_results_set_text(results, BB_F_CONTEXT_DEVICE_TYPE, "CPU"));
    ASSERT_OK(bb_results_set_text(results, BB_F_CONTEXT_GOVERNOR, "performance"));
    ASSERT_OK(bb_results_set_text(results, BB_F_CONTEXT_SMT, "off"));
    ASSERT_OK(bb_results_set_text(results, BB_F_CONTEXT_BOOST, "off"));
    ASSERT_OK(bb_results_set_text(results, BB_F_CONTEXT_PROCESSORS, "all"));
    ASSERT_OK(bb_results_set_number(results, BB_F_CONTEXT_THREADS, 4));
    int index = 0;
    for (bb_entry *build = results->sections[BB_BUILDS].first; build != NULL; build = build->next) {
        char key[700];
        snprintf(key, sizeof key, "scene=%d/builder=%s", index / SAMPLE_PER_SCENE,
                 bb_get_text(build, BB_F_BUILD_BUILDER));
        bb_put_text(build, BB_F_BUILD_CELL, key);
        if (index++ == change.worse_sah)
            put_metric(results, build, "sah", 1.02 * metric_of(build, "sah"));
    }
    index = 0;
    for (bb_entry *trace = results->sections[BB_TRACES].first; trace != NULL; trace = trace->next) {
        bb_samples rounds = {0};
        double ms = 5 + index % 50;
        ms *= index == change.slow_trace ? 1.3 : index == change.fast_trace ? 0.7 : 1;
        for (int i = 0; i < 7; i++)
            bb_samples_add(&rounds, ms * (1 + 0.02 * bb_random_unit(&random) + (i == 0)));
        bb_put_rounds(trace, BB_F_TRACE_MS, &rounds);
        index++;
    }
    return results;
}

static inline void history_add(const char *path, const char *revision, const char *host,
                               const char *date, history_change change, uint64_t seed)
{
    bb_history *history;
    bb_results *results = history_run(revision, host, date, change, seed);
    ASSERT_OK(bb_history_open(path, true, &history));
    ASSERT_OK(bb_history_append(history, bb_results_table(results)));
    bb_history_close(history);
    bb_results_destroy(results);
}

enum { SLOW_TRACE = 40, FAST_TRACE = 90, WORSE_SAH = 3 };

static inline void history_fill(const char *path)
{
    static const history_change nothing = {-1, -1, -1};
    const history_change slower = {SLOW_TRACE, -1, -1}, more = {SLOW_TRACE, -1, WORSE_SAH},
                         faster = {SLOW_TRACE, FAST_TRACE, WORSE_SAH};
    history_add(path, "aaaa111111111", "north", "2024-01-01T00:00:00Z", nothing, 1);
    history_add(path, "aaaa111111111", "north", "2024-01-01T01:00:00Z", nothing, 2);
    history_add(path, "abab222222222", "north", "2024-01-02T00:00:00Z", nothing, 3);
    history_add(path, "cccc333333333", "north", "2024-01-03T00:00:00Z", slower, 4);
    history_add(path, "dddd444444444", "north", "2024-01-04T00:00:00Z", more, 5);
    history_add(path, "eeee555555555", "north", "2024-01-05T00:00:00Z", faster, 6);
    history_add(path, "eeee555555555", "south", "2024-01-06T00:00:00Z", nothing, 7);
}

#endif
