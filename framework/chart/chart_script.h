/* The charts as a script for gnuplot (5.0 or later), which draws each as SVG and as PNG. */
#ifndef BB_CHART_SCRIPT_H
#define BB_CHART_SCRIPT_H

#include "framework/chart/chart.h"

#include <stdio.h>

/* Of each scene and rays, all views together: speed against wrong answers of the kernels, time
 * against wrong answers of the builders, time to n rays, speed against SAH, and against EPO where
 * it was measured. `pictures` gets their number. The script writes NAME.svg and NAME.png into the
 * folder where gnuplot runs. Names from the records stand in it as quoted text alone. */
bb_status bb_charts_script(const bb_charts *charts, FILE *out, uint32_t *pictures);

#endif
