/* A page as one HTML file: its blocks as JSON, which the page's script shows. */
#include "framework/base/file.h"
#include "framework/base/json.h"
#include "framework/table/page.h"
#include "framework/table/template.h"

#include <stdlib.h>

/* Embedded at build time. */
extern const char bb_text_page_html[], bb_text_style_css[], bb_text_page_js[], bb_text_chart_js[];

static void add_item(bb_json *json, const bb_item *item)
{
    if (item->text != NULL) {
        bb_json_add_text(json, NULL, item->text);
        return;
    }
    bb_json_object(json, NULL);
    bb_json_add_number(json, "value", item->figure.value);
    bb_json_add_number(json, "low", item->figure.low);
    bb_json_add_number(json, "high", item->figure.high);
    bb_json_add_bool(json, "best", item->mark == '*');
    bb_json_end_object(json);
}

static void add_grid(bb_json *json, const bb_block *block)
{
    bb_json_array(json, "columns");
    for (uint32_t i = 0; i < block->head_count; i++) {
        bb_json_object(json, NULL);
        bb_json_add_text(json, "heading", block->heads[i].heading);
        bb_json_add_text(json, "help", block->heads[i].help);
        bb_json_add_number(json, "decimals", block->heads[i].decimals);
        bb_json_end_object(json);
    }
    bb_json_end_array(json);
    bb_json_array(json, "rows");
    for (uint32_t k = 0; k < block->item_count; k++) {
        if (k % block->head_count == 0)
            bb_json_array(json, NULL);
        add_item(json, &block->items[k]);
        if ((k + 1) % block->head_count == 0)
            bb_json_end_array(json);
    }
    bb_json_end_array(json);
}

static void add_axes(bb_json *json, const bb_axes *axes)
{
    static const char *const drawings[] = {"bars", "lines", "scatter"};
    bb_json_add_text(json, "drawing", drawings[axes->drawing]);
    bb_json_add_text(json, "x", axes->x);
    bb_json_add_text(json, "y", axes->y);
    bb_json_add_bool(json, "xLog", axes->x_log);
    bb_json_add_bool(json, "yLog", axes->y_log);
}

static void add_picture(bb_json *json, const bb_block *block, const char *folder)
{
    char *source;
    json->lost = json->lost || !bb_page_source(folder, block->path, &source);
    if (json->lost)
        return;
    bb_json_add_text(json, "path", block->path);
    bb_json_add_text(json, "source", source);
    free(source);
}

static void add_block(bb_json *json, const bb_block *block, const char *folder)
{
    static const char *const kinds[] = {"heading", "say",  "note", "verdict",
                                        "picture", "grid", "plot"};
    bb_json_object(json, NULL);
    bb_json_add_text(json, "kind", kinds[block->kind]);
    bb_json_add_text(json, "text", block->text);
    if (block->kind == BB_BLOCK_VERDICT)
        bb_json_add_bool(json, "good", block->good);
    if (block->kind == BB_BLOCK_PICTURE)
        add_picture(json, block, folder);
    if (block->kind == BB_BLOCK_PLOT)
        add_axes(json, &block->axes);
    if (block->kind >= BB_BLOCK_GRID)
        add_grid(json, block);
    bb_json_end_object(json);
}

static char *json_of(const bb_page *page, const char *folder)
{
    bb_json json = {0};
    bb_json_object(&json, NULL);
    bb_json_add_text(&json, "title", bb_page_title(page));
    bb_json_array(&json, "blocks");
    for (uint32_t i = 0; i < bb_page_block_count(page); i++)
        add_block(&json, bb_page_block(page, i), folder);
    bb_json_end_array(&json);
    bb_json_end_object(&json);
    return bb_json_take(&json);
}

bb_status bb_page_html(const bb_page *page, const bb_table *table, const char *folder,
                       const char *path)
{
    BB_TRY(bb_page_status(page));
    bb_page_text text = {0};
    char *blocks = json_of(page, folder);
    char *results = table != NULL ? bb_table_json(table) : NULL;
    bb_status status = BB_OK;
    const bb_page_part parts[] = {
        {"@BB_CSS@", bb_text_style_css, false},
        {"@BB_PAGE@", blocks, true},
        {"@BB_TABLE@", results != NULL ? results : "null", true},
        {"@BB_CHART_JS@", bb_text_chart_js, false},
        {"@BB_SCRIPT@", bb_text_page_js, false},
    };
    if (blocks == NULL || (table != NULL && results == NULL))
        status = bb_fail(BB_REFUSED, "report %s: no memory", path);
    if (status == BB_OK)
        status = bb_page_fill(&text, bb_text_page_html, parts, sizeof parts / sizeof parts[0]);
    if (status == BB_OK)
        status = bb_file_write(path, text.data, text.size, "report");
    free(text.data);
    free(results);
    free(blocks);
    return status;
}
