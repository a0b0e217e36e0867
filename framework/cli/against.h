/* Two runs on one page, for `bvhbench report --against`. */
#ifndef BB_CLI_AGAINST_H
#define BB_CLI_AGAINST_H

#include "framework/cli/cli.h"

/* Compares the two runs that the arguments name, OLD and NEW, prints what moved, and writes the
 * page of both to `out`; NULL: to against.html beside NEW. BB_INVALID unless there are two, with
 * cells in common. */
bb_status bb_report_against(const bb_cli *cli, const char *out);

#endif
