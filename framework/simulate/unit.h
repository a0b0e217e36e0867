/* A unit of a machine (machine.h): several groups of rays in flight, and a first cache. What misses
 * there is noted, for the second cache to answer later, so that units run beside each other.
 *
 * Addresses are offsets: each array has a base of its own. A stack entry is two words of private
 * memory, or one, of which all lanes' words lie side by side.
 */
#ifndef BB_UNIT_H
#define BB_UNIT_H

#include "framework/simulate/cache.h"
#include "framework/simulate/footing.h"
#include "framework/simulate/warp.h"

enum { BB_WINDOW_ROUNDS = 1 << 8 }; /* rounds whose requests are noted at a time */

/* Arrays: array number a begins at address a << BB_BASE_SHIFT. */
enum {
    BB_BASE_SHIFT = 40,
    BB_AT_RAYS = 1,
    BB_AT_RESULTS,
    BB_AT_NODES,
    BB_AT_PRIMS,
    BB_AT_PRIVATE,
    BB_AT_VOXELS,
    BB_AT_TABLE,
};

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
    uint64_t left;      /* recorded steps that were not taken */
    uint64_t ray_steps; /* steps that each ray's group issued, summed over the rays */
    bb_issued issued[BB_ISSUE_KINDS];
    struct {
        uint64_t count, lanes;
    } in_regions[BB_ISSUE_KINDS]; /* of these, in searches for what meets a region */
    uint64_t first, first_hits;   /* sectors asked of the first caches; found there */
    uint64_t second, second_hits; /* likewise, of the second one: reads */
    uint64_t second_written;      /* sectors written to it */
    uint64_t read, written;       /* sectors from and to memory */
} bb_traffic;

typedef struct bb_unit {
    const bb_machine *machine;
    const bb_footing *footing;
    const bb_steps *steps;
    bb_cache cache;
    bb_warp *slots;   /* [in_flight] */
    uint64_t *issued; /* [in_flight]: steps of the group so far */
    bool *busy;
    uint32_t number, turn, running; /* of all units; slot; groups in flight */
    uint64_t next;                  /* group that it takes next (bb_footing_lanes()) */
    bb_traffic traffic;             /* without the second cache and what comes behind it */
    /* Requests of the present window: sectors' addresses, with bit 0 set for writing. */
    uint64_t *asked;
    size_t count, room, ends[BB_WINDOW_ROUNDS]; /* after each round */
    bool short_of_memory;
} bb_unit;

/* Unit `number` runs work-groups number, number + units, and so on. */
bb_status bb_unit_create(const bb_machine *machine, const bb_footing *footing,
                         const bb_steps *steps, uint32_t number, bb_unit *unit);
void bb_unit_release(bb_unit *unit); /* a zeroed one is allowed */

/* Runs the next window: in each round a step of one of its groups, by turns. */
void bb_unit_run(bb_unit *unit);
/* Returns whether the line is of stack entries, which nobody reads once their group has ended. */
static inline bool bb_unit_is_private(uint64_t address)
{
    return address >> BB_BASE_SHIFT == BB_AT_PRIVATE;
}

/* Notes what is still to be written, but for stack entries, as a window of one round. */
void bb_unit_flush(bb_unit *unit);

#endif
