/* Fields of scenes, builds and traces that the table cannot describe: they follow from several
 * members of the record, or stand in rows of their own. */
#include "framework/record/record_private.h"

#include "framework/scene/needs.h"
#include "framework/scene/prim.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Puts each decision into a row of its own. */
static void put_decisions(bb_results *results, const bb_entry *entry, const bb_decisions *list)
{
    for (uint32_t i = 0; i < list->count; i++) {
        bb_entry *part = bb_results_part(results, entry, list->items[i].what);
        bb_put_text(part, BB_F_BUILD_DECISIONS, list->items[i].value);
        bb_put_text(part, BB_F_DECIDED_BY, bb_decider_word(list->items[i].by));
        bb_put_text(part, BB_F_DECIDED_FIGURE, list->items[i].figure);
    }
}

/* ---- scenes ---- */

void bb_put_kinds(const bb_put *p)
{
    char kinds[64];
    bb_prim_kind_names(((const bb_scene *)p->record)->kinds, kinds, sizeof kinds);
    bb_put_text(p->entry, BB_F_SCENE_KIND, kinds);
}

/* Puts the numbers of triangles and of spheres, and of other kinds if the scene has them. */
void bb_put_prims(const bb_put *p)
{
    static bb_column columns[BB_KIND_COUNT];
    const bb_scene *scene = p->record;
    bb_put_number(p->entry, BB_F_SCENE_PRIMS, scene->prim_count);
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++) {
        const char *name = bb_prim_kinds[kind]->plural;
        columns[kind] = (bb_column){.name = name, .heading = name, .unit = "", .help = ""};
        if (kind <= BB_SPHERE || scene->prims[kind].count > 0)
            bb_table_set_number(p->results->table, p->entry->row, &columns[kind],
                                scene->prims[kind].count);
    }
}

/* Puts what the scene needs, if its profile was measured. */
void bb_put_needs(const bb_put *p)
{
    const bb_scene *scene = p->record;
    bb_decisions needs = {0};
    if (scene->profile.measured)
        bb_scene_needs(scene, &needs);
    put_decisions(p->results, p->entry, &needs);
}

void bb_put_closed(const bb_put *p)
{
    const int32_t closed = ((const bb_scene *)p->record)->profile.closed;
    if (closed >= 0)
        bb_put_flag(p->entry, BB_F_PROFILE_CLOSED, closed != 0);
}

/* Puts nothing if 64 bits do not separate the centroids. */
void bb_put_bits(const bb_put *p)
{
    const uint32_t bits = ((const bb_scene *)p->record)->profile.bits_apart;
    bb_put_number(p->entry, BB_F_PROFILE_BITS_APART, bits < BB_BITS_NONE ? bits : (double)NAN);
}

/* `extra`: the samples, or NULL. */
void bb_put_boxes(const bb_put *p)
{
    if (p->extra != NULL)
        bb_put_rounds(p->entry, BB_F_SCENE_BOXES_SAMPLES, p->extra);
}

void bb_put_views(const bb_put *p)
{
    const bb_scene *scene = p->record;
    bb_cell cell = bb_table_cell(p->results->table, p->entry->row);
    for (uint32_t i = 0; i < scene->view_count; i++) {
        cell.names[BB_VIEW] = scene->views[i].name;
        bb_results_entry(p->results, cell);
    }
}

/* ---- builds ---- */

/* Puts one parameter: the given value, else the declared default, unless there is neither. */
static void put_param(bb_results *results, const bb_entry *entry, const char *stage,
                      const char *key, const char *value)
{
    char name[128];
    snprintf(name, sizeof name, "%s%s%s", stage, stage[0] != '\0' ? ": " : "", key);
    if (value != NULL && value[0] != '\0')
        bb_put_text(bb_results_part(results, entry, name), BB_F_BUILD_PARAMS, value);
}

static void put_params(bb_results *results, const bb_entry *entry, const char *stage,
                       const bb_spec *spec, const bb_option *options)
{
    for (const bb_option *o = options; o != NULL && o->name != NULL; o++)
        put_param(results, entry, stage, o->name, bb_spec_value(spec, options, o->name));
    for (uint32_t i = 0; i < spec->param_count; i++)
        put_param(results, entry, stage, spec->keys[i], spec->values[i]);
}

void bb_put_build_params(const bb_put *p)
{
    const bb_build_record *build = p->record;
    if (build->stage_count == 0)
        put_params(p->results, p->entry, "", build->spec, build->options);
    for (uint32_t i = 0; i < build->stage_count; i++)
        put_params(p->results, p->entry, build->stages[i].label, build->stages[i].spec,
                   build->stages[i].options);
}

static double known(uint64_t bytes)
{
    return bytes > 0 ? (double)bytes : (double)NAN;
}

/* Puts times, SAH and bytes of a pipeline's steps; nothing for a single builder. */
void bb_put_stages(const bb_put *p)
{
    const bb_build_record *build = p->record;
    for (uint32_t i = 0; i < build->step_count; i++) {
        bb_entry *part = bb_results_part(p->results, p->entry, build->steps[i].name);
        bb_put_rounds(part, BB_F_BUILD_STAGES, &build->steps[i].ms);
        bb_put_number(part, BB_F_BUILD_STAGES_SAH, build->steps[i].sah);
        bb_put_number(part, BB_F_BUILD_STAGES_BYTES, known(build->steps[i].bytes));
        bb_put_number(part, BB_F_BUILD_STAGES_PEAK, known(build->steps[i].bytes_peak));
    }
}

void bb_put_phases(const bb_put *p)
{
    const bb_build_record *build = p->record;
    for (uint32_t i = 0; i < build->phase_count; i++)
        bb_put_number(bb_results_part(p->results, p->entry, build->phases[i].name),
                      BB_F_BUILD_PHASES, build->phases[i].ms);
}

/* Puts times, SAH and bytes of the layouts. */
void bb_put_layouts(const bb_put *p)
{
    const bb_build_record *build = p->record;
    const double us = bb_get_number(p->results->context, BB_F_CONTEXT_LAUNCH);
    for (uint32_t i = 0; i < build->layout_count; i++) {
        bb_entry *part = bb_results_part(p->results, p->entry, build->layouts[i].name);
        bb_put_rounds(part, BB_F_BUILD_LAYOUTS_MS, &build->layouts[i].ms);
        bb_put_number(part, BB_F_BUILD_LAYOUTS_SAH, build->layouts[i].sah);
        bb_put_number(part, BB_F_BUILD_LAYOUTS_BYTES, known(build->layouts[i].bytes));
        const double launches = known(build->launches + build->layouts[i].launches);
        bb_put_number(part, BB_F_BUILD_LAYOUTS_LAUNCHES, launches);
        bb_put_number(part, BB_F_BUILD_LAYOUTS_FLOOR, launches * us / 1e3);
    }
}

/* Puts each simulation into a row of its own. */
void bb_put_simulated_builds(const bb_put *p)
{
    const bb_build_record *build = p->record;
    for (uint32_t i = 0; i < build->simulated_count; i++) {
        const bb_build_simulation *s = &build->simulated[i].simulation;
        bb_entry *part = bb_results_part(p->results, p->entry, build->simulated[i].name);
        bb_put_text(part, BB_F_SIMT_BUILD_BINDS, bb_binding_word(s->binds));
#define SIMT_BUILD(id, member, name, unit, better, heading, help)                                  \
    bb_put_number(part, BB_F_SIMT_BUILD_##id, s->member);
#include "framework/simulate/simt_build_figures.h"
    }
}

void bb_put_build_decisions(const bb_put *p)
{
    put_decisions(p->results, p->entry, &((const bb_build_record *)p->record)->decisions);
}

void bb_put_tree(bb_results *results, bb_entry *entry, const bb_build_record *build)
{
    bb_put_part(&(bb_put){results, entry, build, NULL}, BB_IN_TREE);
    for (uint32_t m = 0; m < bb_metric_count(); m++) {
        const bb_metric *metric = bb_metrics[m];
        bb_table_set_number(results->table, entry->row, bb_metric_column(metric, false),
                            build->metrics[m].value);
        if (metric->sampled)
            bb_table_set_number(results->table, entry->row, bb_metric_column(metric, true),
                                build->metrics[m].half);
    }
}

/* ---- traces ---- */

void bb_put_native(const bb_put *p)
{
    const bb_trace_record *trace = p->record;
    if (trace->layout[0] != '\0')
        bb_put_flag(p->entry, BB_F_TRACE_NATIVE, trace->native);
}

void bb_put_rays_source(const bb_put *p)
{
    const bool given = ((const bb_trace_record *)p->record)->rays_as_given;
    bb_put_text(p->entry, BB_F_TRACE_RAYS_SOURCE, given ? "as given" : "workload");
}

void bb_put_query(const bb_put *p)
{
    const bb_query *query = ((const bb_trace_record *)p->record)->query;
    bb_put_text(p->entry, BB_F_TRACE_QUERY, query != NULL ? query->name : "");
}

void bb_put_rays_params(const bb_put *p)
{
    const bb_trace_record *trace = p->record;
    if (trace->rays_spec != NULL)
        put_params(p->results, p->entry, "", trace->rays_spec, trace->rays_options);
}

void bb_put_trace_decisions(const bb_put *p)
{
    put_decisions(p->results, p->entry, &((const bb_trace_record *)p->record)->decisions);
}

/* Puts each simulation into a row of its own. */
void bb_put_simulated(const bb_put *p)
{
    const bb_trace_record *trace = p->record;
    for (uint32_t i = 0; i < trace->simulated_count; i++) {
        const bb_simulation *s = &trace->simulated[i].simulation;
        bb_entry *part = bb_results_part(p->results, p->entry, trace->simulated[i].name);
        if (!isnan(s->mrays_s))
            bb_put_text(part, BB_F_SIMT_BINDS, bb_binding_word(s->binds));
#define SIMT(id, member, name, unit, better, heading, help)                                        \
    bb_put_number(part, BB_F_SIMT_##id, s->member);
#include "framework/simulate/simt_figures.h"
    }
}

void bb_put_given(const bb_put *p)
{
    const double rate = ((const bb_trace_record *)p->record)->mrays_s_given;
    bb_put_number(p->entry, BB_F_TRACE_RATE_GIVEN, rate > 0 ? rate : (double)NAN);
}

void bb_put_unlike(const bb_put *p)
{
    const bb_trace_record *trace = p->record;
    if (trace->unlike_whom[0] != '\0')
        bb_put_number(p->entry, BB_F_TRACE_UNLIKE, trace->unlike);
}

void bb_put_wrong_ppm(const bb_put *p)
{
    const bb_accuracy *accuracy = &((const bb_trace_record *)p->record)->accuracy;
    if (accuracy->checked > 0)
        bb_put_number(p->entry, BB_F_ACCURACY_WRONG_PPM, accuracy->wrong_ppm);
}

void bb_put_overflowed(const bb_put *p)
{
    const bb_trace_record *trace = p->record;
    if (trace->counted > 0)
        bb_put_number(p->entry, BB_F_ACCURACY_OVERFLOWED, (double)trace->overflowed);
}

void bb_put_first_wrong(const bb_put *p)
{
    const uint32_t first = ((const bb_trace_record *)p->record)->accuracy.first_wrong;
    if (first != BB_NONE)
        bb_put_number(p->entry, BB_F_ACCURACY_FIRST_WRONG, first);
}

void bb_put_missing_key(bb_entry *trace)
{
    char key[BB_CELL_KEY];
    const char *hash = bb_get_text(trace, BB_F_TRACE_RAYS_HASH);
    bb_cell_parts cell = {.known_by_hash = true, .rays_hash = strtoull(hash, NULL, 16)};
    if (bb_get_text(trace, BB_F_TRACE_CELL)[0] != '\0')
        return;
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
    if (bb_cell_key_format(&cell, key) == BB_OK)
        bb_put_text(trace, BB_F_TRACE_CELL, key);
}
