/* How long the stacks of a kernel may be on a device. */
#ifndef BB_STACK_ROOM_H
#define BB_STACK_ROOM_H

#include "traversal/traversal.h"

enum { BB_STACK_ENTRY_BYTES = 8 }; /* a link and a distance */

/* Rays whose stacks a work-item has at once: as many as it has in flight. */
uint32_t bb_stacks_of_item(const bb_kernel *kernel, const bb_spec *spec);

/* Entries that a stack may have, if each work-item has so many: a power of two, and at least
 * BB_STACK_LEAST, or UINT32_MAX on CPUs, whose work-items come one after the other. */
uint32_t bb_stack_room(const bb_device *device, uint32_t stacks);

enum { BB_STACK_LEAST = 16 };

#endif
