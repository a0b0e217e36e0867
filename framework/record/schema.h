/* The schema of the result file as data: fields with names, units, formats, headings and help
 * (fields.h), and look-ups by field. Writer, reader, tables, charts and the page use it.
 */
#ifndef BB_SCHEMA_H
#define BB_SCHEMA_H

#include "framework/base/statistics.h"
#include "framework/tree/metric.h"

#include <stdbool.h>
#include <stddef.h>

typedef struct cJSON cJSON; /* opaque here; libcjson */

/* An entry of a result document, such as a scene, a build or a trace. */
typedef cJSON bb_entry;
/* All entries of one kind, in the order in which they were added. */
typedef cJSON bb_section;

/* The part of the document in which a field stands. */
typedef enum bb_field_part {
    BB_IN_CONTEXT,
    BB_IN_SCENE,
    BB_IN_PROFILE, /* member "profile" of a scene */
    BB_IN_BUILD,
    BB_IN_TREE, /* member "tree" of a build */
    BB_IN_TRACE,
    BB_IN_ACCURACY, /* member "accuracy" of a trace */
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

/* Types of a member of the file. A field may have several. */
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
    const char *heading; /* of the column; NULL: in no table */
    const char *help;    /* one line of explanation; may be NULL */
} bb_field;

extern const bb_field bb_fields[BB_FIELDS];

/* Returns whether `item` (NULL: absent) has one of the types. */
bool bb_json_is(const cJSON *item, unsigned types);

/* Returns the schema for the page: { "trace": { "mrays_s": { heading, unit, format, help }, ... },
 * ... } with all fields that have headings, and "metrics": [{ name, title, ... }]. Free it with
 * cJSON_free(). NULL without memory. */
char *bb_schema_json(void);

/* ---- metrics of trees ---- */

enum { BB_METRIC_FIELD = 64 };
/* Writes the name of the field that has the half width of a metric's interval. */
void bb_metric_half_name(const bb_metric *metric, char name[BB_METRIC_FIELD]);
/* Returns a metric of a build's tree as built; NAN: not measured. */
double bb_get_metric(const bb_entry *build, const bb_metric *metric);
/* Returns a metric of a build's layout as traced, or of its tree if the file has none of the
 * layout. */
double bb_get_metric_traced(const bb_entry *build, const bb_metric *metric, const char *layout);
/* Returns whether one of the builds has the metric. */
bool bb_metric_measured(const bb_section *builds, const bb_metric *metric);

/* ---- entries ---- */

const bb_entry *bb_first(const bb_section *section); /* NULL: there is none */
const bb_entry *bb_next(const bb_entry *entry);
uint32_t bb_section_count(const bb_section *section);
#define bb_each(entry, section)                                                                    \
    for (const bb_entry *entry = bb_first(section); entry != NULL; entry = bb_next(entry))

/* A part has a name and a figure: a phase, a layout, a step of the run. */
const char *bb_part_name(const bb_entry *part);
double bb_part_number(const bb_entry *part); /* NAN: not measured */
/* Returns the first part of a field of the entry; NULL: none. bb_next() returns the others. */
const bb_entry *bb_first_part(const bb_entry *entry, bb_field_id field);
#define bb_each_part(part, entry, field)                                                           \
    for (const bb_entry *part = bb_first_part(entry, field); part != NULL; part = bb_next(part))

/* ---- look-ups; `entry` is a whole scene, build, trace ..., for fields of inner parts too ---- */

/* Returns the member; NULL if there is none. */
const cJSON *bb_get(const bb_entry *entry, bb_field_id field);
/* Return the member's value; "", NAN or false if there is none of this type. */
const char *bb_get_text(const bb_entry *entry, bb_field_id field);
double bb_get_number(const bb_entry *entry, bb_field_id field);
bool bb_get_true(const bb_entry *entry, bb_field_id field);
/* Returns the figure `name` of an object of figures; NAN if there is none. */
double bb_get_named(const bb_entry *entry, bb_field_id field, const char *name);
/* Returns the text `name` of an object of texts, such as parameters; "" if there is none. */
const char *bb_get_named_text(const bb_entry *entry, bb_field_id field, const char *name);
/* Returns the time before the first ray, in ms: boxes, build, a host builder's transfer, and the
 * layout. For a reference it is the build alone, which includes boxes and layout and needs no
 * transfer. NAN if the build or the layout was not measured. */
double bb_first_ray_ms(const bb_entry *build, const char *layout);
/* Reads samples. Returns false if the member is no array of 1 to BB_SAMPLES_MAX numbers. */
bool bb_get_samples(const bb_entry *entry, bb_field_id field, bb_samples *samples);
/* Return the decision on `what` as text and as number; "" and NAN if there is none. */
const char *bb_get_decision(const bb_entry *entry, const char *what);
double bb_get_decided(const bb_entry *entry, const char *what);
/* Returns whether both entries have the same text in this field. */
bool bb_same_text(const bb_entry *a, const bb_entry *b, bb_field_id field);
/* Returns whether the status of a build or trace is ok. */
bool bb_is_ok(const bb_entry *entry);
/* Returns the number of the entry's run in a merged document; 0 is the first. */
double bb_run_of(const bb_entry *entry);

/* Return a member by a name that is no field's, such as that of a layout, a phase or a step. */
const char *bb_json_text(const cJSON *object, const char *name);
double bb_json_number(const cJSON *object, const char *name);

#endif
