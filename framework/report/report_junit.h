/* A comparison as JUnit's XML. */
#ifndef BB_REPORT_JUNIT_H
#define BB_REPORT_JUNIT_H

#include "framework/compare/compare.h"

#include <stdio.h>

/* Prints each cell of the side before as a test. What is worse, or missing, fails, as in the exit
 * status; what is not compared is skipped. BB_FAILED: `out` cannot be written. */
bb_status bb_report_junit(const bb_comparison_result *result, FILE *out);

#endif
