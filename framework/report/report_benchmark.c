/* The results as Google Benchmark writes its own, for tools that read those (tools/compare.py): one
 * entry per build or trace and round that counts, named by its key. */
#include "framework/base/json.h"
#include "framework/report/report.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Left out if it is not finite. */
static void put_number(bb_json *json, const char *name, double value)
{
    if (isfinite(value))
        bb_json_add_number(json, name, value);
}

static void put_context(bb_json *json, const bb_entry *from)
{
    bb_json_object(json, "context");
    bb_json_add_text(json, "date", bb_get_text(from, BB_F_CONTEXT_DATE));
    bb_json_add_text(json, "host_name", bb_get_text(from, BB_F_CONTEXT_HOST));
    bb_json_add_text(json, "executable", "bvhbench");
    put_number(json, "num_cpus", bb_get_number(from, BB_F_CONTEXT_THREADS));
    bb_json_add_text(json, "library_build_type", "release");
    bb_json_add_text(json, "revision", bb_get_text(from, BB_F_CONTEXT_REVISION));
    bb_json_add_text(json, "cpu", bb_get_text(from, BB_F_CONTEXT_CPU));
    bb_json_add_text(json, "device", bb_get_text(from, BB_F_CONTEXT_DEVICE));
    bb_json_add_number(json, "json_schema_version", 1);
    if (isfinite(bb_get_number(from, BB_F_CONTEXT_LOAD_1))) {
        bb_json_array(json, "load_avg");
        for (int i = 0; i < 3; i++)
            bb_json_add_number(json, NULL, bb_get_number(from, BB_F_CONTEXT_LOAD_1 + i));
        bb_json_end_array(json);
    }
    bb_json_end_object(json);
}

/* What the rounds of one entry share. */
typedef struct row {
    const bb_entry *entry;
    bool trace;
    const char *name;
    uint32_t family, repetitions;
} row;

static void put_counters(bb_json *json, const row *r)
{
    static const bb_field_id of_traces[] = {BB_F_TRACE_NODE_TESTS, BB_F_TRACE_PRIM_TESTS,
                                            BB_F_ACCURACY_WRONG_PPM};
    static const bb_field_id of_builds[] = {BB_F_TREE_NODES, BB_F_TREE_BYTES, BB_F_TREE_BYTES_PEAK};
    for (size_t i = 0; i < 3; i++) {
        bb_field_id field = r->trace ? of_traces[i] : of_builds[i];
        put_number(json, bb_fields[field].name, bb_get_number(r->entry, field));
    }
    for (uint32_t i = 0; i < bb_metric_count() && !r->trace; i++)
        put_number(json, bb_metrics[i]->name, bb_get_metric(r->entry, bb_metrics[i]));
}

static void put_round(bb_json *json, const row *r, uint32_t repetition, double ms, double cpu_ms)
{
    bb_json_object(json, NULL);
    bb_json_add_text(json, "name", r->name);
    bb_json_add_number(json, "family_index", r->family);
    bb_json_add_number(json, "per_family_instance_index", 0);
    bb_json_add_text(json, "run_name", r->name);
    bb_json_add_text(json, "run_type", "iteration");
    bb_json_add_number(json, "repetitions", r->repetitions);
    bb_json_add_number(json, "repetition_index", repetition);
    bb_json_add_number(json, "threads", 1);
    bb_json_add_number(json, "iterations", 1);
    put_number(json, "real_time", ms * 1e6);
    put_number(json, "cpu_time", cpu_ms * 1e6);
    bb_json_add_text(json, "time_unit", "ns");
    if (r->trace)
        put_number(json, "items_per_second",
                   bb_get_number(r->entry, BB_F_TRACE_COUNT) / (ms / 1e3));
    put_counters(json, r);
    bb_json_end_object(json);
}

/* Puts all rounds that count. If no CPU time was measured, the wall clock takes its place. */
static void put_entry(bb_json *json, const bb_entry *entry, bool trace, uint32_t family)
{
    bb_samples ms, cpu;
    if (!bb_is_ok(entry) || !bb_get_samples(entry, trace ? BB_F_TRACE_MS : BB_F_BUILD_MS, &ms))
        return;
    if (!bb_get_samples(entry, trace ? BB_F_TRACE_CPU_MS : BB_F_BUILD_CPU_SAMPLES, &cpu) ||
        cpu.count != ms.count)
        cpu = ms;
    const char *key = bb_get_text(entry, trace ? BB_F_TRACE_CELL : BB_F_BUILD_CELL);
    char name[BB_CELL_KEY + 32];
    double run = bb_run_of(entry);
    uint32_t first = ms.count > 1 ? 1 : 0;
    if (run > 0)
        snprintf(name, sizeof name, "%s/run=%.0f", key, run + 1);
    else
        snprintf(name, sizeof name, "%s", key);
    const row r = {entry, trace, name, family, ms.count - first};
    for (uint32_t i = first; i < ms.count; i++)
        put_round(json, &r, i - first, ms.values[i], cpu.values[i]);
}

bb_status bb_report_benchmark(const bb_results *results, FILE *out)
{
    bb_json json = {.formatted = true};
    uint32_t family = 0;
    bb_json_object(&json, NULL);
    put_context(&json, bb_results_context(results));
    bb_json_array(&json, "benchmarks");
    bb_each(entry, bb_results_section(results, BB_BUILDS))
    {
        put_entry(&json, entry, false, family++);
    }
    bb_each(entry, bb_results_section(results, BB_TRACES))
    {
        put_entry(&json, entry, true, family++);
    }
    bb_json_end_array(&json);
    bb_json_end_object(&json);
    char *text = bb_json_take(&json);
    if (text == NULL)
        return bb_fail(BB_FAILED, "report: no memory");
    fprintf(out, "%s\n", text);
    free(text);
    return BB_OK;
}
