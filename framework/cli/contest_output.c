#include "framework/cli/contest_output.h"

#include "framework/cli/output.h"

#include "framework/base/file.h"
#include "framework/base/interrupt.h"
#include "framework/cli/inputs.h"
#include "framework/device/run_row.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

void bb_contest_take_names(const bb_names *builders, const bb_names *searches,
                           bb_contest_request *request)
{
    request->builders = (const char *const *)builders->items;
    request->builder_count = (uint32_t)builders->count;
    request->searches = (const char *const *)searches->items;
    request->search_count = (uint32_t)searches->count;
}

bb_status bb_contest_output_begin(bb_contest_output *output, const bb_device *device, uint64_t seed)
{
    bb_bystanders_start(&output->watch);
    BB_TRY(bb_output_append(output->choice->history, NULL));
    BB_TRY(bb_table_create(output->outline->command, &output->table));
    bb_run_row(output->table, device, seed, output->command_line);
    return bb_table_status(output->table);
}

bb_status bb_contest_output_request(bb_contest_output *output, const bb_names *builders,
                                    const bb_names *searches, bb_contest_request *request)
{
    bb_contest_take_names(builders, searches, request);
    request->audit = &output->audit;
    request->watch = &output->watch;
    request->simts = output->choice->simts;
    request->simt_count = output->choice->simt_count;
    return bb_contest_output_begin(output, request->device, request->seed);
}

void bb_contest_output_name(const bb_contest_output *output, char *name, size_t capacity)
{
    const size_t length = strnlen(name, capacity - 16);
    const bb_cell cell = {{[BB_SCENE] = name}};
    for (unsigned n = 2; bb_table_find(output->table, cell) != BB_NO_ROW; n++)
        snprintf(name + length, capacity - length, " (%u)", n);
}

bb_status bb_contest_output_scene(bb_contest_output *output)
{
    bb_page *page;
    const bb_table *table = output->table;
    const bb_page_outline *outline = output->printed != NULL ? output->printed : output->outline;
    BB_TRY(bb_table_status(table));
    if (output->choice->json)
        return BB_OK;
    BB_TRY(bb_page_create(outline->title, &page));
    if (!output->begun)
        bb_page_say(page, "%s", bb_table_get_text(table, 0, bb_run_columns[BB_RUN_DEVICE].name));
    output->begun = true;
    bb_outline_scene(outline, table, bb_table_name(table, bb_table_row_count(table) - 1, BB_SCENE),
                     page);
    bb_status status = bb_page_status(page);
    if (status == BB_OK)
        bb_page_print(page, stdout);
    bb_page_free(page);
    return status;
}

static bb_status write_files(const bb_contest_output *output)
{
    char name[80], path[PATH_MAX];
    bb_page *page;
    snprintf(name, sizeof name, "%s.json", output->outline->command);
    BB_TRY(bb_join_path(path, output->choice->out, name));
    BB_TRY(bb_table_write(output->table, path));
    snprintf(name, sizeof name, "%s.html", output->outline->command);
    BB_TRY(bb_join_path(path, output->choice->out, name));
    BB_TRY(bb_outline_page(output->outline, output->table, &page));
    bb_status status = bb_page_html(page, output->table, output->choice->out, path);
    bb_page_free(page);
    return status;
}

static bb_status print_json(const bb_table *table)
{
    char *text = bb_table_json(table);
    if (text == NULL)
        return bb_fail(BB_REFUSED, "no memory for the results");
    printf("%s\n", text);
    free(text);
    return BB_OK;
}

static bool any_measured(const bb_contest_output *output)
{
    return output->table != NULL && bb_table_row_count(output->table) > 1;
}

/* Writes all output, unless nothing was measured. After a failure the run counts as interrupted. */
static bb_status write_all(bb_contest_output *output, bb_status status)
{
    if (!any_measured(output))
        return BB_OK;
    if (status != BB_OK || bb_interrupted())
        bb_table_set_text(output->table, 0, &bb_run_columns[BB_RUN_INTERRUPTED], "yes");
    bb_audit_fill(&output->audit, &output->watch, output->table);
    BB_TRY(bb_table_status(output->table));
    if (output->choice->json)
        BB_TRY(print_json(output->table));
    return output->choice->out != NULL ? write_files(output) : BB_OK;
}

bb_status bb_contest_output_end(bb_contest_output *output, bb_status status, bool *wrong)
{
    char why[1024], kept[320] = "";
    snprintf(why, sizeof why, "%s", status != BB_OK ? bb_message() : "");
    bb_status written = write_all(output, status);
    if (status == BB_OK && written == BB_OK)
        written = bb_output_append(output->choice->history, output->table);
    if (status != BB_OK && written == BB_OK && any_measured(output) && output->choice->out != NULL)
        snprintf(kept, sizeof kept, " (what was measured is in %.200s/%s.json)",
                 output->choice->out, output->outline->command);
    if (wrong != NULL) {
        *wrong = bb_audit_blame(&output->audit);
        *wrong = *wrong ||
                 (output->table != NULL && bb_outline_is_wrong(output->outline, output->table));
    }
    bb_table_free(output->table);
    output->table = NULL;
    return status != BB_OK ? bb_fail(status, "%s%s", why, kept) : written;
}
