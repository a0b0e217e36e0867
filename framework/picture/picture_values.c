/* Fills depth and tests per ray as numbers. */
#include "framework/picture/picture.h"

void bb_values_depth(const bb_rays *rays, const bb_hit *hits, float miss, float *z)
{
    for (uint32_t i = 0; i < rays->count; i++)
        z[i] = hits[i].prim == BB_NONE ? miss : hits[i].t;
}

void bb_values_tests(const bb_rays *rays, const bb_count *counts, float *y)
{
    for (uint32_t i = 0; i < rays->count; i++)
        y[i] = (float)((double)counts[i].nodes + counts[i].prims);
}
