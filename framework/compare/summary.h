/* The summary of results: one row per builder, over all scenes and ray sets or a choice
 * of them.
 *
 * Means over scenes and ray sets are geometric means of ratios between builders on the same rays.
 * On each ray set, a builder counts with its fastest kernel whose answers are right. Only cells
 * with the intersector `exact` enter; bb_summary_accuracy sums up the others. To decide whether two
 * builders can be told apart, the mean ratio of each round is taken, and the 95 % interval of its
 * median over the rounds.
 */
#ifndef BB_SUMMARY_H
#define BB_SUMMARY_H

#include "framework/record/record.h"

enum {
    BB_SUMMARY_COUNTS = 6,     /* numbers of rays for which rows have a time to image */
    BB_SUMMARY_CURVE = 45,     /* points of a curve over numbers of rays */
    BB_SUMMARY_SENTENCES = 16, /* at most */
    BB_SUMMARY_NAME = 64,
};

/* 10^5, 10^6 ... 10^10 rays. */
extern const double bb_summary_counts[BB_SUMMARY_COUNTS];
/* Returns the number of rays at point i of a curve: from 1 to 10^11, four per power of ten. */
double bb_summary_curve_count(uint32_t i);

/* Which cells enter a summary. */
typedef struct bb_summary_choice {
    const char *scene; /* NULL: all */
    const char *rays;  /* as in the file; NULL: all */
} bb_summary_choice;

/* A figure of a row. */
typedef struct bb_standing {
    double value;     /* NAN: not measured */
    double low, high; /* 95 % interval over the rounds; NAN: too few of them */
    bool best;        /* best of the builders that are no reference */
    bool tied;        /* not the best, but this run cannot tell it from the best */
} bb_standing;

typedef struct bb_summary_row {
    const char *builder;        /* as in the results, which own the text */
    double run;                 /* number of the run in a merged file */
    char name[BB_SUMMARY_NAME]; /* short, for tables */
    bool reference;
    uint32_t sets; /* ray sets for which it has figures */
    /* it lacks some ray sets: it has no rank, is never best, and its means cover less */
    bool partial;
    bb_standing trace;  /* rate divided by that of the fastest reference, or of the best builder */
    uint32_t yardstick; /* ray sets on which it is the fastest reference, which others are
                         * divided by */
    double mrays_s;     /* geometric mean over its ray sets */
    /* This run cannot tell the builders of a group from its first by their traces. Group 0 is the
     * fastest; UINT32_MAX: no figure. */
    uint32_t group;
    /* The largest part of a build that recurs outside its clock; above a tenth (`leaves_out`) it is
     * never best by its build. */
    double untimed;
    bool leaves_out;
    bb_standing build; /* million primitives per second */
    bb_standing ready; /* the same for build and layout of the kernel that is fastest most often */
    /* Time to image (build + layout + n rays), divided by that of the best builder. */
    bb_standing image[BB_SUMMARY_COUNTS];
    double curve[BB_SUMMARY_CURVE];
    bool curve_first[BB_SUMMARY_CURVE]; /* best there, or tied with the best */
    bb_standing quality;                /* divided by the least of all builders */
    bb_standing overlap;                /* EPO, likewise */
    bb_standing work;  /* counted work per ray, likewise, with the kernel that needs least */
    double tree, peak; /* bytes of the tree, and peak bytes, of the scene that takes most */
    double wrong;      /* wrong rays; failed builds have none; NAN: nothing was judged */
    double checked;    /* rays judged */
    uint32_t failed;   /* builds and cells that failed or were refused */
    char kernel[BB_SUMMARY_NAME]; /* kernel that is fastest most often */
} bb_summary_row;

/* An intersector beside the others on the same rays, trees and kernels. */
typedef struct bb_summary_accuracy {
    const char *intersector;
    double wrong, checked; /* rays */
    double wrong_t;        /* wrong rays with the right primitive at a wrong distance */
    double speed;          /* divided by that of `exact`, geometric mean; NAN: no common cells */
    uint32_t cells;
} bb_summary_accuracy;

/* A simulation of all traces that enter (framework/simulate/): not measured. */
typedef struct bb_summary_simulation {
    const char *name; /* "simt:device=h100,width=32" */
    /* of each row, with its fastest kernel on each ray set, the geometric mean of the bounds; NAN:
     * not of all ray sets, or a reference */
    double *mrays_s;
    bb_binding *binds;  /* of each row: what binds it most often */
    uint32_t sets;      /* ray sets */
    double correlation; /* Kendall's, of the builders' ranks with those measured; NAN: too few */
    double stability;   /* the same with the ranks of the first simulation */
} bb_summary_simulation;

typedef struct bb_sentence {
    char label[24];
    char text[1000];
} bb_sentence;

typedef struct bb_summary {
    bb_summary_row *rows; /* builders by merit, then references by merit */
    uint32_t row_count, builder_count;
    uint32_t scenes, sets; /* scenes and ray sets that enter */
    uint32_t sets_aside;   /* ray sets that too few builders traced to compare them */
    bool sets_differ;      /* two of these sets differ in size or seed alone */
    /* counting rounds of the cell that has fewest; below BB_INTERVAL_ROUNDS ties are not known */
    uint32_t rounds;
    /* ratios of traces are relative to the fastest row of this reference (bb_results_reference());
     * NULL: to the best builder */
    const char *reference;
    /* relative half width of the rates' intervals: median, worst tenth; NAN: not known */
    double noise, noise_worst;
    double checked, wrong; /* answers of all rows that are no reference */
    double distinct;       /* distinct rays among these answers */
    bb_summary_accuracy *accuracy;
    uint32_t accuracy_count;
    bb_summary_simulation simulations[BB_SIMT_MAX];
    uint32_t simulation_count;
    bb_sentence sentences[BB_SUMMARY_SENTENCES];
    uint32_t sentence_count;
} bb_summary;

/* Makes the summary. Its texts belong to the results, which must outlive it. BB_FAILED without
 * memory. */
bb_status bb_summary_make(const bb_results *results, const bb_summary_choice *choice,
                          bb_summary *summary);
void bb_summary_free(bb_summary *summary);

/* Returns the summaries of the whole document and of each choice of a scene and of rays, as JSON
 * for the page. From malloc. NULL without memory. */
char *bb_summary_json(const bb_results *results);

enum { BB_IMPLAUSIBLE = 768 };
/* Writes a warning and returns true if a tree has more than three times the SAH of the sweep's on
 * the same scene (or of the cheapest tree, if the sweep was not run). */
bool bb_summary_implausible(const bb_results *results, char text[BB_IMPLAUSIBLE]);

/* Writes a warning and returns true if other programs kept the machine busy. */
bool bb_summary_busy(const bb_results *results, char text[256]);

#endif
