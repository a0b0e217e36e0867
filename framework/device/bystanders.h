/* How much of the machine other programs use while this one measures. */
#ifndef BB_BYSTANDERS_H
#define BB_BYSTANDERS_H

#include <stdbool.h>

/* A machine is busy if other programs keep more than this share of its processors at work. */
#define BB_BUSY_SHARE 0.25

typedef struct bb_bystanders {
    double wall_ms, all_ms, own_ms; /* at the start; all_ms counts all processors, NAN: unknown */
    bool warned;                    /* the user was warned of them */
} bb_bystanders;

void bb_bystanders_start(bb_bystanders *watch);

/* Returns how many processors other programs have kept busy since the start, on average. Time that
 * a host withholds from a virtual machine counts as theirs. NAN without /proc/stat. The kernel
 * counts in ticks of 10 ms, so watch for at least a few tenths of a second. */
double bb_bystanders_share(const bb_bystanders *watch);

#endif
