/* Metrics of trees: figures that are meant to say how good a tree is before a ray is traced. Each
 * is one file, metric_NAME.c with `const bb_metric bb_metric_NAME`, which CMake finds. The struct
 * makes it appear in the result file (NAME, and NAME_half if it is sampled, of the build's tree),
 * in the tables of builds, in the chart of speed against metrics, in `list metrics` and in `run
 * --metrics`.
 */
#ifndef BB_METRIC_H
#define BB_METRIC_H

#include "framework/builder/tree.h"

enum { BB_METRICS_MAX = 16 };

typedef struct bb_metric {
    const char *name;       /* as in files and on the command line; a C identifier */
    const char *title;      /* as in headings: "SAH" */
    const char *full_title; /* as on axes: "surface area heuristic" */
    const char *unit;       /* "" for none */
    const char *summary;    /* its meaning for a tree, in a sentence or two for the page and the
                          * help */
    bool on_request;        /* too expensive to be measured each time */
    bool of_layouts; /* the harness also measures it for each layout, as traced: layout_sah */
    /* Rank in the mixture that predicts the time of rays (summary/prediction.h): of several that a
     * tree has, the one with the largest number is used; 0: never used. */
    unsigned mixed;
    bool sampled; /* estimated from points, with a confidence interval */
    /* Computes it for the tree, which has been checked and is on the host. *value: NAN if the tree
     * has none. *half: if it is sampled, the half width of the 95 % interval of *value. `samples`
     * points, at least 1, drawn by `seed`: the same for all trees of a scene. May use all cores,
     * but must not depend on their number. */
    bb_status (*compute)(const bb_tree *tree, const bb_scene *scene, uint64_t samples,
                         uint64_t seed, double *value, double *half);
} bb_metric;

extern const bb_metric *const bb_metrics[]; /* generated; by name; ends with NULL */

/* Builders minimise it, and the harness compares trees by it (metric_sah.c). */
extern const bb_metric bb_metric_sah;

uint32_t bb_metric_count(void);
/* Returns the index in bb_metrics; BB_NONE if there is none of that name. */
uint32_t bb_metric_find(const char *name);
/* Returns the index of the metric that is also measured for layouts. */
uint32_t bb_metric_of_layouts(void);
/* BB_INVALID if there is none, with the most likely alternative. */
bb_status bb_metric_check(const char *name);

/* The value of one metric for a tree; NAN: not measured. */
typedef struct bb_metric_value {
    double value, half;
} bb_metric_value;

/* Calls bb_metric.compute(); the parts of *out are NAN unless they were computed. */
bb_status bb_metric_compute(const bb_metric *metric, const bb_tree *tree, const bb_scene *scene,
                            uint64_t samples, uint64_t seed, bb_metric_value *out);

#endif
