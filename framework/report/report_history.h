/* The page of the history: each cell over the revisions of a machine, one file that works offline.
 */
#ifndef BB_REPORT_HISTORY_H
#define BB_REPORT_HISTORY_H

#include "framework/history/trend.h"

#include <stdio.h>

/* Writes the page. BB_INVALID if there is nothing in the history, or it can't be written. */
bb_status bb_report_history(const bb_trend *trends, uint32_t count, const char *path);

/* What moved, the latest revision of each machine first, as text. */
bb_status bb_report_history_text(const bb_trend *trends, uint32_t count, FILE *out);

#endif
