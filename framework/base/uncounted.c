#include "framework/base/uncounted.h"

#include "framework/base/clock.h"

#include <stdatomic.h>

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
