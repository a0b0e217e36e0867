/* The result document, schema bvhbench-results/1: a cJSON tree that grows by one entry per record.
 * fields.h names its fields and says where they come from.
 */
#include "framework/record/record.h"
#include "framework/embree/embree.h"
#include "framework/record/record_private.h"
#include "framework/scene/prim.h"

#include <cjson/cJSON.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bb_status no_memory(void)
{
    return bb_fail(BB_FAILED, "result document: no memory");
}

void bb_build_record_init(bb_build_record *build)
{
    memset(build, 0, sizeof *build);
    build->cold_ms = build->prepare_ms = build->boxes_ms = NAN;
    build->bytes_native = NAN;
    for (uint32_t i = 0; i < BB_METRICS_MAX; i++)
        build->metrics[i] = (bb_metric_value){NAN, NAN};
    for (uint32_t i = 0; i < BB_LAYOUTS_MAX; i++)
        build->layouts[i].sah = NAN;
    for (uint32_t i = 0; i < BB_RECORD_STEPS_MAX; i++)
        build->steps[i].sah = NAN;
}

void bb_trace_record_init(bb_trace_record *trace)
{
    memset(trace, 0, sizeof *trace);
    trace->node_tests_per_ray = trace->prim_tests_per_ray = NAN;
    trace->accuracy.wrong_ppm = trace->accuracy.t_ulp_max = trace->accuracy.t_ulp_p99 = NAN;
    trace->accuracy.first_wrong = BB_NONE;
}

/* Appends a new entry to the array `section`, and fills it from its record. */
static bb_status append(bb_results *results, const char *section, bb_field_part part,
                        const void *record, const void *extra)
{
    cJSON *array = cJSON_GetObjectItemCaseSensitive(results->root, section);
    cJSON *entry = cJSON_CreateObject();
    if (entry != NULL && bb_put_part(entry, part, record, extra) &&
        (part != BB_IN_TRACE || bb_put_missing_key(entry)) && cJSON_AddItemToArray(array, entry))
        return BB_OK;
    cJSON_Delete(entry);
    return no_memory();
}

/* ---- the document ---- */

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
    bool ok = root != NULL && bb_put_text(root, "schema", BB_RESULTS_SCHEMA) &&
              bb_put_context(root, context, embree_version) == BB_OK &&
              bb_put(root, "scenes", cJSON_CreateArray()) &&
              bb_put(root, "builds", cJSON_CreateArray()) &&
              bb_put(root, "traces", cJSON_CreateArray()) &&
              bb_put(root, "steps_ms", cJSON_CreateObject()) &&
              bb_put(root, "skipped", cJSON_CreateArray()) &&
              bb_put(root, "pictures", cJSON_CreateArray());
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

const bb_section *bb_results_section(const bb_results *results, bb_section_id section)
{
    static const char *const names[BB_SECTIONS] = {"scenes",  "builds",   "traces",
                                                   "skipped", "pictures", "predictions",
                                                   "merged",  "steps_ms", "time_ms"};
    return cJSON_GetObjectItemCaseSensitive(results->root, names[section]);
}

const cJSON *bb_results_member(const bb_results *results, const char *name)
{
    return cJSON_GetObjectItemCaseSensitive(results->root, name);
}

const bb_entry *bb_results_context(const bb_results *results)
{
    return cJSON_GetObjectItemCaseSensitive(results->root, "context");
}

double bb_results_ms(const bb_results *results, bb_section_id section, const char *part)
{
    return bb_json_number(bb_results_section(results, section), part);
}

bool bb_device_is_like(const char *device, const char *type, const char *other,
                       const char *other_type)
{
    const bool processors =
        strcmp(type, BB_DEVICE_CPU) == 0 && strcmp(other_type, BB_DEVICE_CPU) == 0;
    return processors || strcmp(device, other) == 0;
}

const char *bb_results_reference(const bb_results *results)
{
    bb_each(trace, bb_results_section(results, BB_TRACES))
    {
        if (bb_get_text(trace, BB_F_TRACE_ON)[0] != '\0')
            return "Embree on the CPU";
    }
    return "Embree";
}

cJSON *bb_results_scene(const bb_results *results, const char *name)
{
    cJSON *scene;
    cJSON_ArrayForEach(scene, cJSON_GetObjectItemCaseSensitive(results->root, "scenes"))
    {
        if (strcmp(bb_get_text(scene, BB_F_SCENE_NAME), name) == 0)
            return scene;
    }
    return NULL;
}

cJSON *bb_results_build(const bb_results *results, uint32_t id)
{
    cJSON *build;
    cJSON_ArrayForEach(build, cJSON_GetObjectItemCaseSensitive(results->root, "builds"))
    {
        if (bb_get_number(build, BB_F_BUILD_ID) == (double)id)
            return build;
    }
    return NULL;
}

uint32_t bb_results_next_build(const bb_results *results)
{
    uint32_t next = 0;
    bb_each(build, bb_results_section(results, BB_BUILDS))
    {
        uint32_t id = (uint32_t)bb_get_number(build, BB_F_BUILD_ID);
        next = id < next ? next : id + 1;
    }
    return next;
}

/* ---- entries ---- */

bb_status bb_results_add_scene(bb_results *results, const bb_scene *scene,
                               const bb_samples *boxes_ms)
{
    char hash[17], kinds[64];
    bb_prim_kind_names(scene->kinds, kinds, sizeof kinds);
    snprintf(hash, sizeof hash, "%016llx", (unsigned long long)scene->hash);
    const bb_entry *known = bb_results_scene(results, scene->name);
    if (known == NULL)
        return append(results, "scenes", BB_IN_SCENE, scene, boxes_ms);
    if (strcmp(bb_get_text(known, BB_F_SCENE_HASH), hash) == 0)
        return BB_OK;
    return bb_fail(BB_INVALID, "scene %s is in the results already with other geometry",
                   scene->name);
}

bb_status bb_results_add_build(bb_results *results, const bb_build_record *build)
{
    if (bb_results_build(results, build->id) != NULL)
        return bb_fail(BB_INVALID, "build %u is in the results already", build->id);
    return append(results, "builds", BB_IN_BUILD, build, bb_results_scene(results, build->scene));
}

bb_status bb_results_add_trace(bb_results *results, const bb_trace_record *trace)
{
    if (bb_results_build(results, trace->build) == NULL)
        return bb_fail(BB_INVALID, "a trace names build %u, which is not in the results",
                       trace->build);
    return append(results, "traces", BB_IN_TRACE, trace, NULL);
}

bb_status bb_results_add_prediction(bb_results *results, const bb_prediction_record *prediction)
{
    if (bb_results_section(results, BB_PREDICTIONS) == NULL &&
        cJSON_AddArrayToObject(results->root, "predictions") == NULL)
        return no_memory();
    return append(results, "predictions", BB_IN_PREDICTION, prediction, NULL);
}

void bb_results_clear_predictions(bb_results *results)
{
    cJSON_DeleteItemFromObjectCaseSensitive(results->root, "predictions");
}

bb_status bb_results_add_skipped(bb_results *results, const char *scene, const char *rays,
                                 const char *view, const char *reason)
{
    const bb_note_record note = {.scene = scene, .rays = rays, .view = view, .reason = reason};
    return append(results, "skipped", BB_IN_SKIPPED, &note, NULL);
}

bb_status bb_results_add_picture(bb_results *results, const char *scene, const char *view,
                                 const char *caption, const char *path)
{
    const bb_note_record note = {.scene = scene, .view = view, .caption = caption, .path = path};
    return append(results, "pictures", BB_IN_PICTURE, &note, NULL);
}

cJSON *bb_results_reproductions(bb_results *results)
{
    cJSON *all = cJSON_GetObjectItemCaseSensitive(results->root, "reproductions");
    return all != NULL ? all : cJSON_AddArrayToObject(results->root, "reproductions");
}

/* ---- times ---- */

bb_status bb_results_add_step(bb_results *results, const char *name, double ms)
{
    cJSON *steps = cJSON_GetObjectItemCaseSensitive(results->root, "steps_ms");
    cJSON *known = cJSON_GetObjectItemCaseSensitive(steps, name);
    if (known == NULL)
        return bb_put_number(steps, name, ms) ? BB_OK : no_memory();
    cJSON_SetNumberValue(known, known->valuedouble + ms);
    return BB_OK;
}

bb_status bb_results_set_others(bb_results *results, double processors)
{
    cJSON *context = cJSON_GetObjectItemCaseSensitive(results->root, "context");
    const char *name = bb_fields[BB_F_CONTEXT_OTHERS].name;
    cJSON_DeleteItemFromObjectCaseSensitive(context, name);
    return bb_put_number(context, name, processors) ? BB_OK : no_memory();
}

bb_status bb_results_set_compiling(bb_results *results, const bb_compiling *compiling)
{
    cJSON *context = cJSON_GetObjectItemCaseSensitive(results->root, "context");
    bool ok = bb_put_number(context, bb_fields[BB_F_CONTEXT_PROGRAMS].name, compiling->programs) &&
              bb_put_number(context, bb_fields[BB_F_CONTEXT_COMPILE].name, compiling->ms) &&
              bb_put_text(context, bb_fields[BB_F_CONTEXT_CACHE].name, compiling->cache);
    return ok ? BB_OK : no_memory();
}

bb_status bb_results_set_shard(bb_results *results, const char *shard, uint64_t of)
{
    char hash[24];
    cJSON *context = cJSON_GetObjectItemCaseSensitive(results->root, "context");
    const char *name = bb_fields[BB_F_CONTEXT_SHARD].name;
    const char *whole = bb_fields[BB_F_CONTEXT_SHARD_OF].name;
    snprintf(hash, sizeof hash, "%016" PRIx64, of);
    cJSON_DeleteItemFromObjectCaseSensitive(context, name);
    cJSON_DeleteItemFromObjectCaseSensitive(context, whole);
    return bb_put_text(context, name, shard) && bb_put_text(context, whole, hash) ? BB_OK
                                                                                  : no_memory();
}

bb_status bb_results_set_interrupted(bb_results *results)
{
    cJSON *context = cJSON_GetObjectItemCaseSensitive(results->root, "context");
    const char *name = bb_fields[BB_F_CONTEXT_INTERRUPTED].name;
    cJSON_DeleteItemFromObjectCaseSensitive(context, name);
    return cJSON_AddTrueToObject(context, name) != NULL ? BB_OK : no_memory();
}

bb_status bb_results_set_total(bb_results *results, double build_ms, double trace_ms,
                               double total_ms)
{
    double steps_ms = 0;
    bb_each(step, bb_results_section(results, BB_STEPS))
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
    return bb_put_named(results->root, "time_ms", times, sizeof times / sizeof times[0])
               ? BB_OK
               : no_memory();
}
