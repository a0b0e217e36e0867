/* Surface area heuristic of a tree (Goldsmith and Salmon 1987; MacDonald and Booth 1990):
 *
 *   (1 / A(root)) (sum over inner nodes Ct children/2 A(n) + sum over leaves Ci |refs| A(n))
 *
 * Ct = 1.2, Ci = 1, the constants of the extended-Morton-code paper (Vinkler, Bittner, Havran
 * 2017); children/2 so that wide trees do not win by definition. Duplicated references count each
 * time. Half areas are used, since the factor 2 cancels.
 */
#include "framework/builder/metric.h"
#include "framework/builder/tree_walk.h"

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
        /* Neumaier 1974: all terms are >= 0, and rounding errors of the sum are added up
         * separately. */
        double term = bb_node_cost(node, walk.width[i]) * area, next = sum + term;
        lost += sum >= term ? (sum - next) + term : (term - next) + sum;
        sum = next;
    }
    bb_walk_release(&walk);
    return root > 0.0 ? (sum + lost) / root : (double)NAN;
}

static bb_status compute(const bb_tree *tree, const bb_scene *scene, uint64_t samples,
                         uint64_t seed, double *value, double *half)
{
    (void)scene;
    (void)samples;
    (void)seed;
    (void)half;
    *value = bb_tree_sah(tree);
    return BB_OK;
}

const bb_metric bb_metric_sah = {
    .name = "sah",
    .title = "SAH",
    .full_title = "surface area heuristic",
    .unit = "",
    .summary =
        "What a random ray is expected to cost, relative to the area of the root. A node with "
        "k children costs 1.2 \xc2\xb7 k/2, a reference in a leaf 1. Given for the tree as built "
        "and for each layout as traced.",
    .of_layouts = true,
    .compute = compute,
};
