/* Precision in which rounds of PLOC compare distances; ploc_cluster.clh says why. */
#ifndef BB_PLOC_SHARED_H
#define BB_PLOC_SHARED_H

/* Bits of a distance, a float >= 0, that a round compares: all, or only the exponent. */
#define BB_PLOC_EXACT 0x7fffffff
#define BB_PLOC_FORCED 0x7f800000

/* A round that makes fewer pairs of `count` clusters than this, 5 %, is followed by a forced one.
 * Rounded down for a whole list, whose last clusters merge once; rounded up for a node's window,
 * since the depth that chains add accumulates from node to node. */
#define BB_PLOC_FEW(count) ((count) / 20u)
#define BB_HPLOC_FEW(count) (((count) + 19u) / 20u)

#endif
