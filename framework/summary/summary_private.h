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
    double layout_ms;  /* of what its kernel reads; 0 for a reference */
    bb_samples layout_all;
    double low, high; /* of its rate, Mrays/s */
    const char *kernel;
} bb_candidate;

typedef struct bb_built {
    bool ok;
    double fixed_ms; /* before the layout: build, boxes, transfer; median */
    bb_samples fixed_all;
    double build_ms;
    bb_samples build_all;
    double prims, sah, peak;
} bb_built;

typedef struct bb_entrant_row {
    const char *builder;
    double run;
    bool reference;
} bb_entrant_row;

/* Rays that builders were compared on. */
typedef struct bb_ray_set {
    const char *rays, *view, *hash;
    uint32_t scene;
} bb_ray_set;

typedef struct bb_numbers {
    const bb_results *results;
    bb_entrant_row *entrants;
    const char **scenes;
    bb_ray_set *sets;
    bb_candidate *candidates;
    uint32_t *starts; /* of each entrant's candidates for each set, and the end */
    bb_built *builds; /* entrants x scenes */
    uint32_t entrant_count, scene_count, set_count, candidate_count;
} bb_numbers;

bb_status bb_numbers_read(const bb_results *results, bb_numbers *numbers);
void bb_numbers_free(bb_numbers *numbers);

/* The summary of a choice. */
bb_status bb_summary_of(const bb_numbers *numbers, const bb_summary_choice *choice,
                        bb_summary *summary);

/* Whether a trace of the document is one that `choice` takes. */
bool bb_choice_takes(const bb_summary_choice *choice, const char *scene, const char *rays);

/* What the sentences say follows from the rows. */
void bb_summary_say(bb_summary *summary);

/* Fills accuracy and accuracy_count. */
bb_status bb_summary_accuracies(const bb_results *results, const bb_summary_choice *choice,
                                bb_summary *summary);

#endif
