/* The HTML report: a template into which style, chart library, script, records and pictures are
 * put, so that one file is all there is to keep or send. The cells of the charts are computed here
 * (framework/report/chart.h); the page's script draws what is chosen of them.
 */
#include "framework/report/report.h"
#include "framework/base/file.h"
#include "framework/base/json.h"
#include "framework/compare/prediction.h"
#include "framework/compare/summary.h"
#include "framework/record/schema.h"
#include "framework/report/chart.h"
#include "framework/report/report_compare.h"
#include "framework/report/report_papers.h"
#include "framework/table/template.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* Embedded at build time. */
extern const char bb_text_report_html[], bb_text_style_css[], bb_text_report_js[],
    bb_text_chart_js[];

enum { PICTURE_BYTES_MAX = 16 << 20 };

/* ---- pictures ---- */

/* Where FOLDER/PATH really is, from malloc, and whether that is below the folder; NULL if it is not
 * there. */
static char *locate_picture(const char *folder, const char *path, bool *below)
{
    bb_page_text joined = {0};
    bb_page_append_string(&joined, folder);
    bb_page_append_string(&joined, "/");
    bb_page_append_string(&joined, path);
    bb_page_append(&joined, "", 1);
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
static bool picture_source(const char *folder, const char *path, bb_page_text *source,
                           const char **missing)
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
        bb_page_append_string(source, "data:image/png;base64,");
        bb_page_append_base64(source, (const unsigned char *)data, size);
        bb_page_append(source, "", 1);
    }
    free(data);
    free(real);
    return *missing == NULL && !source->failed;
}

/* The pictures as data URIs, or why there are none; NULL if there is no memory. */
static char *pictures_json(const bb_results *results, const char *folder)
{
    static const bb_field_id fields[] = {BB_F_PICTURE_SCENE, BB_F_PICTURE_VIEW,
                                         BB_F_PICTURE_CAPTION, BB_F_PICTURE_PATH};
    bb_json json = {0};
    bb_json_array(&json, NULL);
    bb_each(picture, bb_results_section(results, BB_PICTURES))
    {
        bb_page_text source = {0};
        const char *missing = NULL;
        const char *own = bb_get_text(picture, BB_F_PICTURE_FOLDER);
        const char *from = folder != NULL ? folder : own[0] != '\0' ? own : ".";
        bool found =
            picture_source(from, bb_get_text(picture, BB_F_PICTURE_PATH), &source, &missing);
        bb_json_object(&json, NULL);
        for (int i = 0; i < 4; i++)
            bb_json_add_text(&json, bb_fields[fields[i]].name, bb_get_text(picture, fields[i]));
        bb_json_add_text(&json, found ? "src" : "missing", found ? source.data : missing);
        bb_json_end_object(&json);
        json.lost = json.lost || source.failed;
        free(source.data);
    }
    bb_json_end_array(&json);
    return bb_json_take(&json);
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

/* `compared`: NULL, or what is said of two runs. */
static bb_status write_html(bb_results *results, const bb_comparison_result *compared,
                            const char *picture_folder, const char *path)
{
    bb_page_text page = {0};
    BB_TRY(bb_predictions_record(results));
    bb_status status;
    char *records = bb_results_json(results);
    char *pictures = pictures_json(results, picture_folder);
    char *charts = charts_json(results);
    char *schema = bb_schema_json();
    char *summary = bb_summary_json(results);
    char *papers = bb_papers_json(results);
    char *against = compared != NULL ? bb_against_json(compared) : strdup("null");
    if (schema == NULL || against == NULL || summary == NULL || records == NULL ||
        pictures == NULL || charts == NULL || papers == NULL) {
        status = bb_fail(BB_FAILED, "report %s: no memory", path);
        goto out;
    }
    const bb_page_part parts[] = {
        {"@BB_CSS@", bb_text_style_css, false},
        {"@BB_DATA@", records, true},
        {"@BB_SCHEMA@", schema, true},
        {"@BB_SUMMARY@", summary, true},
        {"@BB_CHARTS@", charts, true},
        {"@BB_AGAINST@", against, true},
        {"@BB_PAPERS@", papers, true},
        {"@BB_PICTURES@", pictures, true},
        {"@BB_CHART_JS@", bb_text_chart_js, false},
        {"@BB_SCRIPT@", bb_text_report_js, false},
    };
    status = bb_page_fill(&page, bb_text_report_html, parts, sizeof parts / sizeof parts[0]);
    if (status == BB_OK)
        status = bb_file_write(path, page.data, page.size, "report");
out:
    free(page.data);
    free(against);
    free(papers);
    free(schema);
    free(summary);
    free(charts);
    free(pictures);
    free(records);
    return status;
}

bb_status bb_report_html(bb_results *results, const char *picture_folder, const char *path)
{
    return write_html(results, NULL, picture_folder, path);
}

bb_status bb_report_html_against(bb_results *results, const bb_comparison_result *compared,
                                 const char *path)
{
    return write_html(results, compared, NULL, path);
}
