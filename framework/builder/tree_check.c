/* The checker: verifies what "The common tree" in framework/README.md requires. Linear time, except
 * for the two declared properties (duplicated, disjoint), which compare the leaves of one primitive
 * and the children of one node.
 *
 * Links and references are verified by the walk (tree_walk.c), boxes here, coverage by several
 * leaves in tree_cover.c.
 */
#include "framework/builder/tree_cover.h"
#include "framework/builder/tree_walk.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Returns the first axis on which `inner` is not inside of `outer`, 3 if it is inside; comparisons
 * are exact.
 */
static int outside_axis(const float outer_lo[3], const float outer_hi[3], const float inner_lo[3],
                        const float inner_hi[3])
{
    for (int axis = 0; axis < 3; axis++)
        if (!(outer_lo[axis] <= inner_lo[axis] && inner_hi[axis] <= outer_hi[axis]))
            return axis;
    return 3;
}

static bb_status check_box(const bb_tree *tree, uint32_t index)
{
    const bb_node *node = &tree->nodes[index];
    for (int axis = 0; axis < 3; axis++)
        if (!isfinite(node->lo[axis]) || !isfinite(node->hi[axis]) ||
            !(node->lo[axis] <= node->hi[axis]))
            return bb_fail(BB_FAILED, "box of node %u: %.9g to %.9g on axis %c", index,
                           (double)node->lo[axis], (double)node->hi[axis], "xyz"[axis]);
    return BB_OK;
}

static bb_status check_child(const bb_tree *tree, uint32_t parent, uint32_t child)
{
    const bb_node *a = &tree->nodes[parent], *b = &tree->nodes[child];
    int axis = outside_axis(a->lo, a->hi, b->lo, b->hi);
    if (axis == 3)
        return BB_OK;
    return bb_fail(BB_FAILED,
                   "node %u does not contain its child %u: %.9g to %.9g against %.9g to %.9g on "
                   "axis %c",
                   parent, child, (double)a->lo[axis], (double)a->hi[axis], (double)b->lo[axis],
                   (double)b->hi[axis], "xyz"[axis]);
}

/* Checks the references of leaf `index`: in range, counted in uses[], boxes inside of the
 * leaf's. */
static bb_status check_leaf(const bb_tree *tree, const bb_scene *scene, uint32_t index,
                            uint32_t width, uint32_t *uses)
{
    const bb_node *node = &tree->nodes[index];
    const uint32_t *refs = tree->refs + (node->first & BB_INDEX_MASK);
    for (uint32_t i = 0; i < width; i++) {
        uint32_t prim = refs[i] & BB_INDEX_MASK;
        if (prim >= scene->prim_count)
            return bb_fail(BB_FAILED, "leaf %u references primitive %u, there are %u", index, prim,
                           scene->prim_count);
        if (++uses[prim] > 1 && !tree->duplicated)
            return bb_fail(BB_FAILED,
                           "primitive %u is referenced twice, the second time by leaf %u, and the "
                           "tree does not declare duplicated references (bb_tree.duplicated)",
                           prim, index);
        const bb_box *box = &scene->boxes[prim];
        int axis = outside_axis(node->lo, node->hi, box->lo, box->hi);
        if (axis < 3 && !tree->duplicated)
            return bb_fail(BB_FAILED,
                           "leaf %u does not contain its primitive %u: %.9g to %.9g against %.9g "
                           "to %.9g on axis %c, and the tree does not declare duplicated "
                           "references (bb_tree.duplicated)",
                           index, prim, (double)node->lo[axis], (double)node->hi[axis],
                           (double)box->lo[axis], (double)box->hi[axis], "xyz"[axis]);
    }
    return BB_OK;
}

static bb_status check_nodes(const bb_tree *tree, const bb_scene *scene, const bb_walk *walk,
                             uint32_t *uses)
{
    for (uint32_t i = 0; i < walk->info.node_count; i++) {
        uint32_t index = walk->order[i];
        BB_TRY(check_box(tree, index));
        if (i > 0)
            BB_TRY(check_child(tree, walk->order[walk->parent[i]], index));
        if (bb_node_is_leaf(&tree->nodes[index]))
            BB_TRY(check_leaf(tree, scene, index, walk->width[i], uses));
    }
    for (uint32_t prim = 0; prim < scene->prim_count; prim++)
        if (uses[prim] == 0)
            return bb_fail(BB_FAILED, "primitive %u is in no leaf", prim);
    return BB_OK;
}

static bb_status check_info(const bb_tree_info *declared, const bb_tree_info *found)
{
    const struct {
        const char *name;
        uint32_t declared, found;
    } rows[] = {
        {"node_count", declared->node_count, found->node_count},
        {"leaf_count", declared->leaf_count, found->leaf_count},
        {"ref_count", declared->ref_count, found->ref_count},
        {"arity", declared->arity, found->arity},
        {"depth", declared->depth, found->depth},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        if (rows[i].declared != rows[i].found)
            return bb_fail(BB_FAILED, "the tree declares %s %u, it is %u", rows[i].name,
                           rows[i].declared, rows[i].found);
    return BB_OK;
}

/* ---- siblings that share no volume ---- */

static bool share_volume(const bb_node *a, const bb_node *b)
{
    for (int axis = 0; axis < 3; axis++)
        if (!(fmaxf(a->lo[axis], b->lo[axis]) < fminf(a->hi[axis], b->hi[axis])))
            return false;
    return true;
}

typedef struct sibling {
    float lo; /* on the axis of the sweep */
    uint32_t index;
} sibling;

static int compare_siblings(const void *a, const void *b)
{
    const sibling *x = a, *y = b;
    if (x->lo != y->lo)
        return x->lo < y->lo ? -1 : 1;
    return (x->index > y->index) - (x->index < y->index);
}

/* Sweeps the children of one node along the parent's longest axis. */
static bb_status check_siblings(const bb_tree *tree, uint32_t parent, uint32_t width,
                                sibling *siblings)
{
    const bb_node *nodes = tree->nodes, *box = &nodes[parent];
    int axis = 0;
    for (int i = 1; i < 3; i++)
        if ((double)box->hi[i] - box->lo[i] > (double)box->hi[axis] - box->lo[axis])
            axis = i;
    uint32_t child = box->first;
    for (uint32_t i = 0; i < width; i++, child = nodes[child].skip)
        siblings[i] = (sibling){nodes[child].lo[axis], child};
    qsort(siblings, width, sizeof *siblings, compare_siblings);
    for (uint32_t i = 0; i < width; i++)
        for (uint32_t j = i + 1; j < width; j++) {
            const bb_node *a = &nodes[siblings[i].index], *b = &nodes[siblings[j].index];
            if (b->lo[axis] >= a->hi[axis])
                break;
            if (share_volume(a, b))
                return bb_fail(BB_FAILED,
                               "nodes %u and %u, children of %u, share volume, and the tree "
                               "declares disjoint siblings",
                               b < a ? siblings[j].index : siblings[i].index,
                               b < a ? siblings[i].index : siblings[j].index, parent);
        }
    return BB_OK;
}

static bb_status check_disjoint(const bb_tree *tree, const bb_walk *walk)
{
    sibling *siblings = NULL;
    bb_status status =
        bb_host_alloc(NULL, walk->info.arity * sizeof *siblings, "check of the tree", &siblings);
    for (uint32_t i = 0; i < walk->info.node_count && status == BB_OK; i++)
        if (!bb_node_is_leaf(&tree->nodes[walk->order[i]]))
            status = check_siblings(tree, walk->order[i], walk->width[i], siblings);
    bb_host_free(siblings);
    return status;
}

bb_status bb_tree_check(const bb_tree *tree, const bb_scene *scene)
{
    bb_walk walk;
    uint32_t *uses = NULL;
    bb_status status = bb_walk_tree(tree, &walk);
    if (status != BB_OK)
        goto out;
    status = bb_host_alloc(NULL, scene->prim_count * sizeof *uses, "check of the tree", &uses);
    if (status != BB_OK)
        goto out;
    memset(uses, 0, scene->prim_count * sizeof *uses);
    status = check_nodes(tree, scene, &walk, uses);
    if (status == BB_OK)
        status = check_info(&tree->info, &walk.info);
    if (status == BB_OK && tree->duplicated)
        status = bb_tree_check_cover(tree, scene, &walk, uses);
    if (status == BB_OK && tree->disjoint)
        status = check_disjoint(tree, &walk);
out:
    bb_host_free(uses);
    bb_walk_release(&walk);
    return status;
}
