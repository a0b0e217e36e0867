/* What a kernel's steps read and write in a layout. */
#ifndef BB_FOOTING_H
#define BB_FOOTING_H

#include "traversal/traversal.h"

typedef struct bb_footing {
    bb_control control;
    uint32_t ring;         /* entries of a short stack; 0: as many as it takes */
    uint32_t node_bytes;   /* size of a node */
    uint32_t prim_bytes;   /* of a primitive, or of a block of them */
    uint32_t result_bytes; /* of an answer */
} bb_footing;

bb_footing bb_footing_of(const bb_traverser_request *request, const bb_layout_data *layout);

#endif
