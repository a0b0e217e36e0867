/* The option --charts, which the commands that make a report share. */
#ifndef BB_CHARTS_OPTION_H
#define BB_CHARTS_OPTION_H

#include "framework/cli/cli.h"

/* For a command's table of options. */
#define BB_CHARTS_OPTION                                                                           \
    {                                                                                              \
        "charts", "WHEN", "also as SVG and PNG: yes, no, or auto (if gnuplot is installed)", false \
    }

/* Whether charts are to be drawn; BB_INVALID if they are asked for and gnuplot is missing: to be
 * called before the work. */
bb_status bb_charts_wanted(const bb_cli *cli, bool *wanted);
/* Where none were drawn: says so on standard error, and why, unless that was asked for. */
void bb_charts_note(const bb_cli *cli);

#endif
