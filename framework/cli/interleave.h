/* Runs two programs in turns, for `compare --run`. */
#ifndef BB_INTERLEAVE_H
#define BB_INTERLEAVE_H

#include "framework/compare/cell_set.h"

typedef struct bb_interleaving {
    const char *programs[2];
    char *const *arguments; /* arguments of `run` */
    uint32_t argument_count;
    uint32_t rounds;    /* most counting pairs, after a discarded one ... */
    uint32_t least;     /* ... and fewest of which anything can be told */
    double ends_ms;     /* bb_wall_ms() at which it is to end; 0: after all rounds */
    uint64_t seed;      /* decides which program begins a pair */
    const char *folder; /* folder in which all result files stay; NULL: a temporary one */
    bool quiet;
} bb_interleaving;

/* Runs `PROGRAM run ARGUMENTS --out ...`, both programs once per pair. sets[k][0..*pairs] get what
 * program k measured; *pairs are the counting pairs: all rounds, or those that fit into the time,
 * as the discarded pair foretells, or those before a signal ended it. Sets must be zeroed, rounds +
 * 1 of them; release them with bb_cell_set_free(), also after a failure. BB_INVALID if a program
 * cannot be run or refuses the arguments; the message quotes it. BB_REFUSED if the fewest pairs do
 * not fit into the time. */
bb_status bb_interleave(const bb_interleaving *wanted, bb_cell_set *sets[2], uint32_t *pairs);

#endif
