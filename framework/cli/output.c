#include "framework/cli/output.h"

#include "framework/base/clock.h"
#include "framework/base/file.h"
#include "framework/base/interrupt.h"
#include "framework/cli/earlier.h"
#include "framework/cli/out_option.h"
#include "framework/compare/history.h"
#include "framework/compare/prediction.h"
#include "framework/device/bystanders.h"
#include "framework/device/device_private.h"
#include "framework/report/report.h"

#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

/* Paths of a run's files. */
typedef struct places {
    char json[1100], html[1100], tables[1100], pictures[1100];
} places;

static bb_status set_places(const char *folder, places *p)
{
    snprintf(p->json, sizeof p->json, "%s/results.json", folder);
    snprintf(p->html, sizeof p->html, "%s/report.html", folder);
    snprintf(p->tables, sizeof p->tables, "%s/tables.txt", folder);
    return bb_report_charts_folder(p->html, p->pictures, sizeof p->pictures);
}

static bb_status write_tables(const bb_results *results, const char *path)
{
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    if (out == NULL)
        return bb_fail(BB_FAILED, "tables: no memory");
    bb_status status = bb_report_table(results, out);
    if (fclose(out) != 0 && status == BB_OK)
        status = bb_fail(BB_FAILED, "tables: no memory");
    if (status == BB_OK)
        status = bb_file_write(path, text, size, "tables");
    free(text);
    return status;
}

/* The first of several failures. */
typedef struct failure {
    bb_status status;
    char reason[1024];
} failure;

static void keep_first(failure *first, bb_status status)
{
    if (status == BB_OK || first->status != BB_OK)
        return;
    first->status = status;
    snprintf(first->reason, sizeof first->reason, "%s", bb_message());
}

/* Writes as much of page and charts as possible, and returns the first failure. */
static bb_status write_views(const bb_comparison *c, bb_results *results, const places *p,
                             uint32_t *charts)
{
    failure first = {.status = BB_OK};
    keep_first(&first, bb_report_html(results, c->folder, p->html));
    if (c->charts == BB_CHARTS_YES && !bb_interrupted())
        keep_first(&first, bb_report_charts(results, p->pictures, charts));
    return first.status == BB_OK
               ? BB_OK
               : bb_fail(first.status,
                         "%.700s (the results are in %.200s: once that is mended, bvhbench report "
                         "%.80s)",
                         first.reason, p->json, c->folder);
}

static bb_status set_totals(bb_results *results, bb_bench_outcome *outcome)
{
    const bb_bench_times *times = &outcome->times;
    bb_audit *audit = &outcome->audit;
    BB_TRY(bb_results_set_total(results, times->build_ms, times->trace_ms, times->total_ms));
    bb_audit_total(audit, times->build_ms, times->trace_ms, bb_results_time_ms(results, "steps"),
                   times->total_ms);
    bb_audit_rates(audit, results);
    BB_TRY(bb_results_set_number(results, BB_F_CONTEXT_SETS, outcome->sets));
    BB_TRY(bb_results_set_number(results, BB_F_CONTEXT_CELLS, outcome->cells));
    return bb_results_set_audit(results, audit);
}

/* Prints the answer and the paths of all files. This comes last, so that it stays on the screen. */
static bb_status print(const bb_comparison *c, bb_results *results, const places *p,
                       uint32_t charts)
{
    BB_TRY(c->print(results, stdout));
    if (c->quiet)
        return BB_OK;
    printf(" report   %s\n tables   %s\n results  %s\n", p->html, p->tables, p->json);
    if (charts > 0)
        printf(" charts   %s/: %u, each as SVG and PNG\n", p->pictures, charts);
    return BB_OK;
}

bb_status bb_output_append_all(const char *database, const bb_table *const *tables, uint32_t count)
{
    bb_history *history = NULL;
    bb_status status = database != NULL ? bb_history_open(database, true, &history) : BB_OK;
    if (status == BB_OK && history != NULL && count > 0)
        status = bb_history_append_all(history, tables, count);
    bb_history_close(history);
    return status;
}

bb_status bb_output_append(const char *database, const bb_table *table)
{
    return bb_output_append_all(database, &table, table != NULL ? 1 : 0);
}

/* Appends the run to the history. The results are written before, so that they can be appended
 * later if this fails. */
static bb_status append_history(const bb_comparison *c, const bb_results *results, const char *json)
{
    bb_status status = bb_output_append(c->history, bb_results_table(results));
    return status == BB_OK ? BB_OK
                           : bb_fail(status,
                                     "%.700s (the results are in %.200s: bvhbench merge %.80s "
                                     "--history %.100s appends them later)",
                                     bb_message(), json, c->folder, c->history);
}

/* Writes the results first, since they must not be lost, and again with the time that page and
 * charts took. */
static bb_status write_files(const bb_comparison *c, bb_results *results,
                             const bb_bench_times *times, const places *p, uint32_t *charts)
{
    failure first = {.status = BB_OK};
    const double start = bb_wall_ms();
    BB_TRY(bb_keep_earlier(c->folder, "run", c->quiet));
    bb_status status = bb_results_write(results, p->json);
    if (status != BB_OK)
        return bb_fail(status, "%s (only what was printed is kept: choose another --out)",
                       bb_message());
    keep_first(&first, append_history(c, results, p->json));
    status = write_views(c, results, p, charts);
    const double ms = bb_wall_ms() - start;
    if (status == BB_OK)
        status = bb_results_add_step(results, "report", ms);
    if (status == BB_OK)
        status =
            bb_results_set_total(results, times->build_ms, times->trace_ms, times->total_ms + ms);
    if (status == BB_OK)
        status = write_tables(results, p->tables);
    if (status == BB_OK)
        status = bb_report_html(results, c->folder, p->html);
    if (status == BB_OK)
        status = bb_results_write(results, p->json);
    keep_first(&first, status);
    return first.status == BB_OK ? BB_OK : bb_fail(first.status, "%s", first.reason);
}

/* Writes all files and prints the answer, even if a file cannot be written. */
static bb_status write_all(const bb_comparison *c, bb_results *results, bb_bench_outcome *outcome)
{
    places p;
    failure first = {.status = BB_OK};
    uint32_t charts = 0;
    BB_TRY(set_places(c->folder, &p));
    BB_TRY(set_totals(results, outcome));
    BB_TRY(bb_predictions_record(results));
    keep_first(&first, write_files(c, results, &outcome->times, &p, &charts));
    bb_status printed = print(c, results, &p, charts);
    return first.status != BB_OK ? bb_fail(first.status, "%s", first.reason) : printed;
}

/* Says in one line each what is wrong. Returns true if anything is. */
static bool blame(const bb_bench_outcome *outcome)
{
    if (outcome->wrong > 0)
        fprintf(stderr,
                "bvhbench: %u cells or builds are wrong: see the rows marked WRONG, unlike or "
                "failed\n",
                outcome->wrong);
    if (outcome->unbuilt > 0)
        fprintf(
            stderr,
            "bvhbench: %u of the builders could not build any of the scenes: their rows say why\n",
            outcome->unbuilt);
    if (outcome->unjudged > 0)
        fprintf(stderr,
                "bvhbench: no answer was judged on %u scenes: see why their cells were refused\n",
                outcome->unjudged);
    const bool blamed = bb_audit_blame(&outcome->audit);
    return outcome->wrong > 0 || outcome->unbuilt > 0 || outcome->unjudged > 0 || blamed;
}

/* Keeps what was measured before a failure. Returns `status`; the message then says where the
 * measurements are. */
static bb_status keep(bb_results *results, const bb_comparison *c, bb_status status)
{
    char json[1100];
    failure first = {.status = BB_OK};
    keep_first(&first, status);
    snprintf(json, sizeof json, "%s/results.json", c->folder);
    if (bb_first(bb_results_section(results, BB_BUILDS)) == NULL ||
        bb_results_set_interrupted(results) != BB_OK ||
        bb_keep_earlier(c->folder, "run", true) != BB_OK ||
        bb_results_write(results, json) != BB_OK)
        return bb_fail(status, "%s", first.reason);
    return bb_fail(status, "%s (earlier measurements are in %s)", first.reason, json);
}

static bb_status compare(const bb_comparison *c, bb_device *device, int *exit_status)
{
    bb_bench_outcome outcome = {0};
    bb_results *results = NULL;
    bb_bystanders watch;
    BB_TRY(bb_results_create(&(bb_context){device, c->seed, c->command}, &results));
    bb_bystanders_start(&watch);
    bb_status status =
        c->shard != NULL ? bb_results_set_shard(results, c->shard, c->shard_of) : BB_OK;
    if (status == BB_OK && c->reduced_to != NULL && c->reduced_to[0] != '\0')
        status = bb_results_set_text(results, BB_F_CONTEXT_REDUCED_TO, c->reduced_to);
    if (status == BB_OK)
        status = c->compare(c->request, device, results, &outcome);
    bool measured = bb_section_count(bb_results_section(results, BB_BUILDS)) > 0;
    (void)bb_results_set_number(results, BB_F_CONTEXT_OTHERS, bb_bystanders_share(&watch));
    bb_compiling compiling;
    bb_programs_measure(device, &compiling);
    (void)bb_results_set_compiling(results, &compiling);
    if (bb_interrupted()) { /* even if something failed: a signal makes compilers fail */
        *exit_status = BB_EXIT_INTERRUPTED;
        status = bb_results_set_interrupted(results);
        if (status == BB_OK && !measured) {
            fprintf(stderr, "bvhbench: interrupted before anything was measured\n");
            bb_results_destroy(results);
            return BB_OK;
        }
    }
    status = status == BB_OK ? write_all(c, results, &outcome) : keep(results, c, status);
    if (status == BB_OK)
        bb_charts_note(c->charts);
    if (status == BB_OK && blame(&outcome) && *exit_status == BB_EXIT_OK)
        *exit_status = BB_EXIT_WRONG;
    bb_results_destroy(results);
    return status;
}

bb_status bb_output_compare(const bb_comparison *comparison, int *exit_status)
{
    bb_device *device = NULL;
    BB_TRY(bb_out_folder(comparison->folder)); /* the history may be in this folder */
    BB_TRY(bb_output_append(comparison->history, NULL));
    bb_interrupt_catch();
    bb_status status = bb_open_device(comparison->device, &device);
    if (status == BB_OK) {
        status = compare(comparison, device, exit_status);
    } else if (bb_interrupted()) { /* a signal makes compilers fail */
        fprintf(stderr, "bvhbench: interrupted before anything was measured\n");
        *exit_status = BB_EXIT_INTERRUPTED;
        status = BB_OK;
    }
    bb_device_close(device);
    return status;
}
