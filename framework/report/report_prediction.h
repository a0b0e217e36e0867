/* Does a tree's cost predict what rays take? As a table on the terminal. */
#ifndef BB_REPORT_PREDICTION_H
#define BB_REPORT_PREDICTION_H

#include "framework/record/record.h"

#include <stdio.h>

/* A row per kind of rays (framework/summary/prediction.h); nothing where there are too few trees.
 */
bb_status bb_report_predictions(const bb_results *results, FILE *out);

#endif
