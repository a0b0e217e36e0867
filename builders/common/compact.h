/* Compaction on the device: moves the values to be kept to the front, in order; for example nodes
 * that are not empty, or clusters that have not been merged. A scan of the marks says where each
 * value goes (Blelloch 1990, "Prefix Sums and Their Applications").
 */
#ifndef BB_COMPACT_H
#define BB_COMPACT_H

#include "framework/device/primitives.h"

#pragma GCC visibility push(default) /* what a plug-in may call */
#ifdef __cplusplus
extern "C" {
#endif

typedef struct bb_compaction bb_compaction;

/* Compiles the kernel. `primitives`, which does the scan, must outlive it; the scratch is in
 * `account`. Owned by the caller. */
bb_status bb_compaction_create(bb_device *device, bb_account *account, bb_primitives *primitives,
                               bb_compaction **out);
void bb_compaction_destroy(bb_compaction *compaction); /* NULL is allowed */

/* Reserves the scratch for up to `count` values, so that a timed build does not. */
bb_status bb_compaction_reserve(bb_compaction *compaction, uint32_t count);

/* Writes values[i] of each i < count with marks[i] 1 (not 0) to out[0], out[1], ...; if `values` is
 * NULL, the indices i themselves. kept[0] gets their number. All are u32; `out` must not be one of
 * the other buffers, and has room for all that may be kept. Enqueued, not waited for. BB_INVALID: a
 * buffer is too small; BB_REFUSED: there is no memory for the scratch. */
bb_status bb_compact_u32(bb_compaction *compaction, const bb_buffer *marks, const bb_buffer *values,
                         uint32_t count, bb_buffer *out, bb_buffer *kept);

#ifdef __cplusplus
}
#endif
#pragma GCC visibility pop

#endif
