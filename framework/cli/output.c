#include "framework/cli/output.h"

#include "framework/base/clock.h"
#include "framework/report/report.h"

#include <cjson/cJSON.h>
#include <stdio.h>

/* The file first: it is what must not be lost. It is written again with the time that the page and the charts took. */
bb_status bb_output_write(bb_results *results, const bb_output_request *request)
{
    const bb_bench_times *times = &request->outcome->times;
    bb_audit *audit = &request->outcome->audit;
    const char *folder = request->folder;
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
    bb_status drawn = request->charts ? bb_report_charts(results, pictures, &chart_count) : BB_OK;
    if (drawn != BB_OK)
        snprintf(reason, sizeof reason, "%s", bb_message());
    double ms = bb_wall_ms() - start;
    BB_TRY(bb_results_add_step(results, "report", ms));
    BB_TRY(bb_results_set_total(results, times->build_ms, times->trace_ms, times->total_ms + ms));
    BB_TRY(bb_report_html(results, folder, html));
    BB_TRY(bb_results_write(results, json));
    if (!request->quiet)
        fprintf(stderr, "wrote %s and %s\n", json, html);
    if (!request->quiet && drawn == BB_OK && chart_count > 0)
        fprintf(stderr, "wrote %u charts, each as SVG and PNG, into %s\n", chart_count, pictures);
    BB_TRY(request->print(results, stdout));
    return drawn == BB_OK ? BB_OK : bb_fail(drawn, "%s (all else is written)", reason);
}

bool bb_output_blame(const bb_bench_outcome *outcome)
{
    const bb_audit *audit = &outcome->audit;
    if (outcome->wrong > 0)
        fprintf(stderr,
                "bvhbench: %u cells or builds are wrong: see the rows marked WRONG, unlike or "
                "failed\n",
                outcome->wrong);
    if (outcome->unjudged > 0)
        fprintf(stderr, "bvhbench: of %u scenes no answer was judged: see why cells were refused\n",
                outcome->unjudged);
    for (uint32_t i = 0; i < audit->complaints && i < BB_COMPLAINTS_MAX; i++)
        fprintf(stderr, "bvhbench: clocks: %s\n", audit->texts[i]);
    if (audit->complaints > 0)
        fprintf(stderr, "bvhbench: %u figures contradict each other: do not trust this run\n",
                audit->complaints);
    return outcome->wrong > 0 || outcome->unjudged > 0 || audit->complaints > 0;
}

bb_status bb_output_keep(bb_results *results, const char *folder, bb_status status)
{
    char reason[1024], json[1100];
    snprintf(reason, sizeof reason, "%s", bb_message());
    snprintf(json, sizeof json, "%s/results.json", folder);
    const cJSON *builds = cJSON_GetObjectItem(bb_results_json(results), "builds");
    if (cJSON_GetArraySize(builds) == 0 || bb_results_write(results, json) != BB_OK)
        return bb_fail(status, "%s", reason);
    return bb_fail(status, "%s (what was measured before is in %s)", reason, json);
}
