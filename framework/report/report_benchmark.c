/* The results as Google Benchmark writes its own, for tools that read those (tools/compare.py): one
 * entry per build or trace and round that counts, named by its key. */
#include "framework/base/json.h"
#include "framework/report/report.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static bool add_text(cJSON *object, const char *name, const char *text)
{
    return cJSON_AddStringToObject(object, name, text) != NULL;
}

static bool add_number(cJSON *object, const char *name, double value)
{
    return !isfinite(value) || cJSON_AddNumberToObject(object, name, value) != NULL;
}

static bool add_context(cJSON *root, const cJSON *from)
{
    cJSON *context = cJSON_AddObjectToObject(root, "context");
    const cJSON *load = bb_get(from, BB_F_CONTEXT_LOAD);
    bool ok = context != NULL && add_text(context, "date", bb_get_text(from, BB_F_CONTEXT_DATE)) &&
              add_text(context, "host_name", bb_get_text(from, BB_F_CONTEXT_HOST)) &&
              add_text(context, "executable", "bvhbench") &&
              add_number(context, "num_cpus", bb_get_number(from, BB_F_CONTEXT_THREADS)) &&
              add_text(context, "library_build_type", "release") &&
              add_text(context, "revision", bb_get_text(from, BB_F_CONTEXT_REVISION)) &&
              add_text(context, "cpu", bb_get_text(from, BB_F_CONTEXT_CPU)) &&
              add_text(context, "device", bb_get_text(from, BB_F_CONTEXT_DEVICE)) &&
              add_number(context, "json_schema_version", 1);
    if (ok && cJSON_IsArray(load))
        ok = cJSON_AddItemToObject(context, "load_avg", cJSON_Duplicate(load, 1));
    return ok;
}

/* What is one entry's apart from its times. */
typedef struct row {
    const cJSON *entry;
    bool trace;
    const char *name;
    uint32_t family, repetitions;
} row;

static bool add_counters(cJSON *object, const row *r)
{
    static const bb_field_id of_traces[] = {BB_F_TRACE_NODE_TESTS, BB_F_TRACE_PRIM_TESTS,
                                            BB_F_ACCURACY_WRONG_PPM};
    static const bb_field_id of_builds[] = {BB_F_TREE_NODES, BB_F_TREE_BYTES, BB_F_TREE_BYTES_PEAK};
    for (size_t i = 0; i < 3; i++) {
        bb_field_id field = r->trace ? of_traces[i] : of_builds[i];
        if (!add_number(object, bb_fields[field].name, bb_get_number(r->entry, field)))
            return false;
    }
    for (uint32_t i = 0; i < bb_metric_count() && !r->trace; i++)
        if (!add_number(object, bb_metrics[i]->name, bb_get_metric(r->entry, bb_metrics[i])))
            return false;
    return true;
}

static bool add_round(cJSON *list, const row *r, uint32_t repetition, double ms, double cpu_ms)
{
    cJSON *object = cJSON_CreateObject();
    bool ok = object != NULL && add_text(object, "name", r->name) &&
              add_number(object, "family_index", r->family) &&
              add_number(object, "per_family_instance_index", 0) &&
              add_text(object, "run_name", r->name) && add_text(object, "run_type", "iteration") &&
              add_number(object, "repetitions", r->repetitions) &&
              add_number(object, "repetition_index", repetition) &&
              add_number(object, "threads", 1) && add_number(object, "iterations", 1) &&
              add_number(object, "real_time", ms * 1e6) &&
              add_number(object, "cpu_time", cpu_ms * 1e6) && add_text(object, "time_unit", "ns");
    if (ok && r->trace)
        ok = add_number(object, "items_per_second",
                        bb_get_number(r->entry, BB_F_TRACE_COUNT) / (ms / 1e3));
    if (ok && add_counters(object, r) && cJSON_AddItemToArray(list, object))
        return true;
    cJSON_Delete(object);
    return false;
}

/* All rounds that count. Where no CPU time was measured, the wall clock stands for it. */
static bool add_entry(cJSON *list, const cJSON *entry, bool trace, uint32_t family)
{
    bb_samples ms, cpu;
    if (!bb_is_ok(entry) || !bb_get_samples(entry, trace ? BB_F_TRACE_MS : BB_F_BUILD_MS, &ms))
        return true;
    if (!bb_get_samples(entry, trace ? BB_F_TRACE_CPU_SAMPLES : BB_F_BUILD_CPU_SAMPLES, &cpu) ||
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
        if (!add_round(list, &r, i - first, ms.values[i], cpu.values[i]))
            return false;
    return true;
}

bb_status bb_report_benchmark(const bb_results *results, FILE *out)
{
    cJSON *root = cJSON_CreateObject();
    bool ok = root != NULL && add_context(root, bb_results_section(results, "context"));
    cJSON *list = ok ? cJSON_AddArrayToObject(root, "benchmarks") : NULL;
    uint32_t family = 0;
    const cJSON *entry;
    ok = list != NULL;
    cJSON_ArrayForEach(entry, bb_results_section(results, "builds"))
    {
        ok = ok && add_entry(list, entry, false, family++);
    }
    cJSON_ArrayForEach(entry, bb_results_section(results, "traces"))
    {
        ok = ok && add_entry(list, entry, true, family++);
    }
    char *text = ok ? bb_json_print(root, true) : NULL;
    bb_status status = BB_OK;
    if (text == NULL)
        status = bb_fail(BB_FAILED, "report: no memory");
    else
        fprintf(out, "%s\n", text);
    cJSON_free(text);
    cJSON_Delete(root);
    return status;
}
