/* What an ordinary comparison measured, as a table: the only reader of the results here. */
#include "framework/builder/metric.h"
#include "framework/papers/reproduce.h"
#include "framework/record/record.h"

#include <string.h>

/* Figures under the names that they have in the results. */
static const bb_field_id of_scenes[] = {BB_F_SCENE_PRIMS, BB_F_PROFILE_FLATNESS,
                                        BB_F_PROFILE_SIZE_MAX, BB_F_PROFILE_SIZE_MEDIAN,
                                        BB_F_PROFILE_OVERLAP};
static const bb_field_id of_builds[] = {BB_F_TREE_NODES, BB_F_TREE_LEAVES, BB_F_TREE_BYTES,
                                        BB_F_TREE_BYTES_PEAK};
static const bb_field_id of_traces[] = {BB_F_TRACE_NODE_TESTS, BB_F_TRACE_PRIM_TESTS};
enum { OF_SCENES = 5, OF_BUILDS = 4, OF_TRACES = 2 };

static const bb_column rays = BB_FOUND_NUMBER("rays", "Rays of the set."),
                       sah = BB_FOUND_NUMBER("sah", "Cost of the tree."),
                       work =
                           BB_FOUND_NUMBER("work", "Counted work per ray, in units of the cost."),
                       about = BB_FOUND_TEXT("about", "The builder's words on its tree."),
                       phase_ms = BB_FOUND_NUMBER("phase_ms", "Median of a phase of the build."),
                       build_ms = BB_FOUND_ROUNDS("build_ms", "Building the tree."),
                       trace_ms = BB_FOUND_ROUNDS("trace_ms", "Tracing all rays of the set.");

static void put_numbers(bb_table *table, uint32_t row, const bb_entry *entry,
                        const bb_field_id *fields, size_t count)
{
    static bb_column columns[BB_FIELDS]; /* outlive the table */
    for (size_t i = 0; i < count; i++) {
        const bb_field *field = &bb_fields[fields[i]];
        columns[fields[i]] = (bb_column){
            .name = field->name, .heading = field->name, .unit = field->unit, .help = ""};
        bb_table_set_number(table, row, &columns[fields[i]], bb_get_number(entry, fields[i]));
    }
}

static void add_scene(bb_table *table, const bb_entry *scene)
{
    bb_cell cell = {{[BB_SCENE] = bb_get_text(scene, BB_F_SCENE_NAME)}};
    put_numbers(table, bb_table_row(table, cell), scene, of_scenes, OF_SCENES);
    bb_each_part(view, scene, BB_F_SCENE_VIEWS)
    {
        cell.names[BB_FRAME] = bb_part_name(view);
        bb_table_row(table, cell);
    }
}

static uint32_t add_build(bb_table *table, const bb_entry *build)
{
    bb_samples rounds;
    bb_cell cell = {{[BB_SCENE] = bb_get_text(build, BB_F_BUILD_SCENE),
                     [BB_BUILDER] = bb_get_text(build, BB_F_BUILD_BUILDER)}};
    const uint32_t row = bb_table_row(table, cell);
    put_numbers(table, row, build, of_builds, OF_BUILDS);
    bb_table_set_number(table, row, &sah, bb_get_metric(build, &bb_metric_sah));
    bb_table_set_text(table, row, &about, bb_get_text(build, BB_F_BUILD_ABOUT));
    if (bb_get_samples(build, BB_F_BUILD_MS, &rounds))
        bb_table_set_rounds(table, row, &build_ms, &rounds);
    bb_each_part(phase, build, BB_F_BUILD_PHASES)
    {
        cell.names[BB_MAKER] = bb_part_name(phase);
        bb_table_set_number(table, bb_table_row(table, cell), &phase_ms,
                            bb_get_number(phase, BB_F_BUILD_PHASES));
    }
    return row;
}

static uint32_t add_trace(bb_table *table, const bb_entry *trace)
{
    bb_samples rounds;
    const bb_cell cell = {{[BB_SCENE] = bb_get_text(trace, BB_F_TRACE_SCENE),
                           [BB_BUILDER] = bb_get_text(trace, BB_F_TRACE_BUILDER),
                           [BB_INTERSECTOR] = bb_get_text(trace, BB_F_TRACE_KERNEL),
                           [BB_QUESTION] = bb_get_text(trace, BB_F_TRACE_RAYS),
                           [BB_FRAME] = bb_get_text(trace, BB_F_TRACE_VIEW)}};
    const uint32_t row = bb_table_row(table, cell);
    put_numbers(table, row, trace, of_traces, OF_TRACES);
    bb_table_set_number(table, row, &rays, bb_get_number(trace, BB_F_TRACE_COUNT));
    /* of kernels on binary nodes, which test the boxes of both children of a node they visit */
    bb_table_set_number(table, row, &work,
                        BB_COST_TRAVERSAL * bb_get_number(trace, BB_F_TRACE_NODE_TESTS) / 2 +
                            bb_get_number(trace, BB_F_TRACE_PRIM_TESTS));
    if (bb_get_samples(trace, BB_F_TRACE_MS, &rounds))
        bb_table_set_rounds(table, row, &trace_ms, &rounds);
    return row;
}

/* The columns of simulated times, by simulation (BB_SIMULATED_TIME). */
#define OF_SIMULATIONS(name_)                                                                      \
    {                                                                                              \
        SIMULATED("simulated1_" name_), SIMULATED("simulated2_" name_),                            \
            SIMULATED("simulated3_" name_), SIMULATED("simulated4_" name_)                         \
    }
#define SIMULATED(name_) BB_FOUND_NUMBER(name_, "Simulated, neither measured nor validated.")
static const bb_column simulated_trace[BB_SIMT_MAX] = OF_SIMULATIONS("trace_ms"),
                       simulated_build[BB_SIMT_MAX] = OF_SIMULATIONS("build_ms"),
                       simulated_answer[BB_SIMT_MAX] = OF_SIMULATIONS("answer_ms");

static void add_simulated_build(const bb_findings *f, const bb_entry *build, uint32_t row)
{
    for (uint32_t i = 0; i < f->simulation_count; i++)
        bb_table_set_number(f->table, row, &simulated_build[i],
                            bb_get_named(build, BB_F_SIMT_BUILD_MS, f->simulations[i]));
}

/* By the first simulation. */
enum { EFFICIENCIES = 3 };
static const bb_field_id of_efficiencies[EFFICIENCIES] = {BB_F_SIMT_EFFICIENCY, BB_F_SIMT_NODES,
                                                          BB_F_SIMT_PRIMS};
static const bb_column efficiencies[EFFICIENCIES] = {SIMULATED("simt_efficiency"),
                                                     SIMULATED("simt_node_efficiency"),
                                                     SIMULATED("simt_prim_efficiency")};

static void add_simulated_trace(const bb_findings *f, const bb_entry *trace, uint32_t row)
{
    for (uint32_t k = 0; k < EFFICIENCIES && f->simulation_count > 0; k++)
        bb_table_set_number(f->table, row, &efficiencies[k],
                            bb_get_named(trace, of_efficiencies[k], f->simulations[0]));
    for (uint32_t i = 0; i < f->simulation_count; i++)
        bb_table_set_number(f->table, row, &simulated_trace[i],
                            bb_get_number(trace, BB_F_TRACE_COUNT) / 1e3 /
                                bb_get_named(trace, BB_F_SIMT_RATE, f->simulations[i]));
}

void bb_paper_add_simulated_answers(bb_findings *f)
{
    for (uint32_t i = 0; i < f->simulation_count; i++)
        for (uint32_t row = 0; row < bb_table_row_count(f->table); row++) {
            if (strcmp(bb_table_name(f->table, row, BB_MAKER), f->simulations[i]) != 0)
                continue;
            bb_cell way = bb_table_cell(f->table, row);
            way.names[BB_MAKER] = NULL;
            bb_table_set_number(f->table, bb_table_row(f->table, way), &simulated_answer[i],
                                bb_table_get_number(f->table, row, "simt_answer_ms"));
        }
}

static bool is_of(const bb_entry *entry, uint32_t run)
{
    return bb_run_of(entry) == run && bb_is_ok(entry);
}

bb_status bb_paper_measured(const bb_results *results, uint32_t run, bb_findings *f)
{
    bb_table *table = f->table;
    bb_each(scene, bb_results_section(results, BB_SCENES)) add_scene(table, scene);
    bb_each(build, bb_results_section(results, BB_BUILDS)) if (is_of(build, run))
        add_simulated_build(f, build, add_build(table, build));
    bb_each(trace, bb_results_section(results, BB_TRACES)) if (is_of(trace, run))
        add_simulated_trace(f, trace, add_trace(table, trace));
    return bb_table_status(table);
}
