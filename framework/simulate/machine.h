/* A machine of units, each of which keeps several groups of rays in flight and has a first cache of
 * its own; the second cache is shared. It runs recorded steps (warp.h) in an order that depends on
 * nothing else: work-groups are dealt out to the units by turns; in each round each unit, one after
 * the other, issues the next step of one of its groups, by turns, and takes its next group when one
 * ends.
 *
 * First caches begin empty; the second one begins with the layout, or if that is larger with an
 * even share of its lines, as a render that has run for long leaves it.
 *
 * Left out: how long anything takes. What is counted gives bounds (simulate.h).
 */
#ifndef BB_MACHINE_H
#define BB_MACHINE_H

#include "framework/simulate/unit.h"

/* Runs all rays, on all cores. Answers that are still in the caches at the end go to memory; stack
 * entries do not, since the next groups would write over them. BB_REFUSED: there is no memory for
 * it. */
bb_status bb_machine_run(const bb_machine *machine, const bb_footing *footing,
                         const bb_steps *steps, bb_traffic *traffic);

/* Returns the active lanes per lane issued; NAN: nothing was issued. */
double bb_efficiency(const bb_issued *issued, uint32_t width);

#endif
