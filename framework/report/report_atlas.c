/* The page of the atlas: a template into which style, chart library, script, figures and pictures
 * are put. */
#include "framework/report/report.h"
#include "framework/show/template.h"

#include "framework/base/file.h"
#include "framework/base/json.h"

#include <cjson/cJSON.h>
#include <stdlib.h>

/* Embedded at build time. */
extern const char bb_text_atlas_html[], bb_text_style_css[], bb_text_atlas_js[], bb_text_chart_js[];

/* A picture of the axis as a data URI, the member "src"; none where there is no picture. False if
 * there is no memory. */
static bool add_picture(cJSON *axis, const char *folder)
{
    char *source;
    if (!bb_page_source(folder, cJSON_GetStringValue(cJSON_GetObjectItem(axis, "picture")),
                        &source))
        return false;
    bool ok = source == NULL || cJSON_AddStringToObject(axis, "src", source) != NULL;
    free(source);
    return ok;
}

static char *with_pictures(const cJSON *atlas, const char *folder)
{
    cJSON *copy = cJSON_Duplicate(atlas, 1), *axis;
    bool ok = copy != NULL;
    cJSON_ArrayForEach(axis, cJSON_GetObjectItem(copy, "axes")) ok =
        ok && add_picture(axis, folder);
    char *text = ok ? bb_json_print(copy, false) : NULL;
    cJSON_Delete(copy);
    return text;
}

bb_status bb_report_atlas(const cJSON *atlas, const char *folder, const char *path)
{
    bb_page_text page = {0};
    char *figures = with_pictures(atlas, folder);
    if (figures == NULL)
        return bb_fail(BB_FAILED, "report %s: no memory", path);
    const bb_page_part parts[] = {
        {"@BB_CSS@", bb_text_style_css, false},
        {"@BB_DATA@", figures, true},
        {"@BB_CHART_JS@", bb_text_chart_js, false},
        {"@BB_SCRIPT@", bb_text_atlas_js, false},
    };
    bb_status status =
        bb_page_fill(&page, bb_text_atlas_html, parts, sizeof parts / sizeof parts[0]);
    if (status == BB_OK)
        status = bb_file_write(path, page.data, page.size, "report");
    free(page.data);
    cJSON_free(figures);
    return status;
}
