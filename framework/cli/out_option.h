/* --out of all commands: the folder, or the file and its folder, made before the work. */
#ifndef BB_OUT_OPTION_H
#define BB_OUT_OPTION_H

#include "framework/base/status.h"

/* Makes the folder and those around it that are missing, and makes sure that it can be written.
 * BB_INVALID: it cannot. */
bb_status bb_out_folder(const char *path);

/* The same of the folder of a file, which must be none of another kind. Messages start with
 * `what`. */
bb_status bb_out_file(const char *path, const char *what);

/* Removes the folders that were made and are empty. To be called when a command ends. */
void bb_out_tidy(void);

#endif
