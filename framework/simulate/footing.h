/* What a kernel's steps read and write: of a layout, and of a volume. */
#ifndef BB_FOOTING_H
#define BB_FOOTING_H

#include "traversal/traversal.h"

/* A tree in arrays, whose boxes are apart from what nodes have, and whose leaves list primitives
 * that are tetrahedra of the scene (kernels/olbvh.clh). A node reads where its children begin and
 * end, or what it lists does: two words that follow each other; a box its corners, or its flags
 * alone; a primitive its place in the list, four numbers of vertices, and these. */
typedef struct bb_footing_lists {
    const uint32_t *tets;    /* at each place of the list; BB_NONE: no tetrahedron. NULL: no such
                              * tree */
    const uint32_t *corners; /* of each tetrahedron, four vertices */
    /* where arrays begin, in bytes: behind what nodes have, and behind the list */
    uint64_t boxes_at, flags_at, corners_at, vertices_at;
} bb_footing_lists;

typedef struct bb_footing {
    bb_control control;
    uint32_t group;                    /* rays of a work-group, at least 1 */
    uint32_t packet;                   /* rays of a packet, a divisor of the width; 1: no packets */
    uint32_t ring;                     /* entries of a short stack; 0: as many as it takes */
    bool in_region;                    /* the first search is for what meets a region */
    bool is_link;                      /* an entry is a link, one word; or else two words */
    uint32_t node_bytes;               /* size of a node */
    uint32_t prim_bytes;               /* of a primitive, or of a block of them */
    uint32_t item_bytes;               /* of a ray, or whatever an answer is asked for */
    uint32_t result_bytes;             /* of an answer */
    uint64_t nodes_bytes, prims_bytes; /* of all of them */
    uint32_t voxel_bytes;              /* of a value of a volume */
    uint32_t row, slice;               /* values from a sample's first to the next along y and z */
    uint32_t entry_bytes;              /* of an entry of a table that is looked up */
    bb_footing_lists lists;            /* in place of sizes of nodes and primitives */
} bb_footing;

/* Gets the rays of the lanes that run in lockstep, group number i of `width` lanes: those of a
 * work-group follow each other, and its last one may not be whole. Returns their number: 0 beyond
 * the last ray. */
uint32_t bb_footing_lanes(const bb_footing *footing, uint32_t width, uint32_t rays, uint64_t i,
                          uint32_t *first);

bb_footing bb_footing_of(const bb_traverser_request *request, const bb_layout_data *layout);

#endif
