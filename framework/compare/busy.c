/* Warns if other programs used the machine during the measurements. */
#include "framework/compare/summary.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Times count as disturbed if other programs kept more than this share of all threads busy. */
static const double quiet_share = 0.1;

bool bb_summary_busy(const bb_results *results, char text[256])
{
    const bb_entry *context = bb_results_context(results);
    double threads = bb_get_number(context, BB_F_CONTEXT_THREADS);
    double others = bb_get_number(context, BB_F_CONTEXT_OTHERS);
    if (!(threads > 0) || !(others > quiet_share * threads))
        return false;
    const char *type = bb_get_text(context, BB_F_CONTEXT_DEVICE_TYPE);
    const bool elsewhere = strcmp(type, BB_DEVICE_OTHER) == 0;
    snprintf(text, 256,
             "the machine was busy: other programs took %.2g of its %.0f threads while this "
             "measured%s; run it again when it is quiet",
             others, threads, elsewhere ? ", and what they did on the GPU is not known" : "");
    return true;
}
