/* How many rays a launch may have on a device that also draws a display, and when its clocks have
 * settled. Knows nothing of devices, so that it can be tried on made-up ones. */
#ifndef BB_LAUNCHES_H
#define BB_LAUNCHES_H

#include <stdbool.h>
#include <stdint.h>

enum {
    /* A display's watchdog ends what keeps a GPU for longer than 2 s (Windows) to 10 s, and resets
     * the device. Half a second leaves room for rays that take several times as long as those
     * before. */
    BB_LAUNCH_MS = 500,
    BB_LAUNCH_FIRST = 1 << 16, /* rays of a launch when nothing is known of how long it takes */
    BB_WARM_ROUNDS = 10,       /* at most */
    BB_WARM_MS = 3000,         /* and once so much time was spent */
};

/* Rays that the next launch may have, at most `most`, if one of `count` rays took `ms`: as many as
 * take half of BB_LAUNCH_MS, and no more than eight times as many. */
uint32_t bb_launch_rays(uint32_t count, double ms, uint32_t most);

/* Rounds that are run until the clocks have settled. A zeroed one has seen none. */
typedef struct bb_warming {
    uint32_t rounds;
    double ms;     /* of the last */
    double all_ms; /* of all */
    bool settled;  /* the last two took the same time */
} bb_warming;

/* Takes note of a round of `ms`; true if it took as long as the one before, to 2 %, so that the
 * next may count, or if there were enough. */
bool bb_warmed(bb_warming *warming, double ms);

#endif
