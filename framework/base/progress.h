/* Progress of long work, on standard error: a bar with the time left that is redrawn on a terminal,
 * else a line per stage. */
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
    double plan;         /* work of all stages; 0: not known */
    double past, weight; /* work of the stages before, and of this one */
    void (*tell)(void *whom, double share);
    void *whom;
} bb_progress;

/* One line that comes before the first one that any progress prints, if one is printed: what is to
 * be known of all that follows. */
void bb_progress_head(const char *format, ...) __attribute__((format(printf, 1, 2)));
void bb_progress_start(bb_progress *progress, bool quiet);
/* A new stage of `total` steps; of 0 steps: something short, named on a terminal only. */
void bb_progress_stage(bb_progress *progress, uint32_t total, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* What all stages together will take, in any unit; and in that unit what of it the present stage
 * takes. With both, the bar is that of all stages, and has the time left. */
void bb_progress_plan(bb_progress *progress, double work);
void bb_progress_weigh(bb_progress *progress, double work);
/* Has `tell` told of the share of the plan that is done, also where this is quiet; NULL: nobody. */
void bb_progress_tell(bb_progress *progress, void (*tell)(void *whom, double share), void *whom);
/* A line of its own, for something to be known. */
void bb_progress_note(bb_progress *progress, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
void bb_progress_step(bb_progress *progress);
/* Of work with a plan whose steps are somebody else's: the share that is done, and in words what.
 * Without a terminal, a line every few seconds. */
void bb_progress_at(bb_progress *progress, double share, const char *what);
/* Clears the bar. */
void bb_progress_end(bb_progress *progress);

#endif
