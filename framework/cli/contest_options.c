#include "framework/cli/contest_options.h"

#include "framework/base/file.h"
#include "framework/base/interrupt.h"
#include "framework/builder/pipeline.h"
#include "framework/cli/inputs.h"
#include "framework/locate/tet_search.h"
#include "framework/record/put.h"
#include "framework/report/report.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

extern const char bb_build_revision[];

bb_status bb_choose_searches(const bb_cli *cli, bb_names *searches)
{
    uint32_t count;
    char *const *given = bb_cli_values(cli, "search", &count);
    for (uint32_t i = 0; i < count; i++) {
        bb_spec spec;
        BB_TRY(bb_tet_search_parse(given[i], &spec));
        for (uint32_t k = 0; k < i; k++)
            if (strcmp(given[k], given[i]) == 0)
                return bb_fail(BB_INVALID, "--search has %s twice", given[i]);
        BB_TRY(bb_names_add(searches, given[i]));
    }
    return count > 0 ? BB_OK : bb_names_add(searches, "skip,octree");
}

bb_status bb_choose_tree_builders(const bb_cli *cli, const char *usual, bb_names *builders)
{
    uint32_t count;
    bb_cli_values(cli, "builder", &count);
    return count > 0 ? bb_choose_builders(cli, true, builders) : bb_names_add(builders, usual);
}

bool bb_contest_document(const char *schema, const bb_device *device, cJSON **document,
                         cJSON **results)
{
    *document = cJSON_CreateObject();
    *results = cJSON_CreateArray();
    bool put = *document != NULL && bb_put_text(*document, "schema", schema) &&
               bb_put_text(*document, "revision", bb_build_revision) &&
               bb_put_text(*document, "device", device->name);
    put = bb_put(*document, "results", *results) && put;
    if (put)
        return true;
    cJSON_Delete(*document);
    *document = NULL;
    return false;
}

bb_status bb_contest_add(cJSON *results, cJSON *result, cJSON *files)
{
    if (result == NULL)
        cJSON_Delete(files);
    else if (bb_put(result, "picture_files", files) && cJSON_AddItemToArray(results, result))
        return BB_OK;
    cJSON_Delete(result);
    return bb_fail(BB_REFUSED, "no memory for the results");
}

static bb_status write_files(const cJSON *document, const char *text, const char *folder,
                             const char *name, bb_page_writer *page)
{
    char file[64], path[PATH_MAX];
    snprintf(file, sizeof file, "%s.json", name);
    BB_TRY(bb_join_path(path, folder, file));
    BB_TRY(bb_file_write(path, text, strlen(text), "results"));
    snprintf(file, sizeof file, "%s.html", name);
    BB_TRY(bb_join_path(path, folder, file));
    return page(document, folder, path);
}

bb_status bb_contest_write(const bb_cli *cli, const cJSON *document, const char *name,
                           bb_page_writer *page)
{
    const char *out = bb_cli_value(cli, "out");
    char *text = cJSON_Print(document);
    if (text == NULL)
        return bb_fail(BB_REFUSED, "no memory for the results");
    if (bb_cli_value(cli, "json") != NULL)
        printf("%s\n", text);
    bb_status status = out != NULL ? write_files(document, text, out, name, page) : BB_OK;
    free(text);
    return status;
}

bb_status bb_contest_begin(const bb_cli *cli, char *const *scenes, uint32_t count, bool *made)
{
    const char *out = bb_cli_value(cli, "out");
    *made = out != NULL && access(out, F_OK) != 0;
    BB_TRY(bb_load_plugins(cli));
    for (uint32_t i = 0; i < count; i++)
        BB_TRY(bb_check_scene(scenes[i]));
    return out != NULL ? bb_make_folder(out) : BB_OK;
}

bb_status bb_contest_end(const bb_cli *cli, bb_status status, bool made, bool wrong,
                         int *exit_status)
{
    if (status != BB_OK && made)
        (void)rmdir(bb_cli_value(cli, "out")); /* which stays if anything was written */
    if (status == BB_OK && wrong)
        *exit_status = BB_EXIT_WRONG;
    if (!bb_interrupted())
        return status;
    fprintf(stderr, "bvhbench: interrupted: %s\n",
            status == BB_OK ? "the results are those of what was measured" : bb_message());
    *exit_status = BB_EXIT_INTERRUPTED;
    return BB_OK;
}
