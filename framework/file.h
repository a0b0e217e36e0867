/* Whole files: read at once, written so that an interruption leaves the old file or none. */
#ifndef BB_FILE_H
#define BB_FILE_H

#include "framework/status.h"

#include <stddef.h>

/* Reads a regular file of at most `limit` bytes into *data (from malloc; a 0 byte follows the last
 * one). BB_INVALID when it is missing, no regular file, or larger; the message starts with `what`.
 */
bb_status bb_file_read(const char *path, size_t limit, const char *what, char **data, size_t *size);

/* Writes a temporary file in the folder of `path`, syncs it and renames it to `path`. BB_INVALID
 * when the folder cannot be written or `path` is something else than a regular file. */
bb_status bb_file_write(const char *path, const void *data, size_t size, const char *what);

/* Folder of `path` as a new string from malloc: "." if it has none. NULL if there is no memory. */
char *bb_file_folder(const char *path);

#endif
