/* A machine of units, each of which keeps several groups of rays in flight and has a first cache of
 * its own; the second cache is shared. It runs recorded steps (warp.h) in an order that depends on
 * nothing else: in each round each unit, one after the other, issues the next step of one of its
 * groups, by turns. A unit takes the next group of rays when one ends.
 *
 * Addresses are offsets: each array has a base of its own. A stack entry is two words of private
 * memory, of which all lanes' words lie side by side.
 *
 * Left out: how long anything takes. What is counted gives bounds (bound.h).
 */
#ifndef BB_MACHINE_H
#define BB_MACHINE_H

#include "framework/simulate/cache.h"
#include "framework/simulate/footing.h"
#include "framework/simulate/warp.h"

typedef struct bb_machine {
    uint32_t width;                     /* lanes of a group: 1 to BB_WARP_MOST */
    uint32_t units;                     /* at least 1 */
    uint32_t in_flight;                 /* groups of a unit at a time, at least 1 */
    uint64_t first_bytes, second_bytes; /* of a unit's first cache, and of the second one */
    uint32_t first_ways, second_ways;
} bb_machine;

/* Sums over all that was issued of a kind. */
typedef struct bb_issued {
    uint64_t count;   /* issued steps */
    uint64_t lanes;   /* active lanes */
    uint64_t sectors; /* distinct ones, of each step */
    uint64_t lines;   /* likewise */
} bb_issued;

typedef struct bb_traffic {
    uint64_t rays, groups;
    bb_issued issued[BB_ISSUE_KINDS];
    uint64_t first, first_hits;   /* sectors asked of the first caches; found there */
    uint64_t second, second_hits; /* likewise, of the second one: reads */
    uint64_t second_written;      /* sectors written to it */
    uint64_t read, written;       /* sectors from and to memory */
} bb_traffic;

/* Runs all rays. What is still in the caches at the end counts as written. */
bb_status bb_machine_run(const bb_machine *machine, const bb_footing *footing,
                         const bb_steps *steps, bb_traffic *traffic);

/* Returns the active lanes per lane issued; NAN: nothing was issued. */
double bb_efficiency(const bb_issued *issued, uint32_t width);

#endif
