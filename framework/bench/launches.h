/* How many rays a launch may have on a GPU that may also drive a display, and when its clocks have
 * settled. Does not use OpenCL, so that tests can simulate devices. */
#ifndef BB_LAUNCHES_H
#define BB_LAUNCHES_H

#include <stdbool.h>
#include <stdint.h>

enum {
    /* A display's watchdog resets a GPU whose launch takes longer than 2 s (Windows) to 10 s. Half
     * a second leaves room for rays that take several times as long as those before. */
    BB_LAUNCH_MS = 500,
    BB_LAUNCH_FIRST = 1 << 16, /* rays of the first launch, whose time is not known */
    BB_WARM_ROUNDS = 10,       /* most rounds of warming up */
    BB_WARM_MS = 3000,         /* warming up ends after this time */
};

/* Returns how many rays the next launch may have if one of `count` rays took `ms`: as many as take
 * half of BB_LAUNCH_MS, but at most `most` and at most 8 * count. */
uint32_t bb_launch_rays(uint32_t count, double ms, uint32_t most);

/* Rounds that warm up a device until its clocks have settled. Begins zeroed. */
typedef struct bb_warming {
    uint32_t rounds;
    double ms;     /* time of the last round */
    double all_ms; /* time of all rounds */
    bool settled;  /* the last two took the same time */
} bb_warming;

/* Notes a round of `ms`. Returns true if warming up is over: the round took as long as the one
 * before, to 2 %, or the limits are reached. */
bool bb_warmed(bb_warming *warming, double ms);

#endif
