/* Linking: makes the binary radix tree over sorted keys, with boxes, in the common format. All
 * Morton-based builders share it.
 *
 * Leaf i of the tree is the i-th key; the index breaks ties between equal keys. Keys are bit
 * strings of one length (Morton codes), or nodes of a binary tree, which may be below one another
 * (those of a loose octree); radix_tree.cl says how nodes are encoded. A leaf has one reference, or
 * a run of them. Both ways of linking give the same tree with the same node indices: the root is
 * node 0, and the children below the split between keys s and s + 1 are nodes 2s + 1 and 2s + 2.
 * With that numbering first and skip follow from a node's range alone, in the same pass as its box.
 */
#ifndef BB_RADIX_TREE_H
#define BB_RADIX_TREE_H

#include "framework/builder/tree.h"
#include "framework/device/device.h"

#pragma GCC visibility push(default) /* what a plug-in may call */
#ifdef __cplusplus
extern "C" {
#endif

typedef struct bb_radix_tree bb_radix_tree;

typedef enum bb_linking {
    BB_LINK_APETREI, /* bottom-up, boxes in the same pass (Apetrei 2014) */
    BB_LINK_KARRAS,  /* all inner nodes at once, then boxes bottom-up (Karras 2012) */
} bb_linking;

typedef struct bb_radix_kind {
    uint32_t key_bytes; /* 4 or 8: keys are u32 or u64 */
    bb_linking linking;
    bool nodes; /* keys are nodes of a binary tree */
    bool runs;  /* leaves are runs of references, see bb_radix_runs */
} bb_radix_kind;

/* Runs of equal keys as leaves: key i stands for the references starts[i] .. starts[i + 1] - 1. */
typedef struct bb_radix_runs {
    bb_buffer starts; /* u32, one more than there are keys; the last is the number of references */
    bb_buffer total;  /* u32: the number of keys */
} bb_radix_runs;

/* Scratch is booked on `account`. */
bb_status bb_radix_tree_create(bb_device *device, bb_account *account, bb_radix_kind kind,
                               bb_radix_tree **out);
void bb_radix_tree_destroy(bb_radix_tree *radix); /* NULL is allowed */

/* Reserves scratch for up to `count` references, and room in `tree` (on the device). */
bb_status bb_radix_tree_reserve(bb_radix_tree *radix, uint32_t count, bb_tree *tree);

/* Links sorted keys over `count` >= 1 references; values[] are their primitives, boxes[] the
 * primitives' boxes (bb_box). `runs` is given if kind.runs; if NULL, each reference has a key of
 * its own. Fills tree, d_info included. Enqueued, not waited for. */
bb_status bb_radix_tree_link(bb_radix_tree *radix, const bb_buffer *keys, const bb_radix_runs *runs,
                             const bb_buffer *values, const bb_buffer *boxes, uint32_t count,
                             bb_tree *tree);

/* The longest loop of a work-item in the last link if work-groups have no fence: *met leaves or
 * subtrees that it took one after the other, of at most *most for keys of this size. 0 if there was
 * a fence, or leaves are runs. Waits. */
bb_status bb_radix_tree_longest(const bb_radix_tree *radix, uint32_t *met, uint32_t *most);

/* Height of each node of the last tree linked, a u8: edges to the deepest leaf below it. The root's
 * is not written; it is the tree's depth. */
const bb_buffer *bb_radix_tree_heights(const bb_radix_tree *radix);

#ifdef __cplusplus
}
#endif
#pragma GCC visibility pop

#endif
