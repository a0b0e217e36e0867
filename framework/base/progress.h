/* Progress of long work, on standard error: a bar that is redrawn on a terminal, else a line per
 * stage. */
#ifndef BB_PROGRESS_H
#define BB_PROGRESS_H

#include <stdbool.h>
#include <stdint.h>

typedef struct bb_progress {
    bool quiet;
    bool terminal;
    uint32_t done, total;
    double shown; /* when the bar was last drawn */
} bb_progress;

void bb_progress_start(bb_progress *progress, bool quiet);
/* A new stage of `total` steps; of 0 steps: something short, named on a terminal only. */
void bb_progress_stage(bb_progress *progress, uint32_t total, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* A line of its own, for something to be known. */
void bb_progress_note(bb_progress *progress, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
void bb_progress_step(bb_progress *progress);
/* Clears the bar. */
void bb_progress_end(bb_progress *progress);

#endif
