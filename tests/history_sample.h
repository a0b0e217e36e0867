/* A history of made-up runs: revisions of two machines, in which one kernel gets slower by 30 %,
 * another faster, and an SAH worse by 2 %. */
#ifndef BB_HISTORY_SAMPLE_H
#define BB_HISTORY_SAMPLE_H

#include "tests/record_fixture.h"

#include "framework/base/random.h"
#include "framework/history/history.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static inline void set_text(cJSON *object, const char *name, const char *text)
{
    cJSON_DeleteItemFromObjectCaseSensitive(object, name);
    assert_non_null(cJSON_AddStringToObject(object, name, text));
}

static inline void set_item(cJSON *object, const char *name, cJSON *item)
{
    cJSON_DeleteItemFromObjectCaseSensitive(object, name);
    assert_true(cJSON_AddItemToObject(object, name, item));
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
    cJSON *context = cJSON_GetObjectItem(bb_results_json(results), "context"), *entry;
    bb_random random = bb_random_make(seed, 0);
    set_text(context, "revision", revision);
    set_text(context, "host", host);
    set_text(context, "date", date);
    set_text(context, "cpu", "made up");
    set_text(context, "device_type", "CPU");
    int index = 0;
    cJSON_ArrayForEach(entry, section(results, "builds"))
    {
        char key[700];
        snprintf(key, sizeof key, "scene=%d/builder=%s", index / SAMPLE_PER_SCENE,
                 member(entry, "builder")->valuestring);
        for (char *at = key; *at != '\0'; at++)
            *at = *at == '/' && strncmp(at, "/builder=", 9) != 0 ? '.' : *at;
        set_text(entry, "cell", key);
        cJSON *sah = cJSON_GetObjectItem(cJSON_GetObjectItem(entry, "tree"), "sah");
        if (index == change.worse_sah)
            cJSON_SetNumberValue(sah, sah->valuedouble * 1.02);
        index++;
    }
    index = 0;
    cJSON_ArrayForEach(entry, section(results, "traces"))
    {
        cJSON *rounds = cJSON_CreateArray();
        double ms = 5 + index % 50;
        ms *= index == change.slow_trace ? 1.3 : index == change.fast_trace ? 0.7 : 1;
        for (int i = 0; i < 7; i++)
            cJSON_AddItemToArray(
                rounds, cJSON_CreateNumber(ms * (1 + 0.02 * bb_random_unit(&random) + (i == 0))));
        set_item(entry, "ms", rounds);
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
    ASSERT_OK(bb_history_append(history, results));
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
