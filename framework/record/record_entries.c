/* Fields of scenes, builds and traces that the table cannot describe: they follow from several
 * members of the record, or from other entries. */
#include "framework/record/record_private.h"

#include "framework/scene/prim.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* ---- scenes ---- */

bool bb_put_kinds(cJSON *object, const char *name, const void *record, const void *extra)
{
    (void)extra;
    char kinds[64];
    bb_prim_kind_names(((const bb_scene *)record)->kinds, kinds, sizeof kinds);
    return bb_put_text(object, name, kinds);
}

/* Puts "triangles": 12, "spheres": 0, and other kinds if the scene has them. */
bool bb_put_prims(cJSON *object, const char *name, const void *record, const void *extra)
{
    (void)name;
    (void)extra;
    const bb_scene *scene = record;
    bool ok = true;
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++)
        if (kind <= BB_SPHERE || scene->prims[kind].count > 0)
            ok = ok && bb_put_number(object, bb_prim_kinds[kind]->plural, scene->prims[kind].count);
    return ok;
}

bool bb_put_bounds(cJSON *object, const char *name, const void *record, const void *extra)
{
    (void)extra;
    const bb_box *box = &((const bb_scene *)record)->bounds;
    cJSON *bounds = cJSON_CreateObject();
    if (bounds == NULL)
        return false;
    double lo[3] = {box->lo[0], box->lo[1], box->lo[2]};
    double hi[3] = {box->hi[0], box->hi[1], box->hi[2]};
    if (bb_put_numbers(bounds, "lo", lo, 3) && bb_put_numbers(bounds, "hi", hi, 3))
        return bb_put(object, name, bounds);
    cJSON_Delete(bounds);
    return false;
}

bool bb_put_profile(cJSON *object, const char *name, const void *record, const void *extra)
{
    (void)extra;
    return bb_put_inner(object, name, BB_IN_PROFILE, record);
}

bool bb_put_closed(cJSON *object, const char *name, const void *record, const void *extra)
{
    (void)extra;
    int32_t closed = ((const bb_scene *)record)->profile.closed;
    return bb_put(object, name, closed < 0 ? cJSON_CreateNull() : cJSON_CreateBool(closed != 0));
}

/* Puts the median as NAME and all samples as NAME_samples. `extra`: the samples, or NULL. */
bool bb_put_boxes(cJSON *object, const char *name, const void *record, const void *extra)
{
    (void)record;
    const bb_samples none = {0}, *samples = extra != NULL ? extra : &none;
    return bb_put_number(object, name, bb_samples_median(samples)) &&
           bb_put_samples(object, bb_fields[BB_F_SCENE_BOXES_SAMPLES].name, samples);
}

bool bb_put_views(cJSON *object, const char *name, const void *record, const void *extra)
{
    (void)extra;
    const bb_scene *scene = record;
    cJSON *views = cJSON_CreateArray();
    bool ok = views != NULL;
    for (uint32_t i = 0; ok && i < scene->view_count; i++) {
        cJSON *view = cJSON_CreateString(scene->views[i].name);
        ok = view != NULL && cJSON_AddItemToArray(views, view);
        if (!ok)
            cJSON_Delete(view);
    }
    if (ok)
        return bb_put(object, name, views);
    cJSON_Delete(views);
    return false;
}

/* ---- builds ---- */

/* Adds all parameters: the given value, else the declared default, else null. `stage` stands before
 * their names. */
static bool add_params(cJSON *params, const char *stage, const bb_spec *spec,
                       const bb_option *options)
{
    bool ok = true;
    const char *separator = stage[0] != '\0' ? ": " : "";
    char name[128];
    for (const bb_option *option = options; ok && option != NULL && option->name != NULL;
         option++) {
        snprintf(name, sizeof name, "%s%s%s", stage, separator, option->name);
        ok = bb_put_text(params, name, bb_spec_value(spec, options, option->name));
    }
    for (uint32_t i = 0; ok && i < spec->param_count; i++) {
        snprintf(name, sizeof name, "%s%s%s", stage, separator, spec->keys[i]);
        if (cJSON_GetObjectItemCaseSensitive(params, name) == NULL)
            ok = bb_put_text(params, name, spec->values[i]);
    }
    return ok;
}

static bool put_params(cJSON *entry, const char *name, const bb_spec *spec,
                       const bb_option *options)
{
    cJSON *params = cJSON_CreateObject();
    if (params != NULL && add_params(params, "", spec, options))
        return bb_put(entry, name, params);
    cJSON_Delete(params);
    return false;
}

bool bb_put_builder(cJSON *object, const char *name, const void *record, const void *extra)
{
    (void)extra;
    return bb_put_text(object, name, ((const bb_build_record *)record)->spec->text);
}

bool bb_put_build_params(cJSON *object, const char *name, const void *record, const void *extra)
{
    (void)extra;
    const bb_build_record *build = record;
    if (build->stage_count == 0)
        return put_params(object, name, build->spec, build->options);
    cJSON *params = cJSON_CreateObject();
    bool ok = params != NULL;
    for (uint32_t i = 0; ok && i < build->stage_count; i++)
        ok = add_params(params, build->stages[i].label, build->stages[i].spec,
                        build->stages[i].options);
    if (ok)
        return bb_put(object, name, params);
    cJSON_Delete(params);
    return false;
}

/* Puts times, all samples, SAH and bytes of a pipeline's steps; nothing for a single builder. */
bool bb_put_steps(cJSON *object, const char *name, const void *record, const void *extra)
{
    (void)extra;
    const bb_build_record *build = record;
    if (build->step_count == 0)
        return true;
    cJSON *ms = cJSON_AddObjectToObject(object, name);
    cJSON *samples = cJSON_AddObjectToObject(object, bb_fields[BB_F_BUILD_STAGES_SAMPLES].name);
    cJSON *sah = cJSON_AddObjectToObject(object, bb_fields[BB_F_BUILD_STAGES_SAH].name);
    cJSON *bytes = cJSON_AddObjectToObject(object, bb_fields[BB_F_BUILD_STAGES_BYTES].name);
    cJSON *peak = cJSON_AddObjectToObject(object, bb_fields[BB_F_BUILD_STAGES_PEAK].name);
    bool ok = ms != NULL && samples != NULL && sah != NULL && bytes != NULL && peak != NULL;
    for (uint32_t i = 0; ok && i < build->step_count; i++) {
        const char *step = build->steps[i].name;
        ok = bb_put_number(ms, step, bb_samples_median(&build->steps[i].ms)) &&
             bb_put_samples(samples, step, &build->steps[i].ms) &&
             bb_put_number(sah, step, build->steps[i].sah) &&
             bb_put_size(bytes, step, build->steps[i].bytes) &&
             bb_put_size(peak, step, build->steps[i].bytes_peak);
    }
    return ok;
}

bool bb_put_build_times(cJSON *object, const char *name, const void *record, const void *extra)
{
    (void)name;
    (void)extra;
    return bb_put_build_spread(object, &((const bb_build_record *)record)->build_ms);
}

/* Puts primitives per second. `extra`: the scene's entry. */
bool bb_put_build_rate(cJSON *object, const char *name, const void *record, const void *extra)
{
    const bb_build_record *build = record;
    double prims = bb_get_number(extra, BB_F_SCENE_PRIMS);
    return bb_put_number(object, name, prims / bb_samples_median(&build->build_ms) / 1e3);
}

bool bb_put_phases(cJSON *object, const char *name, const void *record, const void *extra)
{
    (void)extra;
    const bb_build_record *build = record;
    return bb_put_named(object, name, build->phases, build->phase_count);
}

/* Puts times, all samples, SAH and bytes of the layouts. */
bool bb_put_layouts(cJSON *object, const char *name, const void *record, const void *extra)
{
    (void)extra;
    const bb_build_record *build = record;
    cJSON *ms = cJSON_AddObjectToObject(object, name);
    cJSON *samples = cJSON_AddObjectToObject(object, bb_fields[BB_F_BUILD_LAYOUTS_SAMPLES].name);
    cJSON *sah = cJSON_AddObjectToObject(object, bb_fields[BB_F_BUILD_LAYOUTS_SAH].name);
    cJSON *bytes = cJSON_AddObjectToObject(object, bb_fields[BB_F_BUILD_LAYOUTS_BYTES].name);
    bool ok = ms != NULL && samples != NULL && sah != NULL && bytes != NULL;
    for (uint32_t i = 0; ok && i < build->layout_count; i++) {
        const char *layout = build->layouts[i].name;
        ok = bb_put_number(ms, layout, bb_samples_median(&build->layouts[i].ms)) &&
             bb_put_samples(samples, layout, &build->layouts[i].ms) &&
             bb_put_number(sah, layout, build->layouts[i].sah) &&
             bb_put_size(bytes, layout, build->layouts[i].bytes);
    }
    return ok;
}

/* Puts the time before the first ray, from members that were put before. A reference has no
 * layouts. */
bool bb_put_first_ray(cJSON *object, const char *name, const void *record, const void *extra)
{
    (void)record;
    (void)extra;
    cJSON *ms = cJSON_AddObjectToObject(object, name);
    bool ok = ms != NULL;
    bb_each_part(layout, object, BB_F_BUILD_LAYOUTS_MS)
    {
        const char *of = bb_part_name(layout);
        ok = ok && bb_put_number(ms, of, bb_first_ray_ms(object, of));
    }
    return ok;
}

static bool put_metric(cJSON *tree, const bb_metric *metric, const bb_metric_value *measured)
{
    char half[BB_METRIC_FIELD];
    bb_metric_half_name(metric, half);
    return bb_put_number(tree, metric->name, measured->value) &&
           (!metric->sampled || bb_put_number(tree, half, measured->half));
}

/* Puts the fields of a tree, the metrics that are always measured, and then those on request. */
bool bb_put_tree(cJSON *object, const char *name, const void *record, const void *extra)
{
    (void)extra;
    const bb_build_record *build = record;
    if (!build->has_tree)
        return bb_put(object, name, cJSON_CreateNull());
    cJSON *tree = cJSON_CreateObject();
    bool ok = tree != NULL && bb_put_part(tree, BB_IN_TREE, record, NULL);
    for (uint32_t i = 0; ok && i < 2 * bb_metric_count(); i++) {
        uint32_t m = i % bb_metric_count();
        if (bb_metrics[m]->on_request == (i >= bb_metric_count()))
            ok = put_metric(tree, bb_metrics[m], &build->metrics[m]);
    }
    if (ok)
        return bb_put(object, name, tree);
    cJSON_Delete(tree);
    return false;
}

/* ---- traces ---- */

bool bb_put_native(cJSON *object, const char *name, const void *record, const void *extra)
{
    (void)extra;
    const bb_trace_record *trace = record;
    return bb_put(object, name,
                  trace->layout[0] != '\0' ? cJSON_CreateBool(trace->native) : cJSON_CreateNull());
}

bool bb_put_rays_source(cJSON *object, const char *name, const void *record, const void *extra)
{
    (void)extra;
    return bb_put_text(object, name,
                       ((const bb_trace_record *)record)->rays_as_given ? "as given" : "workload");
}

bool bb_put_query(cJSON *object, const char *name, const void *record, const void *extra)
{
    (void)extra;
    const bb_query *query = ((const bb_trace_record *)record)->query;
    return bb_put_text(object, name, query != NULL ? query->name : "");
}

bool bb_put_rays_params(cJSON *object, const char *name, const void *record, const void *extra)
{
    (void)extra;
    const bb_trace_record *trace = record;
    return trace->rays_spec == NULL ||
           put_params(object, name, trace->rays_spec, trace->rays_options);
}

/* Puts the rate. A given rate has no samples, so neither interval nor range. */
bool bb_put_rate(cJSON *object, const char *name, const void *record, const void *extra)
{
    (void)extra;
    const bb_trace_record *trace = record;
    double rate = trace->mrays_s_given;
    bool given = rate > 0;
    if (!given)
        rate = trace->count / bb_samples_median(&trace->ms) / 1e3;
    return bb_put_number(object, name, rate) &&
           bb_put(object, bb_fields[BB_F_TRACE_RATE_GIVEN].name, cJSON_CreateBool(given)) &&
           bb_put_rate_spread(object, &trace->ms);
}

/* Returns the tests weighted by their costs in SAH. A binary node, which has two boxes, costs 1.2;
 * a wide node costs children/2 times as much, as in SAH. */
static double work_of(double boxes, double prims)
{
    return BB_COST_TRAVERSAL * 0.5 * boxes + BB_COST_INTERSECTION * prims;
}

bool bb_put_work(cJSON *object, const char *name, const void *record, const void *extra)
{
    (void)extra;
    const bb_trace_record *trace = record;
    return bb_put_number(object, name,
                         trace->status == BB_OK
                             ? work_of(trace->node_tests_per_ray, trace->prim_tests_per_ray)
                             : (double)NAN);
}

bool bb_put_accuracy(cJSON *object, const char *name, const void *record, const void *extra)
{
    (void)extra;
    const bb_trace_record *trace = record;
    return trace->has_accuracy ? bb_put_inner(object, name, BB_IN_ACCURACY, record)
                               : bb_put(object, name, cJSON_CreateNull());
}

bool bb_put_unlike(cJSON *object, const char *name, const void *record, const void *extra)
{
    (void)extra;
    const bb_trace_record *trace = record;
    return bb_put_number(object, name,
                         trace->unlike_whom[0] != '\0' ? (double)trace->unlike : (double)NAN);
}

bool bb_put_wrong_ppm(cJSON *object, const char *name, const void *record, const void *extra)
{
    (void)extra;
    const bb_accuracy *accuracy = &((const bb_trace_record *)record)->accuracy;
    return bb_put_number(object, name, accuracy->checked > 0 ? accuracy->wrong_ppm : (double)NAN);
}

bool bb_put_overflowed(cJSON *object, const char *name, const void *record, const void *extra)
{
    (void)extra;
    const bb_trace_record *trace = record;
    return bb_put_number(object, name,
                         trace->counted > 0 ? (double)trace->overflowed : (double)NAN);
}

bool bb_put_first_wrong(cJSON *object, const char *name, const void *record, const void *extra)
{
    (void)extra;
    uint32_t first = ((const bb_trace_record *)record)->accuracy.first_wrong;
    return bb_put_number(object, name, first == BB_NONE ? (double)NAN : (double)first);
}

bool bb_put_missing_key(cJSON *trace)
{
    char key[BB_CELL_KEY];
    const char *name = bb_fields[BB_F_TRACE_CELL].name;
    const char *hash = bb_get_text(trace, BB_F_TRACE_RAYS_HASH);
    bb_cell_parts cell = {.known_by_hash = true, .rays_hash = strtoull(hash, NULL, 16)};
    if (bb_get_text(trace, BB_F_TRACE_CELL)[0] != '\0')
        return true;
    snprintf(cell.scene, sizeof cell.scene, "%s", bb_get_text(trace, BB_F_TRACE_SCENE));
    snprintf(cell.rays, sizeof cell.rays, "%s", bb_get_text(trace, BB_F_TRACE_RAYS));
    snprintf(cell.view, sizeof cell.view, "%s", bb_get_text(trace, BB_F_TRACE_VIEW));
    snprintf(cell.builder, sizeof cell.builder, "%s", bb_get_text(trace, BB_F_TRACE_BUILDER));
    if (!bb_get_true(trace, BB_F_TRACE_REFERENCE)) {
        snprintf(cell.kernel, sizeof cell.kernel, "%s", bb_get_text(trace, BB_F_TRACE_KERNEL));
        snprintf(cell.intersector, sizeof cell.intersector, "%s",
                 bb_get_text(trace, BB_F_TRACE_INTERSECTOR));
    }
    bb_cell_canonical(&cell);
    cJSON_DeleteItemFromObjectCaseSensitive(trace, name);
    return bb_cell_key_format(&cell, key) != BB_OK ||
           cJSON_AddStringToObject(trace, name, key) != NULL;
}
