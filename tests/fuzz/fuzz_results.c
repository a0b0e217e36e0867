/* Result files: whatever is read can be written and read again, merged with another, summed up and
 * shown. */
#include "framework/compare/summary.h"
#include "framework/report/chart.h"
#include "framework/report/report.h"
#include "tests/fuzz/fuzz.h"

#include <cjson/cJSON.h>

/* One screen, and all other forms; each may find that there is no memory, but nothing else. */
static void show(bb_results *results)
{
    static bb_status (*const forms[])(const bb_results *, FILE *) = {
        bb_report_verdict, bb_report_table, bb_report_markdown, bb_report_csv};
    for (size_t i = 0; i < sizeof forms / sizeof forms[0]; i++) {
        char *text = NULL;
        size_t size = 0;
        FILE *out = open_memstream(&text, &size);
        FUZZ_CHECK(out != NULL);
        FUZZ_CHECK(forms[i](results, out) == BB_OK);
        FUZZ_CHECK(fclose(out) == 0);
        /* nothing that moves a terminal's cursor; lines of comma-separated values end with \r\n */
        for (size_t k = 0; k < size; k++)
            FUZZ_CHECK((unsigned char)text[k] >= 0x20 || text[k] == '\n' ||
                       (text[k] == '\r' && forms[i] == bb_report_csv));
        free(text);
    }
}

/* What the page is given must be JSON. */
static void make_page(bb_results *results)
{
    char *summary = bb_summary_json(results);
    FUZZ_CHECK(summary != NULL);
    cJSON *json = cJSON_Parse(summary);
    FUZZ_CHECK(json != NULL);
    cJSON_Delete(json);
    cJSON_free(summary);
    FUZZ_CHECK(bb_report_html(results, NULL, fuzz_path("report.html")) == BB_OK);
}

/* The text of a document is read to a document with that text. */
static bb_results *read_again(const bb_results *results)
{
    bb_results *again = NULL;
    char *text = bb_table_json(bb_results_table(results));
    FUZZ_CHECK(text != NULL);
    FUZZ_CHECK(bb_results_read(fuzz_file("again.json", text, strlen(text)), &again) == BB_OK);
    char *twice = bb_table_json(bb_results_table(again));
    FUZZ_CHECK(twice != NULL && strcmp(text, twice) == 0);
    free(text);
    free(twice);
    return again;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    bb_results *results = NULL;
    bb_status status = bb_results_read(fuzz_file("results.json", data, size), &results);
    if (status != BB_OK) {
        fuzz_refused(status);
        FUZZ_CHECK(results == NULL);
        return 0;
    }
    bb_results *again = read_again(results);
    show(results);
    if (size % 4 == 0) /* it is much that is written */
        make_page(results);
    status = bb_results_merge(results, again);
    if (status != BB_OK)
        fuzz_refused(status);
    else {
        bb_results_destroy(again);
        again = read_again(results);
        show(again);
    }
    bb_results_destroy(results);
    bb_results_destroy(again);
    return 0;
}
