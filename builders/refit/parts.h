/* Refit of a binary tree in parts, and rebuild of those that have become worse (parts.cl).
 *
 * A part is a node that has at most BB_PART_LEAVES leaves below it, and whose parent has more; what
 * is above all parts, with them as its leaves, is one more part, the top. A part keeps its
 * primitives and its places in memory: a rebuild links its inner nodes anew. So it mends what moves
 * within a part, and parts that pass each other; not a primitive that has left its part, whose
 * boxes remain large.
 *
 * A part is rebuilt if its share of the tree's SAH, the sum of its inner nodes' areas over the
 * root's area, is more than `factor` times that after its last build, and if that makes the sum
 * smaller; if it does not, it is tried again when the share has risen by as much once more. Which
 * parts are is decided on the host, in double, so that all devices make the same tree.
 */
#ifndef BB_PARTS_H
#define BB_PARTS_H

#include "builders/common/compact.h"
#include "framework/device/device.h"
#include "framework/tree/tree.h"
#include "parts_shared.h"

typedef struct bb_parts {
    bb_device *device;
    bb_account *account;
    double factor;
    cl_program program;
    cl_kernel mark, measure, list, fit, rebuild, depth;
    bb_primitives *primitives;
    bb_compaction *compaction;
    bb_buffer marks, roots, root_count; /* of the plan: u32 per node */
    bb_buffer part_of;                  /* per node: the part that it is the root of, or BB_NONE */
    bb_buffer parts_there;              /* bb_part, the top last */
    bb_buffer order;                    /* u32 per inner node: by parts, parents before children */
    bb_buffer leaves, ranges, pairs;    /* of rebuilds */
    bb_buffer chosen;                   /* u32: parts to be rebuilt */
    uint32_t count;                     /* of parts, without the top */
    uint32_t capacity;                  /* of the following, on the host */
    bb_part *parts;
    double *built;    /* the share that a part had after its last build */
    uint32_t *choice; /* as `chosen` */
} bb_parts;

/* Compiles into a zeroed object, in which device, account and factor are set. Scratch is booked on
 * the account. To be released also if it fails. */
bb_status bb_parts_create(bb_parts *parts);
void bb_parts_release(bb_parts *parts);

/* Cuts a binary tree on the device, whose info is fetched, into parts, and measures them with
 * `boxes` (bb_box). Waits for the device. */
bb_status bb_parts_plan(bb_parts *parts, const bb_buffer *boxes, bb_tree *tree);

/* New boxes for the tree that was planned, and new links for parts that are rebuilt, of which
 * `rebuilt` gets the number. The tree is declared changed, as far as it is. Waits for the
 * device. */
bb_status bb_parts_update(bb_parts *parts, const bb_buffer *boxes, bb_tree *tree,
                          uint32_t *rebuilt);

#endif
