/* What simulations of several sets of rays come to together, if one set is traced after the other.
 */
#ifndef BB_SIMULATED_SETS_H
#define BB_SIMULATED_SETS_H

#include "framework/simulate/simulate.h"

/* A zeroed one has no sets. */
typedef struct bb_simulated_sets {
    uint32_t count;
    bb_simulation first;
    double rays, samples;
    double longest; /* time of the set that takes longest, and what binds it */
    bb_binding binds;
    double lanes;      /* sum of times by issue, each times its efficiency */
    bb_simulation sum; /* in place of a bound, the time that it takes; in place of a mean, the sum
                        * over all rays */
} bb_simulated_sets;

/* Adds a set of so many rays, of which `one` simulated a sample. */
void bb_simulated_add(bb_simulated_sets *sets, double rays, const bb_simulation *one);

/* Returns the simulation of a single set as it is. Of several: bounds on all rays, what binds the
 * set that takes longest, means per ray, efficiency over all instructions, the rays of all samples;
 * other figures are NAN, and so is what one of the sets lacks. Without sets, all are NAN. */
bb_simulation bb_simulated_sum(const bb_simulated_sets *sets);

#endif
