/* Whether other programs took the machine's time while it measured. */
#include "framework/summary/summary.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>

/* Above this share of all threads, times are taken to be disturbed. */
static const double quiet_share = 0.1;

bool bb_summary_busy(const bb_results *results, char text[256])
{
    const cJSON *context = bb_results_section(results, "context");
    double threads = bb_get_number(context, BB_F_CONTEXT_THREADS);
    double others = bb_get_number(context, BB_F_CONTEXT_OTHERS);
    if (!(threads > 0) || !(others > quiet_share * threads))
        return false;
    snprintf(text, 256,
             "the machine was busy: other programs took %.2g of its %.0f threads while this "
             "measured; run it again when it is quiet",
             others, threads);
    return true;
}
