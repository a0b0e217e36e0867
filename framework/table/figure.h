/* Numbers as text, in every output of the program. */
#ifndef BB_FIGURE_H
#define BB_FIGURE_H

#include "framework/base/statistics.h"

enum { BB_FIGURE_MAX = 128 };

/* Functions return `out`. A value that is not finite is "-". */

/* `decimals` after the point, whole numbers as 1,234,567; -1: three significant digits, and all
 * digits before the point up to ten million. */
const char *bb_figure(char out[BB_FIGURE_MAX], double value, int decimals);
/* "1.03 [1.01, 1.05]"; without an interval the value alone. */
const char *bb_figure_interval(char out[BB_FIGURE_MAX], bb_estimate estimate, int decimals);
/* "3.25 MiB" */
const char *bb_figure_bytes(char out[BB_FIGURE_MAX], double bytes);

#endif
