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
    char canonical[BB_CELL_KEY];
    const bool fits = strlen(key) < BB_CELL_KEY;
    if (fits)
        bb_cell_key_canonical(key, canonical);
    *cell = &set->cells[set->count];
    memset(*cell, 0, sizeof **cell);
    (*cell)->key = strdup(fits ? canonical : key);
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

/* ---- from a table ---- */

static void copy(char *to, size_t capacity, const char *text)
{
    snprintf(to, capacity, "%s", text);
}

/* Whether the row describes a run of the table; the first run's has no name at all. */
static bool is_about_run(const bb_table *table, uint32_t row)
{
    for (int d = 0; d < BB_DIMENSIONS; d++)
        if (d != BB_RUN && bb_table_name(table, row, (bb_dimension)d)[0] != '\0')
            return false;
    return true;
}

/* Puts a text that a run gives in place of none, and "several" in place of another one. */
static void add_text(char *to, size_t capacity, const char *text)
{
    if (text[0] != '\0' && strcmp(to, text) != 0)
        copy(to, capacity, to[0] != '\0' ? BB_SEVERAL : text);
}

/* Adds what a run says of itself. The date is that of the latest. */
static void add_origin(const bb_table *from, uint32_t run, bb_origin *origin)
{
    const struct {
        const char *column;
        char *to;
        size_t capacity;
    } texts[] = {
        {"revision", origin->revision, sizeof origin->revision},
        {"host", origin->host, sizeof origin->host},
        {"cpu", origin->cpu, sizeof origin->cpu},
        {"device", origin->device, sizeof origin->device},
        {"device_type", origin->device_type, sizeof origin->device_type},
        {"driver", origin->driver, sizeof origin->driver},
        {"embree_version", origin->embree, sizeof origin->embree},
        {"seed", origin->seed, sizeof origin->seed},
        {"shard", origin->shard, sizeof origin->shard},
        {"reduced_to", origin->reduced_to, sizeof origin->reduced_to},
        {"governor", origin->governor, sizeof origin->governor},
        {"smt", origin->smt, sizeof origin->smt},
        {"boost", origin->boost, sizeof origin->boost},
        {"processors", origin->processors, sizeof origin->processors},
    };
    const char *date = bb_table_get_text(from, run, "date");
    origin->has_reduced_to = true;
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++)
        add_text(texts[i].to, texts[i].capacity, bb_table_get_text(from, run, texts[i].column));
    if (strcmp(date, origin->date) > 0)
        copy(origin->date, sizeof origin->date, date);
    const double threads = bb_table_get_number(from, run, "cpu_threads");
    const double busy = bb_table_get_number(from, run, "busy_processors") / threads;
    if (threads > 0 && busy > origin->busy)
        origin->busy = busy;
    if (strcmp(bb_table_get_text(from, run, "interrupted"), "yes") == 0)
        origin->interrupted = true;
}

/* A row of a table whose cells go into a set. */
typedef struct source {
    bb_cell_set *set;
    const bb_table *table;
    uint32_t row;
    bool clocks;
} source;

static const char *text_of(const source *s, uint32_t row, bb_field_id field)
{
    return bb_table_get_text(s->table, row, bb_fields[field].name);
}

static uint32_t scene_of(const source *s)
{
    bb_cell scene = {{[BB_RUN] = bb_table_name(s->table, s->row, BB_RUN),
                      [BB_SCENE] = bb_table_name(s->table, s->row, BB_SCENE)}};
    const uint32_t own = bb_table_find(s->table, scene);
    scene.names[BB_RUN] = NULL;
    return own != BB_NO_ROW ? own : bb_table_find(s->table, scene);
}

/* Adds a cell for the row, with the rounds of the column `timed`, which are called `time`; NULL:
 * none. */
static bb_status add_cell(const source *s, const char *key, const char *timed, const char *time,
                          bb_measured **out)
{
    bb_measured *cell;
    const char *status = text_of(s, s->row, BB_F_TRACE_STATUS);
    const bb_samples *rounds = timed != NULL ? bb_table_get_rounds(s->table, s->row, timed) : NULL;
    BB_TRY(bb_cell_set_add(s->set, key, &cell));
    cell->place = s->row;
    copy(cell->time, sizeof cell->time, time);
    cell->reference = strcmp(text_of(s, s->row, BB_F_TRACE_REFERENCE), "yes") == 0;
    copy(cell->status, sizeof cell->status, status[0] != '\0' ? status : "ok");
    copy(cell->scene_hash, sizeof cell->scene_hash, text_of(s, scene_of(s), BB_F_SCENE_HASH));
    copy(cell->rays_hash, sizeof cell->rays_hash, text_of(s, s->row, BB_F_TRACE_RAYS_HASH));
    for (uint32_t i = 0; rounds != NULL && i < rounds->count; i++)
        bb_samples_add(&cell->ms, rounds->values[i]);
    *out = cell;
    return BB_OK;
}

static bb_status end_key(bb_key_writer *w)
{
    w->key[w->length] = '\0';
    return !w->full ? BB_OK
                    : bb_fail(BB_INVALID, "cell '%.60s...': its key has more than %d bytes", w->key,
                              BB_CELL_KEY - 1);
}

/* ---- rows of `run`, which have keys ---- */

static const bb_field_id of_builds[] = {BB_F_TREE_NODES,     BB_F_TREE_LEAVES, BB_F_TREE_REFS,
                                        BB_F_TREE_ARITY,     BB_F_TREE_DEPTH,  BB_F_TREE_BYTES,
                                        BB_F_TREE_BYTES_PEAK};
static const bb_field_id of_layouts[] = {BB_F_BUILD_LAYOUTS_SAH, BB_F_BUILD_LAYOUTS_BYTES};
static const bb_field_id of_traces[] = {
    BB_F_TRACE_COUNT,         BB_F_TRACE_STACK,        BB_F_TRACE_NODE_TESTS,
    BB_F_TRACE_PRIM_TESTS,    BB_F_TRACE_UNLIKE,       BB_F_ACCURACY_MISSED,
    BB_F_ACCURACY_FALSE,      BB_F_ACCURACY_WRONG_T,   BB_F_ACCURACY_UNWRITTEN,
    BB_F_ACCURACY_OVERFLOWED, BB_F_ACCURACY_T_ULP_MAX, BB_F_ACCURACY_CHECKED};

/* Adds the row's number of the column `column`, if there is one, under a name. */
static bb_status add_number(const source *s, uint32_t row, const char *column, const char *name,
                            bb_better better, bb_measured *cell)
{
    const double value = bb_table_get_number(s->table, row, column);
    return isfinite(value) ? bb_measured_add_figure(cell, name, better, value) : BB_OK;
}

static bb_status add_fields(const source *s, uint32_t row, const bb_field_id *fields, size_t count,
                            bb_measured *cell)
{
    for (size_t i = 0; i < count; i++)
        BB_TRY(add_number(s, row, bb_fields[fields[i]].name, bb_fields[fields[i]].name,
                          bb_field_better(fields[i]), cell));
    return BB_OK;
}

bool bb_is_clock(const char *key)
{
    return strstr(key, BB_KEY_OF_CLOCK) != NULL;
}

void bb_wall_key(const char *key, char wall[BB_CELL_KEY])
{
    const char *clock = strstr(key, BB_KEY_OF_CLOCK);
    const size_t before = clock != NULL ? (size_t)(clock - key) : strlen(key);
    const size_t value = clock != NULL ? sizeof BB_KEY_OF_CLOCK - 1 : 0;
    const char *behind = key + before + value;
    snprintf(wall, BB_CELL_KEY, "%.*s%s", (int)before, key, behind + strcspn(behind, "/"));
}

/* Writes the key of a cell that belongs to another: that one's, with a name and value behind it. */
static bb_status write_key_behind(const char *of, const char *name, const char *value,
                                  char key[BB_CELL_KEY])
{
    bb_key_writer w = {.key = key, .length = strnlen(of, BB_CELL_KEY - 1)};
    memcpy(key, of, w.length);
    bb_key_put(&w, name, value);
    return end_key(&w);
}

/* Adds a cell of the processor's time, if it is a figure of its own: that of a GPU's host says
 * nothing. What has failed, or is missing, is said by the cell itself. */
static bb_status add_clock(const source *s, const char *of, bb_field_id field, const char *time)
{
    const bb_samples *rounds = bb_table_get_rounds(s->table, s->row, bb_fields[field].name);
    bb_measured *cell;
    char key[BB_CELL_KEY];
    if (!s->clocks || rounds == NULL || strcmp(text_of(s, s->row, BB_F_TRACE_STATUS), "ok") != 0 ||
        strcmp(s->set->origin.device_type, BB_DEVICE_CPU) != 0)
        return BB_OK;
    BB_TRY(write_key_behind(of, "clock", "cpu", key));
    return add_cell(s, key, bb_fields[field].name, time, &cell);
}

static bb_status add_build(const source *s, const char *key)
{
    bb_measured *cell;
    BB_TRY(add_clock(s, key, BB_F_BUILD_CPU_SAMPLES, "build CPU ms"));
    BB_TRY(add_cell(s, key, bb_fields[BB_F_BUILD_MS].name, "build ms", &cell));
    BB_TRY(add_fields(s, scene_of(s), (bb_field_id[]){BB_F_SCENE_PRIMS}, 1, cell));
    BB_TRY(add_fields(s, s->row, of_builds, sizeof of_builds / sizeof of_builds[0], cell));
    for (uint32_t i = 0; i < bb_metric_count(); i++)
        BB_TRY(
            add_number(s, s->row, bb_metrics[i]->name, bb_metrics[i]->name, BB_BETTER_LESS, cell));
    return BB_OK;
}

static bb_status add_trace(const source *s, const char *key)
{
    bb_measured *cell;
    BB_TRY(add_clock(s, key, BB_F_TRACE_CPU_MS, "trace CPU ms"));
    BB_TRY(add_cell(s, key, bb_fields[BB_F_TRACE_MS].name, "trace ms", &cell));
    return add_fields(s, s->row, of_traces, sizeof of_traces / sizeof of_traces[0], cell);
}

/* Parts that are cells: layouts of builds; simulations of builds and traces, without a time, and
 * all of which is exact. */
typedef struct part_kind {
    const char *word; /* in the key */
    const char *time; /* what the rounds are called; "" for none */
    bb_field_id rounds;
    const bb_field_id *fields;
    size_t count;
} part_kind;

static const bb_field_id of_simulations[] = {
#define SIMT(id, member, name, unit, better, heading, help) BB_F_SIMT_##id,
#include "framework/simulate/simt_figures.h"
};
static const bb_field_id of_simulated_builds[] = {
#define SIMT_BUILD(id, member, name, unit, better, heading, help) BB_F_SIMT_BUILD_##id,
#include "framework/simulate/simt_build_figures.h"
};
static const part_kind layouts = {"layout", "layout ms", BB_F_BUILD_LAYOUTS_MS, of_layouts,
                                  sizeof of_layouts / sizeof of_layouts[0]};
static const part_kind simulations = {.word = "simulated",
                                      .time = "",
                                      .fields = of_simulations,
                                      .count = sizeof of_simulations / sizeof of_simulations[0]};

static const part_kind simulated_builds = {.word = "simulated",
                                           .time = "",
                                           .fields = of_simulated_builds,
                                           .count = sizeof of_simulated_builds /
                                                    sizeof of_simulated_builds[0]};

/* A part's cell has the key of its build or trace, `of`, with its own name behind it. */
static bb_status add_part(const source *s, uint32_t of, const part_kind *kind)
{
    bb_measured *cell;
    char key[BB_CELL_KEY];
    const char *timed = kind->time[0] != '\0' ? bb_fields[kind->rounds].name : NULL;
    BB_TRY(write_key_behind(text_of(s, of, BB_F_TRACE_CELL), kind->word,
                            bb_table_name(s->table, s->row, BB_MAKER), key));
    BB_TRY(add_cell(s, key, timed, kind->time, &cell));
    copy(cell->status, sizeof cell->status, text_of(s, of, BB_F_TRACE_STATUS));
    copy(cell->rays_hash, sizeof cell->rays_hash, text_of(s, of, BB_F_TRACE_RAYS_HASH));
    return add_fields(s, s->row, kind->fields, kind->count, cell);
}

static bool is_simulation(const source *s)
{
    return isfinite(bb_table_get_number(s->table, s->row, bb_fields[BB_F_SIMT_STEPS].name));
}

static bool is_simulated_build(const source *s)
{
    return isfinite(bb_table_get_number(s->table, s->row, bb_fields[BB_F_SIMT_BUILD_MS].name));
}

static bool is_layout(const source *s)
{
    return bb_table_get_rounds(s->table, s->row, bb_fields[BB_F_BUILD_LAYOUTS_MS].name) != NULL;
}

static uint32_t build_of(const source *s)
{
    bb_cell build = bb_table_cell(s->table, s->row);
    build.names[BB_MAKER] = NULL;
    return bb_table_find(s->table, build);
}

/* Rows with a maker are parts, of which only layouts and simulations are cells. A build without a
 * key is of another program's tree, and an unmeasured one is another shard's. */
static bb_status add_row_of_run(const source *s)
{
    const bool part = bb_table_name(s->table, s->row, BB_MAKER)[0] != '\0';
    const uint32_t row = part ? build_of(s) : s->row;
    const char *key = row != BB_NO_ROW ? text_of(s, row, BB_F_TRACE_CELL) : "";
    if (key[0] == '\0' || strcmp(text_of(s, row, BB_F_BUILD_UNMEASURED), "yes") == 0)
        return BB_OK;
    if (part)
        return is_layout(s)            ? add_part(s, row, &layouts)
               : is_simulation(s)      ? add_part(s, row, &simulations)
               : is_simulated_build(s) ? add_part(s, row, &simulated_builds)
                                       : BB_OK;
    return bb_table_name(s->table, s->row, BB_QUESTION)[0] != '\0' ? add_trace(s, key)
                                                                   : add_build(s, key);
}

/* ---- rows of other commands ---- */

/* Writes a key of the row's names and of the column of times; NULL: the row's numbers. */
static bb_status write_key(const source *s, const bb_column *time, char key[BB_CELL_KEY])
{
    bb_key_writer w = {.key = key};
    bb_key_put(&w, "command", bb_table_command(s->table));
    for (int d = BB_RUN + 1; d < BB_DIMENSIONS; d++)
        bb_key_put(&w, bb_dimension_names[d], bb_table_name(s->table, s->row, (bb_dimension)d));
    bb_key_put(&w, "time", time != NULL ? time->name : "");
    return end_key(&w);
}

/* Adds a cell for each column of rounds in which less is better. */
static bb_status add_rounds(const source *s)
{
    for (uint32_t i = 0; i < bb_table_column_count(s->table); i++) {
        const bb_column *column = bb_table_column(s->table, i);
        char key[BB_CELL_KEY], time[64];
        bb_measured *cell;
        if (column->better != BB_BETTER_LESS ||
            bb_table_get_rounds(s->table, s->row, column->name) == NULL)
            continue;
        snprintf(time, sizeof time, "%.40s %.20s", column->heading, column->unit);
        BB_TRY(write_key(s, column, key));
        BB_TRY(add_cell(s, key, column->name, time, &cell));
    }
    return BB_OK;
}

static bb_status add_numbers(const source *s)
{
    char key[BB_CELL_KEY];
    bb_measured *cell = NULL;
    for (uint32_t i = 0; i < bb_table_column_count(s->table); i++) {
        const bb_column *column = bb_table_column(s->table, i);
        if (column->kind != BB_COLUMN_NUMBER || column->sense != BB_SENSE_EXACT ||
            !isfinite(bb_table_get_number(s->table, s->row, column->name)))
            continue;
        if (cell == NULL) {
            BB_TRY(write_key(s, NULL, key));
            BB_TRY(add_cell(s, key, NULL, "", &cell));
        }
        BB_TRY(add_number(s, s->row, column->name, column->name, column->better, cell));
    }
    return BB_OK;
}

static bb_status add_row(const source *s)
{
    BB_TRY(add_numbers(s));
    return add_rounds(s);
}

/* Puts the number of the run behind the keys of all but the first run of a merged table: cells of
 * two runs are not one cell. */
static bb_status name_runs(const bb_table *table, bb_cell_set *set)
{
    for (uint32_t i = 0; i < set->count; i++) {
        bb_measured *cell = &set->cells[i];
        const char *run = bb_table_name(table, cell->place, BB_RUN);
        if (run[0] == '\0')
            continue;
        const size_t size = strlen(cell->key) + sizeof BB_KEY_OF_RUN + strlen(run);
        char *key = malloc(size);
        if (key == NULL)
            return no_memory();
        snprintf(key, size, "%s" BB_KEY_OF_RUN "%s", cell->key, run);
        free(cell->key);
        cell->key = key;
    }
    return BB_OK;
}

static bb_status take_table(const bb_table *table, const char *what, bool clocks, bb_cell_set *set)
{
    const bool keys = strcmp(bb_table_command(table), "run") == 0;
    memset(set, 0, sizeof *set);
    copy(set->origin.what, sizeof set->origin.what, what);
    bb_status status = bb_table_check_runs(table);
    if (status != BB_OK)
        return bb_fail(status, "%.200s: %s", what, bb_message());
    for (uint32_t row = 0; row < bb_table_row_count(table); row++) {
        const source s = {set, table, row, clocks};
        if (is_about_run(table, row))
            add_origin(table, row, &set->origin);
        else
            BB_TRY(keys ? add_row_of_run(&s) : add_row(&s));
    }
    BB_TRY(name_runs(table, set));
    bb_cell_set_sort(set);
    return BB_OK;
}

bb_status bb_cell_set_of_table(const bb_table *table, const char *what, bb_cell_set *set)
{
    return take_table(table, what, false, set);
}

bb_status bb_cell_set_of_pair(const bb_table *table, const char *what, bb_cell_set *set)
{
    return take_table(table, what, true, set);
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
