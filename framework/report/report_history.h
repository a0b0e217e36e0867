/* Shows the history: each cell over the revisions of a machine. */
#ifndef BB_REPORT_HISTORY_H
#define BB_REPORT_HISTORY_H

#include "framework/compare/trend.h"

#include <stdio.h>

/* Writes the page, one file that works offline. BB_INVALID: the history is empty, or the page
 * cannot be written. */
bb_status bb_report_history(const bb_trend *trends, uint32_t count, const char *path);

/* Prints moved cells as text, the latest revision of each machine first. */
bb_status bb_report_history_text(const bb_trend *trends, uint32_t count, FILE *out);

#endif
