/* Ctrl-C and the like, asked for politely: long work looks now and then whether it is to end, and
 * ends with what it has. */
#ifndef BB_INTERRUPT_H
#define BB_INTERRUPT_H

#include <stdbool.h>

/* From now on the first SIGINT, SIGTERM or SIGHUP is noted, and the next one ends the program at
 * once. */
void bb_interrupt_catch(void);

/* Whether such a signal came. */
bool bb_interrupted(void);

/* From now on, writing to a pipe that nobody reads any more fails, and the program goes on. */
void bb_pipe_catch(void);
/* Ends the process as such a pipe would have, if there was one. */
void bb_pipe_end(void);

#endif
