/* bvhbench reproduce: a paper's experiments, tables and claims beside ours; or all papers'. */
#include "framework/base/file.h"
#include "framework/base/interrupt.h"
#include "framework/cli/inputs.h"
#include "framework/cli/out_option.h"
#include "framework/cli/output.h"
#include "framework/cli/time_option.h"
#include "framework/device/run_row.h"
#include "framework/papers/reproduce.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct wanted {
    bb_device_choice device;
    bb_reproduce_request request;
    bb_bystanders watch; /* of its contests */
    bb_names scenes, metrics;
    bb_names own_metrics; /* the present paper's, where none are asked for */
    bb_simt simts[BB_SIMT_MAX];
    const char *folder, *history, *time;
    uint32_t charts;
    double ends_ms;        /* bb_wall_ms() when the time is over; 0: never */
    bool is_over, nothing; /* the time is over; and nothing of the last paper was measured */
    uint32_t done;         /* papers: measured, not kept */
} wanted;

static const bb_cli_option options[] = {
    {"scene", "S",
     "replace the default scenes, if an experiment allows it; `all`: the shipped scenes",
     BB_INTO(wanted, scenes)},
    {"repeats", "N",
     "measured rounds; default: each experiment's own; fewer than 6 decide no claim on times",
     BB_INTO(wanted, request.repeats), .low = 1, .high = BB_SAMPLES_MAX - 1},
    {"max-prims", "N", "most primitives in experiments that vary their number",
     BB_INTO(wanted, request.max_prims), .low = 10000, .high = 100000000, .fallback = "1000000"},
    {"quick", NULL, "small scenes, few rays, two rounds: a trial that decides no claim on times",
     BB_INTO(wanted, request.quick), .apart = "repeats",
     .presets = (const char *const[]){"max-prims", "10000", NULL}},
    {"full-size", NULL,
     "pictures and slices of the papers' sizes (2160^2 and 1024^2; 999^2): hours",
     BB_INTO(wanted, request.full_size), .apart = "quick"},
    BB_SIMULATIONS_OPTION(wanted, metrics, "claims on times, judged once more"),
    BB_TIME_OPTION(wanted, time,
                   "end with what was measured by then, such as 90s, 5min or 1.5h; `all` begins no "
                   "paper later"),
    BB_GROUP(bb_device_options, wanted, device),
    BB_SEED_OPTION(wanted, request.seed),
    {"out", "DIR", "folder for results.json and report.html", BB_INTO(wanted, folder),
     .fallback = "out"},
    BB_HISTORY_OPTION(wanted, history),
    BB_CHARTS_OPTION(wanted, charts),
    BB_QUIET_OPTION(wanted, request.quiet),
    {.name = NULL},
};

static bb_status reproduce(void *user, bb_device *device, bb_results *results,
                           bb_bench_outcome *outcome)
{
    wanted *w = user;
    bb_bystanders_start(&w->watch);
    w->request.device = device;
    w->request.audit = &outcome->audit;
    w->request.watch = &w->watch;
    bb_interrupt_at(w->ends_ms);
    const bb_status status = bb_reproduce(&w->request, results, outcome);
    w->is_over = bb_interrupted_by_time();
    bb_interrupt_at(0); /* what is left to do takes no time to speak of */
    if (!w->is_over)
        return status;
    w->nothing = outcome->audit.timings == 0;
    return !w->nothing ? bb_results_set_interrupted(results)
                       : bb_fail(BB_REFUSED,
                                 "reproduce %s: --time was over before anything was measured: "
                                 "give more time",
                                 w->request.paper->name);
}

/* ---- one paper ---- */

/* Takes the paper, and the simulations that are asked for, or else its own. */
static bb_status choose_paper(wanted *w, const bb_paper *paper)
{
    bb_reproduce_request *request = &w->request;
    const bool own = w->metrics.count == 0 && paper->metrics != NULL;
    request->paper = paper;
    bb_names_free(&w->own_metrics);
    if (own)
        BB_TRY(bb_spec_list(paper->metrics, w->own_metrics.items, BB_NAMES_MAX,
                            &w->own_metrics.count));
    const bb_names *metrics = own ? &w->own_metrics : &w->metrics;
    request->metrics = metrics->items;
    request->simts = w->simts;
    return bb_choose_simulations(metrics, w->simts, &request->simt_count);
}

static bb_status run_paper(const bb_cli *cli, wanted *w, const char *folder, int *exit_status)
{
    const bb_comparison comparison = {
        .command = cli->command_line,
        .device = &w->device,
        .folder = folder,
        .history = w->history,
        .seed = w->request.seed,
        .charts = w->charts,
        .quiet = w->request.quiet,
        .compare = reproduce,
        .request = w,
        .print = bb_reproduction_print,
    };
    return bb_output_compare(&comparison, exit_status);
}

/* ---- all of them ---- */

/* In a paper's folder, once all of it was measured and nothing was wrong: a hash of the program,
 * what was asked of it, the device, and of the results. */
#define MARK "measured-well"
enum { MARK_LENGTH = 16 };

typedef struct mark {
    char text[MARK_LENGTH + 1];
} mark;

static bb_status identify(const bb_cli *cli, const wanted *w, uint64_t *own)
{
    const bb_reproduce_request *r = &w->request;
    const uint64_t asked[] = {r->repeats, r->max_prims, r->quick, r->full_size, r->seed};
    bb_device *device;
    BB_TRY(bb_open_device(&w->device, &device));
    bb_identity *identity = bb_identity_begin();
    bb_identity_add_choice(identity, cli, &w->device);
    bb_identity_add(identity, asked, sizeof asked);
    for (size_t i = 0; i < w->metrics.count; i++) {
        bb_identity_add_text(identity, w->metrics.items[i]);
        bb_identity_add(identity, &w->simts[i].device, sizeof w->simts[i].device);
    }
    bb_identity_add_text(identity, device->name);
    bb_identity_add_text(identity, device->driver);
    bb_device_close(device);
    return bb_identity_end(identity, "reproduce all", own);
}

/* The mark of what is in the folder now. */
static bb_status mark_of(const char *folder, uint64_t own, mark *out)
{
    char path[PATH_MAX];
    uint64_t hash;
    bb_identity *identity = bb_identity_begin();
    bb_identity_add(identity, &own, sizeof own);
    if (bb_join_path(path, folder, "results.json") == BB_OK)
        bb_identity_add_file(identity, path);
    BB_TRY(bb_identity_end(identity, "reproduce all", &hash));
    snprintf(out->text, sizeof out->text, "%016" PRIx64, hash);
    return BB_OK;
}

static bool is_marked(const char *folder, uint64_t own)
{
    char path[PATH_MAX], *text;
    size_t size;
    mark now;
    if (bb_join_path(path, folder, MARK) != BB_OK || mark_of(folder, own, &now) != BB_OK ||
        bb_file_read(path, MARK_LENGTH, "reproduce all", &text, &size) != BB_OK)
        return false;
    const bool same = strcmp(text, now.text) == 0;
    free(text);
    return same;
}

/* Reads what was measured of a paper. NULL: there is nothing, or not all of it. */
static bb_results *read_paper(const char *folder)
{
    char path[PATH_MAX];
    bb_results *results = NULL;
    if (bb_join_path(path, folder, "results.json") != BB_OK ||
        bb_results_read(path, &results) != BB_OK)
        return NULL;
    if (!bb_get_true(bb_results_context(results), BB_F_CONTEXT_INTERRUPTED) &&
        bb_section_count(bb_results_section(results, BB_PAPERS)) == 1)
        return results;
    bb_results_destroy(results);
    return NULL;
}

/* Measures a paper and, if all of it was measured and nothing was wrong, marks its folder. */
static bb_status measure_paper(const bb_cli *cli, wanted *w, const char *folder, uint64_t own,
                               int *exit_status)
{
    char path[PATH_MAX];
    int ended = BB_EXIT_OK;
    BB_TRY(bb_join_path(path, folder, MARK));
    (void)unlink(path);
    const bb_status status = run_paper(cli, w, folder, &ended);
    if (w->nothing)
        return BB_OK;
    BB_TRY(status);
    *exit_status = ended != BB_EXIT_OK ? ended : *exit_status;
    mark now;
    if (w->is_over || ended != BB_EXIT_OK)
        return BB_OK;
    BB_TRY(mark_of(folder, own, &now));
    return bb_file_write(path, now.text, MARK_LENGTH, "reproduce all");
}

/* Measures a paper, unless it was measured before, and shows it on the page. */
static bb_status add_paper(const bb_cli *cli, wanted *w, uint64_t own, bb_page *page,
                           int *exit_status)
{
    char folder[PATH_MAX];
    BB_TRY(bb_join_path(folder, w->folder, w->request.paper->name));
    bb_results *results = is_marked(folder, own) ? read_paper(folder) : NULL;
    if (results != NULL) {
        if (!w->request.quiet)
            fprintf(stderr, "bvhbench: %s: kept what was measured on %s\n", w->request.paper->name,
                    bb_get_text(bb_results_context(results), BB_F_CONTEXT_DATE));
    } else {
        BB_TRY(measure_paper(cli, w, folder, own, exit_status));
        if (w->is_over || *exit_status == BB_EXIT_INTERRUPTED)
            return BB_OK; /* what may be in the folder is older */
        results = read_paper(folder);
        w->done++;
    }
    if (results == NULL)
        return bb_fail(BB_FAILED, "%s: cannot read what was measured", folder);
    bb_reproduction_show(results, page);
    bb_page_say(page, "measured by `%s` on %s, in %.0f s",
                bb_get_text(bb_results_context(results), BB_F_CONTEXT_COMMAND),
                bb_get_text(bb_results_context(results), BB_F_CONTEXT_DATE),
                bb_results_time_ms(results, "total") / 1000);
    bb_results_destroy(results);
    return bb_page_status(page);
}

static bb_status write_markdown(const bb_page *page, const char *path)
{
    char *text = NULL;
    size_t size = 0;
    FILE *file = open_memstream(&text, &size);
    if (file == NULL)
        return bb_fail(BB_REFUSED, "%s: no memory", path);
    bb_page_markdown(page, file);
    const bool failed = fclose(file) != 0;
    const bb_status status = failed ? bb_fail(BB_REFUSED, "%s: no memory", path)
                                    : bb_file_write(path, text, size, "reproduce all");
    free(text);
    return status;
}

static bb_status write_pages(const wanted *w, const bb_page *page)
{
    char html[PATH_MAX], markdown[PATH_MAX];
    BB_TRY(bb_join_path(html, w->folder, "papers.html"));
    BB_TRY(bb_join_path(markdown, w->folder, "PAPERS.md"));
    BB_TRY(bb_page_html(page, NULL, w->folder, html));
    BB_TRY(write_markdown(page, markdown));
    if (!w->request.quiet)
        printf(" papers   %s\n          %s\n", html, markdown);
    return BB_OK;
}

static bb_status run_all(const bb_cli *cli, wanted *w, int *exit_status)
{
    bb_page *page;
    uint64_t own;
    if (w->scenes.count > 0)
        return bb_fail(BB_INVALID,
                       "reproduce all: papers need different scenes: leave out --scene, "
                       "or give one paper");
    for (const bb_paper *const *paper = bb_papers; *paper != NULL; paper++) {
        BB_TRY(choose_paper(w, *paper));
        BB_TRY(bb_reproduce_check(&w->request));
    }
    BB_TRY(bb_out_folder(w->folder));
    BB_TRY(identify(cli, w, &own));
    BB_TRY(bb_page_create("Papers: their tables and claims beside ours", &page));
    bb_status status = BB_OK;
    for (const bb_paper *const *paper = bb_papers;
         *paper != NULL && status == BB_OK && !w->is_over && *exit_status != BB_EXIT_INTERRUPTED;
         paper++) {
        status = choose_paper(w, *paper);
        if (status == BB_OK)
            status = add_paper(cli, w, own, page, exit_status);
    }
    if (status == BB_OK)
        status = write_pages(w, page);
    bb_page_free(page);
    if (status == BB_OK && w->is_over && w->done == 0)
        return bb_fail(BB_REFUSED,
                       "reproduce all: --time was over before %s was done: give more "
                       "time",
                       w->request.paper->name);
    return status;
}

static void say_over(const wanted *w, bool all)
{
    if (w->is_over)
        fprintf(stderr, "bvhbench: --time was over: %s\n",
                all ? "the same command continues, from the paper on that was not done"
                    : "claims that need more cannot be told");
}

static bb_status run_asked(const bb_cli *cli, wanted *w, int *exit_status)
{
    bb_reproduce_request *request = &w->request;
    BB_TRY(bb_time_option(w->time, &w->ends_ms));
    BB_TRY(bb_choose_simulations(&w->metrics, w->simts, &request->simt_count));
    BB_TRY(bb_charts_decide(&w->charts));
    BB_TRY(bb_load_plugins(&w->device.plugins));
    if (cli->positional_count != 1)
        return bb_fail(BB_INVALID, "reproduce: give one paper: `bvhbench list papers` shows them");
    if (strcmp(cli->positional[0], "all") == 0) {
        BB_TRY(run_all(cli, w, exit_status));
        say_over(w, true);
        return BB_OK;
    }
    const bb_paper *paper;
    BB_TRY(bb_paper_find(cli->positional[0], &paper));
    BB_TRY(choose_paper(w, paper));
    if (w->scenes.count > 0) /* else each experiment has its own */
        BB_TRY(bb_choose_scenes(&w->scenes, bb_add_shipped_scenes));
    request->scenes = w->scenes.items;
    request->scene_count = (uint32_t)w->scenes.count;
    BB_TRY(bb_reproduce_check(request));
    BB_TRY(run_paper(cli, w, w->folder, exit_status));
    say_over(w, false);
    return BB_OK;
}

static bb_status run(const bb_cli *cli, void *values, int *exit_status)
{
    wanted *w = values;
    const bb_status status = run_asked(cli, w, exit_status);
    bb_names_free(&w->own_metrics);
    return status;
}

extern const bb_command bb_command_reproduce;
const bb_command bb_command_reproduce = {
    .name = "reproduce",
    .summary = "repeat a paper's experiments; show its tables and claims beside ours",
    .arguments = "PAPER|all",
    .details = "`bvhbench list papers` shows the papers. `all` runs one after the other, each into "
               "a folder\n"
               "DIR/PAPER, and writes DIR/papers.html and DIR/PAPERS.md. If it is cut off, the "
               "same command\n"
               "goes on: it keeps papers in which nothing was wrong, as long as program, plug-ins "
               "and device\n"
               "are the same. Exit status 1: an answer is wrong, or a builder or kernel failed. A "
               "claim that\n"
               "does not hold is not a failure.",
    .options = options,
    .bytes = sizeof(wanted),
    .goes_on = true,
    .run = run,
};
