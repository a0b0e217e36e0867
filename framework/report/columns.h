/* Columns of tables on the terminal: figures as text, and medians with their spread. Headings and
 * formats are those of framework/record/schema.h. */
#ifndef BB_COLUMNS_H
#define BB_COLUMNS_H

#include "framework/record/schema.h"
#include "framework/table/figure.h"

#include <stdio.h>

enum { BB_ENTRY = BB_FIGURE_MAX }; /* room for an entry of a table */

/* Writes a field's figure in its format. */
void bb_text_field(char entry[BB_ENTRY], const bb_entry *row, bb_field_id field);

/* Prints a text, padded to `width`, without letters that steer the terminal. */
void bb_print_text(FILE *out, const char *text, int width);
/* Prints the first letter of a text, or '?' if it steers the terminal. Returns its bytes. */
int bb_print_letter(FILE *out, const char *text);

int bb_larger(int a, int b);

/* The content of brackets behind a figure. */
typedef enum bb_spread { BB_NO_SPREAD, BB_RANGE, BB_INTERVAL } bb_spread;

/* A column of medians, each with its interval, with its range if there are too few rounds, or alone
 * after a single round. The heading names the content of the brackets; a range among intervals is
 * marked. Initialise only the fields. */
typedef struct bb_medians {
    bb_field_id median, low; /* the ends of the spread are `low` and the three fields after it */
    char heading[BB_ENTRY];
    int width;                   /* of the column */
    int widths[BB_INTERVAL + 1]; /* of rows with this spread; 0: none */
} bb_medians;

void bb_medians_take(bb_medians *c, const bb_entry *row);
/* Makes heading and width. To be called after the last row. */
void bb_medians_finish(bb_medians *c);
void bb_medians_text(char entry[BB_ENTRY], const bb_medians *c, const bb_entry *row);

#endif
