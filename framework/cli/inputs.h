/* Result files as arguments: a folder stands for its results.json. */
#ifndef BB_INPUTS_H
#define BB_INPUTS_H

#include "framework/cli/cli.h"
#include "framework/record/record.h"

#include <limits.h>

/* Writes "FOLDER/NAME" into `path`. BB_INVALID if it is too long. */
bb_status bb_join_path(char path[PATH_MAX], const char *folder, const char *name);
/* Writes the path of the result file that an argument names. BB_INVALID if it is too long. */
bb_status bb_input_path(const char *argument, char path[PATH_MAX]);

/* A table from a file. Those of `run` are results, whose rows are checked. */
typedef struct bb_table_file {
    bb_results *results; /* NULL: of another command */
    bb_table *other;     /* NULL: of `run` */
} bb_table_file;

/* Reads the file that an argument names. bb_table_file_free() releases it, even after a failure. */
bb_status bb_table_file_read(const char *argument, bb_table_file *file);
const bb_table *bb_table_of_file(const bb_table_file *file);
void bb_table_file_free(bb_table_file *file);

/* BB_INVALID if two arguments are the same file, which would count twice. */
bb_status bb_inputs_once(const bb_cli *cli);

#endif
