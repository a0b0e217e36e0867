/* Parallel primitives on the device: scan, reduce, key-value radix sort. Two forms behind one
 * interface: for CPU devices (one work-item per chunk) and for GPUs (local memory and barriers);
 * device->form chooses, and either can be forced on any device.
 *
 * Nothing here waits for the device, except the sort's CPU form, once. BB_INVALID: a buffer is too
 * small for the count, or the count or bits are out of range. BB_REFUSED: there is no memory for
 * the scratch.
 */
#ifndef BB_PRIMITIVES_H
#define BB_PRIMITIVES_H

#include "framework/device/device.h"

#pragma GCC visibility push(default) /* what a plug-in may call */
#ifdef __cplusplus
extern "C" {
#endif

typedef struct bb_primitives bb_primitives;

/* Compiles the kernels of the device's form. The object keeps its scratch between calls; it is
 * booked on `account`. The caller owns *out. */
bb_status bb_primitives_create(bb_device *device, bb_account *account, bb_primitives **out);
void bb_primitives_destroy(bb_primitives *primitives); /* NULL is allowed */

/* Exclusive prefix sum of `count` u32 from `in` to `out` (may be the same buffer); the total is
 * written to total[0] if `total` is not NULL. Sums wrap modulo 2^32. Enqueued, not waited for. */
bb_status bb_scan_u32(bb_primitives *primitives, const bb_buffer *in, bb_buffer *out,
                      uint32_t count, bb_buffer *total);

/* Union of `count` bb_box, and of their centroids (lo + hi) / 2 (computed as 0.5f*lo + 0.5f*hi):
 * out[0] is the box of the boxes, out[1] that of the centroids, two bb_box. count >= 1. min and max
 * are exact and zeros become +0, so the result does not depend on the order. Boxes must be finite.
 * The words between lo and hi are not read, so `boxes` may hold any struct of the size and layout
 * of bb_box. Enqueued. */
bb_status bb_reduce_boxes(bb_primitives *primitives, const bb_buffer *boxes, uint32_t count,
                          bb_buffer *out);

/* Stable ascending sort of `count` key-value pairs by the lowest `bits` bits of the key (1 to 32,
 * or to 64). Sorts in place; `keys` holds u32 or u64, `values` u32. Bits above `bits` must be 0.
 * Time and scratch are proportional to the count, for any keys. Enqueued; the CPU form waits until
 * it knows how many keys share their highest digit. */
bb_status bb_sort_u32(bb_primitives *primitives, bb_buffer *keys, bb_buffer *values, uint32_t count,
                      uint32_t bits);
bb_status bb_sort_u64(bb_primitives *primitives, bb_buffer *keys, bb_buffer *values, uint32_t count,
                      uint32_t bits);

/* The same for keys of 4 or 8 bytes; with 0 bits all pairs stay in place. */
bb_status bb_sort_keys(bb_primitives *primitives, uint32_t key_bytes, bb_buffer *keys,
                       bb_buffer *values, uint32_t count, uint32_t bits);

/* Reserves the scratch that sorts of up to `count` pairs need, so that the timed build does not.
 * Keys of 4 or 8 bytes. */
bb_status bb_primitives_reserve(bb_primitives *primitives, uint32_t count, uint32_t key_bytes);

#ifdef __cplusplus
}
#endif
#pragma GCC visibility pop

#endif
