/* Ways as rows of a table, and the views of them. */
#include "framework/bench/contest_table.h"

#include "framework/scene/tets.h"
#include "framework/simulate/simulated_table.h"

#include <math.h>
#include <string.h>

const bb_column bb_column_status =
    BB_TEXT_COLUMN("status", "status", "Refused; failed: a fault; or nothing.");
const bb_column bb_column_refused =
    BB_TEXT_COLUMN("refused", "refused", "Why there are no figures, or none from some frame on.");
const bb_column bb_column_rounds =
    BB_EXACT_COLUMN("rounds", "rounds", "", "That count.", NEITHER, 0);
const bb_column bb_column_nodes = BB_EXACT_COLUMN("nodes", "nodes", "", "Of the tree.", LESS, 0);
const bb_column bb_column_tree_bytes =
    BB_EXACT_COLUMN("tree_bytes", "tree", "bytes", "Of the tree.", LESS, 0);
const bb_column bb_column_bytes = BB_EXACT_COLUMN(
    "bytes", "most memory", "bytes", "Of trees and scratch at most, and of layouts.", LESS, 0);
const bb_column bb_column_phase = BB_ROUNDS_COLUMN(
    "phase_ms", "phase", "ms", "A phase of the build or update, timed apart.", NEITHER, 3);
const bb_column bb_column_picture =
    BB_TEXT_COLUMN("picture", "picture", "PNG file beside this one.");

BB_ROUNDS(build, "build_ms", "build", "ms", "Building the tree.", LESS, 2);
BB_ROUNDS(layout, "layout_ms", "layout", "ms",
          "Layout, and transfer of a tree that was made on the host.", LESS, 2);
BB_ROUNDS(answer, "answer_ms", "answer", "ms", "An answer, such as a slice or a picture.", LESS, 2);
BB_ROUNDS(answer_cpu, "answer_cpu_ms", "answer CPU", "ms", "Processor time of an answer.", LESS, 2);
BB_TIMED(speed, "mitems_per_s", "M/s", "",
         "Millions of items, such as voxels, answered per second.", MORE, 3);
BB_EXACT(visits, "nodes_per_item", "nodes", "", "Nodes visited per item.", LESS, 1);
BB_EXACT(work, "tests_per_item", "tests", "", "Primitives tested, or samples taken, per item.",
         LESS, 2);
BB_EXACT(restarts, "restarts_per_item", "restarts", "",
         "Walks from the root after a short stack ran empty, per item.", LESS, 2);
BB_EXACT(query_bytes, "query_bytes", "bytes to query", "",
         "What an answer reads of the tree, copies of primitives included.", LESS, 0);
BB_EXACT(differ, "differ", "differ", "", "Items whose answers differ from those of the first way.",
         NEITHER, 0);
BB_TIMED(samples_rate, "msamples_per_s", "samples M/s", "", "Millions of samples per second.", MORE,
         2);
BB_EXACT(difference, "largest_difference", "largest difference", "",
         "Of a channel, from the first way.", NEITHER, -1);
BB_EXACT(difference_8, "largest_difference_8_bits", "in 8 bits", "",
         "The largest difference, in steps of 1/255.", NEITHER, 0);
BB_EXACT(leaves, "leaves", "leaves", "", "Of the tree.", NEITHER, 0);
BB_EXACT(references, "references", "references", "", "Of the tree's leaves to primitives.", LESS,
         0);
BB_EXACT(per_primitive, "references_per_primitive", "references per primitive", "", "Of the tree.",
         LESS, 2);

BB_EXACT(simulated_answer, "simt_answer_ms", "answer", "ms",
         "Simulated, neither measured nor validated: an answer, by the bound.", LESS, 3);

static const bb_axes axes = {BB_DRAW_BARS, "ms", "", false, false};
static const bb_axes by_step = {BB_DRAW_LINES, "step", "error of a channel", true, true};
static const bb_axes by_time = {BB_DRAW_LINES, "last picture ms", "error of a channel", true, true};

#define PLAIN(name)                                                                                \
    {                                                                                              \
        {name}, NULL, false                                                                        \
    }
const bb_table_view bb_contest_views[BB_CONTEST_VIEWS] = {
    {.caption = "Meshes",
     .with = BB_SET(BB_QUESTION),
     .rows = BB_SET(BB_QUESTION),
     .columns = {PLAIN("tetrahedra"), PLAIN("boundary_tetrahedra"), PLAIN("flat_tetrahedra"),
                 PLAIN("volume_ratio"), PLAIN("aspect_min"), PLAIN("aspect_median"),
                 PLAIN("aspect_max"), PLAIN("meeting")}},
    {.caption = "Ways",
     .with = BB_SET(BB_INTERSECTOR),
     .without = BB_SET(BB_MAKER),
     .rows = BB_SET(BB_BUILDER) | BB_SET(BB_INTERSECTOR),
     .columns = {PLAIN("build_ms"),
                 PLAIN("layout_ms"),
                 PLAIN("answer_ms"),
                 {{"answer_ms"}, "answer / first", true},
                 {{"build_ms", "layout_ms", "answer_ms"}, "all / first", true},
                 PLAIN("mitems_per_s"),
                 PLAIN("msamples_per_s"),
                 PLAIN("nodes_per_item"),
                 PLAIN("tests_per_item"),
                 PLAIN("restarts_per_item"),
                 PLAIN("query_bytes"),
                 PLAIN("largest_difference"),
                 PLAIN("largest_difference_8_bits"),
                 PLAIN("differ"),
                 PLAIN("refused")}},
    {.caption = "Time",
     .with = BB_SET(BB_INTERSECTOR),
     .without = BB_SET(BB_MAKER),
     .rows = BB_SET(BB_BUILDER) | BB_SET(BB_INTERSECTOR),
     .columns = {PLAIN("build_ms"), PLAIN("layout_ms"), PLAIN("answer_ms")},
     .axes = &axes},
    {.caption = "Simulated: neither measured nor validated",
     .with = BB_SET(BB_INTERSECTOR) | BB_SET(BB_MAKER),
     .rows = BB_SET(BB_BUILDER) | BB_SET(BB_INTERSECTOR),
     .each = BB_SET(BB_MAKER),
     .columns = {{{"simt_answer_ms"}, "answer", false},
                 {{"simt_mrays_s"}, "bound", false},
                 {{"simt_binds"}, "by", false},
                 {{"simt_l1_mrays_s"}, "L1", false},
                 {{"simt_l2_mrays_s"}, "L2", false},
                 {{"simt_memory_mrays_s"}, "memory", false},
                 {{"simt_efficiency"}, "SIMT efficiency", false},
                 {{"simt_node_efficiency"}, "at nodes", false},
                 {{"simt_prim_efficiency"}, "at primitives", false},
                 {{"simt_sample_efficiency"}, "at samples", false},
                 {{"simt_steps_per_ray"}, "steps", false},
                 {{"simt_lines_per_step"}, "lines", false},
                 {{"simt_memory_bytes"}, "memory", false},
                 {{"simt_unsimulated"}, "not simulated", false}}},
    {.caption = "Accuracy",
     .with = BB_SET(BB_QUESTION),
     .rows = BB_SET(BB_QUESTION),
     .columns = {PLAIN("largest_error"), PLAIN("rms_error"), PLAIN("samples_per_ray"),
                 PLAIN("picture_ms")}},
    {.caption = "Step against error",
     .with = BB_SET(BB_QUESTION),
     .rows = BB_SET(BB_QUESTION),
     .columns = {PLAIN("step"), PLAIN("largest_error"), PLAIN("rms_error")},
     .axes = &by_step},
    {.caption = "Time against error",
     .with = BB_SET(BB_QUESTION),
     .rows = BB_SET(BB_QUESTION),
     .columns = {PLAIN("picture_ms"), PLAIN("largest_error"), PLAIN("rms_error")},
     .axes = &by_time},
    {.caption = "Trees",
     .with = BB_SET(BB_BUILDER),
     .without = BB_SET(BB_INTERSECTOR) | BB_SET(BB_MAKER),
     .rows = BB_SET(BB_BUILDER),
     .columns = {PLAIN("tree_bytes"), PLAIN("nodes"), PLAIN("leaves"), PLAIN("references"),
                 PLAIN("references_per_primitive")}},
    {.caption = "Phases of builds",
     .with = BB_SET(BB_MAKER),
     .rows = BB_SET(BB_BUILDER) | BB_SET(BB_MAKER),
     .columns = {PLAIN("phase_ms")}},
};

/* ---- rows ---- */

uint32_t bb_contest_scene_row(bb_table *table, const char *scene, const char *question)
{
    return bb_table_row(table, (bb_cell){{[BB_SCENE] = scene, [BB_QUESTION] = question}});
}

static uint32_t row_of(bb_table *table, const char *scene, const bb_contest_way *way,
                       const char *maker, const char *search)
{
    const bb_cell cell = {{[BB_SCENE] = scene,
                           [BB_BUILDER] = way->builder,
                           [BB_MAKER] = maker,
                           [BB_INTERSECTOR] = search}};
    return bb_table_row(table, cell);
}

/* Ways of one builder have the same tree. */
static void fill_tree(bb_table *table, const char *scene, const bb_contest_way *way,
                      double primitives)
{
    const uint32_t row = row_of(table, scene, way, NULL, NULL);
    bb_table_set_number(table, row, &bb_column_tree_bytes, (double)way->tree_bytes);
    bb_table_set_number(table, row, &bb_column_nodes, way->nodes);
    bb_table_set_number(table, row, &leaves, way->leaves);
    bb_table_set_number(table, row, &references, way->references);
    if (primitives > 0)
        bb_table_set_number(table, row, &per_primitive, way->references / primitives);
    for (uint32_t p = 0; p < way->phase_count; p++)
        bb_table_set_rounds(table, row_of(table, scene, way, way->phases[p].name, NULL),
                            &bb_column_phase, &way->phases[p].ms);
}

static void fill_way(bb_table *table, uint32_t row, const bb_contest_way *way, double items)
{
    bb_table_set_rounds(table, row, &build, &way->build);
    bb_table_set_rounds(table, row, &layout, &way->layout);
    bb_table_set_rounds(table, row, &answer, &way->answer);
    bb_table_set_rounds(table, row, &answer_cpu, &way->answer_cpu);
    bb_table_set_number(table, row, &speed, items / bb_samples_median(&way->answer) / 1e3);
    if (way->builder[0] != '\0')
        bb_table_set_number(table, row, &visits, way->visits);
    bb_table_set_number(table, row, &work, way->work);
    bb_table_set_number(table, row, &restarts, way->restarts);
    if (way->query_bytes > 0)
        bb_table_set_number(table, row, &query_bytes, (double)way->query_bytes);
    bb_table_set_number(table, row, &differ, (double)way->differ);
    if (way->nodes > 0)
        bb_table_set_number(table, row, &bb_column_bytes, (double)way->bytes);
    if (!way->light)
        return;
    bb_table_set_number(table, row, &samples_rate,
                        way->work * items / bb_samples_median(&way->answer) / 1e3);
    if (way->builder[0] == '\0')
        return;
    bb_table_set_number(table, row, &difference, way->most);
    bb_table_set_number(table, row, &difference_8, way->most_8);
}

void bb_contest_fill(bb_table *table, const char *scene, const bb_contest_way *ways, uint32_t count,
                     double items, double primitives)
{
    for (uint32_t w = 0; w < count; w++) {
        const bb_contest_way *way = &ways[w];
        const char *search = way->builder[0] == '\0' ? "no tree" : way->search;
        const uint32_t row = row_of(table, scene, way, NULL, search);
        if (way->refused[0] != '\0') {
            bb_table_set_text(table, row, &bb_column_status, "refused");
            bb_table_set_text(table, row, &bb_column_refused, way->refused);
            continue;
        }
        fill_way(table, row, way, items);
        bb_table_set_number(table, bb_contest_scene_row(table, scene, NULL), &bb_column_rounds,
                            way->answer.count > 1 ? way->answer.count - 1 : 1);
        if (way->nodes > 0)
            fill_tree(table, scene, way, primitives);
    }
}

void bb_contest_fill_simulated(bb_table *table, const char *scene, const bb_contest_way *ways,
                               uint32_t count, double items, const bb_simt *simts,
                               uint32_t simt_count)
{
    for (uint32_t w = 0; w < count; w++)
        for (uint32_t i = 0; i < simt_count; i++) {
            const bb_contest_way *way = &ways[w];
            const char *search = way->builder[0] == '\0' ? "no tree" : way->search;
            if (way->refused[0] != '\0')
                continue;
            if (way->simulated) {
                const uint32_t row = row_of(table, scene, way, simts[i].name, search);
                bb_simulated_put(table, row, &way->simulations[i]);
                bb_table_set_number(table, row, &simulated_answer,
                                    items / way->simulations[i].mrays_s / 1e3);
            } else if (way->unsimulated[0] != '\0')
                bb_simulated_put_none(table, row_of(table, scene, way, simts[i].name, search),
                                      way->unsimulated);
        }
}
