/* Savings of the choice, compared with generous settings. */
#ifndef BB_SAVINGS_H
#define BB_SAVINGS_H

#include "framework/advise/heat.h"

/* Fills advice->savings of advice->choice by a comparison into `results`, which must be empty. Adds
 * its audit to *outcome, and sets outcome->bytes_held. */
bb_status bb_savings_measure(bb_advice *advice, const bb_heat *heat, bb_results *results,
                             bb_bench_outcome *outcome);

#endif
