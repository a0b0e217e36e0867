/* Surface area heuristic of a tree (Goldsmith and Salmon 1987; MacDonald and Booth 1990):
 *
 *   (1 / A(root)) (sum over inner nodes Ct children/2 A(n) + sum over leaves Ci |refs| A(n))
 *
 * Ct = 1.2, Ci = 1, the constants of the extended-Morton-code paper (Vinkler, Bittner, Havran
 * 2017); children/2 so that wide trees don't win by definition. Duplicated references count each
 * time. Half areas serve: the factor 2 cancels.
 */
#include "framework/tree/tree_walk.h"

#include <math.h>

double bb_tree_sah(const bb_tree *tree)
{
    bb_walk walk;
    double sum = 0.0, lost = 0.0, root = 0.0;
    bb_status status = bb_walk_tree(tree, &walk);
    for (uint32_t i = 0; i < walk.info.node_count && status == BB_OK; i++) {
        const bb_node *node = &tree->nodes[walk.order[i]];
        double area = bb_half_area(node->lo, node->hi);
        if (i == 0)
            root = area;
        /* Neumaier 1974: all terms are >= 0, and what a sum of millions of them loses is added up
         * apart. */
        double term = bb_node_cost(node, walk.width[i]) * area, next = sum + term;
        lost += sum >= term ? (sum - next) + term : (term - next) + sum;
        sum = next;
    }
    bb_walk_release(&walk);
    return root > 0.0 ? (sum + lost) / root : (double)NAN;
}
