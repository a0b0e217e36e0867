/* The tables of the history. */
#ifndef BB_HISTORY_SCHEMA_H
#define BB_HISTORY_SCHEMA_H

enum {
    BB_HISTORY_VERSION = 5,
    BB_HISTORY_APPLICATION = 0x42564842, /* "BVHB" */
};

extern const char bb_history_tables[]; /* SQL that creates the tables in an empty file */

#endif
