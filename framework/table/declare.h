/* Declarations of columns, by kind: decimals, identifier, name, heading, unit and help, as in
 * bb_column. */
#ifndef BB_DECLARE_H
#define BB_DECLARE_H

#include "framework/table/table.h"

#define BB_DECLARE(kind, sense, better, decimals, id, name, heading, unit, help)                   \
    const bb_column id = {name, heading, unit, help, kind, sense, better, decimals}

#define BB_TEXT_COLUMN(id, name, heading, help)                                                    \
    BB_DECLARE(BB_COLUMN_TEXT, BB_SENSE_EXACT, BB_BETTER_NEITHER, 0, id, name, heading, "", help)

/* Numbers that a repetition gives again. LESS: less is better. */
#define BB_EXACT_COLUMN(...)                                                                       \
    BB_DECLARE(BB_COLUMN_NUMBER, BB_SENSE_EXACT, BB_BETTER_NEITHER, __VA_ARGS__)
#define BB_LESS_COLUMN(...)                                                                        \
    BB_DECLARE(BB_COLUMN_NUMBER, BB_SENSE_EXACT, BB_BETTER_LESS, __VA_ARGS__)

/* Numbers that depend on time. RATE: more is better. */
#define BB_TIMED_COLUMN(...)                                                                       \
    BB_DECLARE(BB_COLUMN_NUMBER, BB_SENSE_TIMED, BB_BETTER_NEITHER, __VA_ARGS__)
#define BB_RATE_COLUMN(...)                                                                        \
    BB_DECLARE(BB_COLUMN_NUMBER, BB_SENSE_TIMED, BB_BETTER_MORE, __VA_ARGS__)

/* Times, a number for each round. */
#define BB_ROUNDS_COLUMN(...)                                                                      \
    BB_DECLARE(BB_COLUMN_ROUNDS, BB_SENSE_TIMED, BB_BETTER_LESS, __VA_ARGS__)

#endif
