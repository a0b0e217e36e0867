/* Shared by the readers of rays files and hits files: a file that is summed up as it is read, and
 * checks of both headers. Each function fails with BB_INVALID and a message that names the file.
 */
#ifndef BB_EXCHANGE_INTAKE_H
#define BB_EXCHANGE_INTAKE_H

#include "framework/base/file.h"
#include "framework/base/status.h"

#include <stddef.h>
#include <stdint.h>
#include <xxhash.h>

/* A file, and the checksum of what has been read of it. */
typedef struct bb_intake {
    bb_input input;
    XXH3_state_t *sum;
} bb_intake;

/* Messages begin with `what`: "rays file" or "hits file". `what` and `path` must outlive `in`. */
bb_status bb_intake_open(const char *path, const char *what, bb_intake *in);
void bb_intake_close(bb_intake *in);
bb_status bb_intake_read(bb_intake *in, void *data, size_t size);

/* Reads a header of `size` bytes and checks its first members, which both headers have. The
 * header's checksum, at offset `sum_at`, enters the sum as 0. */
bb_status bb_intake_header(bb_intake *in, const char *magic, void *header, size_t size,
                           size_t sum_at);

/* Checks that a count is below 2^31. */
bb_status bb_intake_check_count(const bb_intake *in, const char *name, uint64_t count);
/* Checks that the file has `expected` bytes. */
bb_status bb_intake_check_size(const bb_intake *in, uint64_t expected);
/* Checks the checksum of all that was read. */
bb_status bb_intake_check_sum(const bb_intake *in, uint64_t checksum);
/* Checks that a text ends with a 0, is padded with 0 and has no control characters. */
bb_status bb_intake_check_text(const bb_intake *in, const char *name, const char *text,
                               size_t capacity);

#endif
