/* How exactly rounds of PLOC compare distances, for host and device: ploc_cluster.clh says why. */
#ifndef BB_PLOC_SHARED_H
#define BB_PLOC_SHARED_H

/* Bits of a distance, a float >= 0, that a round compares: all, or its exponent alone. */
#define BB_PLOC_EXACT 0x7fffffff
#define BB_PLOC_FORCED 0x7f800000

/* Pairs of `count` clusters that are too few, so that the next round is forced: less than 5 %. In a
 * whole list, of which the last clusters are merged once, that is rounded down, and in a node's
 * window up: there what a chain adds to the depth adds up from node to node. */
#define BB_PLOC_FEW(count) ((count) / 20u)
#define BB_HPLOC_FEW(count) (((count) + 19u) / 20u)

#endif
