/* The table of fields as data, with the columns of the file. */
#include "framework/record/schema.h"

#include "framework/base/json.h"
#include "framework/device/run_row.h"

#include <stdio.h>
#include <string.h>

/* The short forms of fields.h. */
enum {
    TEXT = BB_FIELD_TEXT,
    FLAG = BB_FIELD_FLAG,
    NUMBER = BB_FIELD_NUMBER,
    ROUNDS = BB_FIELD_ROUNDS,
    DERIVED = BB_FIELD_DERIVED,
    PARTS = BB_FIELD_PARTS,
    NEEDED = BB_FIELD_NEEDED,
    SIGNED = BB_FIELD_SIGNED,
    EXACT = BB_FIELD_EXACT,
};
#define NAME(dimension) (BB_FIELD_NAME | BB_##dimension << BB_FIELD_DIMENSION)

const bb_field bb_fields[BB_FIELDS] = {
#define FIELD(id, part, name, unit, kind, writer, format, heading, help)                           \
    [BB_F_##id] = {BB_IN_##part, name, unit, kind, BB_##format, heading, help},
#include "framework/record/fields.h"
};

/* ---- columns ---- */

/* Times differ from one run to the next, and so do rates, unless the field says otherwise. */
static void set_sense(bb_column *column, bool exact)
{
    const size_t length = strlen(column->unit);
    const bool rate = length > 2 && strcmp(column->unit + length - 2, "/s") == 0;
    const bool time = strcmp(column->unit, "ms") == 0;
    column->sense = (rate || time) && !exact ? BB_SENSE_TIMED : BB_SENSE_EXACT;
    column->better = time ? BB_BETTER_LESS : rate ? BB_BETTER_MORE : BB_BETTER_NEITHER;
}

const bb_column *bb_field_column(bb_field_id field)
{
    static bb_column columns[BB_FIELDS];
    if ((bb_fields[field].kind & (BB_FIELD_NAME | BB_FIELD_DERIVED)) != 0)
        return NULL;
    size_t first = 0;
    while (strcmp(bb_fields[first].name, bb_fields[field].name) != 0 ||
           (bb_fields[first].kind & BB_FIELD_DERIVED) != 0)
        first++;
    if (bb_fields[first].part == BB_IN_CONTEXT) /* these are the first fields */
        return &bb_run_columns[first];
    const bb_field *f = &bb_fields[first];
    bb_column *column = &columns[first];
    if (column->name == NULL) {
        *column =
            (bb_column){.name = f->name,
                        .heading = f->heading != NULL ? f->heading : f->name,
                        .unit = f->unit,
                        .help = f->help != NULL ? f->help : "",
                        .kind = (f->kind & BB_FIELD_ROUNDS) != 0   ? BB_COLUMN_ROUNDS
                                : (f->kind & BB_FIELD_NUMBER) != 0 ? BB_COLUMN_NUMBER
                                                                   : BB_COLUMN_TEXT,
                        .decimals = f->format == BB_AS_FIGURE || f->format == BB_AS_PAIRS ? -1 : 0};
        set_sense(column, (f->kind & BB_FIELD_EXACT) != 0);
    }
    return column;
}

const bb_column *bb_metric_column(const bb_metric *metric, bool half)
{
    static bb_column columns[BB_METRICS_MAX][2];
    static char halves[BB_METRICS_MAX][64];
    const uint32_t m = bb_metric_find(metric->name);
    bb_column *column = &columns[m][half];
    if (column->name == NULL) {
        snprintf(halves[m], sizeof halves[m], "%s_half", metric->name);
        *column = (bb_column){.name = half ? halves[m] : metric->name,
                              .heading = half ? halves[m] : metric->title,
                              .unit = metric->unit,
                              .help = half ? "half width of the interval" : metric->full_title,
                              .better = half ? BB_BETTER_NEITHER : BB_BETTER_LESS,
                              .decimals = -1};
    }
    return column;
}

/* ---- for the page ---- */

static const char *const part_names[BB_PARTS] = {
    [BB_IN_CONTEXT] = "context",       [BB_IN_STEP] = "step",
    [BB_IN_SCENE] = "scene",           [BB_IN_PROFILE] = "profile",
    [BB_IN_BUILD] = "build",           [BB_IN_TREE] = "tree",
    [BB_IN_TRACE] = "trace",           [BB_IN_ACCURACY] = "accuracy",
    [BB_IN_SKIPPED] = "skipped",       [BB_IN_PICTURE] = "picture",
    [BB_IN_PREDICTION] = "prediction", [BB_IN_PAPER] = "paper",
    [BB_IN_TABLE] = "table",           [BB_IN_CLAIM] = "claim"};
static const char *const format_names[] = {[BB_AS_TEXT] = "text",
                                           [BB_AS_FIGURE] = "figure",
                                           [BB_AS_WHOLE] = "whole",
                                           [BB_AS_BYTES] = "bytes",
                                           [BB_AS_PAIRS] = "pairs"};

static void add_field(bb_json *json, const bb_field *f)
{
    bb_json_object(json, f->name);
    bb_json_add_text(json, "heading", f->heading);
    bb_json_add_text(json, "unit", f->unit);
    bb_json_add_text(json, "format", format_names[f->format]);
    if (f->help != NULL)
        bb_json_add_text(json, "help", f->help);
    bb_json_end_object(json);
}

static void add_metric(bb_json *json, const bb_metric *metric)
{
    bb_json_object(json, NULL);
    bb_json_add_text(json, "name", metric->name);
    bb_json_add_text(json, "title", metric->title);
    bb_json_add_text(json, "full_title", metric->full_title);
    bb_json_add_text(json, "unit", metric->unit);
    bb_json_add_text(json, "summary", metric->summary);
    bb_json_add_bool(json, "on_request", metric->on_request);
    bb_json_add_bool(json, "of_layouts", metric->of_layouts);
    if (metric->sampled)
        bb_json_add_text(json, "half", bb_metric_column(metric, true)->name);
    bb_json_end_object(json);
}

char *bb_schema_json(void)
{
    bb_json json = {0};
    bb_json_object(&json, NULL);
    for (int part = 0; part < BB_PARTS; part++) {
        bb_json_object(&json, part_names[part]);
        for (size_t i = 0; i < BB_FIELDS; i++)
            if ((int)bb_fields[i].part == part && bb_fields[i].heading != NULL)
                add_field(&json, &bb_fields[i]);
        bb_json_end_object(&json);
    }
    bb_json_array(&json, "metrics");
    for (uint32_t i = 0; i < bb_metric_count(); i++)
        add_metric(&json, bb_metrics[i]);
    bb_json_end_array(&json);
    bb_json_end_object(&json);
    return bb_json_take(&json);
}
