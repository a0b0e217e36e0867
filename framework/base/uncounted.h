/* Time that a limit of time does not count: that of the driver's compiler, which says nothing about
 * the method that is watched. */
#ifndef BB_UNCOUNTED_H
#define BB_UNCOUNTED_H

/* Between these two, on one thread of the process, time does not count. */
void bb_uncounted_begin(void);
void bb_uncounted_end(void);

/* All of it so far, in ms, what goes on included. May be asked in a signal handler. */
double bb_uncounted_ms(void);

#endif
