/* The option --out of all commands: the folder, or a file's folder, is made before the work. */
#ifndef BB_OUT_OPTION_H
#define BB_OUT_OPTION_H

#include "framework/base/status.h"

/* Makes the folder and its missing parents, and checks that files can be written there. BB_INVALID:
 * they cannot. */
bb_status bb_out_folder(const char *path);

/* Does the same for the folder of a file. BB_INVALID also if `path` exists and is no regular file.
 * Messages start with `what`. */
bb_status bb_out_file(const char *path, const char *what);

/* Removes the folders that were made and are still empty. To be called when a command ends. */
void bb_out_tidy(void);

#endif
