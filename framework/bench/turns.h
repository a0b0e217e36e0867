/* Rounds in which all that is compared takes turns, in another order each round, so that nobody
 * always follows the same. All comparisons measure by these. */
#ifndef BB_MEASURE_TURNS_H
#define BB_MEASURE_TURNS_H

#include "framework/base/progress.h"
#include "framework/base/random.h"
#include "framework/device/device.h"

enum { BB_WARMING_UP = UINT32_MAX }; /* the round of turns that warm up the device */

typedef struct bb_turns {
    const bb_device *device;
    bb_random *random;
    uint32_t count; /* 0 .. count - 1 take turns */
    void *self;
    /* Measures `who`, and adds what the device took to *ms. A failure ends all rounds: whoever may
     * fail while others go on must note that itself. */
    bb_status (*turn)(void *self, uint32_t who, uint32_t round, double *ms);
} bb_turns;

/* One round: each takes its turn. */
bb_status bb_turns_round(bb_turns *turns, uint32_t round);

/* After a round of `ms`: returns how many more rounds there are to be, of `rounds` that are
 * planned, so that they end by `ends_ms` (bb_wall_ms(); 0: at any time), and at least one. Notes
 * for the user what they take, if that is long, and how many are left out; `scene` is in it. */
uint32_t bb_turns_foretell(bb_progress *progress, const char *scene, double ms, uint32_t rounds,
                           double ends_ms);

/* On a device that is no CPU, makes rounds BB_WARMING_UP until its clocks have settled, or until
 * an interruption. Notes for the user if they did not settle; "`scene`: `what`" is in the note. */
bb_status bb_turns_warm_up(bb_turns *turns, bb_progress *progress, const char *scene,
                           const char *what);

#endif
