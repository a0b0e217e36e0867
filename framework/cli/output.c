#include "framework/cli/output.h"

#include "framework/base/clock.h"
#include "framework/cli/charts_option.h"
#include "framework/cli/choice.h"
#include "framework/device/device_private.h"
#include "framework/report/report.h"

#include <cjson/cJSON.h>
#include <stdio.h>
#include <stdlib.h>

/* The file first: it is what must not be lost. It is written again with the time that the page and
 * the charts took. */
static bb_status write_all(const bb_comparison *c, bb_results *results, bb_bench_outcome *outcome)
{
    const bb_bench_times *times = &outcome->times;
    bb_audit *audit = &outcome->audit;
    const char *folder = c->folder;
    char json[1100], html[1100], pictures[1100], reason[1024] = "";
    uint32_t chart_count = 0;
    snprintf(json, sizeof json, "%s/results.json", folder);
    snprintf(html, sizeof html, "%s/report.html", folder);
    BB_TRY(bb_report_charts_folder(html, pictures, sizeof pictures));
    double start = bb_wall_ms();
    BB_TRY(bb_results_set_total(results, times->build_ms, times->trace_ms, times->total_ms));
    const cJSON *all = cJSON_GetObjectItem(bb_results_json(results), "time_ms");
    bb_audit_total(audit, times->build_ms, times->trace_ms,
                   cJSON_GetNumberValue(cJSON_GetObjectItem(all, "steps")), times->total_ms);
    bb_audit_rates(audit, results);
    BB_TRY(bb_results_add_audit(results, audit));
    BB_TRY(bb_results_write(results, json));
    BB_TRY(bb_report_html(results, folder, html));
    bb_status drawn = c->charts ? bb_report_charts(results, pictures, &chart_count) : BB_OK;
    if (drawn != BB_OK)
        snprintf(reason, sizeof reason, "%s", bb_message());
    double ms = bb_wall_ms() - start;
    BB_TRY(bb_results_add_step(results, "report", ms));
    BB_TRY(bb_results_set_total(results, times->build_ms, times->trace_ms, times->total_ms + ms));
    BB_TRY(bb_report_html(results, folder, html));
    BB_TRY(bb_results_write(results, json));
    if (!c->quiet)
        fprintf(stderr, "wrote %s and %s\n", json, html);
    if (!c->quiet && drawn == BB_OK && chart_count > 0)
        fprintf(stderr, "wrote %u charts, each as SVG and PNG, into %s\n", chart_count, pictures);
    BB_TRY(c->print(results, stdout));
    return drawn == BB_OK ? BB_OK : bb_fail(drawn, "%s (all else is written)", reason);
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
        fprintf(stderr,
                "bvhbench: %u of the builders took none of the scenes: their rows say why\n",
                outcome->unbuilt);
    if (outcome->unjudged > 0)
        fprintf(stderr, "bvhbench: of %u scenes no answer was judged: see why cells were refused\n",
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
    const cJSON *builds = cJSON_GetObjectItem(bb_results_json(results), "builds");
    if (cJSON_GetArraySize(builds) == 0 || bb_results_write(results, json) != BB_OK)
        return bb_fail(status, "%s", reason);
    return bb_fail(status, "%s (what was measured before is in %s)", reason, json);
}

static bb_status compare(const bb_comparison *c, const char *command, bb_device *device,
                         int *exit_status)
{
    bb_bench_outcome outcome = {0};
    bb_results *results = NULL;
    BB_TRY(bb_results_create(&(bb_context){device, c->seed, command}, &results));
    bb_status status = c->compare(c->request, device, results, &outcome);
    status = status == BB_OK ? write_all(c, results, &outcome) : keep(results, c->folder, status);
    if (status == BB_OK && !c->charts)
        bb_charts_note(c->cli);
    if (status == BB_OK && blame(&outcome))
        *exit_status = BB_EXIT_WRONG;
    bb_results_destroy(results);
    return status;
}

bb_status bb_output_compare(const bb_comparison *comparison, int *exit_status)
{
    bb_device *device = NULL;
    BB_TRY(bb_make_folder(comparison->folder));
    char *command = bb_cli_command_line(comparison->cli);
    bb_status status = bb_open_device(comparison->cli, &device);
    if (status == BB_OK)
        status = compare(comparison, command, device, exit_status);
    bb_device_close(device);
    free(command);
    return status;
}
