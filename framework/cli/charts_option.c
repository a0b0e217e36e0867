/* The option --charts. */
#include "framework/cli/charts_option.h"
#include "framework/report/report.h"

#include <stdio.h>
#include <string.h>

static const char advice[] =
    "gnuplot is not installed: apt-get install gnuplot-nox, or --charts no";

bb_status bb_charts_wanted(const bb_cli *cli, bool *wanted)
{
    const char *when = bb_cli_value(cli, "charts");
    *wanted = false;
    if (when == NULL || strcmp(when, "auto") == 0) {
        *wanted = bb_report_can_draw();
        return BB_OK;
    }
    if (strcmp(when, "yes") != 0 && strcmp(when, "no") != 0)
        return bb_fail(BB_INVALID, "--charts is '%s', must be yes, no or auto", when);
    *wanted = strcmp(when, "yes") == 0;
    if (*wanted && !bb_report_can_draw())
        return bb_fail(BB_INVALID, "--charts yes: %s", advice);
    return BB_OK;
}

void bb_charts_note(const bb_cli *cli)
{
    const char *when = bb_cli_value(cli, "charts");
    if (when == NULL || strcmp(when, "auto") == 0)
        fprintf(stderr, "bvhbench: charts were not written as SVG and PNG: %s\n", advice);
}
