/* The room for a kernel's stacks on a device. */
#ifndef BB_STACK_ROOM_H
#define BB_STACK_ROOM_H

#include "traversal/traversal.h"

enum { BB_STACK_ENTRY_BYTES = 8 }; /* a link and a distance */

/* Returns the number of stacks per work-item: one per ray that it has in flight. (A packet has one,
 * which is as large; a ray that leaves it has another.) */
uint32_t bb_stacks_of_item(const bb_kernel *kernel, const bb_spec *spec);

/* Returns how many entries each stack may have if each work-item has `stacks` of them: a power of
 * two, at least BB_STACK_LEAST; UINT32_MAX on CPUs, which run work-items one after the other. */
uint32_t bb_stack_room(const bb_device *device, uint32_t stacks);

enum { BB_STACK_LEAST = 16 };

#endif
