/* Figures of a contender on a scene, from results: the time of an image by rounds, wrong
 * rays and memory. */
#ifndef BB_ADVISE_FIGURES_H
#define BB_ADVISE_FIGURES_H

#include "framework/advise/contenders.h"
#include "framework/advise/leastness.h"
#include "framework/record/record.h"
#include "framework/simulate/simulated_sets.h"

/* An image has `rays` rays, equally many of each kind, and within a kind of each view. */
typedef struct bb_image {
    const bb_results *results;
    const char *scene; /* its name in the results */
    uint32_t run;      /* others are ignored */
    double rays;
    double factor;          /* for times and bytes of builds and layouts: bb_ground.factor */
    const char *simulation; /* its name in the results: times are those of its bound; NULL: those
                             * that were measured */
} bb_image;

typedef struct bb_tried_figures {
    bool measured;
    char reason[256]; /* why not */
    /* ms of build, layout and rays by rounds; sample 0 is the warm-up. By simulation: ms of the
     * rays, a single sample */
    bb_samples cost;
    /* medians; rays are the sum of all sets, the build includes boxes and transfer */
    double build_ms, layout_ms, trace_ms;
    double wrong, checked; /* rays */
    double unlike;         /* unjudged rays whose answer differs from that of another `exact` */
    double bytes_build, bytes_layout; /* peak of tree and scratch; layout */
    double bytes_tree;
    double rays;                   /* of all sets in one round */
    bb_extent extent;              /* its time is that of all of `cost` */
    bb_simulated_sets simulated;   /* sets of rays, if there is a simulation */
    const bb_entry *build, *trace; /* its first trace; both in the results */
} bb_tried_figures;

void bb_tried_read(const bb_image *image, const bb_contender *contender, bb_tried_figures *out);

/* Counts kinds: "triangles+spheres" are 2. */
uint32_t bb_kinds_in(const char *words);

/* Returns a decision of a build or trace as a number; 0 without one. */
double bb_decided_number(const bb_entry *entry, const char *what);

#endif
