/* Progress of long work, on standard error: on a terminal a bar with the time left, which is
 * redrawn, elsewhere a line per stage. */
#ifndef BB_PROGRESS_H
#define BB_PROGRESS_H

#include <stdbool.h>
#include <stdint.h>

typedef struct bb_progress {
    bool quiet;
    bool terminal;
    uint32_t done, total;
    double shown; /* when the bar was last drawn */
    double start;
    double plan;         /* work of all stages; 0: unknown */
    double past, weight; /* work of the previous stages, and of this one */
    void (*tell)(void *whom, double share);
    void *whom;
} bb_progress;

/* Sets a line to be printed before the first line of any progress, if there is one. It tells what
 * applies to everything after it. */
void bb_progress_head(const char *format, ...) __attribute__((format(printf, 1, 2)));
void bb_progress_start(bb_progress *progress, bool quiet);
/* Starts a stage of `total` steps. 0 steps mean something short, named on a terminal only. */
void bb_progress_stage(bb_progress *progress, uint32_t total, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* Set the work of all stages, in any unit, and the work of the present stage in that unit. With
 * both, the bar covers all stages and shows the time left. */
void bb_progress_plan(bb_progress *progress, double work);
void bb_progress_weigh(bb_progress *progress, double work);
/* Calls `tell` with the finished share of the plan, even if `progress` is quiet. NULL: no calls. */
void bb_progress_tell(bb_progress *progress, void (*tell)(void *whom, double share), void *whom);
/* Prints a note on a line of its own. */
void bb_progress_note(bb_progress *progress, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
void bb_progress_step(bb_progress *progress);
/* Shows the finished share of a plan whose steps are counted elsewhere, with `what` in words.
 * Without a terminal, it prints a line every few seconds. */
void bb_progress_at(bb_progress *progress, double share, const char *what);
/* Clears the bar. */
void bb_progress_end(bb_progress *progress);

#endif
