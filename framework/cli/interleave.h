/* Two programs run in turns: `compare --run`. */
#ifndef BB_INTERLEAVE_H
#define BB_INTERLEAVE_H

#include "framework/compare/cell_set.h"

typedef struct bb_interleaving {
    const char *programs[2];
    char *const *arguments; /* of `run` */
    uint32_t argument_count;
    uint32_t rounds;    /* pairs that count; one more comes first */
    uint64_t seed;      /* decides who begins a pair */
    const char *folder; /* kept, with all result files; NULL: a temporary one */
    bool quiet;
} bb_interleaving;

/* Runs `PROGRAM run ARGUMENTS --out ...`, both programs once per pair. sets[k][0..rounds] are what
 * program k measured; zeroed before, for bb_cell_set_free(), also after a failure. BB_INVALID if a
 * program can't be run, or can't run this: with its own words. *interrupted: by a signal. */
bb_status bb_interleave(const bb_interleaving *wanted, bb_cell_set *sets[2], bool *interrupted);

#endif
