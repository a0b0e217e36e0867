/* Refits a binary tree in parts, and rebuilds parts (parts.h). One work-item handles a part, and
 * none hands over to another, so this works alike on all devices with OpenCL 1.2.
 *
 *   mark the roots of parts: nodes with few nodes below whose parent has many      (parts_mark)
 *   for each part: count its inner nodes; the top's leaves are the parts        (parts_measure)
 *   for each part: list its inner nodes, level by level                            (parts_list)
 *   for each part, then the top:                                                    (parts_fit)
 *       its leaves: union of their primitives' boxes
 *       its inner nodes, backwards through the list: union of their children's boxes
 *   for each part that has become worse:                                        (parts_rebuild)
 *       split its leaves from the top down, by binned SAH
 *       if that lowers the cost: link the inner nodes accordingly, in the existing pairs of places
 *   update the tree's depth                                                       (parts_depth)
 *
 * Limit: one work-item handles the top, which has a leaf for each part.
 */
#include "bb_device.h"
#include "parts_shared.h"
#include "split.clh"

bool is_leaf_node(global const bb_node *nodes, uint n)
{
    return (nodes[n].first & BB_LEAF_BIT) != 0;
}

/* ---- the plan ---- */

/* Counts the nodes below n, including n; returns one more than a part may have if there are
 * more. */
uint nodes_below(global const bb_node *nodes, uint n)
{
    uint end = nodes[n].skip, count = 0;
    for (uint c = n; c != end && count < 2u * BB_PART_LEAVES; count++)
        c = is_leaf_node(nodes, c) ? nodes[c].skip : nodes[c].first;
    return count;
}

bool is_small(global const bb_node *nodes, uint n)
{
    return nodes_below(nodes, n) < 2u * BB_PART_LEAVES;
}

/* `marks` are 0 before. */
kernel void parts_mark(global const bb_node *nodes, uint count, uint root, global uint *marks)
{
    uint n = get_global_id(0);
    if (n >= count)
        return;
    if (is_small(nodes, n)) {
        if (n == root)
            marks[n] = 1u;
        return;
    }
    for (uint c = nodes[n].first; c != nodes[n].skip; c = nodes[c].skip)
        if (is_small(nodes, c))
            marks[c] = 1u;
}

kernel void parts_measure(global const bb_node *nodes, global const uint *roots, uint count,
                          uint tree_root, global bb_part *parts, global uint *part_of)
{
    uint p = get_global_id(0);
    if (p > count)
        return;
    parts[p].root = p == count ? tree_root : roots[p];
    parts[p].inner = p == count ? count - 1u : (nodes_below(nodes, roots[p]) - 1u) / 2u;
    parts[p].rebuilt = 0u;
    if (p < count)
        part_of[roots[p]] = p;
}

/* Returns whether n is a leaf of the part that its parent is in. */
bool is_end(global const bb_node *nodes, global const uint *part_of, uint n)
{
    return is_leaf_node(nodes, n) || part_of[n] != BB_NONE;
}

/* Returns the number of levels below the root of a part whose inner nodes are listed. */
uint height_of(global const bb_node *nodes, global const uint *part_of,
               global const bb_part *parts, global const uint *own, uint inner)
{
    uint height = 0, level = 1, end = BB_MIN(inner, 1u);
    for (uint i = 0; i < end; level++)
        for (uint next = end, last = end; i < last; i++, end = next)
            for (uint c = nodes[own[i]].first, k = 0; k < 2; c = nodes[c].skip, k++) {
                uint part = part_of[c];
                if (!is_end(nodes, part_of, c))
                    next++;
                else
                    height = BB_MAX(height, level + (part == BB_NONE ? 0u : parts[part].height));
            }
    return height;
}

/* `count` includes the top, which is the last. */
kernel void parts_list(global const bb_node *nodes, global const uint *part_of,
                       global bb_part *parts, uint count, global uint *order)
{
    uint p = get_global_id(0);
    if (p >= count)
        return;
    global uint *own = order + parts[p].begin;
    uint inner = parts[p].inner, listed = BB_MIN(inner, 1u);
    if (inner != 0)
        own[0] = parts[p].root;
    for (uint i = 0; i < listed; i++)
        for (uint c = nodes[own[i]].first, k = 0; k < 2; c = nodes[c].skip, k++)
            if (!is_end(nodes, part_of, c))
                own[listed++] = c;
    if (p + 1 < count)
        parts[p].height = height_of(nodes, part_of, parts, own, inner);
}

/* ---- refit ---- */

void fit_leaf(global bb_node *nodes, global const uint *refs, global const bb_box *boxes, uint n)
{
    uint prims;
    bb_store_box(nodes, n, bb_fit_leaf(refs, boxes, nodes[n].first & BB_INDEX_MASK, &prims));
}

/* Computes the boxes of a part's inner nodes from those of its leaves. */
void join_up(global bb_node *nodes, global const uint *own, global bb_part *part)
{
    float cost = 0.0f;
    for (uint i = part->inner; i-- > 0;) {
        uint a = nodes[own[i]].first, b = nodes[a].skip;
        bb_extent box = bb_joined(bb_load_box(nodes, a), bb_load_box(nodes, b));
        bb_store_box(nodes, own[i], box);
        cost += bb_extent_area(box);
    }
    part->cost = cost;
    part->area = bb_extent_area(bb_load_box(nodes, part->root));
}

/* Handles parts `from` to before `to`. The last of `count` is the top, whose leaves must be
 * finished. */
kernel void parts_fit(global bb_node *nodes, global const uint *refs, global const bb_box *boxes,
                      global bb_part *parts, uint from, uint to, uint count,
                      global const uint *order)
{
    uint p = from + get_global_id(0);
    if (p >= to)
        return;
    global const uint *own = order + parts[p].begin;
    if (p + 1 < count) {
        if (parts[p].inner == 0)
            fit_leaf(nodes, refs, boxes, parts[p].root);
        for (uint i = 0; i < parts[p].inner; i++) {
            uint a = nodes[own[i]].first, b = nodes[a].skip;
            if (is_leaf_node(nodes, a))
                fit_leaf(nodes, refs, boxes, a);
            if (is_leaf_node(nodes, b))
                fit_leaf(nodes, refs, boxes, b);
        }
    }
    join_up(nodes, own, parts + p);
}

/* ---- rebuild ---- */

/* The data of a rebuild: the tree, and a part's slices of the scratch. */
typedef struct part_job {
    global bb_node *nodes;
    global uint *part_of;
    global bb_part *parts;
    global uint *order;
    uint p, inner;
    global uint *own;
    global bb_node *leaves; /* copies; `skip` is the part whose root the leaf is, or BB_NONE */
    global uint4 *ranges;   /* per inner node: its leaves' begin and end, and their division */
    global uint2 *pairs;    /* per inner node: places for two children */
} part_job;

void take_apart(const part_job *job)
{
    uint count = 0;
    for (uint i = 0; i < job->inner; i++) {
        uint a = job->nodes[job->own[i]].first, b = job->nodes[a].skip;
        job->pairs[i] = (uint2)(a, b);
        for (uint c = a, k = 0; k < 2; c = b, k++)
            if (is_end(job->nodes, job->part_of, c)) {
                job->leaves[count] = job->nodes[c];
                job->leaves[count++].skip = job->part_of[c];
            }
    }
}

/* Divides all ranges; returns what the inner nodes would cost. */
float divide(const part_job *job)
{
    uint listed = 1;
    float cost = 0.0f, area;
    job->ranges[0] = (uint4)(0u, job->inner + 1u, 0u, 0u);
    for (uint i = 0; i < job->inner; i++) {
        uint begin = job->ranges[i].x, end = job->ranges[i].y;
        uint mid = bb_split(job->leaves, begin, end, &area);
        job->ranges[i].z = mid;
        cost += area;
        if (mid - begin > 1)
            job->ranges[listed++] = (uint4)(begin, mid, 0u, 0u);
        if (end - mid > 1)
            job->ranges[listed++] = (uint4)(mid, end, 0u, 0u);
    }
    return cost;
}

/* Updates everything that refers to a part's root, which has moved to n, and the skips of the last
 * nodes below it. */
void move_part(const part_job *job, uint part, uint n)
{
    job->parts[part].root = n;
    if (job->parts[part].inner != 0)
        job->order[job->parts[part].begin] = n;
    for (uint skip = job->nodes[n].skip; !is_leaf_node(job->nodes, n);) {
        n = job->nodes[job->nodes[n].first].skip;
        job->nodes[n].skip = skip;
    }
}

/* Puts leaves begin .. end at or below place n, whose skip is final. */
void put_range(const part_job *job, uint n, uint begin, uint end, uint *listed)
{
    job->part_of[n] = BB_NONE;
    if (end - begin > 1) {
        job->own[(*listed)++] = n;
        return;
    }
    uint part = job->leaves[begin].skip;
    bb_store_box(job->nodes, n, bb_load_box(job->leaves, begin));
    job->nodes[n].first = job->leaves[begin].first;
    job->part_of[n] = part;
    if (part != BB_NONE)
        move_part(job, part, n);
}

/* Links the inner nodes as the ranges say. */
void put_together(const part_job *job)
{
    uint listed = 1;
    for (uint i = 0; i < job->inner; i++) {
        uint n = job->own[i], a = job->pairs[i].x, b = job->pairs[i].y;
        uint4 range = job->ranges[i];
        job->nodes[n].first = a;
        job->nodes[a].skip = b;
        job->nodes[b].skip = job->nodes[n].skip;
        put_range(job, a, range.x, range.z, &listed);
        put_range(job, b, range.z, range.y, &listed);
    }
}

/* Rebuilds the parts chosen[from] to chosen[to - 1]. */
kernel void parts_rebuild(global bb_node *nodes, global uint *part_of, global bb_part *parts,
                          global const uint *chosen, uint from, uint to, global uint *order,
                          global bb_node *leaves, global uint4 *ranges, global uint2 *pairs)
{
    uint i = from + get_global_id(0);
    if (i >= to)
        return;
    uint p = chosen[i], begin = parts[p].begin;
    /* each earlier part has one leaf more than inner nodes */
    const part_job job = {nodes,          part_of,       parts,
                          order,          p,             parts[p].inner,
                          order + begin,  leaves + begin + p,
                          ranges + begin, pairs + begin};
    take_apart(&job);
    parts[p].rebuilt = divide(&job) < parts[p].cost ? 1u : 0u;
    if (parts[p].rebuilt == 0u)
        return;
    put_together(&job);
    join_up(nodes, job.own, parts + p);
    parts[p].height = height_of(nodes, part_of, parts, job.own, job.inner);
}

/* Computes the depth of the whole tree from its top, parts[top]. */
kernel void parts_depth(global const bb_node *nodes, global const uint *part_of,
                        global bb_part *parts, uint top, global const uint *order,
                        global bb_tree_info *info)
{
    if (get_global_id(0) != 0)
        return;
    global const uint *own = order + parts[top].begin;
    info->depth = parts[top].inner == 0
                      ? parts[0].height
                      : height_of(nodes, part_of, parts, own, parts[top].inner);
}
