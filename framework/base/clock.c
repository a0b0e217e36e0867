#include "framework/base/clock.h"

#include <stdatomic.h>
#include <time.h>

static double read_ms(clockid_t clock)
{
    struct timespec now;
    clock_gettime(clock, &now);
    return 1e3 * (double)now.tv_sec + 1e-6 * (double)now.tv_nsec;
}

double bb_wall_ms(void)
{
    return read_ms(CLOCK_MONOTONIC);
}

double bb_cpu_ms(void)
{
    return read_ms(CLOCK_PROCESS_CPUTIME_ID);
}

/* ---- time that does not count ---- */

static _Atomic double done_ms, begun_ms; /* begun_ms: 0 while time counts */

void bb_uncounted_begin(void)
{
    begun_ms = bb_wall_ms();
}

/* A query between the two lines counts the span twice, which only makes a watch longer. */
void bb_uncounted_end(void)
{
    done_ms = done_ms + (bb_wall_ms() - begun_ms);
    begun_ms = 0;
}

double bb_uncounted_ms(void)
{
    double begun = begun_ms;
    return done_ms + (begun > 0 ? bb_wall_ms() - begun : 0);
}
