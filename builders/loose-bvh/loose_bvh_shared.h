/* What the host and the device side of the Loose BVH agree on. */
#ifndef BB_LOOSE_BVH_SHARED_H
#define BB_LOOSE_BVH_SHARED_H

/* Of a box that several work-items join. */
#define BB_LOOSE_SPAN_WORDS 6u

/* Room for the splits that a chunk of cells leaves over, of at most 30 depths: those that begin
 * before it, one of each depth, those that end after it, likewise, and the one at its end. */
#define BB_LOOSE_REST_MAX 64u

#endif
