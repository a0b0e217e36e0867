/* What kernels/ray_order.cl and its host side share. */
#ifndef BB_RAY_ORDER_SHARED_H
#define BB_RAY_ORDER_SHARED_H

/* Bits of a cell's number on each axis of the scene's box, and of a key: those of the Morton code,
 * and three of the octant above them. */
#define BB_RAY_CELL_BITS 9
#define BB_RAY_KEY_BITS (3 * BB_RAY_CELL_BITS + 3)

#endif
