/* A hash of all that a result depends on. It tells whether an earlier result still holds. */
#ifndef BB_IDENTITY_H
#define BB_IDENTITY_H

#include "framework/base/status.h"

#include <stddef.h>
#include <stdint.h>

typedef struct XXH3_state_s bb_identity; /* the state of xxHash */

/* Returns NULL without memory; all functions below accept NULL, and the last one reports it. */
bb_identity *bb_identity_begin(void);
void bb_identity_add(bb_identity *identity, const void *bytes, size_t size);
void bb_identity_add_text(bb_identity *identity, const char *text); /* NULL counts as "" */
/* Adds the contents of a file; an unreadable file counts as empty. */
void bb_identity_add_file(bb_identity *identity, const char *path);
/* Adds names and contents of the files in a folder, in any order, without its subfolders. */
void bb_identity_add_folder(bb_identity *identity, const char *path);

/* Frees `identity` and sets *hash to the result. BB_FAILED without memory, with `what` in the
 * message. */
bb_status bb_identity_end(bb_identity *identity, const char *what, uint64_t *hash);

#endif
