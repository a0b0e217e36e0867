/* What the tests of records share: sections and members of a document, and a path for its file. */
#ifndef BB_RECORD_FIXTURE_H
#define BB_RECORD_FIXTURE_H

#include "tests/fixture.h"
#include "tests/report_sample.h"

#include <cjson/cJSON.h>
#include <unistd.h>

static inline cJSON *section(bb_results *results, const char *name)
{
    cJSON *array = cJSON_GetObjectItemCaseSensitive(bb_results_json(results), name);
    assert_true(cJSON_IsArray(array));
    return array;
}

static inline cJSON *member(const cJSON *object, const char *name)
{
    cJSON *item = cJSON_GetObjectItemCaseSensitive(object, name);
    if (item == NULL)
        fail_msg("no member %s", name);
    return item;
}

/* Of a file that is not there yet. */
static inline const char *results_path(const char *test)
{
    static char path[600];
    snprintf(path, sizeof path, "%s/results.json", sample_folder(test));
    unlink(path);
    return path;
}

#endif
