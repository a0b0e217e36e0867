/* Results in memory: a table, whose rows are the entries of sections. */
#include "framework/record/record.h"

#include "framework/device/run_row.h"
#include "framework/judge/embree.h"
#include "framework/record/record_private.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bb_status no_memory(void)
{
    return bb_fail(BB_REFUSED, "no memory for results");
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

/* ---- results ---- */

bb_status bb_results_make(bb_results **out)
{
    *out = NULL;
    bb_results *results = calloc(1, sizeof *results);
    if (results == NULL)
        return no_memory();
    bb_status status = bb_table_create("run", &results->table);
    if (status != BB_OK) {
        free(results);
        return status;
    }
    *out = results;
    return BB_OK;
}

bb_status bb_results_create(const bb_context *about, bb_results **out)
{
    bb_results *results;
    char embree_version[32];
    *out = NULL;
    BB_TRY(bb_embree_version(embree_version, sizeof embree_version));
    BB_TRY(bb_results_make(&results));
    const uint32_t row = bb_run_row(results->table, about->device, about->seed, about->command);
    bb_status status = bb_table_status(results->table);
    if (status == BB_OK)
        status = bb_results_enter(results, row);
    if (status == BB_OK) {
        bb_put_text(results->context, BB_F_CONTEXT_EMBREE, embree_version);
        bb_put_text(results->context, BB_F_CONTEXT_EMBREE_API, BB_EMBREE_API);
        status = bb_table_status(results->table);
    }
    if (status == BB_OK)
        *out = results;
    else
        bb_results_destroy(results);
    return status;
}

static void empty(bb_results *results)
{
    for (uint32_t i = 0; i < results->entry_count; i++)
        free(results->entries[i]);
    free(results->entries);
    bb_table_free(results->table);
}

void bb_results_destroy(bb_results *results)
{
    if (results == NULL)
        return;
    empty(results);
    free(results);
}

void bb_results_replace(bb_results *results, bb_results *made)
{
    empty(results);
    *results = *made;
    free(made);
}

const bb_table *bb_results_table(const bb_results *results)
{
    return results->table;
}

const bb_section *bb_results_section(const bb_results *results, bb_section_id section)
{
    return &results->sections[section];
}

const bb_entry *bb_results_context(const bb_results *results)
{
    return results->context;
}

double bb_results_step_ms(const bb_results *results, const char *step)
{
    return bb_get_number(bb_results_find(results, (bb_cell){{[BB_MAKER] = step}}), BB_F_STEP_MS);
}

double bb_results_time_ms(const bb_results *results, const char *part)
{
    return bb_get_number(bb_results_find(results, (bb_cell){{[BB_MAKER] = part}}), BB_F_STEP_TIME);
}

bb_entry *bb_results_find(const bb_results *results, bb_cell cell)
{
    const uint32_t row = bb_table_find(results->table, cell);
    return row < results->entry_count ? results->entries[row] : NULL;
}

const bb_entry *bb_results_scene(const bb_results *results, const char *name)
{
    return bb_results_find(results, (bb_cell){{[BB_SCENE] = name}});
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

uint32_t bb_results_simulations(const bb_results *results, const char *names[BB_SIMT_MAX])
{
    uint32_t count = 0;
    bb_each(trace, bb_results_section(results, BB_TRACES))
    {
        bb_each_part(part, trace, BB_F_SIMT_RATE)
        {
            uint32_t i = 0;
            while (i < count && strcmp(names[i], bb_part_name(part)) != 0)
                i++;
            if (i == count && count < BB_SIMT_MAX)
                names[count++] = bb_part_name(part);
        }
    }
    return count;
}

bool bb_get_simulation(const bb_entry *trace, const char *name, bb_simulation *s)
{
    *s = (bb_simulation){.binds = bb_binding_of(bb_get_named_text(trace, BB_F_SIMT_BINDS, name))};
#define SIMT(id, member, name_in_file, unit, better, heading, help)                                \
    s->member = bb_get_named(trace, BB_F_SIMT_##id, name);
#include "framework/simulate/simt_figures.h"
    return isfinite(s->mrays_s);
}

/* ---- runs ---- */

uint32_t bb_results_begin_run(bb_results *results)
{
    const bb_entry *last = results->sections[BB_BUILDS].last;
    if (last != NULL && bb_run_of(last) == results->run)
        results->run = bb_table_runs(results->table);
    return results->run;
}

/* ---- entries ---- */

bb_entry *bb_results_entry(bb_results *results, bb_cell cell)
{
    const uint32_t row = bb_table_row(results->table, cell);
    bb_status status = bb_table_status(results->table);
    if (status == BB_OK)
        status = bb_results_enter(results, row);
    if (results->status == BB_OK)
        results->status = status;
    return status == BB_OK ? results->entries[row] : NULL;
}

/* Of an entry, and of the values that were put into it. */
static bb_status status_of(const bb_results *results)
{
    return results->status != BB_OK ? results->status : bb_table_status(results->table);
}

bb_entry *bb_results_part(bb_results *results, const bb_entry *entry, const char *name)
{
    bb_cell cell = bb_table_cell(results->table, entry->row);
    cell.names[BB_MAKER] = name;
    return bb_results_entry(results, cell);
}

/* Adds the entry of a cell and fills it from its record. */
static bb_status add(bb_results *results, bb_cell cell, bb_field_part part, const void *record,
                     const void *extra, bb_entry **out)
{
    bb_entry *entry = bb_results_entry(results, cell);
    if (entry == NULL)
        return results->status;
    bb_put_part(&(bb_put){results, entry, record, extra}, part);
    *out = entry;
    return status_of(results);
}

bb_status bb_results_add_scene(bb_results *results, const bb_scene *scene,
                               const bb_samples *boxes_ms)
{
    char hash[17];
    bb_entry *entry = NULL;
    snprintf(hash, sizeof hash, "%016llx", (unsigned long long)scene->hash);
    const bb_entry *known = bb_results_scene(results, scene->name);
    if (known != NULL)
        return strcmp(bb_get_text(known, BB_F_SCENE_HASH), hash) == 0
                   ? BB_OK
                   : bb_fail(BB_INVALID, "scene %s is in the results already with other geometry",
                             scene->name);
    BB_TRY(
        add(results, (bb_cell){{[BB_SCENE] = scene->name}}, BB_IN_SCENE, scene, boxes_ms, &entry));
    bb_put_part(&(bb_put){results, entry, scene, NULL}, BB_IN_PROFILE);
    return status_of(results);
}

/* The cell of what the present run adds. */
static bb_cell cell_of(const bb_results *results, char run[16], const char *scene,
                       const char *builder)
{
    return (bb_cell){
        {[BB_RUN] = bb_run_name(results->run, run), [BB_SCENE] = scene, [BB_BUILDER] = builder}};
}

bb_status bb_results_add_build(bb_results *results, const bb_build_record *build)
{
    char run[16];
    bb_entry *entry = NULL;
    const bb_cell cell = cell_of(results, run, build->scene, build->spec->text);
    if (bb_results_find(results, cell) != NULL)
        return bb_fail(BB_INVALID, "the build of %.200s on %.200s is in the results already",
                       build->spec->text, build->scene);
    BB_TRY(add(results, cell, BB_IN_BUILD, build, NULL, &entry));
    if (build->has_tree)
        bb_put_tree(results, entry, build);
    return status_of(results);
}

bb_status bb_results_add_trace(bb_results *results, const bb_trace_record *trace)
{
    char run[16];
    bb_entry *entry = NULL;
    bb_cell cell = cell_of(results, run, trace->scene, trace->builder);
    if (bb_results_find(results, cell) == NULL)
        return bb_fail(BB_INVALID,
                       "a trace names a build of %.200s on %.200s, which is not in the "
                       "results",
                       trace->builder, trace->scene);
    cell.names[BB_QUESTION] = trace->rays;
    cell.names[BB_VIEW] = trace->view;
    cell.names[BB_KERNEL] = trace->kernel;
    cell.names[BB_INTERSECTOR] = trace->intersector;
    if (bb_results_find(results, cell) != NULL)
        return bb_fail(BB_INVALID,
                       "%.200s on %.200s, %.100s by %.100s: the trace is in the results already",
                       trace->builder, trace->scene, trace->rays, trace->kernel);
    BB_TRY(add(results, cell, BB_IN_TRACE, trace, NULL, &entry));
    if (trace->has_accuracy)
        bb_put_part(&(bb_put){results, entry, trace, NULL}, BB_IN_ACCURACY);
    bb_put_missing_key(entry);
    return status_of(results);
}

bb_status bb_results_add_prediction(bb_results *results, const bb_prediction_record *prediction)
{
    bb_entry *entry = NULL;
    return add(results, (bb_cell){{[BB_QUESTION] = prediction->rays}}, BB_IN_PREDICTION, prediction,
               NULL, &entry);
}

void bb_results_clear_predictions(bb_results *results)
{
    for (bb_entry *entry = results->sections[BB_PREDICTIONS].first; entry != NULL;
         entry = entry->next)
        for (int id = 0; id < BB_FIELDS; id++)
            if (bb_fields[id].part == BB_IN_PREDICTION && bb_fields[id].kind == BB_FIELD_NUMBER)
                bb_put_number(entry, (bb_field_id)id, (double)NAN);
}

bb_status bb_results_add_skipped(bb_results *results, const char *scene, const char *rays,
                                 const char *view, const char *reason)
{
    char run[16];
    bb_cell cell = cell_of(results, run, scene, NULL);
    cell.names[BB_QUESTION] = rays;
    cell.names[BB_VIEW] = view;
    bb_entry *entry = bb_results_entry(results, cell);
    bb_put_text(entry, BB_F_SKIPPED_REASON, reason);
    return status_of(results);
}

bb_status bb_results_add_picture(bb_results *results, const char *scene, const char *view,
                                 const char *caption, const char *path)
{
    char run[16];
    bb_cell cell = cell_of(results, run, scene, NULL);
    cell.names[BB_VIEW] = view;
    cell.names[BB_FRAME] = path;
    bb_entry *entry = bb_results_entry(results, cell);
    bb_put_text(entry, BB_F_PICTURE_CAPTION, caption);
    return status_of(results);
}

bb_status bb_results_locate_pictures(bb_results *results, const char *folder)
{
    for (bb_entry *entry = results->sections[BB_PICTURES].first; entry != NULL; entry = entry->next)
        bb_put_text(entry, BB_F_PICTURE_FOLDER, folder);
    return status_of(results);
}

/* ---- times ---- */

bb_status bb_results_add_step(bb_results *results, const char *name, double ms)
{
    bb_entry *step = bb_results_entry(results, (bb_cell){{[BB_MAKER] = name}});
    const double known = bb_get_number(step, BB_F_STEP_MS);
    bb_put_number(step, BB_F_STEP_MS, ms + (isfinite(known) ? known : 0));
    return status_of(results);
}

bb_status bb_results_set_total(bb_results *results, double build_ms, double trace_ms,
                               double total_ms)
{
    double steps_ms = 0;
    bb_each(step, bb_results_section(results, BB_STEPS))
    {
        const double ms = bb_get_number(step, BB_F_STEP_MS);
        steps_ms += isfinite(ms) ? ms : 0;
    }
    const bb_named_ms times[] = {
        {"build", build_ms}, {"trace", trace_ms},
        {"steps", steps_ms}, {"other", total_ms - build_ms - trace_ms - steps_ms},
        {"total", total_ms},
    };
    for (size_t i = 0; i < sizeof times / sizeof times[0]; i++) /* NAN: all or none */
        bb_put_number(bb_results_entry(results, (bb_cell){{[BB_MAKER] = times[i].name}}),
                      BB_F_STEP_TIME, isfinite(total_ms) ? times[i].ms : (double)NAN);
    return status_of(results);
}

/* ---- the context ---- */

bb_status bb_results_set_number(bb_results *results, bb_field_id field, double value)
{
    bb_put_number(results->context, field, value);
    return status_of(results);
}

bb_status bb_results_set_text(bb_results *results, bb_field_id field, const char *value)
{
    bb_put_text(results->context, field, value);
    return status_of(results);
}

bb_status bb_results_set_compiling(bb_results *results, const bb_compiling *compiling)
{
    bb_put_number(results->context, BB_F_CONTEXT_PROGRAMS, compiling->programs);
    bb_put_number(results->context, BB_F_CONTEXT_COMPILE, compiling->ms);
    return bb_results_set_text(results, BB_F_CONTEXT_CACHE, compiling->cache);
}

bb_status bb_results_set_shard(bb_results *results, const char *shard, uint64_t of)
{
    char hash[24];
    snprintf(hash, sizeof hash, "%016" PRIx64, of);
    bb_put_text(results->context, BB_F_CONTEXT_SHARD, shard);
    return bb_results_set_text(results, BB_F_CONTEXT_SHARD_OF, hash);
}

bb_status bb_results_set_interrupted(bb_results *results)
{
    return bb_results_set_text(results, BB_F_CONTEXT_INTERRUPTED, "yes");
}
