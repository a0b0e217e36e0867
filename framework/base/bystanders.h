/* What other programs take of the machine while this one measures. */
#ifndef BB_BYSTANDERS_H
#define BB_BYSTANDERS_H

typedef struct bb_bystanders {
    double wall_ms, all_ms, own_ms; /* at the start; all_ms: of all processors, NAN: not known */
} bb_bystanders;

void bb_bystanders_start(bb_bystanders *watch);

/* How many processors the other programs kept busy since then, on average; time that a host
 * withheld from a virtual machine counts as theirs. NAN where /proc/stat is missing. The clock's
 * ticks are 10 ms: watch for a few tenths of a second at least. */
double bb_bystanders_share(const bb_bystanders *watch);

#endif
