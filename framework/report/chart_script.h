/* Writes the charts as a script for gnuplot (5.0 or later), which draws each as SVG and PNG, or one
 * of them for print. */
#ifndef BB_CHART_SCRIPT_H
#define BB_CHART_SCRIPT_H

#include "framework/report/chart.h"

#include <stdio.h>

/* Writes the script. For each scene and rays, over all views, there are pictures of kernels' speed
 * against wrong answers, of builders' time against wrong answers, of time to n rays, and of speed
 * against SAH and other measured metrics of trees. `pictures` gets their number. The script writes
 * NAME.svg and NAME.png into gnuplot's current folder, or `figure` alone, unless that is NULL.
 * Names from the records occur in it only as quoted text. BB_INVALID: no chart has the figure's
 * name. */
bb_status bb_charts_script(const bb_charts *charts, const bb_chart_print *figure, FILE *out,
                           uint32_t *pictures);

#endif
