/* bvhbench report: result files into one HTML page, and its charts as pictures. */
#include "framework/base/file.h"
#include "framework/base/number.h"
#include "framework/cli/against.h"
#include "framework/cli/choice.h"
#include "framework/cli/inputs.h"
#include "framework/cli/out_option.h"
#include "framework/cli/report_table.h"
#include "framework/compare/history.h"
#include "framework/compare/prediction.h"
#include "framework/compare/summary.h"
#include "framework/compare/trend.h"
#include "framework/record/record.h"
#include "framework/report/report.h"
#include "framework/report/report_history.h"
#include "framework/table/table.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

typedef struct wanted {
    const char *out, *history, *figure, *width;
    bool against, table, markdown, google_benchmark, csv, samples, json;
    uint32_t charts;
} wanted;

static const bb_cli_option options[] = {
    {"out", "FILE", "where to write the report; default: report.html beside the first input",
     BB_INTO(wanted, out)},
    {"figure", "NAME",
     "draw one chart for print instead, such as coffee_primary_time, with names for keys; needs "
     "--out FILE.pdf, FILE.svg or FILE.png",
     BB_INTO(wanted, figure),
     .apart = "table|markdown|google-benchmark|csv|samples|json|charts|history"},
    {"width", "W", "width of the figure", BB_INTO(wanted, width), .fallback = "84mm",
     .with = "figure"},
    {"history", "DB", "instead of files, report a database of runs: each cell over the revisions",
     BB_INTO(wanted, history), .apart = "table|markdown|google-benchmark|csv|samples|json|charts"},
    {"against", NULL,
     "make one page of two runs, OLD and NEW: both figures of each cell, and their ratio",
     BB_INTO(wanted, against),
     .apart = "history|figure|table|markdown|google-benchmark|csv|samples|json|charts"},
    {"table", NULL, "print the full tables; write no report unless --out is given",
     BB_INTO(wanted, table)},
    {"markdown", NULL, "the same, with the summary as Markdown", BB_INTO(wanted, markdown)},
    {"google-benchmark", NULL, "the same, with all rounds in the JSON of Google Benchmark",
     BB_INTO(wanted, google_benchmark)},
    {"csv", NULL, "the same, with all traces as comma-separated values", BB_INTO(wanted, csv)},
    {"samples", NULL, "the same, with one line for each round of each time: tidy, for pandas or R",
     BB_INTO(wanted, samples)},
    {"json", NULL,
     "the same, with the summary of all, of each scene and of each kind of rays as JSON",
     BB_INTO(wanted, json)},
    BB_CHARTS_OPTION(wanted, charts),
    {.name = NULL},
};

/* Reads `argument`; *folder is where it lies, from malloc. */
static bb_status read_input(const char *argument, bb_results **results, char **folder)
{
    char path[PATH_MAX];
    BB_TRY(bb_input_path(argument, path));
    BB_TRY(bb_results_read(path, results));
    *folder = bb_file_folder(path);
    if (*folder == NULL)
        return bb_fail(BB_FAILED, "report: no memory");
    return bb_results_locate_pictures(*results, *folder); /* each input its own */
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
static bb_status write_page(bb_results *results, const char *page, bool said, uint32_t charts)
{
    BB_TRY(bb_report_html(results, NULL, page));
    if (said) {
        printf(" report  %s\n", page);
        bb_charts_note(charts);
    }
    return charts == BB_CHARTS_YES ? write_charts(results, page, said) : BB_OK;
}

static bb_status print_json(const bb_results *results)
{
    char *text = bb_summary_json(results);
    if (text == NULL)
        return bb_fail(BB_REFUSED, "report: no memory for the summary");
    printf("%s\n", text);
    free(text);
    return BB_OK;
}

/* What goes to standard output: the summary, if nothing else is asked for. */
static bb_status print(const wanted *w, bb_results *results)
{
    return w->table              ? bb_report_table(results, stdout)
           : w->markdown         ? bb_report_markdown(results, stdout)
           : w->csv              ? bb_report_csv(results, stdout)
           : w->samples          ? bb_report_samples(results, stdout)
           : w->json             ? print_json(results)
           : w->google_benchmark ? bb_report_benchmark(results, stdout)
                                 : bb_report_verdict(results, stdout);
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

static bb_status report_history(const bb_cli *cli, const char *database, const char *out)
{
    char beside[PATH_MAX];
    bb_history *history = NULL;
    bb_trend *trends = NULL;
    uint32_t count = 0;
    if (cli->positional_count > 0)
        return bb_fail(BB_INVALID, "report: --history is a report of its own: leave %s out",
                       cli->positional[0]);
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
        printf(" report  %s\n", out != NULL ? out : beside);
    bb_trends_free(trends, count);
    bb_history_close(history);
    return status;
}

/* All inputs as one; *folder is where the first lies, from malloc. */
static bb_status read_inputs(const bb_cli *cli, bb_results **all, char **folder)
{
    BB_TRY(read_input(cli->positional[0], all, folder));
    for (uint32_t i = 1; i < cli->positional_count; i++) {
        bb_results *more = NULL;
        char *other = NULL;
        bb_status status = read_input(cli->positional[i], &more, &other);
        if (status == BB_OK)
            status = bb_results_merge(*all, more);
        bb_results_destroy(more);
        free(other);
        BB_TRY(status);
    }
    return BB_OK;
}

static bb_status report_table(const bb_cli *cli, const wanted *w, const char *path)
{
    const char *unfit = w->google_benchmark ? "google-benchmark" : w->json ? "json" : NULL;
    if (cli->positional_count > 1 || unfit != NULL)
        return bb_fail(BB_INVALID,
                       "report: %s is a table of results: give it alone%s%s, or merge several "
                       "(bvhbench merge)",
                       path, unfit != NULL ? ", without --" : "", unfit != NULL ? unfit : "");
    if (w->out != NULL)
        BB_TRY(bb_out_file(w->out, "report"));
    return bb_report_table_file(path,
                                w->csv        ? BB_TABLE_CSV
                                : w->samples  ? BB_TABLE_SAMPLES
                                : w->markdown ? BB_TABLE_MARKDOWN
                                : w->table    ? BB_TABLE_TEXT
                                              : BB_TABLE_PAGE,
                                w->out);
}

/* Checks what can be said without the results. */
static bb_status check_figure(const wanted *w, double *width_mm)
{
    enum { LEAST = 30, MOST = 500 };
    char number[32] = "";
    const size_t length = strcspn(w->width, "m");
    const char *dot = w->out != NULL ? strrchr(w->out, '.') : NULL;
    if (dot == NULL ||
        (strcmp(dot, ".pdf") != 0 && strcmp(dot, ".svg") != 0 && strcmp(dot, ".png") != 0))
        return bb_fail(BB_INVALID, "report: a figure needs --out FILE.pdf, FILE.svg or FILE.png");
    if (length < sizeof number)
        memcpy(number, w->width, length);
    if (strcmp(w->width + length, "mm") != 0 || !bb_read_real(number, width_mm) ||
        *width_mm < LEAST || *width_mm > MOST)
        return bb_fail(BB_INVALID, "--width is '%.40s', must be from %dmm to %dmm, such as 84mm",
                       w->width, LEAST, MOST);
    if (!bb_report_can_draw())
        return bb_fail(BB_INVALID, "report: a figure is drawn by gnuplot, which is not installed");
    return BB_OK;
}

static bb_status report_figure(const wanted *w, bb_results *results, double width_mm)
{
    BB_TRY(bb_report_figure(results, w->figure, width_mm, w->out));
    printf(" figure  %s\n", w->out);
    return BB_OK;
}

static bb_status run(const bb_cli *cli, void *values, int *exit_status)
{
    (void)exit_status;
    wanted *w = values;
    if (w->history != NULL)
        return report_history(cli, w->history, w->out);
    if (w->against)
        return bb_report_against(cli, w->out);
    if (cli->positional_count == 0)
        return bb_fail(BB_INVALID, "report: give a result file, or the folder of a run");
    for (uint32_t i = 0; i < cli->positional_count; i++)
        if (bb_table_is_other(cli->positional[i], "run"))
            return w->figure == NULL
                       ? report_table(cli, w, cli->positional[i])
                       : bb_fail(BB_INVALID, "report: %s is no run, of which there are figures",
                                 cli->positional[i]);
    double width_mm = 0;
    if (w->figure != NULL)
        BB_TRY(check_figure(w, &width_mm));
    bb_results *all = NULL;
    char *folder = NULL, beside[PATH_MAX];
    const bool only =
        w->table || w->markdown || w->csv || w->samples || w->json || w->google_benchmark;
    BB_TRY(bb_charts_decide(&w->charts));
    BB_TRY(bb_inputs_once(cli));
    if (w->out != NULL)
        BB_TRY(bb_out_file(w->out, "report"));
    bb_status status = read_inputs(cli, &all, &folder);
    if (status == BB_OK)
        status = bb_predictions_record(all);
    if (status == BB_OK && w->figure != NULL)
        status = report_figure(w, all, width_mm);
    else if (status == BB_OK)
        status = print(w, all);
    if (status == BB_OK && w->out == NULL && !only) {
        status = bb_join_path(beside, folder, "report.html");
        w->out = beside;
    }
    if (status == BB_OK && w->out != NULL && w->figure == NULL)
        status = write_page(all, w->out, !only, w->charts);
    bb_results_destroy(all);
    free(folder);
    return status;
}

extern const bb_command bb_command_report;
const bb_command bb_command_report = {
    .name = "report",
    .summary = "make summary, tables and HTML report of one or more result files",
    .arguments = "FILE|DIR...",
    .details = "A folder stands for its results.json. Several inputs become one report; scenes of "
               "the same\n"
               "name must have the same geometry. A table, such as slice.json, is reported alone.\n"
               "With --against, the page is against.html beside NEW; `bvhbench compare` is the "
               "same in words.",
    .options = options,
    .bytes = sizeof(wanted),
    .run = run,
};
