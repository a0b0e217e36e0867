/* For tests that make a result document member by member: an empty one, and read as from a file. */
#ifndef BB_TEST_DOCUMENT_FIXTURE_H
#define BB_TEST_DOCUMENT_FIXTURE_H

#include "framework/record/record_private.h"
#include "tests/fixture.h"

#include <cjson/cJSON.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

typedef struct document {
    cJSON *root, *scenes, *builds, *traces;
    int next; /* id */
} document;

static inline document empty_document(void)
{
    document d = {.root = cJSON_CreateObject()};
    cJSON_AddStringToObject(d.root, "schema", "bvhbench-results/1");
    cJSON *context = cJSON_AddObjectToObject(d.root, "context");
    cJSON_AddNumberToObject(context, "cpu_threads", 4);
    d.scenes = cJSON_AddArrayToObject(d.root, "scenes");
    d.builds = cJSON_AddArrayToObject(d.root, "builds");
    d.traces = cJSON_AddArrayToObject(d.root, "traces");
    cJSON_AddArrayToObject(d.root, "skipped");
    cJSON_AddArrayToObject(d.root, "pictures");
    cJSON_AddObjectToObject(d.root, "steps_ms");
    return d;
}

/* Traces get keys. The document is freed. */
static inline bb_results *read_back(document *d)
{
    cJSON *trace;
    cJSON_ArrayForEach(trace, d->traces) assert_true(bb_put_missing_key(trace));
    const char *folder = getenv("BVHBENCH_TEST_DIR");
    char path[600];
    bb_results *results = NULL;
    folder = folder != NULL ? folder : "/tmp";
    mkdir(folder, 0777);
    snprintf(path, sizeof path, "%s/document-%ld.json", folder, (long)getpid());
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    char *text = cJSON_Print(d->root);
    fputs(text, file);
    assert_int_equal(fclose(file), 0);
    cJSON_free(text);
    cJSON_Delete(d->root);
    if (bb_results_read(path, &results) != BB_OK)
        fail_msg("%s", bb_message());
    remove(path);
    return results;
}

#endif
