/* The least by simulation: the course of an advice with the bounds of a GPU on paper in place of
 * measured times. Nothing of it depends on a clock, so each contender is simulated once, with all
 * rays, and no heats are needed. */
#ifndef BB_ADVISE_SIMULATED_H
#define BB_ADVISE_SIMULATED_H

#include "framework/advise/heat.h"

/* Fills advice->simulated by all simulations of the request. `heat` has the rays and the scene;
 * progress is shown in it. An interrupt ends it; the advice then has those that were complete. */
bb_status bb_simulated_run(bb_advice *advice, const bb_heat *heat);

/* Predicts how many seconds that takes, from one contender on the sample of the scene. */
bb_status bb_simulated_foretell(const bb_advice *advice, const bb_heat *heat, double *seconds);

void bb_simulated_free(bb_advice *advice);

#endif
