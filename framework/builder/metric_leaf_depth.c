/* Mean depth of the leaves that a random ray meets:
 *
 *   sum over leaves d(l) A(l) / sum over leaves A(l)
 *
 * with d(l) the number of edges from the root to leaf l and A its surface area. A random line that
 * meets the root's box meets a box inside it with probability A(l) / A(root) (Goldsmith and Salmon
 * 1987; MacDonald and Booth 1990), so this is the mean depth over all meetings of random rays with
 * leaves. It says how deep the work is, which a sum of costs does not: two trees of equal SAH may
 * differ in it. A tree of one leaf has depth 0.
 */
#include "framework/builder/metric.h"
#include "framework/builder/tree_walk.h"

#include <math.h>

/* `depth` has room for all positions. */
static double weigh_leaves(const bb_tree *tree, const bb_walk *walk, uint32_t *depth)
{
    double area = 0.0, sum = 0.0;
    for (uint32_t i = 0; i < walk->info.node_count; i++) {
        const bb_node *node = &tree->nodes[walk->order[i]];
        depth[i] = walk->parent[i] == BB_NONE ? 0 : depth[walk->parent[i]] + 1;
        if (!bb_node_is_leaf(node))
            continue;
        double half_area = bb_half_area(node->lo, node->hi);
        area += half_area;
        sum += half_area * depth[i];
    }
    return area > 0.0 ? sum / area : (double)NAN;
}

static bb_status compute(const bb_tree *tree, const bb_scene *scene, uint64_t samples,
                         uint64_t seed, double *value, double *half)
{
    (void)scene;
    (void)samples;
    (void)seed;
    (void)half;
    bb_walk walk;
    uint32_t *depth = NULL;
    bb_status status = bb_walk_tree(tree, &walk);
    if (status == BB_OK)
        status = bb_host_alloc(NULL, walk.info.node_count * sizeof *depth, "leaf depth", &depth);
    if (status == BB_OK)
        *value = weigh_leaves(tree, &walk, depth);
    bb_host_free(depth);
    bb_walk_release(&walk);
    return status;
}

extern const bb_metric bb_metric_leaf_depth;
const bb_metric bb_metric_leaf_depth = {
    .name = "leaf_depth",
    .title = "Leaf depth",
    .full_title = "mean depth of the leaves that random rays meet",
    .unit = "edges",
    .summary =
        "Mean number of edges from the root to a leaf, each leaf weighted by its surface area: "
        "by the probability that a random ray meets it.",
    .compute = compute,
};
