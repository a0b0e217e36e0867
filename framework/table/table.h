/* The table of results: rows are cells, columns are figures.
 *
 * A cell says what was measured: up to nine names, of which any may be absent. A picture has a
 * scene, a question, a builder and an intersector; a build has no question. A figure of the whole
 * run (the device's name) belongs to the cell without names. Columns are declared once, as
 * constants next to the code that fills them; a table takes over a column when it first gets a
 * value.
 */
#ifndef BB_TABLE_H
#define BB_TABLE_H

#include "framework/base/statistics.h"
#include "framework/base/status.h"

#include <stdbool.h>
#include <stdint.h>

/* ---- columns ---- */

typedef enum bb_column_kind {
    BB_COLUMN_NUMBER,
    BB_COLUMN_TEXT,
    BB_COLUMN_ROUNDS, /* one number for each round; the first counts only if it is alone */
} bb_column_kind;

typedef enum bb_sense {
    BB_SENSE_EXACT, /* repeats give the same value */
    BB_SENSE_TIMED, /* repeats differ: intervals, and floors when tables are compared */
} bb_sense;

typedef enum bb_better { BB_BETTER_NEITHER, BB_BETTER_LESS, BB_BETTER_MORE } bb_better;

typedef struct bb_column {
    const char *name;    /* in files: lower case with underscores, unit last: "build_ms" */
    const char *heading; /* in tables: "build" */
    const char *unit;    /* "ms", "bytes", "voxels per second"; "": none */
    const char *help;    /* one sentence: what it is, and of how many */
    bb_column_kind kind;
    bb_sense sense;
    bb_better better;
    int decimals; /* after the point, in tables; -1: three significant digits */
} bb_column;

/* Declare a column of one file: BB_EXACT(nodes, "nodes", "nodes", "", "Of the tree.", LESS, 0). */
#define BB_EXACT(id, ...) static const bb_column id = BB_EXACT_COLUMN(__VA_ARGS__)
#define BB_TIMED(id, ...) static const bb_column id = BB_TIMED_COLUMN(__VA_ARGS__)
#define BB_ROUNDS(id, ...) static const bb_column id = BB_ROUNDS_COLUMN(__VA_ARGS__)
#define BB_TEXT(id, ...) static const bb_column id = BB_TEXT_COLUMN(__VA_ARGS__)

/* Initialisers of columns; `better` is NEITHER, LESS or MORE. */
#define BB_NUMBER_COLUMN(sense, name, heading, unit, help, better, decimals)                       \
    {                                                                                              \
        name, heading, unit, help, BB_COLUMN_NUMBER, BB_SENSE_##sense, BB_BETTER_##better,         \
            decimals                                                                               \
    }
#define BB_EXACT_COLUMN(...) BB_NUMBER_COLUMN(EXACT, __VA_ARGS__)
#define BB_TIMED_COLUMN(...) BB_NUMBER_COLUMN(TIMED, __VA_ARGS__)
#define BB_ROUNDS_COLUMN(name, heading, unit, help, better, decimals)                              \
    {                                                                                              \
        name, heading, unit, help, BB_COLUMN_ROUNDS, BB_SENSE_TIMED, BB_BETTER_##better, decimals  \
    }
#define BB_TEXT_COLUMN(name, heading, help)                                                        \
    {                                                                                              \
        name, heading, "", help, BB_COLUMN_TEXT, BB_SENSE_EXACT, BB_BETTER_NEITHER, 0              \
    }

/* ---- cells ---- */

typedef enum bb_dimension {
    BB_RUN, /* number in a merged table, from 1; the first run has none */
    BB_SCENE,
    BB_FRAME,
    BB_QUESTION,    /* a set of rays, a picture, a slice */
    BB_VIEW,        /* a camera of the scene */
    BB_BUILDER,     /* a specification, with its optimisers */
    BB_KERNEL,      /* that traces */
    BB_MAKER,       /* a stage or a phase of the builder, a layout, a step of the run */
    BB_INTERSECTOR, /* of primitives, or a search */
    BB_DIMENSIONS,
} bb_dimension;

extern const char *const bb_dimension_names[BB_DIMENSIONS]; /* "scene", "frame", ... */

/* NULL or "": the cell has no such name. */
typedef struct bb_cell {
    const char *names[BB_DIMENSIONS];
} bb_cell;

/* ---- the table ---- */

typedef struct bb_table bb_table;

enum { BB_NO_ROW = UINT32_MAX };

/* `command` made it ("slice"): a lower-case word of at most 64 letters, as names of columns are.
 * Owned by the caller. */
bb_status bb_table_create(const char *command, bb_table **out);
void bb_table_free(bb_table *table); /* NULL is allowed */

const char *bb_table_command(const bb_table *table);

/* The row of a cell, which is added if there is none; rows keep the order in which they were added.
 * Texts are copied; a byte that is no UTF-8 becomes %XX. Once memory has run out, this and the
 * functions below do nothing, and bb_table_status() says so: callers ask once, at the end. */
uint32_t bb_table_row(bb_table *table, bb_cell cell);
bb_status bb_table_status(const bb_table *table); /* BB_OK, BB_REFUSED or BB_INVALID */

/* Put one value in a row. A value that is there is replaced. No value: a number that is not finite,
 * an empty text, no rounds, or rounds of which one is not finite. `column` outlives the table. Two
 * columns of one name, or a faulty declaration, are the caller's mistake: bb_table_status() is
 * BB_INVALID then. A table from a file has its own columns; a column of the same name and kind puts
 * values into these. */
void bb_table_set_number(bb_table *table, uint32_t row, const bb_column *column, double value);
void bb_table_set_text(bb_table *table, uint32_t row, const bb_column *column, const char *value);
void bb_table_set_rounds(bb_table *table, uint32_t row, const bb_column *column,
                         const bb_samples *samples);

/* Adds a column, with copies of its texts, unless there is one of that name. */
void bb_table_add_column(bb_table *table, bb_column column);

/* Puts all values of a row of another table into a row of this one, with the columns that it lacks.
 * BB_INVALID, as above, if two columns of one name differ in kind, unit, sense or better. */
void bb_table_copy(bb_table *table, uint32_t row, const bb_table *from, uint32_t from_row);

/* ---- runs of a merged table (table_runs.c) ---- */

enum { BB_RUNS_MAX = 1000000 };

/* How a run is written as a name; NULL for 0, the first. */
const char *bb_run_name(uint32_t run, char text[16]);
/* The number of a row's run; 0 is the first. */
uint32_t bb_table_run_of(const bb_table *table, uint32_t row);
/* How many runs there are; not all need have rows. */
uint32_t bb_table_runs(const bb_table *table);
/* BB_INVALID if a name of a run is not written in that way. */
bb_status bb_table_check_runs(const bb_table *table);
/* The rows of one run as a table of their own, which the caller frees, also after a failure. */
bb_status bb_table_of_run(const bb_table *table, uint32_t run, bb_table **out);

/* ---- what stands in it ---- */

uint32_t bb_table_row_count(const bb_table *table);
uint32_t bb_table_find(const bb_table *table, bb_cell cell); /* BB_NO_ROW: there is none */
/* "" where the cell has no such name. */
const char *bb_table_name(const bb_table *table, uint32_t row, bb_dimension dimension);
bb_cell bb_table_cell(const bb_table *table, uint32_t row);

uint32_t bb_table_column_count(const bb_table *table);
const bb_column *bb_table_column(const bb_table *table, uint32_t index);
const bb_column *bb_table_column_named(const bb_table *table, const char *name); /* or NULL */

/* A value by its column's name, which files have too. Without a value, numbers are NAN, texts ""
 * and rounds NULL. The number of rounds is their median. Of rounds only the first `count` values
 * are in memory: do not copy the struct. */
double bb_table_get_number(const bb_table *table, uint32_t row, const char *column);
const char *bb_table_get_text(const bb_table *table, uint32_t row, const char *column);
const bb_samples *bb_table_get_rounds(const bb_table *table, uint32_t row, const char *column);

/* ---- files ---- */

/* As JSON, schema bvhbench-table/1 (README.md): from malloc; NULL if there is no memory. Reading it
 * and writing it again gives the same bytes. */
char *bb_table_json(const bb_table *table);
bb_status bb_table_write(const bb_table *table, const char *path);
/* `name` is what messages call it. BB_INVALID, in one line, for what is no such table: damaged,
 * truncated, of another schema, with duplicate keys, unknown members or wrong types. */
bb_status bb_table_parse(const char *json, const char *name, bb_table **out);
bb_status bb_table_read(const char *path, bb_table **out);
/* Whether the file says of itself that it is a table, of whatever version, and that another command
 * than this one made it. */
bool bb_table_is_other(const char *path, const char *command);

/* As CSV (RFC 4180), from malloc; NULL if there is no memory. One line of names, then one for each
 * row. Rounds become three columns: NAME, the median, and NAME.low and NAME.high, its interval. */
char *bb_table_csv(const bb_table *table);

/* The same with one line for each round ("tidy"): the names of the row, then figure, unit, round
 * and value. Round 0 is the one that does not count, if there are others. */
char *bb_table_samples(const bb_table *table);

#endif
