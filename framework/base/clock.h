/* Clocks, in milliseconds. */
#ifndef BB_CLOCK_H
#define BB_CLOCK_H

double bb_wall_ms(void); /* monotonic */
double bb_cpu_ms(void);  /* of all threads of the process, user and system time */

/* ---- time that does not count towards a time limit: the driver's compilation, which says nothing
 * about the method under the limit ---- */

/* Time between these two calls, on one thread of the process, does not count. */
void bb_uncounted_begin(void);
void bb_uncounted_end(void);

/* Returns all uncounted time so far in ms, including a span in progress. Safe in a signal
 * handler. */
double bb_uncounted_ms(void);

#endif
