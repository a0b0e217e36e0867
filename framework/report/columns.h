/* Columns of the tables on the terminal: figures as text, medians with what is known of their
 * spread. Headings and formats are the schema's (framework/record/schema.h). */
#ifndef BB_COLUMNS_H
#define BB_COLUMNS_H

#include "framework/record/schema.h"
#include "framework/table/figure.h"

#include <stdio.h>

enum { BB_ENTRY = BB_FIGURE_MAX }; /* room for an entry of a table */

/* A field's figure in its format. */
void bb_text_field(char entry[BB_ENTRY], const bb_entry *row, bb_field_id field);

/* What may come from a file must not steer the terminal. Filled up with blanks to `width`. */
void bb_print_text(FILE *out, const char *text, int width);
/* The first letter of a text, or '?' for one that would; returns how many bytes were taken. */
int bb_print_letter(FILE *out, const char *text);

int bb_larger(int a, int b);

/* What the brackets behind a figure hold. */
typedef enum bb_spread { BB_NO_SPREAD, BB_RANGE, BB_INTERVAL } bb_spread;

/* A column of medians: an interval behind each where there are rounds enough for one, else their
 * range; of a single round nothing. Its heading says what the brackets hold; a range among
 * intervals says so itself. Start with the fields alone. */
typedef struct bb_medians {
    bb_field_id median, low; /* the ends of the spread are `low` and the three fields after it */
    char heading[BB_ENTRY];
    int width;                   /* of the column */
    int widths[BB_INTERVAL + 1]; /* of the rows with such a spread; 0: there is none */
} bb_medians;

void bb_medians_take(bb_medians *c, const bb_entry *row);
/* After the last row: makes the heading and the width. */
void bb_medians_finish(bb_medians *c);
void bb_medians_text(char entry[BB_ENTRY], const bb_medians *c, const bb_entry *row);

#endif
