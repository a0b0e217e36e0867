/* Converts the common tree to families (reinsert_shared.h) and back.
 *
 *   mark the inner nodes; the prefix sum of the marks numbers the families     (families_mark)
 *   make the family of each inner node                                       (families_gather)
 *   cost: half areas of all inner nodes, added up in chunks                    (families_cost)
 *   write nodes: the children of family f are 2 f + 1 and 2 f + 2, the root is 0
 *       CPUs: down the tree, a subtree per work-item             (families_top, families_walk)
 *       GPUs: in any order; skips of last siblings are set later              (families_write)
 *
 * Numbers depend only on the input tree, and siblings are adjacent.
 */
#include "families.clh"

kernel void families_mark(global const bb_node *nodes, uint count, global uint *marks)
{
    uint n = get_global_id(0);
    if (n < count)
        marks[n] = is_leaf_link(nodes[n].first) ? 0u : 1u;
}

/* Returns the link to node n. */
uint link_of(global const bb_node *nodes, global const uint *numbers, uint n)
{
    uint first = nodes[n].first;
    return is_leaf_link(first) ? first : numbers[n];
}

/* Stores node n at a place. */
void place_node(global const bb_node *nodes, global const uint *numbers, uint n, uint place,
                global bb_family *families)
{
    global float *planes = families[place >> 1].planes + (place & 1u);
    uint link = link_of(nodes, numbers, n);
    for (uint k = 0; k < 3u; k++) {
        planes[4u * k] = -nodes[n].lo[k];
        planes[4u * k + 2u] = nodes[n].hi[k];
    }
    families[place >> 1].links[place & 1u] = link;
    if (!is_leaf_link(link))
        families[link].place = place;
}

kernel void families_gather(global const bb_node *nodes, uint count, uint root,
                            global const uint *numbers, uint top, global bb_family *families)
{
    uint n = get_global_id(0);
    if (n >= count)
        return;
    if (n == root) { /* the other side of the family above the root stays empty */
        for (uint k = 0; k < 12u; k++)
            families[top].planes[k] = -INFINITY;
        families[top].links[1] = BB_NONE;
        families[top].place = BB_NONE;
        families[top].pad = 0u;
        place_node(nodes, numbers, n, 2u * top, families);
    }
    uint first = nodes[n].first;
    if (is_leaf_link(first))
        return;
    families[numbers[n]].pad = 0u;
    place_node(nodes, numbers, first, 2u * numbers[n], families);
    place_node(nodes, numbers, nodes[first].skip, 2u * numbers[n] + 1u, families);
}

/* sums[]: one per BB_COST_CHUNK families. */
kernel void families_cost(global const bb_family *families, uint count, float unit,
                          global ulong *sums)
{
    uint begin = get_global_id(0) * BB_COST_CHUNK, end = BB_MIN(begin + BB_COST_CHUNK, count);
    if (begin >= count)
        return;
    ulong sum = 0;
    for (uint f = begin; f < end; f++) {
        bb_two_boxes boxes;
        load_family(families, f, &boxes);
        unite_boxes(&boxes);
        float area = areas_of(&boxes, unit).x;
        sum += convert_ulong_rtz(area * BB_COST_ONE);
    }
    sums[get_global_id(0)] = sum;
}

void write_node(global const bb_family *families, uint place, uint skip, global bb_node *node)
{
    global const float *planes = families[place >> 1].planes + (place & 1u);
    uint link = families[place >> 1].links[place & 1u];
    for (uint k = 0; k < 3u; k++) {
        node->lo[k] = -planes[4u * k];
        node->hi[k] = planes[4u * k + 2u];
    }
    node->first = is_leaf_link(link) ? link : 2u * link + 1u;
    node->skip = skip;
}

/* ---- CPUs: nodes with their skips, top-down ---- */

/* Writes the children of family f, whose node's skip is known. */
void open_node(global const bb_family *families, uint f, uint skip, global bb_node *nodes)
{
    write_node(families, 2u * f, 2u * f + 2u, &nodes[2u * f + 1u]);
    write_node(families, 2u * f + 1u, skip, &nodes[2u * f + 2u]);
}

/* Returns the node of family f: its place plus 1, or 0 for the root. */
uint node_of(global const bb_family *families, uint f, uint top)
{
    uint place = families[f].place;
    return place >> 1 == top ? 0u : place + 1u;
}

/* Runs in one work-item. Opens nodes from the root until there are `most` subtrees or nothing left
 * to open. tasks[]: family and depth of each subtree. total[0]: their number. */
kernel void families_top(global const bb_family *families, uint top, uint most,
                         global bb_node *nodes, global uint2 *tasks, global uint *total,
                         global bb_tree_info *info)
{
    uint begin = 0, end = 1, deepest = 0;
    write_node(families, 2u * top, BB_NONE, &nodes[0]);
    tasks[0] = (uint2)(families[top].links[0], 0u);
    /* a ring buffer used as a queue, so that larger subtrees come first */
    for (uint waiting = 1; waiting > 0u && waiting + 1u < most; waiting = end - begin) {
        uint2 task = tasks[begin++ % most];
        open_node(families, task.x, nodes[node_of(families, task.x, top)].skip, nodes);
        for (uint k = 0; k < 2u; k++) {
            uint link = families[task.x].links[k];
            if (is_leaf_link(link))
                deepest = BB_MAX(deepest, task.y + 1u);
            else
                tasks[end++ % most] = (uint2)(link, task.y + 1u);
        }
    }
    total[0] = begin;
    total[1] = end;
    info->depth = deepest;
}

/* One work-item per task. Traverses the subtree in preorder, left children first, and returns by
 * way of places. */
kernel void families_walk(global const bb_family *families, uint top, uint most,
                          global bb_node *nodes, global const uint2 *tasks,
                          global const uint *total, volatile global bb_tree_info *info)
{
    uint i = total[0] + get_global_id(0);
    if (i >= total[1])
        return;
    uint root = tasks[i % most].x, depth = tasks[i % most].y, deepest = depth + 1u, f = root;
    for (;;) {
        open_node(families, f, nodes[node_of(families, f, top)].skip, nodes);
        deepest = BB_MAX(deepest, depth + 1u);
        uint link = families[f].links[0];
        if (is_leaf_link(link))
            link = families[f].links[1];
        while (is_leaf_link(link)) {
            uint place = families[f].place;
            if (f == root) {
                atomic_max(&info->depth, deepest);
                return;
            }
            f = place >> 1;
            depth--;
            if ((place & 1u) == 0u)
                link = families[f].links[1];
        }
        f = link;
        depth++;
    }
}

/* ---- GPUs ---- */

/* skip: the next sibling, as bb_links_finish_device() expects. */
kernel void families_write(global const bb_family *families, uint count, global bb_node *nodes)
{
    uint f = get_global_id(0);
    if (f > count)
        return;
    if (f == count) {
        write_node(families, 2u * f, BB_NONE, &nodes[0]);
        return;
    }
    write_node(families, 2u * f, 2u * f + 2u, &nodes[2u * f + 1u]);
    write_node(families, 2u * f + 1u, BB_NONE, &nodes[2u * f + 2u]);
}
