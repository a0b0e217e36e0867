/* A binary tree as families, on the device: each inner node with the boxes of both its children
 * (reinsert_shared.h). Subtrees are searched for and moved in this form, which is made from the
 * common tree and converted back (reinsert_families.cl). */
#ifndef BB_FAMILIES_H
#define BB_FAMILIES_H

#include "builders/common/links.h"
#include "framework/builder/tree.h"
#include "framework/device/primitives.h"
#include "reinsert_shared.h"

typedef struct bb_family_tree {
    bb_device *device;
    bb_account *account;
    bb_primitives *primitives;
    bb_links *links; /* GPUs only */
    cl_program program;
    cl_kernel mark, gather, cost;
    cl_kernel top, walk;         /* CPUs only */
    cl_kernel write;             /* GPUs only */
    bb_buffer families;          /* `count` bb_family, and one above the root */
    bb_buffer numbers;           /* u32 per node */
    bb_buffer sums;              /* u64 per BB_COST_CHUNK families */
    bb_buffer tasks, task_range; /* CPUs only */
    uint64_t *sums_here;
    size_t sum_capacity;
    uint32_t count; /* number of inner nodes */
    float unit;     /* scale of lengths for areas: scene_unit.h */
} bb_family_tree;

/* Compiles into a zeroed object. Scratch is booked on `account`. Must be released even if it
 * fails. */
bb_status bb_family_tree_create(bb_device *device, bb_account *account, bb_family_tree *tree);
void bb_family_tree_release(bb_family_tree *tree);

/* Makes the families of a tree on the device. Its inner nodes have two children each, it has at
 * least two leaves, and its info has been fetched. Waits for the device. */
bb_status bb_family_tree_gather(bb_family_tree *tree, const bb_tree *from);

/* Sets *cost to the sum of the half areas of all inner nodes, including the root, in units of
 * length. Waits for the device. */
bb_status bb_family_tree_cost(bb_family_tree *tree, double *cost);

/* Writes the common tree, nodes and d_info, into `to`, which has room. */
bb_status bb_family_tree_write(bb_family_tree *tree, uint32_t ref_count, bb_tree *to);

#endif
