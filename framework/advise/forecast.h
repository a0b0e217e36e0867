/* What an advice will take, foretold from what its scouts took on a sample of the scene. */
#ifndef BB_FORECAST_H
#define BB_FORECAST_H

#include "framework/advise/advice.h"

/* How a heat compares with the scouts': rounds, and rays as multiples of theirs. */
typedef struct bb_forecast_heat {
    double rounds, rays;
} bb_forecast_heat;

/* Of advice->field in `count` heats, 1 or more. Most is dropped on the way: a heat is taken to have
 * a quarter of the configurations of the one before. `scouted`: the outcome of the builders'
 * scouts, in `document`; `host_bytes`: what the program has taken by now, at its peak. Without
 * scouts that could run, seconds are NAN. */
bb_takings bb_forecast(const bb_advice *advice, const bb_forecast_heat *heats, uint32_t count,
                       const bb_bench_times *scouted, const bb_results *document,
                       double host_bytes);

/* As in "2 min 5 s, 2.1 GB of memory, 1.2 GB of it for trees and layouts". */
void bb_takings_say(const bb_takings *takings, char *text, size_t capacity);

#endif
