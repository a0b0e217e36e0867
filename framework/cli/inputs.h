/* Result files as arguments: a folder stands for its results.json. */
#ifndef BB_INPUTS_H
#define BB_INPUTS_H

#include "framework/cli/cli.h"

#include <limits.h>

/* Writes "FOLDER/NAME" into `path`. BB_INVALID if it is too long. */
bb_status bb_join_path(char path[PATH_MAX], const char *folder, const char *name);
/* Writes the path of the result file that an argument names. BB_INVALID if it is too long. */
bb_status bb_input_path(const char *argument, char path[PATH_MAX]);
/* BB_INVALID if two arguments are the same file, which would count twice. */
bb_status bb_inputs_once(const bb_cli *cli);

#endif
