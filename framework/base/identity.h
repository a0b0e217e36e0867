/* A hash of all that a result depends on, by which it is known whether one of an earlier run still
 * holds. */
#ifndef BB_IDENTITY_H
#define BB_IDENTITY_H

#include "framework/base/status.h"

#include <stddef.h>
#include <stdint.h>

typedef struct XXH3_state_s bb_identity; /* xxHash's */

/* NULL without memory, which all functions take; the last one says so. */
bb_identity *bb_identity_begin(void);
void bb_identity_add(bb_identity *identity, const void *bytes, size_t size);
void bb_identity_add_text(bb_identity *identity, const char *text); /* NULL: like "" */
/* The contents of a file; a file that cannot be read is like an empty one. */
void bb_identity_add_file(bb_identity *identity, const char *path);
/* Names and contents of all files of a folder, in whichever order they come; not of its folders. */
void bb_identity_add_folder(bb_identity *identity, const char *path);

/* Releases it; *hash is what came of it. BB_FAILED without memory, with `what` in the message. */
bb_status bb_identity_end(bb_identity *identity, const char *what, uint64_t *hash);

#endif
