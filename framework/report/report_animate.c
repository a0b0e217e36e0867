/* The page of moving scenes: a template into which style, chart library, script, figures and
 * pictures are put. */
#include "framework/report/report.h"
#include "framework/show/template.h"

#include "framework/base/file.h"
#include "framework/base/json.h"

#include <cjson/cJSON.h>
#include <stdlib.h>

/* Embedded at build time. */
extern const char bb_text_animate_html[], bb_text_style_css[], bb_text_animate_js[],
    bb_text_chart_js[];

enum { PICTURES_MAX = 32 }; /* of a result; the others are named */

/* Those of one result, as data URIs, in the same order; "" where there is none, or it is too large.
 * False if there is no memory. */
static bool add_pictures(cJSON *result, const char *folder)
{
    const cJSON *name;
    cJSON *sources = cJSON_AddArrayToObject(result, "sources");
    bool ok = sources != NULL;
    int count = 0;
    cJSON_ArrayForEach(name, cJSON_GetObjectItem(result, "picture_files"))
    {
        char *source;
        if (!ok || count++ == PICTURES_MAX)
            break;
        ok = bb_page_source(folder, cJSON_GetStringValue(name), &source);
        if (!ok)
            break;
        ok = cJSON_AddItemToArray(sources, cJSON_CreateString(source != NULL ? source : ""));
        free(source);
    }
    return ok;
}

static char *with_pictures(const cJSON *document, const char *folder)
{
    cJSON *copy = cJSON_Duplicate(document, 1), *result;
    bool ok = copy != NULL;
    cJSON_ArrayForEach(result, cJSON_GetObjectItem(copy, "results")) ok =
        ok && add_pictures(result, folder);
    char *text = ok ? bb_json_print(copy, false) : NULL;
    cJSON_Delete(copy);
    return text;
}

bb_status bb_report_animate(const cJSON *document, const char *folder, const char *path)
{
    bb_page_text page = {0};
    char *figures = with_pictures(document, folder);
    if (figures == NULL)
        return bb_fail(BB_FAILED, "report %s: no memory", path);
    const bb_page_part parts[] = {
        {"@BB_CSS@", bb_text_style_css, false},
        {"@BB_DATA@", figures, true},
        {"@BB_CHART_JS@", bb_text_chart_js, false},
        {"@BB_SCRIPT@", bb_text_animate_js, false},
    };
    bb_status status =
        bb_page_fill(&page, bb_text_animate_html, parts, sizeof parts / sizeof parts[0]);
    if (status == BB_OK)
        status = bb_file_write(path, page.data, page.size, "report");
    free(page.data);
    cJSON_free(figures);
    return status;
}
