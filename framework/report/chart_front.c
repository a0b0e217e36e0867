/* The Pareto front, and the winners by number of rays. */
#include "framework/report/chart.h"

#include <math.h>
#include <string.h>

/* ---- who beats whom ---- */

uint32_t bb_pareto_front(const bb_chart_point *points, uint32_t count, uint32_t *front)
{
    uint32_t found = 0; /* size of the front so far, along which cost and gain rise */
    for (uint32_t i = 0; i < count; i++) {
        const bb_chart_point *p = &points[i];
        uint32_t at = 0;
        while (at < found && points[front[at]].cost < p->cost)
            at++;
        if ((at > 0 && points[front[at - 1]].gain >= p->gain) ||
            (at < found && points[front[at]].cost == p->cost && points[front[at]].gain >= p->gain))
            continue;
        uint32_t beaten = at;
        while (beaten < found && points[front[beaten]].gain <= p->gain)
            beaten++;
        memmove(front + at + 1, front + beaten, (found - beaten) * sizeof *front);
        front[at] = i;
        found += 1 + at - beaten;
    }
    return found;
}

uint32_t bb_time_winners(const bb_time_line *lines, uint32_t count, bb_winner *winners)
{
    uint32_t found = 0, current = 0;
    double n = 0;
    if (count == 0)
        return 0;
    for (uint32_t i = 1; i < count; i++) {
        const bb_time_line *a = &lines[i], *b = &lines[current];
        if (a->fixed_ms < b->fixed_ms ||
            (a->fixed_ms == b->fixed_ms && a->ms_per_ray < b->ms_per_ray))
            current = i;
    }
    for (;;) {
        winners[found++] = (bb_winner){n, current};
        /* the next winner is the line that the current one meets first; of several, the flattest */
        uint32_t next = current;
        double at = INFINITY;
        for (uint32_t i = 0; i < count; i++) {
            double slope = lines[current].ms_per_ray - lines[i].ms_per_ray;
            if (!(slope > 0))
                continue;
            double cross = fmax(n, (lines[i].fixed_ms - lines[current].fixed_ms) / slope);
            if (cross < at || (cross == at && lines[i].ms_per_ray < lines[next].ms_per_ray)) {
                at = cross;
                next = i;
            }
        }
        if (next == current)
            return found;
        current = next;
        n = at;
    }
}
