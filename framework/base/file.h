/* Whole files: read at once, and written so that an interruption leaves the old file or none. */
#ifndef BB_FILE_H
#define BB_FILE_H

#include "framework/base/status.h"

#include <limits.h>
#include <stddef.h>
#include <stdint.h>

/* A regular file that is read from the beginning, piece by piece. */
typedef struct bb_input {
    const char *path, *what; /* for messages; not copied */
    uint64_t size;           /* of the whole file */
    int handle;
} bb_input;

/* Opens a regular file. BB_INVALID if it is missing or not regular; messages start with `what`. */
bb_status bb_input_open(const char *path, const char *what, bb_input *input);
/* Reads the next `size` bytes. BB_INVALID if there are fewer. */
bb_status bb_input_read(bb_input *input, void *data, size_t size);
void bb_input_close(bb_input *input); /* `input` is open */

/* Reads a regular file of at most `limit` bytes into *data, from malloc, and appends a 0 byte.
 * BB_INVALID if it is missing, not regular or larger; the message starts with `what`. */
bb_status bb_file_read(const char *path, size_t limit, const char *what, char **data, size_t *size);

/* Writes a temporary file in the folder of `path`, syncs it and renames it to `path`. BB_INVALID if
 * the folder cannot be written or `path` exists but is not a regular file. */
bb_status bb_file_write(const char *path, const void *data, size_t size, const char *what);

/* Like bb_file_write(), for several parts that follow each other in the file. */
typedef struct bb_file_part {
    const void *data;
    size_t size;
} bb_file_part;
bb_status bb_file_write_parts(const char *path, const bb_file_part *parts, size_t count,
                              const char *what);

/* Makes a folder in $TMPDIR, or /tmp, and writes its path. BB_INVALID if that is not possible. */
bb_status bb_temporary_folder(char path[PATH_MAX]);
/* Removes a folder with all that is in it; "" is allowed. */
void bb_remove_folder(const char *path);

/* Returns the folder of `path`, from malloc: "." if `path` names none. NULL without memory. */
char *bb_file_folder(const char *path);

#endif
