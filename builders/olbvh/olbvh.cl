/* The OLBVH's own phases (olbvh.c).
 */
#include "bb_device.h"
#include "cell_grid.clh"
#include "morton.clh"
#include "tet_shared.h"

/* ---- how deep: equations 11 and 12 ---- */

/* Sums floor(log2(longest side)) of the boxes over chunks, in cells of the finest grid, which
 * `grid` is. */
kernel void olbvh_sizes(global const bb_box *boxes, uint count, bb_cell_grid grid, uint chunk,
                        global uint *sums)
{
    uint first = (uint)get_global_id(0) * chunk, end = min(first + chunk, count), sum = 0;
    if (first >= count)
        return;
    for (uint i = first; i < end; i++) {
        float most = 0.0f;
        for (uint axis = 0; axis < 3; axis++) {
            float side = boxes[i].hi[axis] - boxes[i].lo[axis];
            if (grid.step[axis] > 0.0f)
                most = BB_MAX(most, side / grid.step[axis]);
        }
        uint cells = (uint)BB_MIN((float)grid.cells, most);
        sum += cells > 0u ? 31u - clz(cells) : 0u;
    }
    sums[get_global_id(0)] = sum;
}

/* ---- references: equation 6 ---- */

typedef struct cell_range {
    uint lo[3], hi[3];
} cell_range;

void range_of(const bb_cell_grid *grid, global const bb_box *box, cell_range *range)
{
    for (uint axis = 0; axis < 3; axis++) {
        range->lo[axis] = bb_cell_of(grid, axis, box->lo[axis]);
        range->hi[axis] = bb_cell_of(grid, axis, box->hi[axis]);
    }
}

/* Returns whether a primitive is on the mesh's boundary: by `flags` for tetrahedra (tets = 1:
 * numbered from `first` on), else always. */
bool is_boundary(global const uint *flags, uint first, uint tets, uint prim)
{
    return tets == 0u || prim < first || (flags[prim - first] & BB_TET_BOUNDARY) != 0u;
}

/* Counts the cells that list each primitive, and sums them over chunks. Primitives of the boundary
 * have their counts before all others', so that in each cell they come first. */
kernel void olbvh_counts(global const bb_box *boxes, uint count, bb_cell_grid grid, uint chunk,
                         global const uint *flags, uint first_tet, uint tets, global uint *counts,
                         global ulong *sums)
{
    uint first = (uint)get_global_id(0) * chunk, end = min(first + chunk, count);
    ulong sum = 0;
    if (first >= count)
        return;
    for (uint i = first; i < end; i++) {
        cell_range r;
        range_of(&grid, boxes + i, &r);
        uint cells = 1;
        for (uint axis = 0; axis < 3; axis++)
            cells *= r.hi[axis] - r.lo[axis] + 1u;
        bool boundary = is_boundary(flags, first_tet, tets, i);
        counts[i] = boundary ? cells : 0u;
        counts[count + i] = boundary ? 0u : cells;
        sum += cells;
    }
    sums[get_global_id(0)] = sum;
}

kernel void olbvh_codes(global const bb_box *boxes, uint count, bb_cell_grid grid,
                        global const uint *flags, uint first_tet, uint tets,
                        global const uint *offsets, global uint *codes, global uint *refs)
{
    uint i = (uint)get_global_id(0);
    if (i >= count)
        return;
    cell_range r;
    range_of(&grid, boxes + i, &r);
    uint at = offsets[is_boundary(flags, first_tet, tets, i) ? i : count + i];
    for (uint z = r.lo[2]; z <= r.hi[2]; z++)
        for (uint y = r.lo[1]; y <= r.hi[1]; y++)
            for (uint x = r.lo[0]; x <= r.hi[0]; x++, at++) {
                codes[at] = bb_morton_30((uint4)(x, y, z, 0u));
                refs[at] = i;
            }
}

/* ---- nodes ---- */

/* Returns the first level on which a node ends after reference i; bits + 1: on none. */
uint split_level(global const uint *codes, uint i, uint count, uint bits)
{
    if (i + 1u == count)
        return 0;
    uint differ = codes[i] ^ codes[i + 1u];
    return differ == 0u ? bits + 1u : bits - (31u - clz(differ)) / 3u;
}

/* splits: number of nodes that end after each reference. boundary: whether the reference is to a
 * primitive of the boundary. */
kernel void olbvh_splits(global const uint *codes, global const uint *refs, uint count, uint bits,
                         global const uint *flags, uint first, uint tets, global uint *splits,
                         global uint *boundary)
{
    uint i = (uint)get_global_id(0);
    if (i >= count)
        return;
    splits[i] = bits + 1u - split_level(codes, i, count, bits);
    boundary[i] = is_boundary(flags, first, tets, refs[i]) ? 1u : 0u;
}

/* Gives each node a slot; nodes that end together are adjacent, from the top down. */
kernel void olbvh_ends(global const uint *codes, uint count, uint bits, global const uint *offsets,
                       global uint *levels, global uint *slots, global uint *ends)
{
    uint i = (uint)get_global_id(0);
    if (i >= count)
        return;
    uint slot = offsets[i];
    for (uint level = split_level(codes, i, count, bits); level <= bits; level++, slot++) {
        levels[slot] = level;
        slots[slot] = slot;
        ends[slot] = i + 1u;
    }
}

/* After nodes have been sorted by level, stably: PO without its last entry, NO, and the node of
 * each slot. */
kernel void olbvh_offsets(global const uint *levels, global const uint *slots, uint count,
                          uint bits, global const uint *ends, global uint *node_of, global uint *po,
                          global uint *no)
{
    uint j = (uint)get_global_id(0);
    if (j >= count)
        return;
    uint slot = slots[j];
    node_of[slot] = j;
    if (j + 1u < count)
        po[j + 1u] = ends[slot];
    if (j == 0u)
        po[0] = 0;
    else if (levels[j] != levels[j - 1u])
        no[levels[j - 1u]] = j;
    if (j + 1u == count)
        no[bits] = count;
}

/* Computes the links of all nodes, CO, `cells`, and the boxes of leaves. `first_of`: slot of the
 * first node that ends after each reference. `marked`: number of boundary references before each.
 * `marked_all`: their number. */
kernel void olbvh_nodes(global const uint *levels, global const uint *slots, uint count,
                        bb_cell_grid grid, uint ref_count, global const uint *codes,
                        global const uint *first_of, global const uint *node_of,
                        global const uint *po, global const uint *marked,
                        global const uint *marked_all, global uint *refs, global uint *co,
                        global bb_node *nodes, global uint *cells, volatile global uint *arity)
{
    uint j = (uint)get_global_id(0);
    if (j >= count)
        return;
    uint level = levels[j], end = j + 1u == count ? ref_count : po[j + 1u];
    uint begin = po[j] < end ? po[j] : 0u; /* equation 9, with >= */
    if (j == 0u)
        co[0] = 0;
    uint last = end == ref_count ? marked_all[0] : marked[end];
    uint code = codes[end - 1u];
    cells[j] = (code >> 3u * (grid.bits - level) & BB_CELL_OCTANT) |
               min(last - marked[begin], BB_CELL_MARKED_MAX) << BB_CELL_MARKED_SHIFT;
    nodes[j].skip = end == ref_count ? BB_NONE : node_of[first_of[end - 1u]] + 1u;
    if (level < grid.bits) {
        uint before = j == 0u ? 0u : node_of[slots[j - 1u] + 1u];
        uint last_child = node_of[slots[j] + 1u];
        co[j + 1u] = last_child;
        nodes[j].first = before + 1u;
        atomic_max(arity, last_child - before);
        return;
    }
    if (j + 1u < count)
        co[j + 1u] = BB_NONE; /* CO ends with the inner nodes, the side array does not */
    for (uint axis = 0; axis < 3; axis++) {
        uint at = 0;
        for (uint bit = 0; bit < grid.bits; bit++)
            at |= (code >> (3u * bit + 2u - axis) & 1u) << bit;
        nodes[j].lo[axis] = bb_cell_plane(&grid, axis, at);
        nodes[j].hi[axis] = bb_cell_plane(&grid, axis, at + 1u);
    }
    nodes[j].first = BB_LEAF_BIT | begin;
    refs[end - 1u] |= BB_LAST_BIT;
}

/* Computes the boxes of a level of inner nodes as unions of their children's. */
kernel void olbvh_unions(global bb_node *nodes, uint first, uint count, global const uint *co)
{
    uint j = first + (uint)get_global_id(0);
    if (j >= first + count)
        return;
    float3 lo = (float3)(INFINITY), hi = (float3)(-INFINITY);
    for (uint child = co[j] + 1u; child <= co[j + 1u]; child++) {
        float3 child_lo = vload3(0, nodes[child].lo), child_hi = vload3(0, nodes[child].hi);
        lo = BB_MIN(child_lo, lo);
        hi = BB_MAX(child_hi, hi);
    }
    vstore3(lo, 0, nodes[j].lo);
    vstore3(hi, 0, nodes[j].hi);
}

kernel void olbvh_info(global bb_tree_info *info, uint nodes, uint leaves, uint refs, uint depth,
                       global const uint *arity)
{
    if (get_global_id(0) != 0)
        return;
    info->root = 0;
    info->node_count = nodes;
    info->leaf_count = leaves;
    info->ref_count = refs;
    info->arity = arity[0];
    info->depth = depth;
}
