/* What a kernel's steps read and write: of a layout, and of a volume. */
#ifndef BB_FOOTING_H
#define BB_FOOTING_H

#include "traversal/traversal.h"

typedef struct bb_footing {
    bb_control control;
    uint32_t group;                    /* rays of a work-group, at least 1 */
    uint32_t packet;                   /* rays of a packet, a divisor of the width; 1: no packets */
    uint32_t ring;                     /* entries of a short stack; 0: as many as it takes */
    uint32_t node_bytes;               /* size of a node */
    uint32_t prim_bytes;               /* of a primitive, or of a block of them */
    uint32_t item_bytes;               /* of a ray, or whatever an answer is asked for */
    uint32_t result_bytes;             /* of an answer */
    uint64_t nodes_bytes, prims_bytes; /* of all of them */
    uint32_t voxel_bytes;              /* of a value of a volume */
    uint32_t row, slice;               /* values from a sample's first to the next along y and z */
    uint32_t entry_bytes;              /* of an entry of a table that is looked up */
} bb_footing;

/* Gets the rays of the lanes that run in lockstep, group number i of `width` lanes: those of a
 * work-group follow each other, and its last one may not be whole. Returns their number: 0 beyond
 * the last ray. */
uint32_t bb_footing_lanes(const bb_footing *footing, uint32_t width, uint32_t rays, uint64_t i,
                          uint32_t *first);

bb_footing bb_footing_of(const bb_traverser_request *request, const bb_layout_data *layout);

#endif
