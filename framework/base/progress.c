#include "framework/base/progress.h"

#include "framework/base/clock.h"
#include "framework/base/number.h"
#include "framework/base/steering.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <unistd.h>

enum { BAR_WIDTH = 24, LINE_EVERY_MS = 5000 };

void bb_progress_start(bb_progress *progress, bool quiet)
{
    *progress = (bb_progress){
        .quiet = quiet, .terminal = isatty(STDERR_FILENO) == 1, .start = bb_wall_ms()};
}

static void clear_line(const bb_progress *progress)
{
    if (progress->terminal)
        fprintf(stderr, "\r\033[K");
}

/* The line printed before the first one of any progress; "" once it is printed. */
static char head[640];

void bb_progress_head(const char *format, ...)
{
    va_list args;
    va_start(args, format);
    vsnprintf(head, sizeof head, format, args);
    va_end(args);
    bb_calm_text(head);
}

static void print_head(void)
{
    if (head[0] != '\0')
        fprintf(stderr, "%s\n", head);
    head[0] = '\0';
}

void bb_progress_stage(bb_progress *progress, uint32_t total, const char *format, ...)
{
    progress->done = 0;
    progress->total = total;
    progress->past += progress->weight;
    progress->weight = 0;
    if (progress->quiet || (total == 0 && !progress->terminal))
        return;
    clear_line(progress);
    print_head();
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
    print_head();
    char note[4096];
    va_list args;
    va_start(args, format);
    vsnprintf(note, sizeof note, format, args);
    va_end(args);
    bb_calm_text(note);
    fprintf(stderr, "%s\n", note);
}

void bb_progress_plan(bb_progress *progress, double work)
{
    progress->plan = work;
}

void bb_progress_tell(bb_progress *progress, void (*tell)(void *whom, double share), void *whom)
{
    progress->tell = tell;
    progress->whom = whom;
}

void bb_progress_weigh(bb_progress *progress, double work)
{
    progress->weight = work;
}

static void draw_bar(const bb_progress *progress, double share)
{
    int filled = (int)(share * BAR_WIDTH);
    fprintf(stderr, "\r\033[K  [");
    for (int i = 0; i < BAR_WIDTH; i++)
        fputc(i < filled ? '=' : ' ', stderr);
    fprintf(stderr, "] ");
    if (progress->plan > 0)
        fprintf(stderr, "%.0f %%", 100 * share);
    else
        fprintf(stderr, "%u/%u", progress->done, progress->total);
}

/* Assumes that the rest goes on at the average speed so far. */
static void draw_time_left(const bb_progress *progress, double share, double now)
{
    const double told_from = 0.03; /* with less done, there is no estimate */
    if (!(progress->plan > 0) || share < told_from)
        return;
    char left[BB_TIME_TEXT];
    fprintf(stderr, ", about %s left",
            bb_time_words((now - progress->start) * (1 - share) / share / 1e3, left));
}

void bb_progress_at(bb_progress *progress, double share, const char *what)
{
    const double now = bb_wall_ms(), every = progress->terminal ? 100 : LINE_EVERY_MS;
    if (progress->quiet || now - progress->shown < every)
        return;
    progress->shown = now;
    if (progress->terminal)
        draw_bar(progress, share);
    fprintf(stderr, "  %s", what);
    draw_time_left(progress, share, now);
    if (!progress->terminal)
        fputc('\n', stderr);
    fflush(stderr);
}

void bb_progress_step(bb_progress *progress)
{
    progress->done++;
    double now = bb_wall_ms();
    const bool draws = !progress->quiet && progress->terminal;
    if (progress->total == 0 || now - progress->shown < 100 || (!draws && progress->tell == NULL))
        return;
    progress->shown = now;
    double share = fmin(1, (double)progress->done / progress->total);
    if (progress->plan > 0)
        share = fmin(1, (progress->past + progress->weight * share) / progress->plan);
    if (progress->tell != NULL)
        progress->tell(progress->whom, share);
    if (!draws)
        return;
    draw_bar(progress, share);
    draw_time_left(progress, share, now);
    fflush(stderr);
}

void bb_progress_end(bb_progress *progress)
{
    if (!progress->quiet)
        clear_line(progress);
    progress->total = 0;
}
