/* Results as JSON, section by section, for tests to look at: documents live until the test ends. */
#ifndef BB_TEST_DOCUMENT_H
#define BB_TEST_DOCUMENT_H

#include "framework/record/record.h"
#include "tests/fixture.h"

#include <cjson/cJSON.h>
#include <stdlib.h>

static cJSON **documents;
static size_t document_count;

static inline void free_documents(void)
{
    for (size_t i = 0; i < document_count; i++)
        cJSON_Delete(documents[i]);
    free(documents);
}

static inline cJSON *keep_document(cJSON *document)
{
    assert_non_null(document);
    if (document_count == 0)
        atexit(free_documents);
    documents = realloc(documents, (document_count + 1) * sizeof *documents);
    assert_non_null(documents);
    return documents[document_count++] = document;
}

/* The results as they are now. */
static inline cJSON *document_of(const bb_results *results)
{
    char *json = bb_results_json(results);
    assert_non_null(json);
    cJSON *document = cJSON_Parse(json);
    free(json);
    return keep_document(document);
}

#endif
