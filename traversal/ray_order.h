/* Rays in an order in which neighbours are alike: host side of kernels/ray_order.cl. */
#ifndef BB_RAY_ORDER_H
#define BB_RAY_ORDER_H

#include "framework/device/device.h"
#include "kernels/bb_shared.h"

/* One for each device. */
typedef struct bb_ray_order bb_ray_order;

/* Gets the device's; the first call compiles. It is there until bb_ray_order_clear(). */
bb_status bb_ray_order_of(bb_device *device, bb_ray_order **out);
/* Releases the device's, if there is one. */
void bb_ray_order_clear(bb_device *device);

/* Sorts the numbers of rays[0..count), bb_ray on the device, by the octant of the direction, then
 * by the Morton code of the origin in `box`, that of the scene; equal ones keep their order. The
 * order is for `whose`. Memory: 16 bytes per ray; BB_REFUSED if there is none. Enqueued. */
bb_status bb_ray_order_make(bb_ray_order *order, const void *whose, const bb_box *box,
                            const bb_buffer *rays, uint32_t count);

/* Gets the numbers, u32, of `count` rays, once after each sort. The object owns *ids. BB_FAILED if
 * the last sort was another's, or of other rays, or was taken before. */
bb_status bb_ray_order_take(bb_ray_order *order, const void *whose, uint32_t count,
                            const bb_buffer **ids);

#endif
