/* End-point overlap from any number of points, for its metrics. */
#ifndef BB_METRIC_EPO_H
#define BB_METRIC_EPO_H

#include "framework/builder/metric.h"

/* How a tree is sampled. `visits`: about how many nodes may be visited in all; 0: no limit. If
 * boxes overlap so much that a point is in most of them, fewer points than `samples` are used. The
 * first points decide, by the nodes they visit and not by a clock, so the same tree always gets the
 * same points. */
typedef struct bb_epo_effort {
    uint64_t samples, visits;
} bb_epo_effort;

/* Like bb_metric.compute(): the mean, and the half width of its 95 % interval. */
bb_status bb_epo(const bb_tree *tree, const bb_scene *scene, const bb_epo_effort *effort,
                 uint64_t seed, double *mean, double *half);

#endif
