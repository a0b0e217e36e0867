/* LOBVH's octree as published, in four arrays: what lobvh.c builds by with `octree=arrays`.
 *
 *   a box, a first child, a next pointer, a first and a last primitive: 40 bytes for each node
 *
 * lobvh_dense.cl has the algorithm.
 */
#ifndef BB_LOBVH_DENSE_H
#define BB_LOBVH_DENSE_H

#include "framework/builder/builder.h"

typedef struct bb_lobvh_dense {
    bb_device *device;
    bb_account *account;
    cl_program program;
    cl_kernel pointers, setup, adjust, next, write;
    bb_buffer boxes, children, nexts, prims; /* the four arrays */
    bb_buffer offsets, total;                /* of nodes above the deepest level; of the tree */
} bb_lobvh_dense;

/* Compiles; what it has so far is released by bb_lobvh_dense_release() also after a failure. */
bb_status bb_lobvh_dense_create(bb_device *device, bb_account *account, bb_lobvh_dense *dense);
void bb_lobvh_dense_release(bb_lobvh_dense *dense); /* a zeroed one is allowed */

/* Bytes of the four arrays and of the places of so many levels; of the largest of them. */
uint64_t bb_lobvh_dense_bytes(uint32_t levels);
uint64_t bb_lobvh_dense_largest(uint32_t levels);
uint64_t bb_lobvh_dense_held(const bb_lobvh_dense *dense);

bb_status bb_lobvh_dense_reserve(bb_lobvh_dense *dense, uint32_t levels);

/* Makes the tree of primitives whose keys are sorted, in `tree`, which has room. */
bb_status bb_lobvh_dense_link(bb_lobvh_dense *dense, bb_primitives *primitives,
                              const bb_buffer *keys, const bb_buffer *values,
                              const bb_buffer *boxes, uint32_t count, uint32_t levels,
                              bb_tree *tree, bb_phases *phases);

#endif
