/* The tables of the history, by version. */
#ifndef BB_HISTORY_SCHEMA_H
#define BB_HISTORY_SCHEMA_H

enum {
    BB_HISTORY_VERSION = 3,
    BB_HISTORY_APPLICATION = 0x42564842, /* "BVHB" */
};

/* bb_history_steps[v] makes version v + 1 of version v; version 0 is an empty file. */
extern const char *const bb_history_steps[BB_HISTORY_VERSION];

#endif
