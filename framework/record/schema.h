/* The fields of a result file as data (fields.h), and look-ups by field. Writer, reader, tables,
 * charts and the page use them.
 */
#ifndef BB_SCHEMA_H
#define BB_SCHEMA_H

#include "framework/base/statistics.h"
#include "framework/builder/metric.h"
#include "framework/table/table.h"

#include <stdbool.h>
#include <stddef.h>

/* A row of the results, such as that of a scene, a build or a trace. */
typedef struct bb_entry bb_entry;
/* All entries of one sort, in the order in which they were added. */
typedef struct bb_section bb_section;

/* The sort of row in which a field stands. */
typedef enum bb_field_part {
    BB_IN_CONTEXT,
    BB_IN_STEP, /* of the run */
    BB_IN_SCENE,
    BB_IN_PROFILE, /* of a scene */
    BB_IN_BUILD,
    BB_IN_TREE, /* of a build */
    BB_IN_TRACE,
    BB_IN_ACCURACY, /* of a trace */
    BB_IN_SKIPPED,
    BB_IN_PICTURE,
    BB_IN_PREDICTION,
    BB_IN_PAPER, /* a reproduced paper */
    BB_IN_TABLE, /* of a paper */
    BB_IN_CLAIM, /* of a paper */
    BB_PARTS
} bb_field_part;

/* How tables show a field. */
typedef enum bb_format {
    BB_AS_TEXT,
    BB_AS_FIGURE, /* some significant digits */
    BB_AS_WHOLE,  /* digits in groups of three */
    BB_AS_BYTES,  /* KiB, MiB ... */
    BB_AS_PAIRS,  /* names with figures or texts */
} bb_format;

/* What a field's values are. */
enum {
    BB_FIELD_NAME = 1 << 0, /* one of the row's names: the dimension is in the bits above */
    BB_FIELD_TEXT = 1 << 1,
    BB_FIELD_FLAG = 1 << 2, /* text: "yes", "no", or none if it is not known */
    BB_FIELD_NUMBER = 1 << 3,
    BB_FIELD_ROUNDS = 1 << 4,
    BB_FIELD_DERIVED = 1 << 5, /* a number in no file */
    BB_FIELD_PARTS = 1 << 6,   /* each maker has a value, in a row of its own */
    BB_FIELD_NEEDED = 1 << 7,  /* each entry has one */
    BB_FIELD_SIGNED = 1 << 8,  /* a time that may be negative: a rest */
    BB_FIELD_EXACT = 1 << 9,   /* a rate that is not timed */
    BB_FIELD_DIMENSION = 10,   /* the first of the bits above */
};

typedef enum bb_field_id {
#define FIELD(id, part, name, unit, kind, writer, format, heading, help) BB_F_##id,
#include "framework/record/fields.h"
    BB_FIELDS
} bb_field_id;

typedef struct bb_field {
    bb_field_part part;
    const char *name; /* in the file */
    const char *unit; /* "" for none */
    unsigned kind;
    bb_format format;
    const char *heading; /* of the column; NULL: in no table */
    const char *help;    /* one line of explanation; may be NULL */
} bb_field;

extern const bb_field bb_fields[BB_FIELDS];

/* Returns the column of a field in the file, which fields of the same name share. NULL for names
 * and derived figures. */
const bb_column *bb_field_column(bb_field_id field);
/* Returns the column of a metric of trees, or of the half width of its interval. */
const bb_column *bb_metric_column(const bb_metric *metric, bool half);

/* Returns the schema for the page: { "trace": { "mrays_s": { heading, unit, format, help }, ... },
 * ... } with all fields that have headings, and "metrics": [{ name, title, ... }]. From malloc.
 * NULL without memory. */
char *bb_schema_json(void);

/* ---- entries ---- */

const bb_entry *bb_first(const bb_section *section); /* NULL: there is none */
const bb_entry *bb_next(const bb_entry *entry);
uint32_t bb_section_count(const bb_section *section);
#define bb_each(entry, section)                                                                    \
    for (const bb_entry *entry = bb_first(section); entry != NULL; entry = bb_next(entry))

/* A part is a row of an entry: a phase, a layout or a parameter of a build, a view of a scene. Its
 * name is that of its maker, or of the view. */
const char *bb_part_name(const bb_entry *part);
/* Return the first and the next part of an entry that has a value of the field; NULL: none. */
const bb_entry *bb_first_part(const bb_entry *entry, bb_field_id field);
const bb_entry *bb_next_part(const bb_entry *part, bb_field_id field);
#define bb_each_part(part, entry, field)                                                           \
    for (const bb_entry *part = bb_first_part(entry, field); part != NULL;                         \
         part = bb_next_part(part, field))

/* Returns the build whose tree a trace went through. */
const bb_entry *bb_build_of(const bb_entry *trace);
/* Returns the entry's place among all entries: it grows in the order in which they were added. */
uint32_t bb_place_of(const bb_entry *entry);

/* ---- look-ups; `entry` may be NULL, and then has no values ---- */

/* Return the entry's value; "", NAN or false if there is none. The number of rounds is their
 * median, the text of a flag "yes" or "no". */
const char *bb_get_text(const bb_entry *entry, bb_field_id field);
double bb_get_number(const bb_entry *entry, bb_field_id field);
bool bb_get_true(const bb_entry *entry, bb_field_id field);
/* Return the value of the part `name`; NAN or "" if there is none. */
double bb_get_named(const bb_entry *entry, bb_field_id field, const char *name);
const char *bb_get_named_text(const bb_entry *entry, bb_field_id field, const char *name);
/* Returns the time before the first ray, in ms: boxes, build, a host builder's transfer, and the
 * layout. For a reference it is the build alone, which includes boxes and layout and needs no
 * transfer. NAN if the build or the layout was not measured. */
double bb_first_ray_ms(const bb_entry *build, const char *layout);

/* A builder that does more than this part of its build again outside the clock, and more than the
 * call of an empty hook takes, is never the fastest. */
#define BB_UNTIMED_MOST 0.1
#define BB_UNTIMED_LEAST_MS 0.02
/* Returns what recurs with each build outside its clock, in ms, if it is more than that; else 0. */
double bb_left_out_ms(const bb_entry *build);
/* Copies the rounds. Returns false if there are none. */
bool bb_get_samples(const bb_entry *entry, bb_field_id field, bb_samples *samples);
/* Return the decision on `what` as text and as number; "" and NAN if there is none. */
const char *bb_get_decision(const bb_entry *entry, const char *what);
double bb_get_decided(const bb_entry *entry, const char *what);
/* Returns whether both entries have the same text in this field. */
bool bb_same_text(const bb_entry *a, const bb_entry *b, bb_field_id field);
/* Returns whether the status of a build or trace is ok. */
bool bb_is_ok(const bb_entry *entry);
/* Returns the number of the entry's run in merged results; 0 is the first. */
uint32_t bb_run_of(const bb_entry *entry);

/* A cell of a paper's table: a number (NAN: not measured), or a text. */
typedef struct bb_printed {
    const char *heading;
    double number;
    const char *text; /* "": it is a number */
} bb_printed;
/* Returns cell `index` of a row of a paper's table, whose first row has headings alone; false: the
 * table has no such column. */
bool bb_get_printed(const bb_entry *row, uint32_t index, bb_printed *cell);
/* Returns the next row of the same table; NULL: it was the last. */
const bb_entry *bb_next_printed(const bb_entry *row);
/* Writes the name of that column, of its numbers or its texts. */
enum { BB_PRINTED_NAME = 65 };
void bb_printed_name(const char *paper, uint32_t table, uint32_t index, bool text,
                     char name[BB_PRINTED_NAME]);

/* ---- metrics of trees ---- */

/* Returns a metric of a build's tree as built; NAN: not measured. */
double bb_get_metric(const bb_entry *build, const bb_metric *metric);
/* Returns the half width of the metric's interval; NAN: not measured, or not sampled. */
double bb_get_metric_half(const bb_entry *build, const bb_metric *metric);
/* Returns a metric of a build's layout as traced, or of its tree if the file has none of the
 * layout. */
double bb_get_metric_traced(const bb_entry *build, const bb_metric *metric, const char *layout);
/* Returns whether one of the builds has the metric. */
bool bb_metric_measured(const bb_section *builds, const bb_metric *metric);

#endif
