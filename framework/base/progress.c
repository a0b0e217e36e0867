#include "framework/base/progress.h"

#include "framework/base/clock.h"

#include <stdarg.h>
#include <stdio.h>
#include <unistd.h>

enum { BAR_WIDTH = 24 };

void bb_progress_start(bb_progress *progress, bool quiet)
{
    *progress = (bb_progress){.quiet = quiet, .terminal = isatty(STDERR_FILENO) == 1};
}

static void clear_line(const bb_progress *progress)
{
    if (progress->terminal)
        fprintf(stderr, "\r\033[K");
}

void bb_progress_stage(bb_progress *progress, uint32_t total, const char *format, ...)
{
    progress->done = 0;
    progress->total = total;
    if (progress->quiet || (total == 0 && !progress->terminal))
        return;
    clear_line(progress);
    va_list args;
    va_start(args, format);
    vfprintf(stderr, format, args);
    va_end(args);
    if (total > 0)
        fputc('\n', stderr);
    fflush(stderr);
}

void bb_progress_note(bb_progress *progress, const char *format, ...)
{
    if (progress->quiet)
        return;
    clear_line(progress);
    va_list args;
    va_start(args, format);
    vfprintf(stderr, format, args);
    va_end(args);
    fputc('\n', stderr);
}

void bb_progress_step(bb_progress *progress)
{
    progress->done++;
    double now = bb_wall_ms();
    if (progress->quiet || !progress->terminal || progress->total == 0 ||
        now - progress->shown < 100)
        return;
    progress->shown = now;
    uint32_t filled = progress->done * BAR_WIDTH / progress->total;
    fprintf(stderr, "\r  [");
    for (uint32_t i = 0; i < BAR_WIDTH; i++)
        fputc(i < filled ? '=' : ' ', stderr);
    fprintf(stderr, "] %u/%u", progress->done, progress->total);
    fflush(stderr);
}

void bb_progress_end(bb_progress *progress)
{
    if (!progress->quiet)
        clear_line(progress);
    progress->total = 0;
}
