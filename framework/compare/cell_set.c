#include "framework/compare/cell_set.h"

#include "framework/compare/figures.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bb_status no_memory(void)
{
    return bb_fail(BB_FAILED, "cells: no memory");
}

bb_status bb_cell_set_add(bb_cell_set *set, const char *key, bb_measured **cell)
{
    if (set->count == set->capacity) {
        uint32_t capacity = 2 * set->capacity + 64;
        bb_measured *grown = realloc(set->cells, capacity * sizeof *grown);
        if (grown == NULL)
            return no_memory();
        set->cells = grown;
        set->capacity = capacity;
    }
    *cell = &set->cells[set->count];
    memset(*cell, 0, sizeof **cell);
    (*cell)->key = strdup(key);
    if ((*cell)->key == NULL)
        return no_memory();
    set->count++;
    return BB_OK;
}

bb_status bb_measured_add_figure(bb_measured *cell, const char *name, bb_better better,
                                 double value)
{
    bb_exact_figure *grown =
        realloc(cell->figures, (cell->figure_count + 1) * sizeof *cell->figures);
    if (grown == NULL)
        return no_memory();
    cell->figures = grown;
    snprintf(grown[cell->figure_count].name, BB_FIGURE_NAME, "%s", name);
    grown[cell->figure_count].better = better;
    grown[cell->figure_count++].value = value;
    return BB_OK;
}

static const bb_exact_figure *find_figure(const bb_measured *cell, const char *name)
{
    for (uint32_t i = 0; i < cell->figure_count; i++)
        if (strcmp(cell->figures[i].name, name) == 0)
            return &cell->figures[i];
    return NULL;
}

double bb_measured_figure(const bb_measured *cell, const char *name)
{
    const bb_exact_figure *figure = find_figure(cell, name);
    return figure != NULL ? figure->value : (double)NAN;
}

bb_better bb_measured_better(const bb_measured *cell, const char *name)
{
    const bb_exact_figure *figure = find_figure(cell, name);
    return figure != NULL ? figure->better : BB_BETTER_NEITHER;
}

/* ---- from results ---- */

static const bb_field_id of_builds[] = {BB_F_TREE_NODES,     BB_F_TREE_LEAVES, BB_F_TREE_REFS,
                                        BB_F_TREE_ARITY,     BB_F_TREE_DEPTH,  BB_F_TREE_BYTES,
                                        BB_F_TREE_BYTES_PEAK};
static const bb_field_id of_traces[] = {
    BB_F_TRACE_COUNT,         BB_F_TRACE_STACK,        BB_F_TRACE_NODE_TESTS,
    BB_F_TRACE_PRIM_TESTS,    BB_F_TRACE_UNLIKE,       BB_F_ACCURACY_MISSED,
    BB_F_ACCURACY_FALSE,      BB_F_ACCURACY_WRONG_T,   BB_F_ACCURACY_UNWRITTEN,
    BB_F_ACCURACY_OVERFLOWED, BB_F_ACCURACY_T_ULP_MAX, BB_F_ACCURACY_CHECKED};

static bb_status add_fields(bb_measured *cell, const bb_entry *entry, const bb_field_id *fields,
                            size_t count)
{
    for (size_t i = 0; i < count; i++) {
        double value = bb_get_number(entry, fields[i]);
        if (isfinite(value))
            BB_TRY(bb_measured_add_figure(cell, bb_fields[fields[i]].name,
                                          bb_field_better(fields[i]), value));
    }
    return BB_OK;
}

/* Adds the metrics of the tree as built and of the layouts as traced. */
static bb_status add_metrics(bb_measured *cell, const bb_entry *build)
{
    for (uint32_t i = 0; i < bb_metric_count(); i++) {
        char full[BB_FIGURE_NAME];
        double value = bb_get_metric(build, bb_metrics[i]);
        if (isfinite(value))
            BB_TRY(bb_measured_add_figure(cell, bb_metrics[i]->name, BB_BETTER_LESS, value));
        if (!bb_metrics[i]->of_layouts)
            continue;
        bb_each_part(layout, build, BB_F_BUILD_LAYOUTS_SAH)
        {
            snprintf(full, sizeof full, "%s %.60s", bb_fields[BB_F_BUILD_LAYOUTS_SAH].name,
                     bb_part_name(layout));
            BB_TRY(bb_measured_add_figure(cell, full, BB_BETTER_LESS,
                                          bb_get_number(layout, BB_F_BUILD_LAYOUTS_SAH)));
        }
    }
    return BB_OK;
}

static void copy(char *to, size_t capacity, const char *text)
{
    snprintf(to, capacity, "%s", text);
}

static bb_status add_entry(bb_cell_set *set, const bb_results *results, const bb_entry *entry,
                           bool trace)
{
    const char *key = bb_get_text(entry, trace ? BB_F_TRACE_CELL : BB_F_BUILD_CELL);
    const bb_entry *scene =
        bb_results_scene(results, bb_get_text(entry, trace ? BB_F_TRACE_SCENE : BB_F_BUILD_SCENE));
    bb_measured *cell;
    if (key[0] == '\0') /* the tree is another program's */
        return BB_OK;
    BB_TRY(bb_cell_set_add(set, key, &cell));
    copy(cell->time, sizeof cell->time, trace ? "trace ms" : "build ms");
    cell->reference = bb_get_true(entry, trace ? BB_F_TRACE_REFERENCE : BB_F_BUILD_REFERENCE);
    copy(cell->status, sizeof cell->status, bb_get_text(entry, BB_F_TRACE_STATUS));
    copy(cell->scene_hash, sizeof cell->scene_hash, bb_get_text(scene, BB_F_SCENE_HASH));
    if (!bb_get_samples(entry, trace ? BB_F_TRACE_MS : BB_F_BUILD_MS, &cell->ms))
        cell->ms.count = 0;
    if (trace) {
        copy(cell->rays_hash, sizeof cell->rays_hash, bb_get_text(entry, BB_F_TRACE_RAYS_HASH));
        return add_fields(cell, entry, of_traces, sizeof of_traces / sizeof of_traces[0]);
    }
    BB_TRY(add_fields(cell, scene, (bb_field_id[]){BB_F_SCENE_PRIMS}, 1));
    BB_TRY(add_fields(cell, entry, of_builds, sizeof of_builds / sizeof of_builds[0]));
    return add_metrics(cell, entry);
}

/* A text that the run says of itself. */
static const char *text_of_run(const bb_table *from, const char *name)
{
    return bb_table_get_text(from, bb_table_find(from, (bb_cell){{NULL}}), name);
}

static void read_origin(const bb_table *from, const char *what, bb_origin *origin)
{
    copy(origin->what, sizeof origin->what, what);
    copy(origin->date, sizeof origin->date, text_of_run(from, "date"));
    copy(origin->revision, sizeof origin->revision, text_of_run(from, "revision"));
    copy(origin->host, sizeof origin->host, text_of_run(from, "host"));
    copy(origin->cpu, sizeof origin->cpu, text_of_run(from, "cpu"));
    copy(origin->device, sizeof origin->device, text_of_run(from, "device"));
    copy(origin->device_type, sizeof origin->device_type, text_of_run(from, "device_type"));
    copy(origin->driver, sizeof origin->driver, text_of_run(from, "driver"));
    copy(origin->embree, sizeof origin->embree, text_of_run(from, "embree_version"));
    copy(origin->seed, sizeof origin->seed, text_of_run(from, "seed"));
    copy(origin->shard, sizeof origin->shard, text_of_run(from, "shard"));
    origin->interrupted = strcmp(text_of_run(from, "interrupted"), "yes") == 0;
}

bb_status bb_cell_set_of_results(const bb_results *results, const char *what, bb_cell_set *set)
{
    memset(set, 0, sizeof *set);
    read_origin(bb_results_table(results), what, &set->origin);
    bb_each(entry, bb_results_section(results, BB_BUILDS))
    {
        if (!bb_get_true(entry, BB_F_BUILD_UNMEASURED))
            BB_TRY(add_entry(set, results, entry, false));
    }
    bb_each(entry, bb_results_section(results, BB_TRACES))
    {
        BB_TRY(add_entry(set, results, entry, true));
    }
    bb_cell_set_sort(set);
    return BB_OK;
}

/* ---- from a table ---- */

/* Adds a cell for the row. `time` is the column of its times; NULL: its exact numbers. */
static bb_status add_row(bb_cell_set *set, const bb_table *table, uint32_t row,
                         const bb_column *time, bb_measured **cell)
{
    char key[BB_CELL_KEY];
    bb_cell scene = {.names = {[BB_SCENE] = bb_table_name(table, row, BB_SCENE)}};
    const char *status = bb_table_get_text(table, row, "status");
    bb_key_writer w = {.key = key};
    bb_key_put(&w, "command", bb_table_command(table));
    for (int d = 0; d < BB_DIMENSIONS; d++)
        bb_key_put(&w, bb_dimension_names[d], bb_table_name(table, row, (bb_dimension)d));
    bb_key_put(&w, "time", time != NULL ? time->name : "");
    key[w.length] = '\0';
    if (w.full)
        return bb_fail(BB_INVALID, "cell '%.60s...': its key has more than %d bytes", key,
                       BB_CELL_KEY - 1);
    BB_TRY(bb_cell_set_add(set, key, cell));
    copy((*cell)->status, sizeof(*cell)->status, status[0] != '\0' ? status : "ok");
    copy((*cell)->scene_hash, sizeof(*cell)->scene_hash,
         bb_table_get_text(table, bb_table_find(table, scene), "scene_hash"));
    return BB_OK;
}

/* Adds a cell for each column of rounds in which less is better. */
static bb_status add_rounds(bb_cell_set *set, const bb_table *table, uint32_t row)
{
    for (uint32_t i = 0; i < bb_table_column_count(table); i++) {
        const bb_column *column = bb_table_column(table, i);
        const bb_samples *rounds = bb_table_get_rounds(table, row, column->name);
        bb_measured *cell;
        if (rounds == NULL || column->better != BB_BETTER_LESS)
            continue;
        BB_TRY(add_row(set, table, row, column, &cell));
        snprintf(cell->time, sizeof cell->time, "%.40s %.20s", column->heading, column->unit);
        for (uint32_t k = 0; k < rounds->count; k++)
            bb_samples_add(&cell->ms, rounds->values[k]);
    }
    return BB_OK;
}

static bb_status add_numbers(bb_cell_set *set, const bb_table *table, uint32_t row)
{
    bb_measured *cell = NULL;
    for (uint32_t i = 0; i < bb_table_column_count(table); i++) {
        const bb_column *column = bb_table_column(table, i);
        const double value = bb_table_get_number(table, row, column->name);
        if (column->kind != BB_COLUMN_NUMBER || column->sense != BB_SENSE_EXACT || !isfinite(value))
            continue;
        if (cell == NULL)
            BB_TRY(add_row(set, table, row, NULL, &cell));
        BB_TRY(bb_measured_add_figure(cell, column->name, column->better, value));
    }
    return BB_OK;
}

bb_status bb_cell_set_of_table(const bb_table *table, const char *what, bb_cell_set *set)
{
    const uint32_t run = bb_table_find(table, (bb_cell){{NULL}});
    memset(set, 0, sizeof *set);
    read_origin(table, what, &set->origin);
    for (uint32_t row = 0; row < bb_table_row_count(table); row++) {
        if (row == run)
            continue;
        BB_TRY(add_numbers(set, table, row));
        BB_TRY(add_rounds(set, table, row));
    }
    bb_cell_set_sort(set);
    return BB_OK;
}

/* ---- by key ---- */

static int by_key(const void *a, const void *b)
{
    return strcmp(((const bb_measured *)a)->key, ((const bb_measured *)b)->key);
}

/* Sorts cells of one key in the order in which they were added. */
static int by_key_and_place(const void *a, const void *b)
{
    const bb_measured *x = a, *y = b;
    int order = by_key(x, y);
    return order != 0 ? order : (x->place > y->place) - (x->place < y->place);
}

static void free_measured(bb_measured *cell)
{
    free(cell->key);
    free(cell->figures);
}

void bb_cell_set_sort(bb_cell_set *set)
{
    for (uint32_t i = 0; i < set->count; i++)
        set->cells[i].place = i;
    qsort(set->cells, set->count, sizeof *set->cells, by_key_and_place);
    uint32_t kept = 0;
    for (uint32_t i = 0; i < set->count; i++) {
        if (kept > 0 && strcmp(set->cells[kept - 1].key, set->cells[i].key) == 0) {
            free_measured(&set->cells[i]);
            set->duplicates++;
        } else {
            set->cells[kept++] = set->cells[i];
        }
    }
    set->count = kept;
}

const bb_measured *bb_cell_set_find(const bb_cell_set *set, const char *key)
{
    const bb_measured wanted = {.key = (char *)(uintptr_t)key};
    return set->count == 0 ? NULL
                           : bsearch(&wanted, set->cells, set->count, sizeof *set->cells, by_key);
}

void bb_cell_set_free(bb_cell_set *set)
{
    for (uint32_t i = 0; i < set->count; i++)
        free_measured(&set->cells[i]);
    free(set->cells);
    memset(set, 0, sizeof *set);
}

bool bb_same_device(const bb_origin *a, const bb_origin *b)
{
    return bb_device_is_like(a->device, a->device_type, b->device, b->device_type);
}

bool bb_same_machine(const bb_origin *a, const bb_origin *b, bool *host)
{
    *host = strcmp(a->host, b->host) == 0;
    return strcmp(a->cpu, b->cpu) == 0 && strcmp(a->device, b->device) == 0 &&
           strcmp(a->driver, b->driver) == 0;
}
