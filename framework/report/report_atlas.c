/* Makes the page of the atlas from a template, style, chart library, script, figures and pictures.
 */
#include "framework/report/report.h"
#include "framework/table/template.h"

#include "framework/base/file.h"
#include "framework/base/json.h"

#include <stdlib.h>

/* Embedded at build time. */
extern const char bb_text_atlas_html[], bb_text_style_css[], bb_text_atlas_js[], bb_text_chart_js[];

/* Returns the pictures of the table as data URIs by name: {"point.png":"data:..."}. NULL after
 * bb_fail(). */
static char *pictures_json(const bb_table *atlas, const char *folder)
{
    bb_json json = {0};
    bool ok = true;
    bb_json_object(&json, NULL);
    for (uint32_t row = 0; row < bb_table_row_count(atlas) && ok; row++) {
        const char *name = bb_table_get_text(atlas, row, "picture");
        char *source = NULL;
        ok = name[0] == '\0' || bb_page_source(folder, name, &source);
        if (source != NULL)
            bb_json_add_text(&json, name, source);
        free(source);
    }
    bb_json_end_object(&json);
    char *text = bb_json_take(&json);
    if (ok && text != NULL)
        return text;
    free(text);
    return NULL;
}

bb_status bb_report_atlas(const bb_table *atlas, const char *folder, const char *path)
{
    bb_page_text page = {0};
    char *figures = bb_table_json(atlas), *pictures = pictures_json(atlas, folder);
    if (figures == NULL || pictures == NULL) {
        free(figures);
        free(pictures);
        return bb_fail(BB_FAILED, "report %s: no memory", path);
    }
    const bb_page_part parts[] = {
        {"@BB_CSS@", bb_text_style_css, false},   {"@BB_DATA@", figures, true},
        {"@BB_PICTURES@", pictures, true},        {"@BB_CHART_JS@", bb_text_chart_js, false},
        {"@BB_SCRIPT@", bb_text_atlas_js, false},
    };
    bb_status status =
        bb_page_fill(&page, bb_text_atlas_html, parts, sizeof parts / sizeof parts[0]);
    if (status == BB_OK)
        status = bb_file_write(path, page.data, page.size, "report");
    free(page.data);
    free(figures);
    free(pictures);
    return status;
}
