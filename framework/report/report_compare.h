/* What a comparison found, for a terminal or for a pull request. */
#ifndef BB_REPORT_COMPARE_H
#define BB_REPORT_COMPARE_H

#include "framework/compare/compare.h"

#include <stdio.h>

/* How both sides came about, the floor, what moved (worst first), what is in one of them only, and
 * whatever else keeps cells from being compared. `github`: as Markdown. */
bb_status bb_report_compare(const bb_comparison_result *result, bool github, FILE *out);

#endif
