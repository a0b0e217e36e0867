/* Leaf collapse by SAH, one pass for all builders.
 *
 *   bottom-up: a leaf costs Ci |refs| A; an inner node Ct children/2 A plus what its children cost
 *              if its subtree has at most max_leaf references and a leaf of them costs no more:
 * collapse top-down:  emit in preorder; the topmost collapsed node of a path becomes the leaf
 *
 * A subtree is contiguous in preorder, so the references of a collapsed node are those of the
 * leaves up to its end.
 */
#include "framework/tree_walk.h"

#include <assert.h>
#include <string.h>

typedef struct collapse {
    const bb_tree *tree;
    uint32_t max_leaf;
    bb_walk walk;
    uint32_t *end;   /* position after the subtree */
    uint32_t *refs;  /* references in the subtree, at most UINT32_MAX */
    double *cost;    /* of the subtree, times area */
    bool *leaf;      /* is a leaf in the result, or inside of one */
    uint32_t *place; /* node of the result that the position became */
    uint32_t *stamp; /* last leaf of the result that referenced the primitive, plus 1; NULL without
                        duplicates */
} collapse;

static bb_status allocate(collapse *c)
{
    const char *what = "leaf collapse";
    size_t count = c->walk.info.node_count;
    BB_TRY(bb_host_alloc(NULL, count * sizeof *c->end, what, &c->end));
    BB_TRY(bb_host_alloc(NULL, count * sizeof *c->refs, what, &c->refs));
    BB_TRY(bb_host_alloc(NULL, count * sizeof *c->cost, what, &c->cost));
    BB_TRY(bb_host_alloc(NULL, count * sizeof *c->leaf, what, &c->leaf));
    BB_TRY(bb_host_alloc(NULL, count * sizeof *c->place, what, &c->place));
    if (!c->tree->duplicated)
        return BB_OK;
    /* Every primitive is referenced, so there are no more of them than references. */
    size_t prims = c->tree->info.ref_count;
    for (uint32_t i = 0; i < prims; i++)
        if ((c->tree->refs[i] & BB_INDEX_MASK) >= prims)
            return bb_fail(BB_FAILED,
                           "reference %u is to primitive %u, but there are %zu references", i,
                           c->tree->refs[i] & BB_INDEX_MASK, prims);
    BB_TRY(bb_host_alloc(NULL, prims * sizeof *c->stamp, what, &c->stamp));
    memset(c->stamp, 0, prims * sizeof *c->stamp);
    return BB_OK;
}

static void release(collapse *c)
{
    bb_walk_release(&c->walk);
    bb_host_free(c->end);
    bb_host_free(c->refs);
    bb_host_free(c->cost);
    bb_host_free(c->leaf);
    bb_host_free(c->place);
    bb_host_free(c->stamp);
}

/* Bottom-up: what each subtree costs at best. */
static void decide(collapse *c)
{
    uint32_t count = c->walk.info.node_count;
    memset(c->refs, 0, count * sizeof *c->refs);
    memset(c->cost, 0, count * sizeof *c->cost);
    for (uint32_t i = count; i-- > 0;) {
        const bb_node *node = &c->tree->nodes[c->walk.order[i]];
        double area = bb_half_area(node->lo, node->hi);
        c->leaf[i] = bb_node_is_leaf(node);
        c->refs[i] += c->leaf[i] ? c->walk.width[i] : 0;
        c->cost[i] += area * bb_node_cost(node, c->walk.width[i]);
        double as_leaf = area * BB_COST_INTERSECTION * c->refs[i];
        if (!c->leaf[i] && c->refs[i] <= c->max_leaf && c->max_leaf > 1 && as_leaf <= c->cost[i]) {
            c->leaf[i] = true;
            c->cost[i] = as_leaf;
        }
        if (i > 0) {
            c->refs[c->walk.parent[i]] += c->refs[i];
            c->cost[c->walk.parent[i]] += c->cost[i];
        }
    }
}

/* Appends the references of the positions from `begin` to `end` as those of leaf `leaf`; returns
 * the new count. */
static uint32_t emit_refs(const collapse *c, uint32_t begin, uint32_t end, uint32_t leaf,
                          uint32_t *refs, uint32_t count)
{
    for (uint32_t i = begin; i < end; i++) {
        const bb_node *node = &c->tree->nodes[c->walk.order[i]];
        if (!bb_node_is_leaf(node))
            continue;
        const uint32_t *from = c->tree->refs + (node->first & BB_INDEX_MASK);
        for (uint32_t k = 0; k < c->walk.width[i]; k++) {
            uint32_t prim = from[k] & BB_INDEX_MASK;
            if (c->stamp != NULL) {
                if (c->stamp[prim] == leaf + 1)
                    continue;
                c->stamp[prim] = leaf + 1;
            }
            refs[count++] = prim;
        }
    }
    refs[count - 1] |= BB_LAST_BIT;
    return count;
}

static void emit(const collapse *c, bb_tree *out)
{
    uint32_t count = c->walk.info.node_count, nodes = 0, refs = 0, leaves = 0;
    for (uint32_t i = 0; i < count;) {
        bb_node node = c->tree->nodes[c->walk.order[i]];
        c->place[i] = nodes;
        node.skip = c->end[i];
        if (c->leaf[i]) {
            node.first = BB_LEAF_BIT | refs;
            refs = emit_refs(c, i, c->end[i], nodes, out->refs, refs);
            leaves++;
        } else {
            node.first = nodes + 1;
        }
        out->nodes[nodes++] = node;
        i = c->leaf[i] ? c->end[i] : i + 1;
    }
    /* The node after a subtree has a place: what is above it is above the subtree too, and was not
     * collapsed. */
    for (uint32_t i = 0; i < nodes; i++) {
        uint32_t skip = out->nodes[i].skip;
        out->nodes[i].skip = skip < count ? c->place[skip] : BB_NONE;
    }
    out->info = (bb_tree_info){.node_count = nodes, .leaf_count = leaves, .ref_count = refs};
}

bb_status bb_tree_collapse(const bb_tree *tree, uint32_t max_leaf, bb_tree *out)
{
    assert(out != tree);
    collapse c = {.tree = tree, .max_leaf = max_leaf};
    bb_walk result = {0};
    bb_status status = bb_walk_tree(tree, &c.walk);
    if (status == BB_OK)
        status = allocate(&c);
    if (status == BB_OK)
        status =
            bb_tree_reserve(out, NULL, BB_ON_HOST, c.walk.info.node_count, c.walk.info.ref_count);
    if (status == BB_OK) {
        bb_walk_ends(&c.walk, c.end);
        decide(&c);
        emit(&c, out);
        out->duplicated = tree->duplicated;
        out->disjoint = tree->disjoint;
        status = bb_walk_tree(out, &result);
    }
    if (status == BB_OK)
        out->info = result.info; /* arity and depth changed too */
    bb_walk_release(&result);
    release(&c);
    return status;
}
