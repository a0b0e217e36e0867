/* bvhbench report: result files into one HTML page, and its charts as pictures. */
#include "framework/base/file.h"
#include "framework/cli/charts_option.h"
#include "framework/cli/cli.h"
#include "framework/cli/inputs.h"
#include "framework/cli/out_option.h"
#include "framework/history/history.h"
#include "framework/history/trend.h"
#include "framework/record/record.h"
#include "framework/report/report.h"
#include "framework/report/report_history.h"

#include <cjson/cJSON.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static const bb_cli_option options[] = {
    {"out", "FILE.html", "where to write the report; default: report.html beside the first input",
     false},
    {"history", "DB", "instead of files: the page of a database of runs, each cell over revisions",
     false},
    {"table", NULL, "print the full tables; write no report unless --out is given", false},
    {"markdown", NULL, "the same, with the summary as Markdown", false},
    {"google-benchmark", NULL, "the same, with all rounds in the JSON of Google Benchmark", false},
    {"csv", NULL, "the same, with all traces as comma-separated values", false},
    BB_CHARTS_OPTION,
    {NULL, NULL, NULL, false},
};

/* Pictures of several inputs lie in several folders: each is told its own. */
static bb_status locate_pictures(bb_results *results, const char *folder)
{
    cJSON *picture;
    cJSON_ArrayForEach(picture,
                       cJSON_GetObjectItemCaseSensitive(bb_results_json(results), "pictures"))
    {
        cJSON_DeleteItemFromObjectCaseSensitive(picture, BB_PICTURE_FOLDER);
        if (cJSON_AddStringToObject(picture, BB_PICTURE_FOLDER, folder) == NULL)
            return bb_fail(BB_FAILED, "report: no memory");
    }
    return BB_OK;
}

/* Reads `argument`; *folder is where it lies, from malloc. */
static bb_status read_input(const char *argument, bb_results **results, char **folder)
{
    char path[PATH_MAX];
    BB_TRY(bb_input_path(argument, path));
    BB_TRY(bb_results_read(path, results));
    *folder = bb_file_folder(path);
    if (*folder == NULL)
        return bb_fail(BB_FAILED, "report: no memory");
    return locate_pictures(*results, *folder);
}

static bb_status write_charts(bb_results *results, const char *page, bool said)
{
    char folder[PATH_MAX];
    uint32_t pictures;
    BB_TRY(bb_report_charts_folder(page, folder, sizeof folder));
    BB_TRY(bb_report_charts(results, folder, &pictures));
    if (said)
        printf(" charts  %s: %u, each as SVG and PNG\n", folder, pictures);
    return BB_OK;
}

/* The page, and its charts; what was written is said, unless a table is all that is wanted. */
static bb_status write_page(const bb_cli *cli, bb_results *results, const char *page, bool said,
                            bool charts)
{
    BB_TRY(bb_report_html(results, NULL, page));
    if (said)
        printf("\n report  %s\n", page);
    if (!charts && said)
        bb_charts_note(cli);
    return charts ? write_charts(results, page, said) : BB_OK;
}

/* What goes to standard output: the summary, if nothing else is asked for. */
static bb_status print(const bb_cli *cli, bb_results *results, bool *only)
{
    bb_status status = BB_OK;
    *only = true;
    if (bb_cli_value(cli, "table") != NULL)
        status = bb_report_table(results, stdout);
    else if (bb_cli_value(cli, "markdown") != NULL)
        status = bb_report_markdown(results, stdout);
    else if (bb_cli_value(cli, "csv") != NULL)
        status = bb_report_csv(results, stdout);
    else if (bb_cli_value(cli, "google-benchmark") != NULL)
        status = bb_report_benchmark(results, stdout);
    else {
        *only = false;
        status = bb_report_verdict(results, stdout);
    }
    return status;
}

/* "bench.html" for "bench.db": beside it. */
static bb_status page_of_history(const char *database, char page[PATH_MAX])
{
    const char *slash = strrchr(database, '/'), *dot = strrchr(database, '.');
    bool ends = dot != NULL && (slash == NULL || dot > slash + 1) && dot > database;
    int length = ends ? (int)(dot - database) : (int)strlen(database);
    if (snprintf(page, PATH_MAX, "%.*s.html", length, database) >= PATH_MAX)
        return bb_fail(BB_INVALID, "%.60s...: the path is too long", database);
    return BB_OK;
}

/* By whatever name: a link leads to the database too. */
static bb_status check_page(const char *page, const char *database)
{
    struct stat a, b;
    bool same = strcmp(page, database) == 0 || (stat(page, &a) == 0 && stat(database, &b) == 0 &&
                                                a.st_dev == b.st_dev && a.st_ino == b.st_ino);
    return same ? bb_fail(BB_INVALID,
                          "report: the page would overwrite the database %.300s: name another "
                          "file with --out",
                          database)
                : BB_OK;
}

static bb_status report_history(const bb_cli *cli, const char *database)
{
    static const char *const others[] = {"table", "markdown", "csv", "google-benchmark", "charts"};
    char beside[PATH_MAX];
    bb_history *history = NULL;
    bb_trend *trends = NULL;
    uint32_t count = 0;
    const char *out = bb_cli_value(cli, "out");
    if (cli->positional_count > 0)
        return bb_fail(BB_INVALID, "report: --history is a report of its own: leave %s out",
                       cli->positional[0]);
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++)
        if (bb_cli_value(cli, others[i]) != NULL)
            return bb_fail(BB_INVALID, "report: --history and --%s do not go together", others[i]);
    BB_TRY(page_of_history(database, beside));
    BB_TRY(check_page(out != NULL ? out : beside, database));
    if (out != NULL)
        BB_TRY(bb_out_file(out, "report"));
    BB_TRY(bb_history_open(database, false, &history));
    bb_status status = bb_history_trends(history, &trends, &count);
    if (status == BB_OK)
        status = bb_report_history(trends, count, out != NULL ? out : beside);
    if (status == BB_OK)
        status = bb_report_history_text(trends, count, stdout);
    if (status == BB_OK)
        printf("\n report  %s\n", out != NULL ? out : beside);
    bb_trends_free(trends, count);
    bb_history_close(history);
    return status;
}

static bb_status run(const bb_cli *cli, int *exit_status)
{
    if (bb_cli_value(cli, "history") != NULL)
        return report_history(cli, bb_cli_value(cli, "history"));
    if (cli->positional_count == 0)
        return bb_fail(BB_INVALID, "report: give a result file, or the folder of a run");
    bb_results *all = NULL, *more = NULL;
    char *folder = NULL, *other = NULL;
    char beside[PATH_MAX];
    const char *out = bb_cli_value(cli, "out");
    bool charts;
    BB_TRY(bb_charts_wanted(cli, &charts));
    BB_TRY(bb_inputs_once(cli, 0));
    if (out != NULL)
        BB_TRY(bb_out_file(out, "report"));
    bb_status status = read_input(cli->positional[0], &all, &folder);
    for (uint32_t i = 1; status == BB_OK && i < cli->positional_count; i++) {
        status = read_input(cli->positional[i], &more, &other);
        if (status == BB_OK)
            status = bb_results_merge(all, more);
        bb_results_destroy(more);
        free(other);
        more = NULL;
        other = NULL;
    }
    bool only = false;
    if (status == BB_OK)
        status = print(cli, all, &only);
    if (status == BB_OK && out == NULL && !only) {
        status = bb_join_path(beside, folder, "report.html");
        out = beside;
    }
    if (status == BB_OK && out != NULL)
        status = write_page(cli, all, out, !only, charts);
    bb_results_destroy(all);
    free(folder);
    *exit_status = BB_EXIT_OK;
    return status;
}

extern const bb_command bb_command_report;
const bb_command bb_command_report = {
    .name = "report",
    .summary = "make summary, tables and HTML report of one or more result files",
    .arguments = "FILE|DIR...",
    .details = "A folder stands for its results.json. Several inputs become one report; scenes of "
               "the same\n"
               "name must have the same geometry.",
    .options = options,
    .run = run,
};
