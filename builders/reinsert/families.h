/* A binary tree as families, on the device: each inner node with the boxes of both its children, in
 * which subtrees are searched for and moved (reinsert_shared.h), made from the common tree and made
 * one again (reinsert_families.cl). */
#ifndef BB_FAMILIES_H
#define BB_FAMILIES_H

#include "builders/common/links.h"
#include "framework/device/primitives.h"
#include "framework/tree/tree.h"
#include "reinsert_shared.h"

typedef struct bb_family_tree {
    bb_device *device;
    bb_account *account;
    bb_primitives *primitives;
    bb_links *links; /* GPUs */
    cl_program program;
    cl_kernel mark, gather, cost;
    cl_kernel top, walk;         /* CPUs */
    cl_kernel write;             /* GPUs */
    bb_buffer families;          /* bb_family: `count` of them, and what is above the root */
    bb_buffer numbers;           /* u32 per node */
    bb_buffer sums;              /* u64 per BB_COST_CHUNK families */
    bb_buffer tasks, task_range; /* CPUs */
    uint64_t *sums_here;
    size_t sum_capacity;
    uint32_t count; /* inner nodes */
    float unit;     /* of length, for areas: scene_unit.h */
} bb_family_tree;

/* Compiles into a zeroed object. Scratch is booked on `account`. To be released also if it
 * fails. */
bb_status bb_family_tree_create(bb_device *device, bb_account *account, bb_family_tree *tree);
void bb_family_tree_release(bb_family_tree *tree);

/* Families of a tree on the device, of two children per inner node and at least two leaves, whose
 * info is fetched. Waits for the device. */
bb_status bb_family_tree_gather(bb_family_tree *tree, const bb_tree *from);

/* Sum of the half areas of all inner nodes, the root's included, in units of length. Waits for the
 * device. */
bb_status bb_family_tree_cost(bb_family_tree *tree, double *cost);

/* The common tree again, into `to`, which has room: nodes, and d_info. */
bb_status bb_family_tree_write(bb_family_tree *tree, uint32_t ref_count, bb_tree *to);

#endif
