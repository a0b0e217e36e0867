/* Time that does not count towards a time limit: the driver's compilation, which says nothing about
 * the method under the limit. */
#ifndef BB_UNCOUNTED_H
#define BB_UNCOUNTED_H

/* Time between these two calls, on one thread of the process, does not count. */
void bb_uncounted_begin(void);
void bb_uncounted_end(void);

/* Returns all uncounted time so far in ms, including a span in progress. Safe in a signal
 * handler. */
double bb_uncounted_ms(void);

#endif
