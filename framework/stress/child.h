/* Work in a process of its own, so that a crash, a hang or a flood of memory ends nothing else. */
#ifndef BB_CHILD_H
#define BB_CHILD_H

#include "framework/base/status.h"

#include <stddef.h>
#include <stdint.h>

typedef struct bb_child_limits {
    double seconds;     /* wall clock, from the start or the last bb_child_alive() */
    uint64_t megabytes; /* resident, in MiB */
} bb_child_limits;

typedef enum bb_child_end {
    BB_CHILD_DONE,        /* `work` returned 0 */
    BB_CHILD_GAVE_UP,     /* it returned something else */
    BB_CHILD_STOPPED,     /* it returned BB_STOP_ALL: no other child would do better */
    BB_CHILD_CRASHED,     /* a signal that nobody here sent, or exit() by a library */
    BB_CHILD_HUNG,        /* killed at the limit of time */
    BB_CHILD_FLOODED,     /* killed at the limit of memory */
    BB_CHILD_INTERRUPTED, /* killed since this process is asked to end (interrupt.h) */
} bb_child_end;

enum { BB_STOP_ALL = 2 }; /* what `work` may return */

typedef struct bb_child_report {
    bb_child_end end;
    char words[256]; /* what ended it; "" for BB_CHILD_DONE */
    char said[256];  /* the last line that it wrote to standard output or error; "": none */
} bb_child_report;

/* Forks and calls `work` in the child; waits. The child is killed when this process dies. The
 * parent must have no other threads, nor an open device: neither survives a fork. BB_FAILED if
 * there can be no child. */
bb_status bb_child_run(int (*work)(void *user), void *user, const bb_child_limits *limits,
                       bb_child_report *report);

/* Called in the child between pieces of its work: its time begins anew. Elsewhere it does nothing.
 */
void bb_child_alive(void);

#endif
