/* What times depend on beside the processor's name: how the machine runs its processors, and on
 * which of them this process may run. */
#ifndef BB_PROCESSORS_H
#define BB_PROCESSORS_H

#include <sched.h>

#define BB_PROCESSORS_FOLDER "/sys/devices/system/cpu"

/* "" stands for what the machine does not say, as virtual ones do not. */
typedef struct bb_processors {
    char governor[64]; /* of their clocks; several, between blanks, if they differ */
    char smt[4];       /* "on": a core runs several threads; "off" */
    char boost[4];     /* "on", "off" */
    char list[256];    /* where the process may run: "0-3,8"; "all" if that is all of them */
} bb_processors;

/* Reads about the processors `mine` from `folder`, which is BB_PROCESSORS_FOLDER but for tests. */
void bb_processors_read(const char *folder, const cpu_set_t *mine, bb_processors *out);

#endif
