/* How exactly rounds of PLOC compare distances, for host and device: ploc_cluster.clh says why. */
#ifndef BB_PLOC_SHARED_H
#define BB_PLOC_SHARED_H

/* Bits of a distance, a float >= 0, that a round compares: all, or its exponent alone. */
#define BB_PLOC_EXACT 0x7fffffff
#define BB_PLOC_FORCED 0x7f800000

/* The mask for the round after one that made `pairs` pairs of `count` clusters: forced after less
 * than 5 %. */
#define BB_PLOC_NEXT_MASK(pairs, count) ((pairs) < (count) / 20u ? BB_PLOC_FORCED : BB_PLOC_EXACT)

#endif
