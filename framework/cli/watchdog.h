/* A watch over what may never end. A kernel that hangs cannot be stopped from within its process:
 * when the time is over, the process says what it was at and ends. */
#ifndef BB_WATCHDOG_H
#define BB_WATCHDOG_H

#include <stdint.h>

/* From now on, until the next call of either: after `seconds` (0: never) `last_words`, of which at
 * most 2047 characters count, go to standard output as they are, and the program ends with
 * BB_EXIT_WRONG. What is to stand before them must have been flushed. Time that does not count
 * (framework/base/uncounted.h) is added to the seconds. */
void bb_watchdog_start(uint32_t seconds, const char *last_words);

void bb_watchdog_stop(void);

#endif
