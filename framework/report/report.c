/* The HTML report: a template into which style, chart library, script, records and pictures are
 * put, so that one file is all there is to keep or send. The cells of the charts are computed here
 * (framework/chart/chart.h); the page's script draws what is chosen of them.
 */
#include "framework/report/report.h"
#include "framework/base/file.h"
#include "framework/chart/chart.h"
#include "framework/record/schema.h"
#include "framework/summary/summary.h"

#include <cjson/cJSON.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* Embedded at build time. */
extern const char bb_text_report_html[], bb_text_report_css[], bb_text_report_js[],
    bb_text_chart_js[];

enum { PICTURE_BYTES_MAX = 16 << 20 };

/* ---- a text that grows ---- */

typedef struct text {
    char *data;
    size_t size, capacity;
    bool failed; /* no memory; later calls do nothing */
} text;

static void append(text *out, const char *data, size_t size)
{
    if (out->failed)
        return;
    if (out->size + size > out->capacity) {
        size_t capacity = 2 * (out->size + size) + 4096;
        char *grown = realloc(out->data, capacity);
        if (grown == NULL) {
            out->failed = true;
            return;
        }
        out->data = grown;
        out->capacity = capacity;
    }
    memcpy(out->data + out->size, data, size);
    out->size += size;
}

static void append_string(text *out, const char *string)
{
    append(out, string, strlen(string));
}

/* JSON inside <script>: a '<' can only stand in a string, where it is escaped, so that no text ends
 * the script. */
static void append_json(text *out, const char *json)
{
    for (;;) {
        size_t plain = strcspn(json, "<");
        append(out, json, plain);
        if (json[plain] == '\0')
            return;
        append_string(out, "\\u003c");
        json += plain + 1;
    }
}

/* RFC 4648, section 4. */
static void append_base64(text *out, const unsigned char *data, size_t size)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < size; i += 3) {
        size_t left = size - i;
        uint32_t bits = (uint32_t)data[i] << 16 | (left > 1 ? (uint32_t)data[i + 1] << 8 : 0) |
                        (left > 2 ? data[i + 2] : 0);
        char four[4] = {digits[bits >> 18], digits[bits >> 12 & 63],
                        left > 1 ? digits[bits >> 6 & 63] : '=',
                        left > 2 ? digits[bits & 63] : '='};
        append(out, four, 4);
    }
}

/* ---- pictures ---- */

/* Where FOLDER/PATH really is, from malloc, and whether that is below the folder; NULL if it is not
 * there. */
static char *locate_picture(const char *folder, const char *path, bool *below)
{
    text joined = {0};
    append_string(&joined, folder);
    append_string(&joined, "/");
    append_string(&joined, path);
    append(&joined, "", 1);
    char *real = joined.failed ? NULL : realpath(joined.data, NULL);
    char *real_folder = realpath(folder, NULL);
    size_t length = real_folder != NULL ? strlen(real_folder) : 0;
    *below = real != NULL && length > 0 && strncmp(real, real_folder, length) == 0 &&
             (real[length] == '/' || length == 1);
    free(real_folder);
    free(joined.data);
    return real;
}

/* The picture as a data URI, or why there is none. Only PNG files below the folder of the results
 * are taken in: a result file, which may be anybody's, must not make us copy others. */
static bool picture_source(const char *folder, const char *path, text *source, const char **missing)
{
    bool below = false;
    char *real = path[0] != '/' ? locate_picture(folder, path, &below) : NULL;
    char *data = NULL;
    size_t size = 0;
    *missing = NULL;
    if (path[0] == '/' || (real != NULL && !below))
        *missing = "the file is not in the folder of the results";
    else if (real == NULL ||
             bb_file_read(real, PICTURE_BYTES_MAX, "picture", &data, &size) != BB_OK)
        *missing = "the file was not there or is too large";
    else if (size < 8 || memcmp(data, "\x89PNG\r\n\x1a\n", 8) != 0)
        *missing = "the file is no PNG";
    if (*missing == NULL) {
        append_string(source, "data:image/png;base64,");
        append_base64(source, (const unsigned char *)data, size);
        append(source, "", 1);
    }
    free(data);
    free(real);
    return *missing == NULL && !source->failed;
}

/* The picture records with "src" or "missing" added; NULL if there is no memory. */
static char *pictures_json(const cJSON *root, const char *folder)
{
    cJSON *list = cJSON_Duplicate(cJSON_GetObjectItemCaseSensitive(root, "pictures"), 1);
    bool ok = list != NULL;
    cJSON *picture;
    cJSON_ArrayForEach(picture, list)
    {
        text source = {0};
        const char *missing;
        const cJSON *own = cJSON_GetObjectItemCaseSensitive(picture, BB_PICTURE_FOLDER);
        const char *from = folder != NULL ? folder : cJSON_GetStringValue(own);
        bool found = picture_source(from != NULL ? from : ".",
                                    bb_get_text(picture, BB_F_PICTURE_PATH), &source, &missing);
        const char *name = found ? "src" : "missing";
        cJSON_DeleteItemFromObjectCaseSensitive(picture, "src");
        ok = ok && !source.failed &&
             cJSON_AddStringToObject(picture, name, found ? source.data : missing) != NULL;
        free(source.data);
    }
    char *json = ok ? cJSON_PrintUnformatted(list) : NULL;
    cJSON_Delete(list);
    return json;
}

/* The cells of the charts; NULL after bb_fail(). */
static char *charts_json(bb_results *results)
{
    bb_charts charts;
    if (bb_charts_make(results, &charts) != BB_OK)
        return NULL;
    char *json = bb_charts_json(&charts);
    bb_charts_free(&charts);
    return json;
}

/* ---- the page ---- */

typedef struct part {
    const char *mark; /* in the template */
    const char *content;
    bool json;
} part;

/* Copies the template and puts each part in the place of its mark. The parts stand in the order of
 * the template, so that no part's content is searched for marks. */
static bb_status fill_template(text *page, const part *parts, size_t count)
{
    const char *rest = bb_text_report_html;
    for (size_t i = 0; i < count; i++) {
        const char *at = strstr(rest, parts[i].mark);
        if (at == NULL)
            return bb_fail(BB_FAILED, "the report's template lacks %s", parts[i].mark);
        append(page, rest, (size_t)(at - rest));
        if (parts[i].json)
            append_json(page, parts[i].content);
        else
            append_string(page, parts[i].content);
        rest = at + strlen(parts[i].mark);
    }
    append_string(page, rest);
    return page->failed ? bb_fail(BB_FAILED, "report: no memory for the page") : BB_OK;
}

bb_status bb_report_html(bb_results *results, const char *picture_folder, const char *path)
{
    text page = {0};
    bb_status status;
    char *records = bb_results_print(results, false);
    char *pictures = pictures_json(bb_results_json(results), picture_folder);
    char *charts = charts_json(results);
    char *schema = bb_schema_json();
    char *summary = bb_summary_json(results);
    if (schema == NULL || summary == NULL || records == NULL || pictures == NULL ||
        charts == NULL) {
        status = bb_fail(BB_FAILED, "report %s: no memory", path);
        goto out;
    }
    const part parts[] = {
        {"@BB_CSS@", bb_text_report_css, false},
        {"@BB_DATA@", records, true},
        {"@BB_SCHEMA@", schema, true},
        {"@BB_SUMMARY@", summary, true},
        {"@BB_CHARTS@", charts, true},
        {"@BB_PICTURES@", pictures, true},
        {"@BB_CHART_JS@", bb_text_chart_js, false},
        {"@BB_SCRIPT@", bb_text_report_js, false},
    };
    status = fill_template(&page, parts, sizeof parts / sizeof parts[0]);
    if (status == BB_OK)
        status = bb_file_write(path, page.data, page.size, "report");
out:
    free(page.data);
    cJSON_free(schema);
    cJSON_free(summary);
    cJSON_free(charts);
    cJSON_free(pictures);
    cJSON_free(records);
    return status;
}
