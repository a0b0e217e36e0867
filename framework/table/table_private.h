/* How a table lies in memory. */
#ifndef BB_TABLE_PRIVATE_H
#define BB_TABLE_PRIVATE_H

#include "framework/table/index.h"
#include "framework/table/table.h"

#define BB_TABLE_SCHEMA "bvhbench-table/1"

/* Words of files, by the enums of table.h. */
extern const char *const bb_kind_words[], *const bb_sense_words[], *const bb_better_words[];

typedef union bb_value {
    double number;      /* NAN: none */
    const char *text;   /* interned; NULL: none */
    bb_samples *rounds; /* with room for `count` values alone; NULL: none */
} bb_value;

/* Values of the first `count` rows; the others have none. */
typedef struct bb_stored_column {
    const bb_column *column;
    bb_column *own; /* the same, of a file */
    bb_value *values;
    uint32_t count;
} bb_stored_column;

/* Equal names are interned as one text, so that cells are equal if their pointers are. */
struct bb_table {
    const char *command;
    bb_status status;
    const char *column, *fault; /* of BB_INVALID: the column's name, and what is wrong with it */
    char **names;
    bb_cell *rows;
    bb_stored_column *columns;
    bb_index name_index, row_index, column_index;
};

/* The text as the table keeps it; NULL for none, and if there is no memory. */
const char *bb_table_intern(bb_table *table, const char *text);

/* Whether the text is a name of a column or a command: a lower-case word of at most 64 letters. */
bool bb_is_table_word(const char *text);
/* The dimension of that name; -1: there is none. */
int bb_dimension_of(const char *name);
/* What is wrong with the declaration of a column, for a message; NULL: nothing. */
const char *bb_column_fault(const bb_column *column);

/* Number of the column of that name, or UINT32_MAX. */
uint32_t bb_table_column_index(const bb_table *table, const char *name);

#endif
