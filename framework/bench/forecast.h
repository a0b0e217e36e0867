/* Predicts what a comparison takes of a large scene, from a small comparison of the same cells on a
 * sample of its primitives, with few rays. */
#ifndef BB_BENCH_FORECAST_H
#define BB_BENCH_FORECAST_H

#include "framework/bench/bench.h"

enum {
    /* Smaller scenes take no time to speak of; of larger ones so many are a sample, or ... */
    BB_FORECAST_PRIMS = 1 << 16,
    BB_FORECAST_SHARE = 16, /* ... one primitive of so many, if that is more */
};

/* A comparison takes less time with smaller pictures and ray sets, then in one view, then in fewer
 * rounds: the higher the thrift, the more is left out. 0: nothing. */
enum { BB_THRIFTS = 6 };
bb_bench_request bb_bench_thrifty(const bb_bench_request *request, uint32_t thrift);

typedef struct bb_forecast {
    double seconds[BB_THRIFTS]; /* of the scene, without loading it and without the report */
    double bytes;               /* of the host, at their peak, with all rays */
} bb_forecast;

/* Returns whether the scene can be sampled: it has no volume and does not move. */
bool bb_bench_can_be_foretold(const bb_scene *scene);

/* Returns whether it is known how the time of a step grows: others count as constant. */
bool bb_bench_knows_growth(const char *step);

/* Makes and runs the small comparison, with all that the builders leave in the process: it is meant
 * for a process of its own. `text`: the scene as requested. Small pictures are written into the
 * request's folder, if there is one. An interrupt leaves NANs. */
bb_status bb_bench_forecast(const bb_bench_request *request, const bb_scene *scene,
                            const char *text, bb_forecast *forecast);

#endif
