/* The schema of the result file as data: its fields with names, units, formats, headings and help
 * (fields.h), and look-ups by field. Writer, reader, tables, charts and the page take all of these
 * from here.
 */
#ifndef BB_SCHEMA_H
#define BB_SCHEMA_H

#include "framework/base/statistics.h"
#include "framework/tree/metric.h"

#include <stdbool.h>
#include <stddef.h>

typedef struct cJSON cJSON; /* opaque here; libcjson */

/* A scene, a build, a trace ... of a result document. */
typedef cJSON bb_entry;
/* Entries of one kind, in the order in which they were added. */
typedef cJSON bb_section;

/* Where a field stands. */
typedef enum bb_field_part {
    BB_IN_CONTEXT,
    BB_IN_SCENE,
    BB_IN_PROFILE, /* of a scene: its member "profile" */
    BB_IN_BUILD,
    BB_IN_TREE, /* of a build: its member "tree" */
    BB_IN_TRACE,
    BB_IN_ACCURACY, /* of a trace: its member "accuracy" */
    BB_IN_SKIPPED,
    BB_IN_PICTURE,
    BB_IN_PREDICTION,
    BB_IN_PAPER, /* reproduced */
    BB_IN_TABLE, /* of a paper */
    BB_IN_CLAIM, /* of a paper */
    BB_PARTS
} bb_field_part;

/* How tables show it. */
typedef enum bb_format {
    BB_AS_TEXT,
    BB_AS_FIGURE, /* some significant digits */
    BB_AS_WHOLE,  /* digits in groups of three */
    BB_AS_BYTES,  /* KiB, MiB ... */
    BB_AS_PAIRS,  /* names with figures or texts */
} bb_format;

/* Types of a member of the file; a field takes one or several. */
enum {
    BB_JSON_TEXT = 1 << 0,
    BB_JSON_NUMBER = 1 << 1,
    BB_JSON_BOOLEAN = 1 << 2,
    BB_JSON_OBJECT = 1 << 3,
    BB_JSON_NUMBERS = 1 << 4, /* array of numbers or nulls */
    BB_JSON_TEXTS = 1 << 5,   /* array of strings */
    BB_JSON_FIGURES = 1 << 6, /* object of numbers or nulls */
    BB_JSON_NONE = 1 << 7,    /* null or absent */
};

typedef enum bb_field_id {
#define FIELD(id, part, name, unit, types, writer, format, heading, help) BB_F_##id,
#include "framework/record/fields.h"
    BB_FIELDS
} bb_field_id;

typedef struct bb_field {
    bb_field_part part;
    const char *name; /* in the file */
    const char *unit; /* "" for none */
    unsigned types;
    bb_format format;
    const char *heading; /* of a column; NULL: in no table */
    const char *help;    /* a line on it; may be NULL */
} bb_field;

extern const bb_field bb_fields[BB_FIELDS];

/* Whether `item` (NULL: absent) is of one of the types. */
bool bb_json_is(const cJSON *item, unsigned types);

/* The schema for the page: { "trace": { "mrays_s": { heading, unit, format, help }, ... }, ... },
 * of fields with headings, and "metrics": [{ name, title, ... }]. For cJSON_free(); NULL without
 * memory. */
char *bb_schema_json(void);

/* ---- metrics of trees ---- */

enum { BB_METRIC_FIELD = 64 };
/* Name of the field with the half width of its interval. */
void bb_metric_half_name(const bb_metric *metric, char name[BB_METRIC_FIELD]);
/* Of a build's tree as built; NAN: not measured. */
double bb_get_metric(const bb_entry *build, const bb_metric *metric);
/* Of a build's layout as traced, if the file has that; else of its tree. */
double bb_get_metric_traced(const bb_entry *build, const bb_metric *metric, const char *layout);
/* Whether one of the builds has it. */
bool bb_metric_measured(const bb_section *builds, const bb_metric *metric);

/* ---- entries ---- */

const bb_entry *bb_first(const bb_section *section); /* NULL: there is none */
const bb_entry *bb_next(const bb_entry *entry);
uint32_t bb_section_count(const bb_section *section);
#define bb_each(entry, section)                                                                    \
    for (const bb_entry *entry = bb_first(section); entry != NULL; entry = bb_next(entry))

/* What has a name and a figure of its own: a phase, a layout, a step of the run. */
const char *bb_part_name(const bb_entry *part);
double bb_part_number(const bb_entry *part); /* NAN: not measured */
/* The first part that `field` of the entry has; NULL: none. bb_next() gives the others. */
const bb_entry *bb_first_part(const bb_entry *entry, bb_field_id field);
#define bb_each_part(part, entry, field)                                                           \
    for (const bb_entry *part = bb_first_part(entry, field); part != NULL; part = bb_next(part))

/* ---- look-ups; `entry` is a whole scene, build, trace ..., for fields of inner parts too ---- */

/* The member; NULL if there is none. */
const cJSON *bb_get(const bb_entry *entry, bb_field_id field);
/* "" / NAN / false where there is none of that type. */
const char *bb_get_text(const bb_entry *entry, bb_field_id field);
double bb_get_number(const bb_entry *entry, bb_field_id field);
bool bb_get_true(const bb_entry *entry, bb_field_id field);
/* Of an object of figures, the one called `name`; NAN if there is none. */
double bb_get_named(const bb_entry *entry, bb_field_id field, const char *name);
/* The same of an object of texts, as of parameters; "" if there is none. */
const char *bb_get_named_text(const bb_entry *entry, bb_field_id field, const char *name);
/* What the first ray waits for, in ms: boxes, build, transfer of a builder on the host, and the
 * layout. Of a reference, which makes its boxes and its layout inside its build, and is on the host
 * already, its build. NAN if the build or the layout was not measured. */
double bb_first_ray_ms(const bb_entry *build, const char *layout);
/* False if it is no array of 1 to BB_SAMPLES_MAX numbers. */
bool bb_get_samples(const bb_entry *entry, bb_field_id field, bb_samples *samples);
/* What was decided of `what`, as text and as number; "" and NAN if nothing was. */
const char *bb_get_decision(const bb_entry *entry, const char *what);
double bb_get_decided(const bb_entry *entry, const char *what);
/* Whether both have the same text there. */
bool bb_same_text(const bb_entry *a, const bb_entry *b, bb_field_id field);
/* Whether the status of a build or trace is ok. */
bool bb_is_ok(const bb_entry *entry);
/* Number of the run in a merged document; 0 is the first. */
double bb_run_of(const bb_entry *entry);

/* The same by a name that is no field's: of layouts, phases, steps. */
const char *bb_json_text(const cJSON *object, const char *name);
double bb_json_number(const cJSON *object, const char *name);

#endif
