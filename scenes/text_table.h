/* Files of lines of numbers, like TetGen's: `#` begins a comment, empty lines are ignored. A file
 * whose name ends in .zst is expanded. */
#ifndef BB_TEXT_TABLE_H
#define BB_TEXT_TABLE_H

#include "framework/base/status.h"

#include <stddef.h>
#include <stdint.h>

typedef struct bb_text_table {
    const char *path; /* not copied */
    char *text;
    const char *at, *end;
    uint64_t line; /* line of the last bb_text_table_next() */
} bb_text_table;

/* `room`: bytes that it may take; reduced by the bytes taken. BB_REFUSED if it is too small. */
bb_status bb_text_table_open(const char *path, uint64_t *room, bb_text_table *table);
void bb_text_table_close(bb_text_table *table);

/* Reads the numbers of the next line: at least `least`; those beyond `most` are left out. *count:
 * their number. BB_INVALID, with the line, for anything else, and at the end of the file: `what`
 * says what should have been there. */
bb_status bb_text_table_next(bb_text_table *table, const char *what, uint32_t least, uint32_t most,
                             double *numbers, uint32_t *count);

/* Converts one of these numbers to a whole one, from `low` to `high`; `name` is for the message. */
bb_status bb_text_table_whole(const bb_text_table *table, double number, const char *name,
                              uint64_t low, uint64_t high, uint64_t *out);

#endif
