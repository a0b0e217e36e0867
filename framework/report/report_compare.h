/* Prints a comparison for a terminal or for a pull request. */
#ifndef BB_REPORT_COMPARE_H
#define BB_REPORT_COMPARE_H

#include "framework/compare/compare.h"

#include <stdio.h>

/* Writes both values with four digits, or with more if they would look equal. */
void bb_compare_figures(double from, double to, char texts[2][40]);

/* Prints the origin of both sides, the floor, moved cells (worst first), cells on one side only,
 * and other reasons why cells are not compared. `github`: as Markdown. */
bb_status bb_report_compare(const bb_comparison_result *result, bool github, FILE *out);

/* Returns the cells that both runs measured as JSON for the page: both figures, their ratio, and
 * what the comparison says of it. From malloc. NULL without memory. */
char *bb_against_json(const bb_comparison_result *result);

#endif
