/* Refits a binary tree in parts, and rebuilds parts that have become worse (parts.cl).
 *
 * A part is the subtree of a node that has at most BB_PART_LEAVES leaves and whose parent has more.
 * The nodes above all parts form one more part, the top, whose leaves are the parts. A part keeps
 * its primitives and its places in memory: a rebuild links its inner nodes anew. This repairs
 * motion within a part, and of parts past each other, but not primitives that have left their part:
 * its boxes remain large.
 *
 * A part is rebuilt if its share of the tree's SAH, the sum of its inner nodes' areas over the
 * root's area, is more than `factor` times the share after its last build, and if the rebuild
 * lowers that sum. If it does not, the part is tried again once the share has risen by the same
 * factor again. The host selects parts, in double, so that all devices make the same tree.
 */
#ifndef BB_PARTS_H
#define BB_PARTS_H

#include "builders/common/compact.h"
#include "framework/builder/tree.h"
#include "framework/device/device.h"
#include "parts_shared.h"

typedef struct bb_parts {
    bb_device *device;
    bb_account *account;
    double factor;
    cl_program program;
    cl_kernel mark, measure, list, fit, rebuild, depth;
    bb_primitives *primitives;
    bb_compaction *compaction;
    bb_buffer marks, roots, root_count; /* for the plan: u32 per node */
    bb_buffer part_of;                  /* per node: the part whose root it is, or BB_NONE */
    bb_buffer parts_there;              /* bb_part, the top last */
    bb_buffer order;                    /* u32 per inner node: by part, parents before children */
    bb_buffer leaves, ranges, pairs;    /* for rebuilds */
    bb_buffer chosen;                   /* u32: parts to be rebuilt */
    uint32_t count;                     /* number of parts, without the top */
    uint32_t capacity;                  /* of the following arrays, on the host */
    bb_part *parts;
    double *built;    /* the part's share after its last build */
    uint32_t *choice; /* the same as `chosen` */
} bb_parts;

/* Compiles into a zeroed object with device, account and factor set. Scratch is booked on the
 * account. Must be released even if it fails. */
bb_status bb_parts_create(bb_parts *parts);
void bb_parts_release(bb_parts *parts);

/* Cuts a binary tree on the device, whose info has been fetched, into parts, and measures them with
 * `boxes` (bb_box). Waits for the device. */
bb_status bb_parts_plan(bb_parts *parts, const bb_buffer *boxes, bb_tree *tree);

/* Computes new boxes for the planned tree, and links the parts that are rebuilt; *rebuilt: their
 * number. Declares which parts of the tree have changed. Waits for the device. */
bb_status bb_parts_update(bb_parts *parts, const bb_buffer *boxes, bb_tree *tree,
                          uint32_t *rebuilt);

#endif
