/* Puts the atlas into a table. */
#include "framework/stress/stress.h"

#include "framework/device/run_row.h"
#include "framework/stress/point_private.h"
#include "framework/stress/stress_private.h"

#include <stdio.h>
#include <string.h>

/* ---- of the run ---- */

BB_TEXT(quick, "quick", "quick", "yes: few values, small scenes, times not judged.");
BB_EXACT(rays_per_set, "rays_per_set", "rays a set", "", "At most.", NEITHER, -1);
BB_EXACT(rounds, "rounds", "rounds", "", "Of which the least time counts.", NEITHER, -1);
BB_EXACT(factor, "factor", "factor", "", "Slower and bigger: by more than this.", NEITHER, -1);
BB_EXACT(bugs, "bugs", "bugs", "", "Crashes, hangs, failures, wrong answers of exact methods.",
         NEITHER, -1);
BB_TEXT(metric, "metric_of_trees", "metric", "What the cost of trees is.");
BB_TIMED(total_ms, "total_ms", "total", "ms", "Wall time of the run.", LESS, -1);

/* ---- of a method ---- */

BB_TEXT(part, "part", "part", "builder, kernel or intersector.");
BB_TEXT(exact, "exact", "exact", "yes: it must never be wrong.");

/* ---- of an axis ---- */

BB_TEXT(title, "title", "title", "What the axis is about.");
BB_TEXT(parameter, "parameter", "parameter", "What x is.");
BB_TEXT(why, "why", "why", "What fails on it, and why.");
BB_TEXT(known, "known", "known limit", "Where wrong answers are documented.");
BB_TEXT(family, "family", "scene", "The scene, by x and n.");
BB_TEXT(rays, "ray_families", "rays", "The ray sets, by x and n, between blanks.");
BB_TEXT(builder, "traced_tree", "tree", "Builder of the trees that kernels trace.");
BB_TEXT(kernel, "traced_by", "kernel", "What traces the builders' trees.");
BB_EXACT(from, "from", "from", "", "x where all is normal.", NEITHER, -1);
BB_EXACT(to, "to", "to", "", "x where it is worst.", NEITHER, -1);
BB_TEXT(steps, "steps", "steps", "log, linear, whole or count.");
BB_EXACT(n, "n", "n", "", "Primitives.", NEITHER, -1);
BB_EXACT(frames, "frames", "frames", "", "Of moving scenes.", NEITHER, -1);
BB_TEXT(picture, "picture", "picture", "A file beside this one.");
BB_EXACT(picture_at, "picture_at", "picture at", "", "x of the picture.", NEITHER, -1);
BB_TEXT(complete, "complete", "complete", "no: the run was interrupted.");

/* ---- of a method at a value of an axis, beside its figures (point_file.c) ---- */

BB_EXACT(x, "x", "x", "", "The value.", NEITHER, -1);

/* ---- of a failure: a method on an axis, in a manner ---- */

BB_TEXT(word, "word", "fails", "The manner in words.");
BB_TEXT(from_start, "from_start", "from the start", "yes: at the first value already.");
BB_EXACT(at, "at", "from", "", "x of the first failure.", NEITHER, -1);
BB_EXACT(below, "below", "not yet at", "", "The last x before it.", NEITHER, -1);
BB_EXACT(ratio, "ratio", "times", "", "How many times its own normal figure.", NEITHER, -1);
BB_TEXT(returns, "returns", "not throughout", "yes: it does not fail at all x behind.");

static const bb_table_view views[] = {
    {.caption = "Failures",
     .with = BB_SET(BB_QUESTION) | BB_SET(BB_MAKER),
     .having = "word",
     .rows = BB_SET(BB_BUILDER) | BB_SET(BB_MAKER) | BB_SET(BB_INTERSECTOR),
     .columns = {{.parts = {"at"}},
                 {.parts = {"below"}},
                 {.parts = {"ratio"}},
                 {.parts = {"from_start"}},
                 {.parts = {"returns"}}}},
    {.caption = "Simulated: neither measured nor validated",
     .with = BB_SET(BB_QUESTION) | BB_SET(BB_MAKER) | BB_SET(BB_FRAME),
     .rows = BB_SET(BB_FRAME) | BB_SET(BB_BUILDER) | BB_SET(BB_INTERSECTOR),
     .each = BB_SET(BB_MAKER),
     .columns = {{{"simt_mrays_s"}, "bound", false},
                 {{"simt_binds"}, "by", false},
                 {{"simt_efficiency"}, "SIMT efficiency", false},
                 {{"simt_steps_per_ray"}, "steps", false},
                 {{"simt_memory_bytes"}, "memory B", false}}},
};
const bb_page_outline bb_stress_outline = {
    .command = "stress",
    .title = "bvhbench: where methods fail",
    .by_question = true,
    .views = views,
    .view_count = sizeof views / sizeof views[0],
};

static const char *yes(bool it_is)
{
    return it_is ? "yes" : NULL;
}

static void put_run(bb_table *table, const bb_stress *s, const char *command)
{
    const uint32_t run = bb_run_row(table, NULL, s->request->seed, command);
    bb_table_set_text(table, run, &bb_run_columns[BB_RUN_DEVICE], s->device);
    bb_table_set_text(table, run, &bb_run_columns[BB_RUN_DRIVER], s->driver);
    bb_table_set_text(table, run, &quick, yes(s->request->quick));
    bb_table_set_number(table, run, &rays_per_set, s->max_rays);
    bb_table_set_number(table, run, &rounds, s->repeats);
    bb_table_set_number(table, run, &factor, BB_STRESS_FACTOR);
    bb_table_set_number(table, run, &bugs, bb_stress_blame(s, NULL));
    bb_table_set_text(table, run, &metric, bb_metrics[bb_metric_of_layouts()]->title);
    bb_table_set_number(table, run, &total_ms, s->ms);
    for (uint32_t m = 0; m < s->request->method_count; m++) {
        const bb_method *method = &s->request->methods[m];
        const uint32_t row = bb_table_row(table, bb_method_row(method, NULL, NULL));
        bb_table_set_text(table, row, &part, bb_method_part_word(method->part));
        bb_table_set_text(table, row, &exact, yes(method->exact));
    }
}

static void put_about(bb_table *table, const bb_stress_axis *a)
{
    static const char *const words[] = {"log", "linear", "whole", "count"};
    char sets[BB_AXIS_RAYS_MAX * 130] = "";
    const bb_axis *axis = &a->axis;
    const uint32_t row = bb_table_row(table, (bb_cell){{[BB_QUESTION] = axis->name}});
    for (uint32_t i = 0, used = 0; i < axis->ray_count; i++)
        used += (uint32_t)sprintf(sets + used, "%s%s", i > 0 ? " " : "", axis->rays[i]);
    bb_table_set_text(table, row, &title, axis->title);
    bb_table_set_text(table, row, &parameter, axis->parameter);
    bb_table_set_text(table, row, &why, axis->why);
    bb_table_set_text(table, row, &known, axis->known);
    bb_table_set_text(table, row, &family, axis->scene);
    bb_table_set_text(table, row, &rays, sets);
    bb_table_set_text(table, row, &builder, axis->builder);
    bb_table_set_text(table, row, &kernel, axis->kernel);
    bb_table_set_number(table, row, &from, axis->from);
    bb_table_set_number(table, row, &to, axis->to);
    bb_table_set_text(table, row, &steps, words[axis->steps]);
    bb_table_set_number(table, row, &n, (double)a->n);
    bb_table_set_number(table, row, &frames, axis->frames);
    bb_table_set_text(table, row, &picture, a->picture);
    if (a->picture[0] != '\0')
        bb_table_set_number(table, row, &picture_at, a->picture_at);
    bb_table_set_text(table, row, &complete, a->complete ? "yes" : "no");
}

static void put_failure(bb_table *table, bb_cell cell, uint32_t manner, const bb_threshold *t)
{
    cell.names[BB_MAKER] = bb_manners[manner].name;
    const uint32_t row = bb_table_row(table, cell);
    bb_table_set_text(table, row, &word, bb_manners[manner].word);
    bb_table_set_text(table, row, &from_start, yes(t->from_start));
    bb_table_set_number(table, row, &at, t->at);
    bb_table_set_number(table, row, &below, t->below);
    bb_table_set_number(table, row, &ratio, t->ratio);
    bb_table_set_text(table, row, &returns, yes(t->returns));
}

static void put_axis(bb_table *table, const bb_stress *s, const bb_stress_axis *a)
{
    const bb_points points = bb_stress_points(s->request, &a->axis);
    put_about(table, a);
    for (uint32_t i = 0; i < a->search.probe_count; i++) {
        char value[BB_AXIS_VALUE];
        bb_axis_value(a->search.probes[i].x, value);
        for (uint32_t m = 0; m < s->request->method_count; m++) {
            const bb_cell cell = bb_method_row(&s->request->methods[m], a->axis.name, value);
            if (a->search.probes[i].figures[m].outcome == BB_NOT_MEASURED)
                continue;
            const uint32_t row =
                bb_figures_put(table, cell, &points, &a->search.probes[i].figures[m]);
            bb_table_set_number(table, row, &x, a->search.probes[i].x);
        }
    }
    for (uint32_t m = 0; m < s->request->method_count; m++)
        for (uint32_t f = 0; f < BB_MANNERS; f++)
            if (a->search.thresholds[m][f].found)
                put_failure(table, bb_method_row(&s->request->methods[m], a->axis.name, NULL), f,
                            &a->search.thresholds[m][f]);
}

bb_status bb_atlas_table(const bb_stress *s, const char *command, bb_table **out)
{
    bb_table *table;
    *out = NULL;
    BB_TRY(bb_table_create("stress", &table));
    put_run(table, s, command);
    for (uint32_t i = 0; i < s->axis_count; i++)
        put_axis(table, s, &s->axes[i]);
    bb_status status = bb_table_status(table);
    if (status == BB_OK)
        *out = table;
    else
        bb_table_free(table);
    return status;
}
