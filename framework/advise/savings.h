/* What the choice saves: it is measured beside itself with generous settings. */
#ifndef BB_SAVINGS_H
#define BB_SAVINGS_H

#include "framework/advise/heat.h"

/* Fills advice->savings, of advice->choice, by a comparison in `results`, which is empty. What
 * comes of its audit is added to *outcome, whose bytes_held become its. */
bb_status bb_savings_measure(bb_advice *advice, const bb_heat *heat, bb_results *results,
                             bb_bench_outcome *outcome);

#endif
