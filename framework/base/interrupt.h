/* Ctrl-C and similar signals, and a time that is over: long work checks for them now and then, and
 * ends with what it has. */
#ifndef BB_INTERRUPT_H
#define BB_INTERRUPT_H

#include <stdbool.h>

struct sigaction;

/* From now on the first SIGINT, SIGTERM or SIGHUP is noted; the second ends the program at once. */
void bb_interrupt_catch(void);

/* The work is to end as if such a signal came at this bb_wall_ms(); 0: it may take any time. */
void bb_interrupt_at(double ms);

/* Returns whether such a signal came, or the time is over. */
bool bb_interrupted(void);
/* Returns whether the time is over, and no signal came. */
bool bb_interrupted_by_time(void);

/* Whether that is why the action of a signal, `then` before, is another one `now`. */
bool bb_interrupt_changed(int signal_number, const struct sigaction *then,
                          const struct sigaction *now);

/* From now on, a write to a pipe without a reader fails, and the program goes on. */
void bb_pipe_catch(void);
/* Ends the process as SIGPIPE would have, if such a write failed. */
void bb_pipe_end(void);

#endif
