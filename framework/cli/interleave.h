/* Runs two programs in turns, for `compare --run`. */
#ifndef BB_INTERLEAVE_H
#define BB_INTERLEAVE_H

#include "framework/compare/cell_set.h"

typedef struct bb_interleaving {
    const char *programs[2];
    char *const *arguments; /* arguments of `run` */
    uint32_t argument_count;
    uint32_t rounds;    /* counting pairs, after a discarded one */
    uint64_t seed;      /* decides which program begins a pair */
    const char *folder; /* folder in which all result files stay; NULL: a temporary one */
    bool quiet;
} bb_interleaving;

/* Runs `PROGRAM run ARGUMENTS --out ...`, both programs once per pair. sets[k][0..rounds] get what
 * program k measured. They must be zeroed; release them with bb_cell_set_free(), also after a
 * failure. BB_INVALID if a program cannot be run or refuses the arguments; the message quotes it.
 * *interrupted: a signal ended it. */
bb_status bb_interleave(const bb_interleaving *wanted, bb_cell_set *sets[2], bool *interrupted);

#endif
