/* What the readers of rays files and of hits files share: a file whose checksum is taken as it is
 * read, and the checks of what both headers hold. Each fails with BB_INVALID, the file's path and
 * what is wrong.
 */
#ifndef BB_EXCHANGE_INTAKE_H
#define BB_EXCHANGE_INTAKE_H

#include "framework/base/file.h"
#include "framework/base/status.h"

#include <stddef.h>
#include <stdint.h>
#include <xxhash.h>

/* A file that is read and summed up. */
typedef struct bb_intake {
    bb_input input;
    XXH3_state_t *sum;
} bb_intake;

/* `what` begins the messages: "rays file" or "hits file"; it and `path` must stay. */
bb_status bb_intake_open(const char *path, const char *what, bb_intake *in);
void bb_intake_close(bb_intake *in);
bb_status bb_intake_read(bb_intake *in, void *data, size_t size);

/* Reads a header of `size` bytes that begins with `magic`, and checks what both headers begin with.
 * Its checksum lies at `sum_at`; the sum takes that as 0. */
bb_status bb_intake_header(bb_intake *in, const char *magic, void *header, size_t size,
                           size_t sum_at);

/* Counts are below 2^31. */
bb_status bb_intake_check_count(const bb_intake *in, const char *name, uint64_t count);
/* The file is as long as its header says. */
bb_status bb_intake_check_size(const bb_intake *in, uint64_t expected);
/* All that was read has this checksum. */
bb_status bb_intake_check_sum(const bb_intake *in, uint64_t checksum);
/* A text ends with a 0, is filled up with 0 and does not move a terminal's cursor. */
bb_status bb_intake_check_text(const bb_intake *in, const char *name, const char *text,
                               size_t capacity);

#endif
