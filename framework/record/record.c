/* Records into the result document: schema bvhbench-results/1, a cJSON tree that grows by one entry
 * per record.
 *
 * Fields of the schema may be added, never renamed. A figure that was not measured is null, never
 * 0. Hashes are strings of 16 hexadecimal digits, since a JSON number does not hold 64 bits.
 */
#include "framework/record/record.h"
#include "framework/base/clock.h"
#include "framework/embree/embree.h"
#include "framework/record/record_private.h"
#include "framework/scene/prim.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

/* Generated at build time. */
extern const char bb_build_revision[], bb_build_version[], bb_build_flags[];

static bb_status no_memory(void)
{
    return bb_fail(BB_FAILED, "result document: no memory");
}

void bb_build_record_init(bb_build_record *build)
{
    memset(build, 0, sizeof *build);
    build->cold_ms = build->prepare_ms = build->boxes_ms = NAN;
    build->sah = build->epo = build->epo_half = build->bytes_native = NAN;
    for (uint32_t i = 0; i < BB_LAYOUTS_MAX; i++)
        build->layouts[i].sah = NAN;
}

void bb_trace_record_init(bb_trace_record *trace)
{
    memset(trace, 0, sizeof *trace);
    trace->node_tests_per_ray = trace->prim_tests_per_ray = NAN;
    trace->accuracy.wrong_ppm = trace->accuracy.t_ulp_max = trace->accuracy.t_ulp_p99 = NAN;
    trace->accuracy.first_wrong = BB_NONE;
}

/* ---- members: each returns false when there is no memory ---- */

/* Takes `item` over, also when it fails. */
static bool put(cJSON *object, const char *name, cJSON *item)
{
    if (item != NULL && cJSON_AddItemToObject(object, name, item))
        return true;
    cJSON_Delete(item);
    return false;
}

static bool put_text(cJSON *object, const char *name, const char *text)
{
    return put(object, name,
               text != NULL && text[0] != '\0' ? cJSON_CreateString(text) : cJSON_CreateNull());
}

static cJSON *number(double value)
{
    return isfinite(value) ? cJSON_CreateNumber(value) : cJSON_CreateNull();
}

static bool put_number(cJSON *object, const char *name, double value)
{
    return put(object, name, number(value));
}

/* For figures of which 0 says that nobody filled them in. */
static bool put_size(cJSON *object, const char *name, uint64_t value)
{
    return put_number(object, name, value == 0 ? (double)NAN : (double)value);
}

static bool put_bool(cJSON *object, const char *name, bool value)
{
    return put(object, name, cJSON_CreateBool(value));
}

static bool put_hash(cJSON *object, const char *name, uint64_t hash)
{
    char text[17];
    snprintf(text, sizeof text, "%016llx", (unsigned long long)hash);
    return put_text(object, name, text);
}

static bool put_numbers(cJSON *object, const char *name, const double *values, uint32_t count)
{
    cJSON *array = cJSON_CreateArray();
    for (uint32_t i = 0; array != NULL && i < count; i++) {
        cJSON *item = number(values[i]);
        if (item == NULL || !cJSON_AddItemToArray(array, item)) {
            cJSON_Delete(item);
            cJSON_Delete(array);
            return false;
        }
    }
    return put(object, name, array);
}

/* All samples, or null if there are none. */
static bool put_samples(cJSON *object, const char *name, const bb_samples *samples)
{
    return samples->count == 0 ? put(object, name, cJSON_CreateNull())
                               : put_numbers(object, name, samples->values, samples->count);
}

/* The median as NAME, all samples as NAME_samples. */
static bool put_repeats(cJSON *object, const char *name, const bb_samples *samples)
{
    char label[64];
    snprintf(label, sizeof label, "%s_samples", name);
    return put_number(object, name, bb_samples_median(samples)) &&
           put_samples(object, label, samples);
}

/* { name: ms, ... } */
static bool put_named(cJSON *object, const char *name, const bb_named_ms *entries, uint32_t count)
{
    cJSON *inner = cJSON_CreateObject();
    bool ok = inner != NULL;
    for (uint32_t i = 0; ok && i < count; i++)
        ok = put_number(inner, entries[i].name, entries[i].ms);
    if (!ok) {
        cJSON_Delete(inner);
        return false;
    }
    return put(object, name, inner);
}

/* A finished entry goes into the array `section` of the document. */
static bb_status append(bb_results *results, const char *section, cJSON *entry, bool ok)
{
    cJSON *array = cJSON_GetObjectItemCaseSensitive(results->root, section);
    if (ok && entry != NULL && cJSON_AddItemToArray(array, entry))
        return BB_OK;
    cJSON_Delete(entry);
    return no_memory();
}

/* ---- context ---- */

static void cpu_name(char *name, size_t capacity)
{
    name[0] = '\0';
    FILE *file = fopen("/proc/cpuinfo", "r");
    if (file == NULL)
        return;
    char line[512];
    while (name[0] == '\0' && fgets(line, sizeof line, file) != NULL) {
        char *colon = strchr(line, ':');
        if (strncmp(line, "model name", 10) != 0 || colon == NULL)
            continue;
        colon += strspn(colon, ": \t");
        colon[strcspn(colon, "\n")] = '\0';
        snprintf(name, capacity, "%s", colon);
    }
    fclose(file);
}

static bool put_machine(cJSON *object)
{
    char host[256] = "", cpu[256];
    if (gethostname(host, sizeof host - 1) != 0)
        host[0] = '\0';
    cpu_name(cpu, sizeof cpu);
    double load[3];
    int loads = getloadavg(load, 3);
    long threads = sysconf(_SC_NPROCESSORS_ONLN);
    return put_text(object, "host", host) && put_text(object, "cpu", cpu) &&
           put_size(object, "cpu_threads", threads > 0 ? (uint64_t)threads : 0) &&
           (loads == 3 ? put_numbers(object, "load", load, 3)
                       : put(object, "load", cJSON_CreateNull()));
}

/* What the device's floats can do, in words: OpenCL's names without their prefix. */
static bool put_float_config(cJSON *object, cl_device_fp_config config)
{
    static const struct {
        cl_device_fp_config flag;
        const char *word;
    } words[] = {
        {CL_FP_DENORM, "denorm"},
        {CL_FP_INF_NAN, "inf_nan"},
        {CL_FP_ROUND_TO_NEAREST, "round_to_nearest"},
        {CL_FP_ROUND_TO_ZERO, "round_to_zero"},
        {CL_FP_ROUND_TO_INF, "round_to_inf"},
        {CL_FP_FMA, "fma"},
        {CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT, "correctly_rounded_divide_sqrt"},
        {CL_FP_SOFT_FLOAT, "soft_float"},
    };
    const char *said[sizeof words / sizeof words[0]];
    int count = 0;
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++)
        if (config & words[i].flag)
            said[count++] = words[i].word;
    return put(object, "float_config",
               count > 0 ? cJSON_CreateStringArray(said, count) : cJSON_CreateNull());
}

/* How work-groups hand over to each other, and what the litmus test of the fence found; null: no fence. */
static bool put_handover(cJSON *object, const bb_device *device)
{
    bool fence = device != NULL && device->litmus_pairs > 0;
    const char *word = device == NULL                          ? NULL
                       : device->handover == BB_HANDOVER_FENCE ? "fence"
                                                               : "levels";
    return put_text(object, "handover", word) &&
           put_number(object, "litmus_messages", fence ? device->litmus_pairs : (double)NAN) &&
           put_number(object, "litmus_stale", fence ? device->litmus_stale : (double)NAN);
}

static bool put_device(cJSON *object, const bb_device *device)
{
    return put_text(object, "device", device ? device->name : NULL) &&
           put_text(object, "driver", device ? device->driver : NULL) &&
           put_text(object, "opencl", device ? device->version : NULL) &&
           put_size(object, "compute_units", device ? device->compute_units : 0) &&
           put_float_config(object, device ? device->float_config : 0) &&
           put_handover(object, device) &&
           put_text(object, "kernels", device ? device->sources : NULL);
}

/* The Embree that is the oracle and the reference. */
static bool put_embree(cJSON *object, const char *version)
{
    cJSON *embree = cJSON_CreateObject();
    if (embree == NULL)
        return false;
    if (put_text(embree, "version", version) && put_text(embree, "api", BB_EMBREE_API))
        return put(object, "embree", embree);
    cJSON_Delete(embree);
    return false;
}

/* A seed that a JSON number cannot hold is written as its digits. */
static bool put_seed(cJSON *object, uint64_t seed)
{
    char digits[24];
    if (seed <= (uint64_t)1 << 53)
        return put_number(object, "seed", (double)seed);
    snprintf(digits, sizeof digits, "%llu", (unsigned long long)seed);
    return put_text(object, "seed", digits);
}

static bool put_context(cJSON *root, const bb_context *context, const char *embree_version)
{
    cJSON *object = cJSON_CreateObject();
    if (object == NULL)
        return false;
    char date[32];
    time_t now = time(NULL);
    struct tm utc;
    gmtime_r(&now, &utc);
    strftime(date, sizeof date, "%Y-%m-%dT%H:%M:%SZ", &utc);
    bool ok = put_text(object, "date", date) && put_text(object, "revision", bb_build_revision) &&
              put_text(object, "version", bb_build_version) && put_machine(object) &&
              put_device(object, context->device) && put_embree(object, embree_version) &&
              put_text(object, "build_flags", bb_build_flags) && put_seed(object, context->seed) &&
              put_text(object, "command", context->command);
    if (ok)
        return put(root, "context", object);
    cJSON_Delete(object);
    return false;
}

bb_status bb_results_create(const bb_context *context, bb_results **out)
{
    *out = NULL;
    char embree_version[32];
    BB_TRY(bb_embree_version(embree_version, sizeof embree_version));
    bb_results *results = calloc(1, sizeof *results);
    if (results == NULL)
        return no_memory();
    results->root = cJSON_CreateObject();
    cJSON *root = results->root;
    bool ok =
        root != NULL && put_text(root, "schema", BB_RESULTS_SCHEMA) &&
        put_context(root, context, embree_version) && put(root, "scenes", cJSON_CreateArray()) &&
        put(root, "builds", cJSON_CreateArray()) && put(root, "traces", cJSON_CreateArray()) &&
        put(root, "steps_ms", cJSON_CreateObject()) && put(root, "skipped", cJSON_CreateArray()) &&
        put(root, "pictures", cJSON_CreateArray());
    if (!ok) {
        bb_results_destroy(results);
        return no_memory();
    }
    *out = results;
    return BB_OK;
}

void bb_results_destroy(bb_results *results)
{
    if (results == NULL)
        return;
    cJSON_Delete(results->root);
    free(results);
}

cJSON *bb_results_json(bb_results *results)
{
    return results->root;
}

/* ---- scenes ---- */

static bool put_bounds(cJSON *object, const bb_box *box)
{
    cJSON *bounds = cJSON_CreateObject();
    if (bounds == NULL)
        return false;
    double lo[3] = {box->lo[0], box->lo[1], box->lo[2]};
    double hi[3] = {box->hi[0], box->hi[1], box->hi[2]};
    if (put_numbers(bounds, "lo", lo, 3) && put_numbers(bounds, "hi", hi, 3))
        return put(object, "bounds", bounds);
    cJSON_Delete(bounds);
    return false;
}

static bool put_profile(cJSON *object, const bb_profile *profile)
{
    cJSON *inner = cJSON_CreateObject();
    bool ok =
        inner != NULL && put_number(inner, "flatness", profile->flatness) &&
        put_number(inner, "size_min", profile->size_min) &&
        put_number(inner, "size_median", profile->size_median) &&
        put_number(inner, "size_max", profile->size_max) &&
        put_number(inner, "zero_area", profile->zero_area) &&
        put_number(inner, "duplicate_boxes", profile->duplicate_boxes) &&
        put_number(inner, "duplicate_centroids", profile->duplicate_centroids) &&
        put_number(inner, "overlap", profile->overlap) &&
        put(inner, "closed",
            profile->closed < 0 ? cJSON_CreateNull() : cJSON_CreateBool(profile->closed != 0)) &&
        put_number(inner, "code_bits", profile->code_bits) &&
        put_number(inner, "octree_depth", profile->octree_depth);
    if (ok)
        return put(object, "profile", inner);
    cJSON_Delete(inner);
    return false;
}

static bool put_views(cJSON *object, const bb_scene *scene)
{
    cJSON *views = cJSON_CreateArray();
    bool ok = views != NULL;
    for (uint32_t i = 0; ok && i < scene->view_count; i++) {
        cJSON *name = cJSON_CreateString(scene->views[i].name);
        ok = name != NULL && cJSON_AddItemToArray(views, name);
        if (!ok)
            cJSON_Delete(name);
    }
    if (ok)
        return put(object, "views", views);
    cJSON_Delete(views);
    return false;
}

/* "triangles": 12, "spheres": 0; of further kinds those that the scene has. */
static bool put_prims(cJSON *entry, const bb_scene *scene)
{
    bool ok = true;
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++)
        if (kind <= BB_SPHERE || scene->prims[kind].count > 0)
            ok = ok && put_number(entry, bb_prim_kinds[kind]->plural, scene->prims[kind].count);
    return ok;
}

bb_status bb_results_add_scene(bb_results *results, const bb_scene *scene,
                               const bb_samples *boxes_ms)
{
    char hash[17], kinds[64];
    bb_prim_kind_names(scene->kinds, kinds, sizeof kinds);
    snprintf(hash, sizeof hash, "%016llx", (unsigned long long)scene->hash);
    const cJSON *known = bb_results_scene(results, scene->name);
    if (known != NULL) {
        const cJSON *other = cJSON_GetObjectItemCaseSensitive(known, "hash");
        if (cJSON_IsString(other) && strcmp(other->valuestring, hash) == 0)
            return BB_OK;
        return bb_fail(BB_INVALID, "scene %s is in the results already with other geometry",
                       scene->name);
    }
    const bb_samples none = {0};
    cJSON *entry = cJSON_CreateObject();
    bool ok = entry != NULL && put_text(entry, "name", scene->name) &&
              put_text(entry, "kind", kinds) && put_text(entry, "source", scene->source) &&
              put_number(entry, "prims", scene->prim_count) && put_prims(entry, scene) &&
              put_number(entry, "ignored", scene->ignored) && put_bounds(entry, &scene->bounds) &&
              put_hash(entry, "hash", scene->hash) && put_profile(entry, &scene->profile) &&
              put_number(entry, "scale", scene->scale) &&
              put_number(entry, "out_of_range", scene->out_of_range) &&
              put_repeats(entry, "boxes_ms", boxes_ms != NULL ? boxes_ms : &none) &&
              put_views(entry, scene) && put_number(entry, "load_ms", scene->load_ms);
    return append(results, "scenes", entry, ok);
}

/* ---- builds ---- */

/* What the record shares among builds and traces: status and reason. */
static bool put_status(cJSON *entry, bb_status status, const char *reason)
{
    return put_text(entry, "status", bb_status_word(status)) && put_text(entry, "reason", reason);
}

/* Of what was refused or failed there are no figures. */
static double measured(bb_status status, double value)
{
    return status == BB_OK ? value : (double)NAN;
}

/* All parameters: as given, else the declared default; those without either are null. `stage`
 * stands before their names. */
static bool add_params(cJSON *params, const char *stage, const bb_spec *spec,
                       const bb_option *options)
{
    bool ok = true;
    const char *separator = stage[0] != '\0' ? ": " : "";
    char name[128];
    for (const bb_option *option = options; ok && option != NULL && option->name != NULL;
         option++) {
        snprintf(name, sizeof name, "%s%s%s", stage, separator, option->name);
        ok = put_text(params, name, bb_spec_value(spec, options, option->name));
    }
    for (uint32_t i = 0; ok && i < spec->param_count; i++) {
        snprintf(name, sizeof name, "%s%s%s", stage, separator, spec->keys[i]);
        if (cJSON_GetObjectItemCaseSensitive(params, name) == NULL)
            ok = put_text(params, name, spec->values[i]);
    }
    return ok;
}

static bool put_params(cJSON *entry, const char *name, const bb_spec *spec,
                       const bb_option *options)
{
    cJSON *params = cJSON_CreateObject();
    if (params != NULL && add_params(params, "", spec, options))
        return put(entry, name, params);
    cJSON_Delete(params);
    return false;
}

static bool put_build_params(cJSON *entry, const bb_build_record *build)
{
    if (build->stage_count == 0)
        return put_params(entry, "params", build->spec, build->options);
    cJSON *params = cJSON_CreateObject();
    bool ok = params != NULL;
    for (uint32_t i = 0; ok && i < build->stage_count; i++)
        ok = add_params(params, build->stages[i].label, build->stages[i].spec,
                        build->stages[i].options);
    if (ok)
        return put(entry, "params", params);
    cJSON_Delete(params);
    return false;
}

/* Of a pipeline; else there are none. */
static bool put_steps(cJSON *entry, const bb_build_record *build)
{
    if (build->step_count == 0)
        return true;
    cJSON *ms = cJSON_AddObjectToObject(entry, "stages_ms");
    cJSON *samples = cJSON_AddObjectToObject(entry, "stages_ms_samples");
    bool ok = ms != NULL && samples != NULL;
    for (uint32_t i = 0; ok && i < build->step_count; i++)
        ok = put_number(ms, build->steps[i].name, bb_samples_median(&build->steps[i].ms)) &&
             put_samples(samples, build->steps[i].name, &build->steps[i].ms);
    return ok;
}

static bool put_build_times(cJSON *entry, const bb_samples *ms)
{
    return put_samples(entry, "build_ms", ms) &&
           put_number(entry, "build_ms_median", bb_samples_median(ms)) &&
           bb_put_build_spread(entry, ms);
}

static bool put_tree(cJSON *entry, const bb_build_record *build)
{
    if (!build->has_tree)
        return put(entry, "tree", cJSON_CreateNull());
    cJSON *tree = cJSON_CreateObject();
    bool ok = tree != NULL && put_number(tree, "nodes", build->tree.node_count) &&
              put_number(tree, "leaves", build->tree.leaf_count) &&
              put_number(tree, "refs", build->tree.ref_count) &&
              put_number(tree, "arity", build->tree.arity) &&
              put_number(tree, "depth", build->tree.depth) &&
              put_size(tree, "bytes_tree", build->bytes_tree) &&
              put_size(tree, "bytes_peak", build->bytes_peak) &&
              put_number(tree, "sah", build->sah) && put_number(tree, "epo", build->epo) &&
              put_number(tree, "epo_half", build->epo_half);
    if (ok)
        return put(entry, "tree", tree);
    cJSON_Delete(tree);
    return false;
}

static bool put_layouts(cJSON *entry, const bb_build_record *build)
{
    cJSON *ms = cJSON_AddObjectToObject(entry, "layouts_ms");
    cJSON *samples = cJSON_AddObjectToObject(entry, "layouts_ms_samples");
    cJSON *sah = cJSON_AddObjectToObject(entry, "layouts_sah");
    bool ok = ms != NULL && samples != NULL && sah != NULL;
    for (uint32_t i = 0; ok && i < build->layout_count; i++) {
        const char *name = build->layouts[i].name;
        ok = put_number(ms, name, bb_samples_median(&build->layouts[i].ms)) &&
             put_samples(samples, name, &build->layouts[i].ms) &&
             put_number(sah, name, build->layouts[i].sah);
    }
    return ok;
}

uint32_t bb_results_next_build(const bb_results *results)
{
    uint32_t next = 0;
    const cJSON *build;
    cJSON_ArrayForEach(build, cJSON_GetObjectItemCaseSensitive(results->root, "builds"))
    {
        uint32_t id = (uint32_t)bb_json_number(build, "id");
        next = id < next ? next : id + 1;
    }
    return next;
}

bb_status bb_results_add_build(bb_results *results, const bb_build_record *build)
{
    if (bb_results_build(results, build->id) != NULL)
        return bb_fail(BB_INVALID, "build %u is in the results already", build->id);
    double prims = bb_json_number(bb_results_scene(results, build->scene), "prims");
    double rate = prims / bb_samples_median(&build->build_ms) / 1e3;
    cJSON *entry = cJSON_CreateObject();
    bool ok = entry != NULL && put_number(entry, "id", build->id) &&
              put_text(entry, "scene", build->scene) &&
              put_text(entry, "builder", build->spec->text) && put_build_params(entry, build) &&
              put_status(entry, build->status, build->reason) &&
              put_build_times(entry, &build->build_ms) && put_number(entry, "mprims_s", rate) &&
              put_number(entry, "cold_ms", measured(build->status, build->cold_ms)) &&
              put_steps(entry, build) &&
              put_named(entry, "phases_ms", build->phases, build->phase_count) &&
              put_samples(entry, "event_ms_samples", &build->event_ms) &&
              put_samples(entry, "cpu_ms_samples", &build->cpu_ms) &&
              put_number(entry, "prepare_ms", measured(build->status, build->prepare_ms)) &&
              put_repeats(entry, "restore_ms", &build->restore_ms) &&
              put_repeats(entry, "outside_ms", &build->outside_ms) &&
              put_text(entry, "inputs", build->inputs) &&
              put_number(entry, "boxes_ms", measured(build->status, build->boxes_ms)) &&
              put_repeats(entry, "transfer_ms", &build->transfer_ms) && put_layouts(entry, build) &&
              put_tree(entry, build) && put_number(entry, "bytes_native", build->bytes_native) &&
              put_bool(entry, "reference", build->reference);
    if (ok && build->about[0] != '\0')
        ok = put_text(entry, "about", build->about);
    return append(results, "builds", entry, ok);
}

/* ---- traces ---- */

static bool put_accuracy(cJSON *entry, const bb_trace_record *trace)
{
    if (!trace->has_accuracy)
        return put(entry, "accuracy", cJSON_CreateNull());
    const bb_accuracy *accuracy = &trace->accuracy;
    cJSON *inner = cJSON_CreateObject();
    bool ok =
        inner != NULL && put_number(inner, "checked", (double)accuracy->checked) &&
        put_number(inner, "wrong_ppm", accuracy->checked > 0 ? accuracy->wrong_ppm : (double)NAN) &&
        put_number(inner, "missed", (double)accuracy->missed) &&
        put_number(inner, "false", (double)accuracy->false_hits) &&
        put_number(inner, "wrong_t", (double)accuracy->wrong_t) &&
        put_number(inner, "unwritten", (double)accuracy->unwritten) &&
        put_number(inner, "right", (double)accuracy->right) &&
        put_number(inner, "ties", (double)accuracy->ties) &&
        put_number(inner, "margin_limited", (double)accuracy->margin_limited) &&
        put_number(inner, "t_off", (double)accuracy->t_off) &&
        put_number(inner, "oracle_wrong", (double)accuracy->oracle_wrong) &&
        put_number(inner, "forgiven", (double)accuracy->forgiven) &&
        put_number(inner, "arbitrated", (double)accuracy->arbitrated) &&
        put_number(inner, "t_ulp_max", accuracy->t_ulp_max) &&
        put_number(inner, "t_ulp_p99", accuracy->t_ulp_p99) &&
        put_number(inner, "overflowed",
                   trace->counted > 0 ? (double)trace->overflowed : (double)NAN) &&
        put(inner, "first_wrong",
            accuracy->first_wrong == BB_NONE ? cJSON_CreateNull()
                                             : cJSON_CreateNumber(accuracy->first_wrong)) &&
        put_number(inner, "judge_ms", accuracy->judge_ms);
    if (ok)
        return put(entry, "accuracy", inner);
    cJSON_Delete(inner);
    return false;
}

/* A rate that was given has no samples, thus neither interval nor range. */
static bool put_rate(cJSON *entry, const bb_trace_record *trace)
{
    double median = bb_samples_median(&trace->ms), rate = trace->mrays_s_given;
    bool given = rate > 0;
    if (!given)
        rate = trace->count / median / 1e3;
    return put_samples(entry, "ms", &trace->ms) && put_number(entry, "ms_median", median) &&
           put_number(entry, "event_ms", bb_samples_median(&trace->event_ms)) &&
           put_samples(entry, "event_ms_samples", &trace->event_ms) &&
           put_number(entry, "cpu_ms", bb_samples_median(&trace->cpu_ms)) &&
           put_samples(entry, "cpu_ms_samples", &trace->cpu_ms) &&
           put_number(entry, "mrays_s", rate) && put_bool(entry, "mrays_s_given", given) &&
           bb_put_rate_spread(entry, &trace->ms);
}

bb_status bb_results_add_trace(bb_results *results, const bb_trace_record *trace)
{
    if (bb_results_build(results, trace->build) == NULL)
        return bb_fail(BB_INVALID, "a trace names build %u, which is not in the results",
                       trace->build);
    cJSON *entry = cJSON_CreateObject();
    bool ok =
        entry != NULL && put_number(entry, "build", trace->build) &&
        put_text(entry, "scene", trace->scene) && put_text(entry, "view", trace->view) &&
        put_text(entry, "builder", trace->builder) && put_text(entry, "kernel", trace->kernel) &&
        put_text(entry, "layout", trace->layout) &&
        (trace->layout[0] != '\0' ? put_bool(entry, "native", trace->native)
                                  : cJSON_AddNullToObject(entry, "native") != NULL) &&
        put_text(entry, "intersector", trace->intersector) &&
        put_text(entry, "rays", trace->rays) &&
        put_text(entry, "rays_source", trace->rays_as_given ? "as given" : "workload") &&
        put_text(entry, "query", trace->query != NULL ? trace->query->name : "") &&
        put_number(entry, "count", trace->count) &&
        put_hash(entry, "rays_hash", trace->rays_hash) &&
        (trace->rays_spec == NULL ||
         put_params(entry, "rays_params", trace->rays_spec, trace->rays_options)) &&
        put_size(entry, "group_size", trace->group_size) &&
        put_size(entry, "stack_size", trace->stack_size) &&
        put_status(entry, trace->status, trace->reason) && put_rate(entry, trace) &&
        put_number(entry, "node_tests_per_ray",
                   measured(trace->status, trace->node_tests_per_ray)) &&
        put_number(entry, "prim_tests_per_ray",
                   measured(trace->status, trace->prim_tests_per_ray)) &&
        put_size(entry, "counted", trace->counted) && put_accuracy(entry, trace) &&
        put_number(entry, "unlike",
                   trace->unlike_whom[0] != '\0' ? (double)trace->unlike : (double)NAN) &&
        put_text(entry, "unlike_whom", trace->unlike_whom) &&
        put_bool(entry, "counts_for_exit", trace->counts_for_exit) &&
        put_bool(entry, "wrong", trace->wrong) && put_bool(entry, "reference", trace->reference);
    return append(results, "traces", entry, ok);
}

/* ---- times, skipped sets, pictures ---- */

bb_status bb_results_add_step(bb_results *results, const char *name, double ms)
{
    cJSON *steps = cJSON_GetObjectItemCaseSensitive(results->root, "steps_ms");
    cJSON *known = cJSON_GetObjectItemCaseSensitive(steps, name);
    if (known == NULL)
        return put_number(steps, name, ms) ? BB_OK : no_memory();
    cJSON_SetNumberValue(known, known->valuedouble + ms);
    return BB_OK;
}

bb_status bb_results_set_total(bb_results *results, double build_ms, double trace_ms,
                               double total_ms)
{
    double steps_ms = 0;
    const cJSON *step;
    cJSON_ArrayForEach(step, cJSON_GetObjectItemCaseSensitive(results->root, "steps_ms"))
    {
        if (cJSON_IsNumber(step))
            steps_ms += step->valuedouble;
    }
    const bb_named_ms times[] = {
        {"build", build_ms}, {"trace", trace_ms},
        {"steps", steps_ms}, {"other", total_ms - build_ms - trace_ms - steps_ms},
        {"total", total_ms},
    };
    cJSON_DeleteItemFromObjectCaseSensitive(results->root, "time_ms");
    return put_named(results->root, "time_ms", times, sizeof times / sizeof times[0]) ? BB_OK
                                                                                      : no_memory();
}

bb_status bb_results_add_skipped(bb_results *results, const char *scene, const char *rays,
                                 const char *view, const char *reason)
{
    cJSON *entry = cJSON_CreateObject();
    bool ok = entry != NULL && put_text(entry, "scene", scene) && put_text(entry, "rays", rays) &&
              put_text(entry, "view", view) && put_text(entry, "reason", reason);
    return append(results, "skipped", entry, ok);
}

bb_status bb_results_add_picture(bb_results *results, const char *scene, const char *view,
                                 const char *caption, const char *path)
{
    cJSON *entry = cJSON_CreateObject();
    bool ok = entry != NULL && put_text(entry, "scene", scene) && put_text(entry, "view", view) &&
              put_text(entry, "caption", caption) && put_text(entry, "path", path);
    return append(results, "pictures", entry, ok);
}

cJSON *bb_results_reproductions(bb_results *results)
{
    cJSON *all = cJSON_GetObjectItemCaseSensitive(results->root, "reproductions");
    return all != NULL ? all : cJSON_AddArrayToObject(results->root, "reproductions");
}
