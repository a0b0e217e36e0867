/* Objects that are collections of primitives, each with a tree of its own: Eisemann, Grosch,
 * Mueller, Magnor 2007, section 3.1 and figure 1.
 *
 * In the common tree come first the nodes below the objects' roots, an object's in preorder after
 * the other's, then the nodes of the tree over objects, whose leaves are these roots. An object's
 * nodes stay where they are; when its primitives move, their boxes are made anew, children before
 * parents. (The paper transforms rays into an object's own coordinates instead; kernels here know
 * one system of coordinates.)
 */
#include "gs.h"

#include <math.h>
#include <string.h>

static uint32_t size_of(const bb_gs_groups *g, uint32_t object)
{
    return g->starts[object + 1] - g->starts[object];
}

void bb_gs_groups_release(bb_gs_groups *g)
{
    bb_gs_release(&g->one);
    bb_host_free(g->nodes);
    bb_host_free(g->boxes);
    bb_host_free(g->first);
    bb_host_free(g->heights);
}

bb_status bb_gs_groups_reserve(bb_gs_groups *g, bb_account *account, const bb_scene *scene)
{
    const char *what = "gs: collections";
    const size_t count = scene->object_count;
    uint32_t largest = 1;
    if (g->boxes != NULL && g->count == scene->object_count && g->starts == scene->object_starts)
        return BB_OK; /* as before */
    g->count = scene->object_count;
    g->starts = scene->object_starts;
    for (uint32_t o = 0; o < g->count; o++)
        largest = size_of(g, o) > largest ? size_of(g, o) : largest;
    BB_TRY(bb_host_alloc(account, count * sizeof *g->boxes, what, &g->boxes));
    BB_TRY(bb_host_alloc(account, (count + 1) * sizeof *g->first, what, &g->first));
    BB_TRY(bb_host_alloc(account, count * sizeof *g->heights, what, &g->heights));
    BB_TRY(bb_host_alloc(account, (2 * (size_t)largest - 1) * sizeof *g->nodes, what, &g->nodes));
    return bb_gs_reserve(&g->one, account, largest);
}

/* ---- building ---- */

/* Moves the nodes of the tree that was made alone, but for its root, to the object's place. */
static void place(const bb_gs_groups *g, uint32_t object, uint32_t count, bb_tree *out)
{
    const uint32_t to = g->first[object];
    for (uint32_t i = 1; i < count; i++) {
        bb_node *node = &out->nodes[to + i - 1];
        *node = g->nodes[i];
        node->first = (node->first & BB_LEAF_BIT) != 0
                          ? BB_LEAF_BIT | (g->starts[object] + (node->first & BB_INDEX_MASK))
                          : to + node->first - 1;
        node->skip = node->skip != BB_NONE ? to + node->skip - 1 : BB_NONE;
    }
}

static void make_one(bb_gs_groups *g, uint32_t object, const bb_scene *scene, bb_tree *out)
{
    const uint32_t first = g->starts[object], members = size_of(g, object);
    bb_tree alone = {.nodes = g->nodes};
    bb_gs_clear(&g->one, members);
    for (uint32_t i = 0; i < members; i++)
        g->one.scratch[i] = i;
    bb_gs_put_in_order(&g->one, g->order, members, g->seed, object);
    for (uint32_t i = 0; i < members; i++) {
        const uint32_t member = g->one.scratch[i];
        const bb_gs_box box = bb_gs_box_of(&scene->boxes[first + member]);
        bb_gs_add(&g->one, member, &box);
    }
    bb_gs_emit(&g->one, true, &alone);
    g->heights[object] = alone.info.depth;
    g->arity = alone.info.arity > g->arity ? alone.info.arity : g->arity;
    g->first[object + 1] = g->first[object] + alone.info.node_count - 1;
    place(g, object, alone.info.node_count, out);
}

void bb_gs_groups_make(bb_gs_groups *g, const bb_scene *scene, bb_tree *out)
{
    g->first[0] = g->arity = 0;
    for (uint32_t o = 0; o < g->count; o++)
        make_one(g, o, scene, out);
}

/* ---- in the common tree ---- */

bool bb_gs_is_group(const bb_gs_groups *g, uint32_t object)
{
    return g->first[object + 1] > g->first[object];
}

void bb_gs_groups_end(const bb_gs_groups *g, uint32_t object, uint32_t skip, bb_tree *out)
{
    const uint32_t first = g->first[object], end = g->first[object + 1];
    uint32_t n = first;
    for (;;) {
        while (out->nodes[n].skip >= first && out->nodes[n].skip < end)
            n = out->nodes[n].skip;
        out->nodes[n].skip = skip;
        if ((out->nodes[n].first & BB_LEAF_BIT) != 0)
            return;
        n = out->nodes[n].first;
    }
}

/* ---- moving ---- */

static void join(const float lo[3], const float hi[3], float to_lo[3], float to_hi[3])
{
    for (int k = 0; k < 3; k++) {
        to_lo[k] = lo[k] < to_lo[k] ? lo[k] : to_lo[k];
        to_hi[k] = hi[k] > to_hi[k] ? hi[k] : to_hi[k];
    }
}

/* The union of the nodes from `n` on, up to the one that is followed by `skip`. */
static void join_siblings(const bb_tree *out, uint32_t n, uint32_t skip, float lo[3], float hi[3])
{
    for (int k = 0; k < 3; k++) {
        lo[k] = INFINITY;
        hi[k] = -INFINITY;
    }
    for (; n != skip; n = out->nodes[n].skip)
        join(out->nodes[n].lo, out->nodes[n].hi, lo, hi);
}

void bb_gs_groups_refit(bb_gs_groups *g, uint32_t object, const bb_scene *scene, uint32_t skip,
                        bb_tree *out)
{
    const uint32_t first = g->first[object], end = g->first[object + 1];
    bb_box *box = &g->boxes[object];
    if (!bb_gs_is_group(g, object)) {
        *box = scene->boxes[g->starts[object]];
        return;
    }
    for (uint32_t n = end; n-- > first;) {
        bb_node *node = &out->nodes[n];
        if ((node->first & BB_LEAF_BIT) == 0) {
            join_siblings(out, node->first, node->skip, node->lo, node->hi);
            continue;
        }
        memcpy(node->lo, scene->boxes[node->first & BB_INDEX_MASK].lo, sizeof node->lo);
        memcpy(node->hi, scene->boxes[node->first & BB_INDEX_MASK].hi, sizeof node->hi);
    }
    join_siblings(out, first, skip, box->lo, box->hi);
}
