/* What a result document says of a contender on a scene: what it costs to make an image, by rounds,
 * how often it is wrong, and how much it takes. */
#ifndef BB_ADVISE_FIGURES_H
#define BB_ADVISE_FIGURES_H

#include "framework/advise/contenders.h"
#include "framework/advise/leastness.h"
#include "framework/record/record.h"

/* An image: so many rays in all, in equal parts of each kind that there are, and within a kind of
 * each view. */
typedef struct bb_image {
    const bb_results *results;
    const char *scene;    /* its name in the results */
    uint32_t first_build; /* of earlier builds nothing is read */
    double rays;
    double factor; /* by which times and bytes of builds and layouts grow: of a sample, the inverse
                    * of its share of the primitives */
} bb_image;

typedef struct bb_tried_figures {
    bool measured;
    char reason[256]; /* why not */
    bb_samples cost;  /* ms of build, layout and rays, by rounds; sample 0 is the warm-up */
    /* Medians, of all sets the sum; boxes and transfers are in the build's. */
    double build_ms, layout_ms, trace_ms;
    double wrong, checked; /* rays */
    double unlike;         /* rays that nobody judged, answered otherwise than by another `exact` */
    double bytes_build, bytes_layout; /* peak of tree and scratch; of the layout */
    double bytes_tree;
    double rays; /* of one round, all sets together */
    bb_extent extent;
    const bb_entry *build, *trace; /* the first of its traces; in the results */
} bb_tried_figures;

void bb_tried_read(const bb_image *image, const bb_contender *contender, bb_tried_figures *out);

/* Of several kinds, how many are compiled in: "triangles+spheres" are 2. */
uint32_t bb_kinds_in(const char *words);

/* A decision of a build or trace as a number; 0 where there is none. */
double bb_decided_number(const bb_entry *entry, const char *what);

#endif
