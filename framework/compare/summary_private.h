/* Shared by the files of this folder: the numbers of results, read once, and means over them. */
#ifndef BB_SUMMARY_PRIVATE_H
#define BB_SUMMARY_PRIVATE_H

#include "framework/compare/summary.h"

#include <math.h>

/* A trace that may rank: its answers are right, and its intersector is `exact` or a reference's
 * own. */
typedef struct bb_candidate {
    uint32_t entrant, set, scene;
    double ns;         /* median time of a ray */
    bb_samples ns_all; /* the same for each round; empty: not in the file */
    double work;       /* counted, per ray; NAN: not counted */
    double layout_ms;  /* time of its layout; 0 for a reference; NAN: not known */
    double low, high;  /* interval of its rate, Mrays/s */
    const char *kernel;
} bb_candidate;

typedef struct bb_built {
    bool there, ok;
    double fixed_ms; /* median time before the layout: build, boxes, transfer */
    bb_samples fixed_all;
    double build_ms, untimed_ms; /* untimed: outside the clock, with each build */
    bb_samples build_all;
    double prims, tree, peak;
    double quality; /* of the metric that layouts have too (SAH) */
    double overlap; /* EPO */
} bb_built;

typedef struct bb_entrant_row {
    const char *builder;
    double run;
    bool reference;
} bb_entrant_row;

/* A ray set on which builders were compared. */
typedef struct bb_summary_set {
    const char *rays, *view, *hash;
    uint32_t scene;
    double judged; /* rays of the set on which one of our cells was judged */
} bb_summary_set;

typedef struct bb_numbers {
    const bb_results *results;
    bb_entrant_row *entrants;
    const char **scenes;
    bb_summary_set *sets;
    bb_candidate *candidates;
    uint32_t *starts; /* index of the first candidate of each entrant and set, and the end */
    bb_built *builds; /* entrants x scenes */
    uint32_t entrant_count, scene_count, set_count, candidate_count;
} bb_numbers;

bb_status bb_numbers_read(const bb_results *results, bb_numbers *numbers);
void bb_numbers_free(bb_numbers *numbers);

/* ---- costs, the lower the better, and their means (means.c) ---- */

enum { BB_FASTEST_REFERENCE = UINT32_MAX - 1, BB_NOBODY = UINT32_MAX };

typedef enum bb_quantity {
    BB_OF_TRACE,   /* ns of a ray, per ray set */
    BB_OF_BUILD,   /* ms per primitive, per scene */
    BB_OF_READY,   /* the same for build and layout */
    BB_OF_IMAGE,   /* ms for build, layout and some rays, per ray set */
    BB_OF_QUALITY, /* per scene */
    BB_OF_OVERLAP, /* per scene */
    BB_OF_WORK,    /* counted work of a ray, per ray set, with the kernel that needs least */
} bb_quantity;

typedef struct bb_measure {
    bb_quantity quantity;
    double rays; /* of BB_OF_IMAGE */
} bb_measure;

typedef struct bb_summary_view {
    const bb_numbers *n;
    bool *sets, *scenes; /* that enter */
    bool *whole;         /* entrants that have figures for all of these */
    /* for each entrant, the largest part of its build on a scene that recurs outside the clock */
    double *untimed;
    const char **favourites; /* for each entrant, the kernel that is fastest most often, or NULL */
} bb_summary_view;

/* The geometric mean of the cost of a divided by that of b, over the sets or scenes that both have,
 * and the same for each round. If b is BB_NOBODY, the mean of the cost of a. */
typedef struct bb_mean {
    double value; /* NAN: nothing in common */
    bb_estimate rounds;
    uint32_t units;
} bb_mean;

/* Returns the entrant's build on a scene. */
const bb_built *bb_built_of(const bb_summary_view *v, uint32_t e, uint32_t scene);

/* Returns the fastest reference of the run: another run may be of another machine or time. NULL:
 * the run has none. */
const bb_candidate *bb_fastest_reference(const bb_summary_view *view, uint32_t set, double run);

/* Returns the entrant's candidate of least cost for `rays` rays (0: by the trace alone); NULL if it
 * has none. */
const bb_candidate *bb_fastest(const bb_summary_view *v, uint32_t e, uint32_t set, double rays);

bb_mean bb_mean_ratio(const bb_summary_view *v, uint32_t a, uint32_t b, const bb_measure *m);

/* Returns whether the entrant's own figure of this quantity leaves out work that recurs. */
bool bb_leaves_out(const bb_summary_view *v, uint32_t e, const bb_measure *m);

/* Returns whether this run cannot tell two apart: the interval of their ratio includes 1. */
bool bb_is_tie(const bb_mean *ratio);

/* Returns the builder of least mean cost among those that have figures for all that enters;
 * BB_NOBODY if there is none. */
uint32_t bb_best_builder(const bb_summary_view *v, const bb_measure *m);

/* ---- the summary ---- */

/* Makes the summary of a choice. */
bb_status bb_summary_of(const bb_numbers *numbers, const bb_summary_choice *choice,
                        bb_summary *summary);

/* Returns whether `choice` takes traces of this scene and rays. */
bool bb_choice_takes(const bb_summary_choice *choice, const char *scene, const char *rays);

/* Adds the sentences, which follow from the rows. */
void bb_summary_say(bb_summary *summary);
/* Adds a sentence on how well costs of trees predict the time of rays, unless the choice is a
 * single scene or too few scenes were measured. */
bb_status bb_summary_say_predictions(const bb_results *results, const bb_summary_choice *choice,
                                     bb_summary *summary);

/* Fills the simulations. */
bb_status bb_summary_simulations(const bb_results *results, const bb_summary_choice *choice,
                                 bb_summary *summary);

/* Fills accuracy and accuracy_count. */
bb_status bb_summary_accuracies(const bb_results *results, const bb_summary_choice *choice,
                                bb_summary *summary);

#endif
