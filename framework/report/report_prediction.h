/* Prints how well the cost of trees predicts times of rays. */
#ifndef BB_REPORT_PREDICTION_H
#define BB_REPORT_PREDICTION_H

#include "framework/record/record.h"

#include <stdio.h>

/* Prints a row per kind of rays (framework/summary/prediction.h); nothing with too few trees. */
bb_status bb_report_predictions(const bb_results *results, FILE *out);

#endif
