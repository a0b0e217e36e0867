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
    g->count = scene->object_count;
    g->starts = scene->object_starts;
    for (uint32_t o = 0; o < g->count; o++)
        largest = size_of(g, o) > largest ? size_of(g, o) : largest;
    if (g->count > g->capacity) {
        g->capacity = 0;
        BB_TRY(bb_host_alloc(account, count * sizeof *g->boxes, what, &g->boxes));
        BB_TRY(bb_host_alloc(account, (count + 1) * sizeof *g->first, what, &g->first));
        BB_TRY(bb_host_alloc(account, count * sizeof *g->heights, what, &g->heights));
        g->capacity = g->count;
    }
    if (largest > g->one.capacity)
        BB_TRY(
            bb_host_alloc(account, (2 * (size_t)largest - 1) * sizeof *g->nodes, what, &g->nodes));
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
    memcpy(g->boxes[object].lo, g->nodes[0].lo, sizeof g->nodes[0].lo);
    memcpy(g->boxes[object].hi, g->nodes[0].hi, sizeof g->nodes[0].hi);
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

/* The union of the nodes from `n` on, up to the one that is followed by `skip`. */
static bb_gs_box unite_siblings(const bb_tree *out, uint32_t n, uint32_t skip)
{
    bb_gs_box all = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    for (; n != skip; n = out->nodes[n].skip) {
        bb_gs_box one;
        memcpy(one.lo, out->nodes[n].lo, sizeof one.lo);
        memcpy(one.hi, out->nodes[n].hi, sizeof one.hi);
        all = bb_gs_unite(&all, &one);
    }
    return all;
}

void bb_gs_groups_refit(bb_gs_groups *g, uint32_t object, const bb_scene *scene, uint32_t skip,
                        bb_tree *out)
{
    const uint32_t first = g->first[object], end = g->first[object + 1];
    if (!bb_gs_is_group(g, object)) {
        g->boxes[object] = scene->boxes[g->starts[object]];
        return;
    }
    for (uint32_t n = end; n-- > first;) {
        bb_node *node = &out->nodes[n];
        const bb_gs_box box = (node->first & BB_LEAF_BIT) != 0
                                  ? bb_gs_box_of(&scene->boxes[node->first & BB_INDEX_MASK])
                                  : unite_siblings(out, node->first, node->skip);
        memcpy(node->lo, box.lo, sizeof node->lo);
        memcpy(node->hi, box.hi, sizeof node->hi);
    }
    const bb_gs_box box = unite_siblings(out, first, skip);
    memcpy(g->boxes[object].lo, box.lo, sizeof box.lo);
    memcpy(g->boxes[object].hi, box.hi, sizeof box.hi);
}
