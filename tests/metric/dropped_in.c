/* A metric of trees that nobody else knows of, for one_file.sh. */
#include "framework/builder/metric.h"

static bb_status compute(const bb_tree *tree, const bb_scene *scene, uint64_t samples,
                         uint64_t seed, double *value, double *half)
{
    (void)scene;
    (void)samples;
    (void)seed;
    *value = tree->info.node_count + 0.25;
    *half = 0.125;
    return BB_OK;
}

extern const bb_metric bb_metric_dropped_in;
const bb_metric bb_metric_dropped_in = {
    .name = "dropped_in",
    .title = "DROP",
    .full_title = "nodes and a quarter",
    .unit = "nodes",
    .summary = "Nobody else knows of this.",
    .on_request = true,
    .sampled = true,
    .compute = compute,
};
