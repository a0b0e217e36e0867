/* Compaction on the device: moves the values to be kept to the front, in order; for example nodes
 * that are not empty, or clusters that have not been merged. A scan of the marks gives each value's
 * place (Blelloch 1990, "Prefix Sums and Their Applications").
 */
#ifndef BB_COMPACT_H
#define BB_COMPACT_H

#include "framework/device/primitives.h"

#pragma GCC visibility push(default) /* what a plug-in may call */
#ifdef __cplusplus
extern "C" {
#endif

typedef struct bb_compaction bb_compaction;

/* Compiles the kernel. `primitives` does the scan and must outlive the compaction; scratch is
 * booked on `account`. The caller owns the result. */
bb_status bb_compaction_create(bb_device *device, bb_account *account, bb_primitives *primitives,
                               bb_compaction **out);
void bb_compaction_destroy(bb_compaction *compaction); /* NULL is allowed */

/* Reserves scratch for up to `count` values, so that a timed build need not. */
bb_status bb_compaction_reserve(bb_compaction *compaction, uint32_t count);

/* Writes values[i], or i if `values` is NULL, to out[0], out[1], ... for each i < count with
 * marks[i] 1 (not 0), and their number to kept[0]. All are u32; `out` must be none of the other
 * buffers and has room for all that may be kept. Enqueued, not waited for. BB_INVALID: a buffer is
 * too small; BB_REFUSED: there is no memory for the scratch. */
bb_status bb_compact_u32(bb_compaction *compaction, const bb_buffer *marks, const bb_buffer *values,
                         uint32_t count, bb_buffer *out, bb_buffer *kept);

#ifdef __cplusplus
}
#endif
#pragma GCC visibility pop

#endif
