/* What an OLBVH is made from, for tests. */
#ifndef OLBVH_H
#define OLBVH_H

#include "framework/device/device.h"

/* The arrays of the last build that the tree does not have, named as in section 3. */
typedef struct olbvh_arrays {
    uint32_t nodes, references, levels;
    const bb_buffer *codes; /* MC, u32[references], sorted */
    const bb_buffer *no;    /* u32[levels] */
} olbvh_arrays;

/* `self`: an object of bb_builder_olbvh, after build(). */
void olbvh_arrays_of(const void *self, olbvh_arrays *arrays);

#endif
