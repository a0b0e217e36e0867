/* Compares extents. */
#include "framework/advise/leastness.h"

#include <math.h>
#include <stddef.h>

/* Returns bytes in steps of 2 %. Unknown bytes are more than any. */
static double step_of(double bytes)
{
    return bytes > 0 ? floor(log(bytes) / log(1.02)) : (double)INFINITY;
}

static int order(double a, double b)
{
    return (a > b) - (a < b);
}

static int compare(const bb_extent *a, const bb_extent *b, const char **reason)
{
    const struct {
        int result;
        const char *reason;
    } steps[] = {
        {order(step_of(a->bytes), step_of(b->bytes)), "memory"},
        {order(a->code_bits, b->code_bits), "bits of the code"},
        {order(a->stack, b->stack), "entries of the stack"},
        {order(a->kinds, b->kinds), "kinds of primitives"},
        {order(a->width, b->width), "children of a node"},
        {order(a->doubt, b->doubt), "a more careful intersector"},
        {order(a->ms, b->ms), "time"},
        {order(a->place, b->place), "its place in the list"},
    };
    for (size_t i = 0; i < sizeof steps / sizeof steps[0]; i++)
        if (steps[i].result != 0) {
            *reason = steps[i].reason;
            return steps[i].result;
        }
    *reason = "nothing";
    return 0;
}

int bb_extent_compare(const bb_extent *a, const bb_extent *b)
{
    const char *reason;
    return compare(a, b, &reason);
}

const char *bb_extent_reason(const bb_extent *a, const bb_extent *b)
{
    const char *reason;
    compare(a, b, &reason);
    return reason;
}
