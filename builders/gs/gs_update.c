/* Objects that moved: Eisemann, Grosch, Mueller, Magnor 2007, section 3.1 and algorithm 1.
 *
 *   for each object whose box differs from its last one, bit for bit:
 *       start = the first ancestor of its leaf whose box contains the new box; or the root
 *       unlink the leaf; shrink the boxes above, up to the first that stays the same
 *       insert it with its new box, from start down
 */
#include "gs.h"

#include <string.h>

uint32_t bb_gs_enclosing(const bb_gs_tree *tree, uint32_t n, const bb_gs_box *box)
{
    const bb_gs_node *nodes = tree->nodes;
    uint32_t up = nodes[n].parent;
    while (up != BB_NONE && !bb_gs_contains(&nodes[up].box, box))
        up = nodes[up].parent;
    return up != BB_NONE ? up : tree->root;
}

/* Free of branches, since which object has moved is unpredictable. */
static uint32_t differ(const float a[3], const float b[3])
{
    uint64_t xy_a, xy_b;
    uint32_t z_a, z_b;
    memcpy(&xy_a, a, sizeof xy_a);
    memcpy(&xy_b, b, sizeof xy_b);
    memcpy(&z_a, a + 2, sizeof z_a);
    memcpy(&z_b, b + 2, sizeof z_b);
    return ((xy_a ^ xy_b) | (z_a ^ z_b)) != 0;
}

uint32_t bb_gs_detect(bb_gs_tree *tree, const bb_box *boxes)
{
    uint32_t moved = 0;
    for (uint32_t i = 0; i < tree->object_count; i++) {
        tree->scratch[moved] = i;
        moved += differ(tree->boxes[i].lo, boxes[i].lo) | differ(tree->boxes[i].hi, boxes[i].hi);
    }
    return moved;
}

void bb_gs_move(bb_gs_tree *tree, const bb_box *boxes, uint32_t moved)
{
    for (uint32_t i = 0; i < moved; i++) {
        uint32_t object = tree->scratch[i], leaf = tree->leaf_of[object];
        bb_gs_box box = tree->boxes[object] = bb_gs_box_of(&boxes[object]);
        if (leaf == tree->root) {
            bb_gs_set_box(tree, leaf, &box);
            continue;
        }
        uint32_t start = tree->rules.from_root ? tree->root : bb_gs_enclosing(tree, leaf, &box);
        bb_gs_detach(tree, leaf, &start);
        bb_gs_set_box(tree, leaf, &box);
        bb_gs_insert(tree, &start, leaf);
    }
    tree->reinserted += moved;
}
