#include "framework/cli/output.h"

#include "framework/base/bystanders.h"
#include "framework/base/clock.h"
#include "framework/base/file.h"
#include "framework/base/interrupt.h"
#include "framework/cli/earlier.h"
#include "framework/cli/out_option.h"
#include "framework/device/device_private.h"
#include "framework/history/history.h"
#include "framework/report/report.h"
#include "framework/summary/prediction.h"

#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

/* Where a run's files go. */
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

/* Page and charts, all that can be; the first failure is returned. */
static bb_status write_views(const bb_comparison *c, bb_results *results, const places *p,
                             uint32_t *charts)
{
    char reason[1024] = "";
    bb_status first = BB_OK;
    for (int i = 0; i < 2; i++) {
        bb_status status = BB_OK;
        if (i == 0)
            status = bb_report_html(results, c->folder, p->html);
        else if (c->charts == BB_CHARTS_YES && !bb_interrupted())
            status = bb_report_charts(results, p->pictures, charts);
        if (status != BB_OK && first == BB_OK) {
            first = status;
            snprintf(reason, sizeof reason, "%s", bb_message());
        }
    }
    return first == BB_OK ? BB_OK
                          : bb_fail(first,
                                    "%.700s (the results are in %.200s: once that is mended, "
                                    "bvhbench report %.80s)",
                                    reason, p->json, c->folder);
}

static bb_status set_totals(bb_results *results, bb_bench_outcome *outcome)
{
    const bb_bench_times *times = &outcome->times;
    bb_audit *audit = &outcome->audit;
    BB_TRY(bb_results_set_total(results, times->build_ms, times->trace_ms, times->total_ms));
    bb_audit_total(audit, times->build_ms, times->trace_ms,
                   bb_results_ms(results, BB_TIMES, "steps"), times->total_ms);
    bb_audit_rates(audit, results);
    return bb_results_add_audit(results, audit);
}

/* On standard output the answer, and where all else is: last, so that it is what stays on the
 * screen. */
static bb_status print(const bb_comparison *c, bb_results *results, const places *p,
                       uint32_t charts)
{
    BB_TRY(c->print(results, stdout));
    if (c->quiet)
        return BB_OK;
    printf("\n report   %s\n tables   %s\n results  %s\n", p->html, p->tables, p->json);
    if (charts > 0)
        printf(" charts   %s/: %u, each as SVG and PNG\n", p->pictures, charts);
    return BB_OK;
}

/* The first failure stays. */
static void keep_first(bb_status status, bb_status *first, char *reason, size_t capacity)
{
    if (status == BB_OK || *first != BB_OK)
        return;
    *first = status;
    snprintf(reason, capacity, "%s", bb_message());
}

/* After the results: what can't be appended now can be later. */
static bb_status append_history(const bb_comparison *c, const bb_results *results, const char *json)
{
    bb_history *history = NULL;
    char reason[700];
    if (c->history == NULL)
        return BB_OK;
    bb_status status = bb_history_open(c->history, true, &history);
    if (status == BB_OK)
        status = bb_history_append(history, results);
    bb_history_close(history);
    if (status == BB_OK)
        return BB_OK;
    snprintf(reason, sizeof reason, "%s", bb_message());
    return bb_fail(status,
                   "%s (the results are in %.200s: bvhbench merge %.80s --history %.100s appends "
                   "them later)",
                   reason, json, c->folder, c->history);
}

/* The file first: it is what must not be lost. It is written again with the time that the page and
 * the charts took. Whatever cannot be written, the answer is printed. */
static bb_status write_all(const bb_comparison *c, bb_results *results, bb_bench_outcome *outcome)
{
    places p;
    char kept[1200], reason[1024], first_reason[1024];
    bb_status first = BB_OK;
    uint32_t charts = 0;
    const bb_bench_times *times = &outcome->times;
    double start = bb_wall_ms();
    BB_TRY(set_places(c->folder, &p));
    BB_TRY(set_totals(results, outcome));
    BB_TRY(bb_predictions_record(results));
    bb_status status = bb_keep_earlier(c->folder, kept, sizeof kept);
    if (kept[0] != '\0' && !c->quiet)
        fprintf(stderr, "moved the results that were in %s to %s\n", c->folder, kept);
    if (status == BB_OK) {
        status = bb_results_write(results, p.json);
        snprintf(reason, sizeof reason, "%s", bb_message());
        if (status != BB_OK)
            bb_fail(status, "%s (only what was printed is kept: choose another --out)", reason);
    }
    if (status == BB_OK) {
        bb_status appended = append_history(c, results, p.json);
        keep_first(appended, &first, first_reason, sizeof first_reason);
        status = write_views(c, results, &p, &charts);
        double ms = bb_wall_ms() - start;
        if (status == BB_OK)
            status = bb_results_add_step(results, "report", ms);
        if (status == BB_OK)
            status = bb_results_set_total(results, times->build_ms, times->trace_ms,
                                          times->total_ms + ms);
        if (status == BB_OK)
            status = write_tables(results, p.tables);
        if (status == BB_OK)
            status = bb_report_html(results, c->folder, p.html);
        if (status == BB_OK)
            status = bb_results_write(results, p.json);
    }
    keep_first(status, &first, first_reason, sizeof first_reason);
    bb_status printed = print(c, results, &p, charts);
    return first != BB_OK ? bb_fail(first, "%s", first_reason) : printed;
}

/* A line each; true if anything is wrong. */
static bool blame(const bb_bench_outcome *outcome)
{
    const bb_audit *audit = &outcome->audit;
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
    for (uint32_t i = 0; i < audit->complaints && i < BB_COMPLAINTS_MAX; i++)
        fprintf(stderr, "bvhbench: clocks: %s\n", audit->texts[i]);
    if (audit->complaints > 0)
        fprintf(stderr, "bvhbench: %u figures contradict each other: do not trust this run\n",
                audit->complaints);
    return outcome->wrong > 0 || outcome->unbuilt > 0 || outcome->unjudged > 0 ||
           audit->complaints > 0;
}

/* Returns `status` with its message, which then says where what was measured lies, if anything
 * was. */
static bb_status keep(bb_results *results, const char *folder, bb_status status)
{
    char reason[1024], json[1100];
    snprintf(reason, sizeof reason, "%s", bb_message());
    snprintf(json, sizeof json, "%s/results.json", folder);
    char kept[1200];
    if (bb_first(bb_results_section(results, BB_BUILDS)) == NULL ||
        bb_results_set_interrupted(results) != BB_OK ||
        bb_keep_earlier(folder, kept, sizeof kept) != BB_OK ||
        bb_results_write(results, json) != BB_OK)
        return bb_fail(status, "%s", reason);
    return bb_fail(status, "%s (earlier measurements are in %s)", reason, json);
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
    if (status == BB_OK)
        status = c->compare(c->request, device, results, &outcome);
    bool measured = bb_results_section(results, BB_BUILDS)->child != NULL;
    (void)bb_results_set_others(results, bb_bystanders_share(&watch));
    bb_compiling compiling;
    bb_programs_measure(device, &compiling);
    (void)bb_results_set_compiling(results, &compiling);
    if (bb_interrupted()) { /* whatever failed on the way: a signal makes compilers fail */
        *exit_status = BB_EXIT_INTERRUPTED;
        status = bb_results_set_interrupted(results);
        if (status == BB_OK && !measured) {
            fprintf(stderr, "bvhbench: interrupted before anything was measured\n");
            bb_results_destroy(results);
            return BB_OK;
        }
    }
    status = status == BB_OK ? write_all(c, results, &outcome) : keep(results, c->folder, status);
    if (status == BB_OK)
        bb_charts_note(c->charts);
    if (status == BB_OK && blame(&outcome) && *exit_status == BB_EXIT_OK)
        *exit_status = BB_EXIT_WRONG;
    bb_results_destroy(results);
    return status;
}

/* A history that can't be written is found out before the work. */
static bb_status try_history(const char *path)
{
    bb_history *history = NULL;
    bb_status status = path != NULL ? bb_history_open(path, true, &history) : BB_OK;
    bb_history_close(history);
    return status;
}

bb_status bb_output_compare(const bb_comparison *comparison, int *exit_status)
{
    bb_device *device = NULL;
    BB_TRY(bb_out_folder(comparison->folder)); /* which the history may lie in */
    BB_TRY(try_history(comparison->history));
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
