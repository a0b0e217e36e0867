/* The six arrays of an OLBVH, for tests. */
#ifndef OLBVH_H
#define OLBVH_H

#include "framework/device/device.h"

/* The arrays of the last build, named as in section 3.1. P and BV are the common tree's references
 * and nodes. */
typedef struct olbvh_arrays {
    uint32_t nodes, references, levels;
    const bb_buffer *codes; /* MC, u32[references], sorted */
    const bb_buffer *co;    /* u32[inner nodes + 1] */
    const bb_buffer *po;    /* u32[nodes + 1] */
    const bb_buffer *bf;    /* u32[nodes] */
    const bb_buffer *no;    /* u32[levels] */
} olbvh_arrays;

/* `self`: an object of bb_builder_olbvh, after build(). */
void olbvh_arrays_of(const void *self, olbvh_arrays *arrays);

#endif
