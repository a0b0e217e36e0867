/* What a kernel's code costs on a GPU: its instructions for each step, and its registers, as a
 * compiler made them (kernels/isa.tsv, by scripts/isa). No compiler is needed here. */
#ifndef BB_COSTS_H
#define BB_COSTS_H

#include "framework/simulate/warp.h"

typedef struct bb_costs {
    /* of a group for each step of a kind: all of its loop, once, those in branches too; of
     * BB_ISSUE_BEGIN: all outside of loops; of searches of tetrahedra the larger of what those for
     * points and those in regions have there */
    double instructions[BB_ISSUE_KINDS];
    double in_regions[BB_ISSUE_KINDS]; /* likewise, in searches for what meets a region */
    bool counted;                      /* instructions are known, not registers alone */
    uint32_t registers;                /* of a ray */
} bb_costs;

/* Finds those of a kernel in a program, a specification: in the row that has most of its options,
 * and no others. `code`:
 * whose registers (bb_description). BB_UNSUPPORTED if the table has no row of it. */
bb_status bb_costs_find(const char *program, const char *kernel, const char *code, bb_costs *costs);

#endif
