#include "framework/bench/launches.h"

#include <math.h>

uint32_t bb_launch_rays(uint32_t count, double ms, uint32_t most)
{
    const double grown = 8.0 * count, rays = ms > 0 ? count * (0.5 * BB_LAUNCH_MS / ms) : grown;
    const double next = fmax(1, fmin(rays, grown));
    return next < most ? (uint32_t)next : most;
}

bool bb_warmed(bb_warming *warming, double ms)
{
    static const double same = 0.02;
    warming->settled = warming->rounds > 0 && fabs(ms - warming->ms) <= same * warming->ms;
    warming->rounds++;
    warming->ms = ms;
    warming->all_ms += ms;
    return warming->settled || warming->rounds >= BB_WARM_ROUNDS || warming->all_ms >= BB_WARM_MS;
}
