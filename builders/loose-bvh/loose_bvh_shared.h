/* Constants that host and device share for the Loose BVH. */
#ifndef BB_LOOSE_BVH_SHARED_H
#define BB_LOOSE_BVH_SHARED_H

/* Words of a box that several work-items join. */
#define BB_LOOSE_SPAN_WORDS 6u

/* Most splits that a chunk of cells leaves over, with at most 30 depths: those whose nodes begin
 * before it and those whose nodes end after it, one of each depth, and the one at its end. */
#define BB_LOOSE_REST_MAX 64u

#endif
