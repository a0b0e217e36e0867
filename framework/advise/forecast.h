/* Predicts time and memory of an advice from its scouts on a sample of the scene. */
#ifndef BB_FORECAST_H
#define BB_FORECAST_H

#include "framework/advise/advice.h"

/* Rounds of a heat, and its rays as a multiple of the scouts'. */
typedef struct bb_forecast_heat {
    double rounds, rays;
} bb_forecast_heat;

/* Predicts `count` heats, 1 or more, of advice->field. Each heat is assumed to have a quarter of
 * the contenders of the one before. `scouted`: the times of the builders' scouts, whose results are
 * in `document`. `host_bytes`: the program's peak so far. Seconds are NAN if no scout could run. */
bb_takings bb_forecast(const bb_advice *advice, const bb_forecast_heat *heats, uint32_t count,
                       const bb_bench_times *scouted, const bb_results *document,
                       double host_bytes);

/* Returns the ms that the comparison of these results took to compile. */
double bb_forecast_compiled_ms(const bb_results *document);

/* Writes "2 min 5 s, 2.10 GB of host memory and ...". */
void bb_takings_say(const bb_takings *takings, char *text, size_t capacity);

#endif
