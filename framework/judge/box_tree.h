/* The arbiter's own hierarchy over the primitives' boxes, on the host: binary, built once,
 * traversed conservatively in doubles. It shares nothing with the builders under test. */
#ifndef BB_BOX_TREE_H
#define BB_BOX_TREE_H

#include "framework/base/status.h"
#include "kernels/bb_shared.h"

#include <stdbool.h>
#include <stdint.h>

typedef struct bb_box_tree bb_box_tree;

typedef struct bb_box_node {
    float lo[3];
    uint32_t first; /* of the two adjacent children, or of the references */
    float hi[3];
    uint32_t count; /* references; 0 for an inner node */
} bb_box_node;

bb_status bb_box_tree_create(const bb_box *boxes, uint32_t count, bb_box_tree **out);
void bb_box_tree_destroy(bb_box_tree *tree); /* NULL is allowed */

/* Node 0 is the root; references are primitives. Both arrays belong to the tree. */
const bb_box_node *bb_box_tree_nodes(const bb_box_tree *tree, uint32_t *count);
const uint32_t *bb_box_tree_refs(const bb_box_tree *tree);

/* A ray for box tests. bb_probe_make() fills the fields after `grow`. */
typedef struct bb_probe {
    double o[3], d[3];
    double tmin, tmax;
    double grow; /* boxes are grown by at least this, in scene units */
    double inverse[3];
    double length; /* of d */
} bb_probe;

void bb_probe_make(const bb_ray *ray, bb_probe *probe);

/* Calls visit(context, primitive) for every primitive whose box the ray meets, and for some others.
 * The box, and the interval [tmin, tmax], are grown by the larger of probe->grow and eps = 16 *
 * 2^-24 * max |v - o| over the box's coordinates. Ends when visit() returns true. */
void bb_box_tree_visit(const bb_box_tree *tree, const bb_probe *probe,
                       bool (*visit)(void *context, uint32_t prim), void *context);

#endif
