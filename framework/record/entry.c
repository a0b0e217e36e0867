/* Look-ups in the rows of results, and figures that follow from others. */
#include "framework/record/record_private.h"

#include "framework/base/number.h"
#include "framework/builder/tree.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- entries ---- */

const bb_entry *bb_first(const bb_section *section)
{
    return section != NULL ? section->first : NULL;
}

const bb_entry *bb_next(const bb_entry *entry)
{
    return entry->next;
}

uint32_t bb_section_count(const bb_section *section)
{
    return section != NULL ? section->count : 0;
}

const char *bb_part_name(const bb_entry *part)
{
    const char *maker = bb_table_name(part->table, part->row, BB_MAKER);
    return maker[0] != '\0' ? maker : bb_table_name(part->table, part->row, BB_VIEW);
}

static bool has_value(const bb_entry *part, bb_field_id field)
{
    return bb_get_text(part, field)[0] != '\0' || isfinite(bb_get_number(part, field));
}

static const bb_entry *part_from(const bb_entry *part, bb_field_id field)
{
    while (part != NULL && !has_value(part, field))
        part = part->next;
    return part;
}

const bb_entry *bb_first_part(const bb_entry *entry, bb_field_id field)
{
    return entry != NULL ? part_from(entry->parts.first, field) : NULL;
}

const bb_entry *bb_next_part(const bb_entry *part, bb_field_id field)
{
    return part_from(part->next, field);
}

const bb_entry *bb_build_of(const bb_entry *trace)
{
    return trace->build;
}

uint32_t bb_place_of(const bb_entry *entry)
{
    return entry->row;
}

/* ---- look-ups ---- */

const char *bb_get_text(const bb_entry *entry, bb_field_id field)
{
    const bb_field *f = &bb_fields[field];
    if (entry == NULL)
        return "";
    return (f->kind & BB_FIELD_NAME) != 0
               ? bb_table_name(entry->table, entry->row, f->kind >> BB_FIELD_DIMENSION)
               : bb_table_get_text(entry->table, entry->row, f->name);
}

static bb_estimate estimate(const bb_entry *entry, bb_field_id field)
{
    const bb_samples *rounds = bb_table_get_rounds(entry->table, entry->row, bb_fields[field].name);
    return rounds != NULL ? bb_samples_estimate(rounds) : bb_not_measured;
}

static double million_per_s(double count, double ms)
{
    return count / ms / 1e3;
}

/* Of an outside tracer the rate is as given, and has no spread. */
static double rate_of(const bb_entry *trace)
{
    const double given = bb_get_number(trace, BB_F_TRACE_RATE_GIVEN);
    return isfinite(given) ? given
                           : million_per_s(bb_get_number(trace, BB_F_TRACE_COUNT),
                                           bb_get_number(trace, BB_F_TRACE_MS));
}

/* NAN: nothing of it was measured. */
static double untimed_of(const bb_entry *build)
{
    const bool remembers = bb_get_true(build, BB_F_BUILD_REMEMBERS);
    const double parts[] = {
        bb_get_number(build, BB_F_BUILD_RESTORE_MS), bb_get_number(build, BB_F_BUILD_OUTSIDE_MS),
        remembers ? bb_get_number(build, BB_F_BUILD_UNSEEN_MS) - bb_get_number(build, BB_F_BUILD_MS)
                  : (double)NAN};
    double sum = NAN;
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++)
        if (isfinite(parts[i]))
            sum = isfinite(sum) ? sum + parts[i] : parts[i];
    return sum;
}

static double prims_of(const bb_entry *build)
{
    const bb_cell cell = {{[BB_SCENE] = bb_get_text(build, BB_F_BUILD_SCENE)}};
    return bb_table_get_number(build->table, bb_table_find(build->table, cell),
                               bb_fields[BB_F_SCENE_PRIMS].name);
}

/* Returns the tests weighted by their costs in SAH. A binary node, which has two boxes, costs 1.2;
 * a wide node costs children/2 times as much, as in SAH. */
static double work_of(const bb_entry *trace)
{
    return BB_COST_TRAVERSAL * 0.5 * bb_get_number(trace, BB_F_TRACE_NODE_TESTS) +
           BB_COST_INTERSECTION * bb_get_number(trace, BB_F_TRACE_PRIM_TESTS);
}

static double derived(const bb_entry *entry, bb_field_id field)
{
    const double count = bb_get_number(entry, BB_F_TRACE_COUNT);
    switch (field) {
    case BB_F_SCENE_BOXES_MS:
        return bb_get_number(entry, BB_F_SCENE_BOXES_SAMPLES);
    case BB_F_BUILD_MS_MEDIAN:
        return bb_get_number(entry, BB_F_BUILD_MS);
    case BB_F_BUILD_MS_LO:
        return estimate(entry, BB_F_BUILD_MS).low;
    case BB_F_BUILD_MS_HI:
        return estimate(entry, BB_F_BUILD_MS).high;
    case BB_F_BUILD_MS_LEAST:
        return estimate(entry, BB_F_BUILD_MS).least;
    case BB_F_BUILD_MS_MOST:
        return estimate(entry, BB_F_BUILD_MS).most;
    case BB_F_BUILD_UNTIMED:
        return untimed_of(entry);
    case BB_F_BUILD_RATE:
        return million_per_s(prims_of(entry), bb_get_number(entry, BB_F_BUILD_MS));
    case BB_F_TRACE_MS_MEDIAN:
        return bb_get_number(entry, BB_F_TRACE_MS);
    case BB_F_TRACE_RATE:
        return rate_of(entry);
    case BB_F_TRACE_RATE_LO: /* the longest time gives the lowest rate */
        return million_per_s(count, estimate(entry, BB_F_TRACE_MS).high);
    case BB_F_TRACE_RATE_HI:
        return million_per_s(count, estimate(entry, BB_F_TRACE_MS).low);
    case BB_F_TRACE_RATE_LEAST:
        return million_per_s(count, estimate(entry, BB_F_TRACE_MS).most);
    case BB_F_TRACE_RATE_MOST:
        return million_per_s(count, estimate(entry, BB_F_TRACE_MS).least);
    case BB_F_TRACE_WORK:
        return work_of(entry);
    default:
        return (double)NAN;
    }
}

/* The first ray's time belongs to the row of the layout. */
static double first_ray_of(const bb_entry *part)
{
    bb_cell cell = bb_table_cell(part->table, part->row);
    cell.names[BB_MAKER] = NULL;
    const bb_entry build = {.table = part->table, .row = bb_table_find(part->table, cell)};
    return isfinite(bb_get_number(part, BB_F_BUILD_LAYOUTS_MS))
               ? bb_first_ray_ms(&build, bb_part_name(part))
               : (double)NAN;
}

double bb_get_number(const bb_entry *entry, bb_field_id field)
{
    const bb_field *f = &bb_fields[field];
    if (entry == NULL)
        return (double)NAN;
    if (field == BB_F_BUILD_FIRST_RAY)
        return first_ray_of(entry);
    const double number = (f->kind & BB_FIELD_DERIVED) != 0
                              ? derived(entry, field)
                              : bb_table_get_number(entry->table, entry->row, f->name);
    return isfinite(number) ? number : (double)NAN;
}

bool bb_get_true(const bb_entry *entry, bb_field_id field)
{
    return strcmp(bb_get_text(entry, field), "yes") == 0;
}

/* The row of the part; a row that is none has no values. */
static bb_entry part_named(const bb_entry *entry, const char *name)
{
    bb_cell cell = bb_table_cell(entry->table, entry->row);
    cell.names[BB_MAKER] = name;
    const bool named = name[0] != '\0';
    return (bb_entry){.table = entry->table,
                      .row = named ? bb_table_find(entry->table, cell) : BB_NO_ROW};
}

double bb_get_named(const bb_entry *entry, bb_field_id field, const char *name)
{
    if (entry == NULL)
        return (double)NAN;
    const bb_entry part = part_named(entry, name);
    return bb_get_number(&part, field);
}

const char *bb_get_named_text(const bb_entry *entry, bb_field_id field, const char *name)
{
    if (entry == NULL)
        return "";
    const bb_entry part = part_named(entry, name);
    return bb_get_text(&part, field);
}

double bb_left_out_ms(const bb_entry *build)
{
    const double ms = bb_get_number(build, BB_F_BUILD_UNTIMED);
    return ms > BB_UNTIMED_LEAST_MS && ms > BB_UNTIMED_MOST * bb_get_number(build, BB_F_BUILD_MS)
               ? ms
               : 0;
}

double bb_first_ray_ms(const bb_entry *build, const char *layout)
{
    double boxes = bb_get_number(build, BB_F_BUILD_BOXES_MS);
    double transfer = bb_get_number(build, BB_F_BUILD_TRANSFER_MS);
    double layout_ms = bb_get_true(build, BB_F_BUILD_REFERENCE)
                           ? 0
                           : bb_get_named(build, BB_F_BUILD_LAYOUTS_MS, layout);
    return bb_get_number(build, BB_F_BUILD_MS) + layout_ms + (isfinite(boxes) ? boxes : 0) +
           (isfinite(transfer) ? transfer : 0);
}

bool bb_get_samples(const bb_entry *entry, bb_field_id field, bb_samples *samples)
{
    const bb_samples *rounds =
        entry != NULL ? bb_table_get_rounds(entry->table, entry->row, bb_fields[field].name) : NULL;
    samples->count = 0;
    for (uint32_t i = 0; rounds != NULL && i < rounds->count; i++)
        bb_samples_add(samples, rounds->values[i]);
    return rounds != NULL;
}

/* Builds, traces and scenes use the same column. */
const char *bb_get_decision(const bb_entry *entry, const char *what)
{
    return bb_get_named_text(entry, BB_F_BUILD_DECISIONS, what);
}

double bb_get_decided(const bb_entry *entry, const char *what)
{
    uint64_t number;
    return bb_read_whole(bb_get_decision(entry, what), &number) ? (double)number : (double)NAN;
}

bool bb_same_text(const bb_entry *a, const bb_entry *b, bb_field_id field)
{
    return strcmp(bb_get_text(a, field), bb_get_text(b, field)) == 0;
}

/* Builds and traces use the same column. */
bool bb_is_ok(const bb_entry *entry)
{
    return strcmp(bb_get_text(entry, BB_F_TRACE_STATUS), "ok") == 0;
}

uint32_t bb_run_of(const bb_entry *entry)
{
    return (uint32_t)strtoul(bb_get_text(entry, BB_F_TRACE_RUN), NULL, 10);
}

/* ---- tables of papers ---- */

void bb_printed_name(const char *paper, uint32_t table, uint32_t index, bool text,
                     char name[BB_PRINTED_NAME])
{
    snprintf(name, BB_PRINTED_NAME, "%.40s_%u_%u%s", paper, table, index, text ? "_text" : "");
}

/* The row's maker is "TABLE.ROW", that of the headings "TABLE". */
static uint32_t table_of(const bb_entry *row)
{
    return (uint32_t)strtoul(bb_part_name(row), NULL, 10);
}

const bb_entry *bb_next_printed(const bb_entry *row)
{
    const bb_entry *next = bb_next_part(row, BB_F_TABLE_TITLE);
    return next != NULL && table_of(next) == table_of(row) ? next : NULL;
}

bool bb_get_printed(const bb_entry *row, uint32_t index, bb_printed *cell)
{
    char number[BB_PRINTED_NAME], text[BB_PRINTED_NAME];
    const char *paper = bb_get_text(row, BB_F_PAPER_NAME);
    const uint32_t table = table_of(row);
    bb_printed_name(paper, table, index, false, number);
    bb_printed_name(paper, table, index, true, text);
    char first[16];
    bb_cell head = bb_table_cell(row->table, row->row);
    snprintf(first, sizeof first, "%u", table);
    head.names[BB_MAKER] = first;
    *cell = (bb_printed){bb_table_get_text(row->table, bb_table_find(row->table, head), text),
                         bb_table_get_number(row->table, row->row, number),
                         bb_table_get_text(row->table, row->row, text)};
    return cell->heading[0] != '\0';
}

/* ---- metrics of trees ---- */

static double metric_of(const bb_entry *build, const bb_column *column)
{
    return build != NULL ? bb_table_get_number(build->table, build->row, column->name)
                         : (double)NAN;
}

double bb_get_metric(const bb_entry *build, const bb_metric *metric)
{
    return metric_of(build, bb_metric_column(metric, false));
}

double bb_get_metric_half(const bb_entry *build, const bb_metric *metric)
{
    return metric_of(build, bb_metric_column(metric, true));
}

double bb_get_metric_traced(const bb_entry *build, const bb_metric *metric, const char *layout)
{
    const double traced = metric->of_layouts && build != NULL
                              ? bb_get_named(build, BB_F_BUILD_LAYOUTS_SAH, layout)
                              : (double)NAN;
    return isfinite(traced) ? traced : bb_get_metric(build, metric);
}

bool bb_metric_measured(const bb_section *builds, const bb_metric *metric)
{
    bb_each(build, builds) if (isfinite(bb_get_metric(build, metric))) return true;
    return false;
}
