/* What the files of this folder share: the numbers of a document, read once. */
#ifndef BB_SUMMARY_PRIVATE_H
#define BB_SUMMARY_PRIVATE_H

#include "framework/summary/summary.h"

#include <math.h>

/* A trace that may rank: answers right, intersector `exact` or a reference's own. */
typedef struct bb_candidate {
    uint32_t entrant, set, scene;
    double ns;         /* of a ray, median */
    bb_samples ns_all; /* by rounds; empty: not in the file */
    double work;       /* counted, per ray; NAN: not counted */
    double layout_ms;  /* of what its kernel reads; 0 for a reference; NAN: not known */
    double low, high;  /* of its rate, Mrays/s */
    const char *kernel;
} bb_candidate;

typedef struct bb_built {
    bool there, ok;
    double fixed_ms; /* before the layout: build, boxes, transfer; median */
    bb_samples fixed_all;
    double build_ms;
    bb_samples build_all;
    double prims, peak;
    double quality; /* by the metric that layouts have too */
    double overlap; /* EPO */
} bb_built;

typedef struct bb_entrant_row {
    const char *builder;
    double run;
    bool reference;
} bb_entrant_row;

/* Rays that builders were compared on. */
typedef struct bb_summary_set {
    const char *rays, *view, *hash;
    uint32_t scene;
    double judged; /* rays of it that one of our cells was judged on */
} bb_summary_set;

typedef struct bb_numbers {
    const bb_results *results;
    bb_entrant_row *entrants;
    const char **scenes;
    bb_summary_set *sets;
    bb_candidate *candidates;
    uint32_t *starts; /* of each entrant's candidates for each set, and the end */
    bb_built *builds; /* entrants x scenes */
    uint32_t entrant_count, scene_count, set_count, candidate_count;
} bb_numbers;

bb_status bb_numbers_read(const bb_results *results, bb_numbers *numbers);
void bb_numbers_free(bb_numbers *numbers);

/* ---- costs, the lower the better, and their means (means.c) ---- */

enum { BB_FASTEST_REFERENCE = UINT32_MAX - 1, BB_NOBODY = UINT32_MAX };

typedef enum bb_quantity {
    BB_OF_TRACE,   /* ns of a ray, per ray set */
    BB_OF_BUILD,   /* ms of a primitive, per scene */
    BB_OF_READY,   /* the same of build and layout */
    BB_OF_IMAGE,   /* ms for build, layout and some rays, per ray set */
    BB_OF_QUALITY, /* per scene */
    BB_OF_OVERLAP, /* per scene */
    BB_OF_WORK,    /* counted work of a ray, per ray set, by the kernel that needs least */
} bb_quantity;

typedef struct bb_measure {
    bb_quantity quantity;
    double rays; /* of BB_OF_IMAGE */
} bb_measure;

typedef struct bb_summary_view {
    const bb_numbers *n;
    bool *sets, *scenes;     /* that enter */
    bool *whole;             /* entrants that have figures of all these */
    const char **favourites; /* of each entrant: the kernel that is fastest most often, or NULL */
} bb_summary_view;

/* Geometric mean of the cost of a by that of b over what both have; by rounds too. With BB_NOBODY
 * as b: of the cost of a. */
typedef struct bb_mean {
    double value; /* NAN: nothing in common */
    bb_estimate rounds;
    uint32_t units;
} bb_mean;

/* The entrant's build on a scene. */
const bb_built *bb_built_of(const bb_summary_view *v, uint32_t e, uint32_t scene);

/* The entrant's candidate of least cost for `rays` rays (0: by the trace alone); NULL if it has
 * none. */
const bb_candidate *bb_fastest(const bb_summary_view *v, uint32_t e, uint32_t set, double rays);

bb_mean bb_mean_ratio(const bb_summary_view *v, uint32_t a, uint32_t b, const bb_measure *m);

/* Whether this run can't tell two apart: the interval of their ratio has 1 in it. */
bool bb_is_tie(const bb_mean *ratio);

/* The builder of least mean cost among those that have all that enters; BB_NOBODY. */
uint32_t bb_best_builder(const bb_summary_view *v, const bb_measure *m);

/* ---- the summary ---- */

/* The summary of a choice. */
bb_status bb_summary_of(const bb_numbers *numbers, const bb_summary_choice *choice,
                        bb_summary *summary);

/* Whether a trace of the document is one that `choice` takes. */
bool bb_choice_takes(const bb_summary_choice *choice, const char *scene, const char *rays);

/* What the sentences say follows from the rows. */
void bb_summary_say(bb_summary *summary);
/* Another sentence, on how well costs of trees predict the time of rays; none for a single scene,
 * or where too few scenes were measured. */
bb_status bb_summary_say_predictions(const bb_results *results, const bb_summary_choice *choice,
                                     bb_summary *summary);

/* Fills accuracy and accuracy_count. */
bb_status bb_summary_accuracies(const bb_results *results, const bb_summary_choice *choice,
                                bb_summary *summary);

#endif
