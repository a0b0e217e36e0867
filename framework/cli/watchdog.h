/* A watchdog for work that may never end. A kernel that hangs cannot be stopped from within its
 * process: when the time is over, the process says what it was doing and ends. */
#ifndef BB_WATCHDOG_H
#define BB_WATCHDOG_H

#include <stdint.h>

/* Starts the watchdog, until the next call of either function. After `seconds` (0: never), the
 * first 2047 characters of `last_words` are written to standard output, and the program exits with
 * BB_EXIT_WRONG. Earlier output must have been flushed. Time that does not count
 * (framework/base/clock.h) is added to the seconds. */
void bb_watchdog_start(uint32_t seconds, const char *last_words);

void bb_watchdog_stop(void);

#endif
