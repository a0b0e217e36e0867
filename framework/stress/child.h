/* Runs work in a child process, which may crash, hang or flood the memory. */
#ifndef BB_CHILD_H
#define BB_CHILD_H

#include "framework/base/status.h"

#include <stddef.h>
#include <stdint.h>

typedef struct bb_child_limits {
    double seconds;     /* wall time since the start or the last bb_child_alive() */
    uint64_t megabytes; /* resident memory in MiB */
} bb_child_limits;

typedef enum bb_child_end {
    BB_CHILD_DONE,        /* `work` returned 0 */
    BB_CHILD_GAVE_UP,     /* `work` returned another value */
    BB_CHILD_STOPPED,     /* `work` returned BB_STOP_ALL: other children would fail as well */
    BB_CHILD_CRASHED,     /* a signal, or exit() by a library */
    BB_CHILD_HUNG,        /* killed at the time limit */
    BB_CHILD_FLOODED,     /* killed at the memory limit */
    BB_CHILD_INTERRUPTED, /* killed because this process must end (interrupt.h) */
} bb_child_end;

enum { BB_STOP_ALL = 2 }; /* a return value of `work` */

typedef struct bb_child_report {
    bb_child_end end;
    char words[256]; /* how it ended; "" for BB_CHILD_DONE */
    char said[256];  /* its last line on standard output or error; "": none */
} bb_child_report;

/* Forks, calls `work` in the child, and waits. The child is killed when this process dies. The
 * parent must have no other threads and no open device, since neither survives a fork. BB_FAILED:
 * the fork failed. */
bb_status bb_child_run(int (*work)(void *user), void *user, const bb_child_limits *limits,
                       bb_child_report *report);

/* Restarts the child's time limit. The child calls it between pieces of work. Does nothing in other
 * processes. */
void bb_child_alive(void);

#endif
