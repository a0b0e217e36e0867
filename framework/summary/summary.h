/* What a result document says about its builders: one row each, over all scenes and ray sets or
 * over a choice of them.
 *
 * Means over scenes and ray sets are geometric, of ratios between builders on the same rays. A
 * builder's kernel is its fastest whose answers are right, on each ray set by itself. Only cells
 * with the intersector `exact` enter; what the others say of speed and accuracy is summed up apart
 * (bb_summary_accuracy). Whether two builders can be told apart is decided round by round: the
 * mean of their ratio in each round, and the 95 % interval of its median over the rounds.
 */
#ifndef BB_SUMMARY_H
#define BB_SUMMARY_H

#include "framework/record/record.h"

enum {
    BB_SUMMARY_COUNTS = 6,     /* numbers of rays of which rows have the time to image */
    BB_SUMMARY_CURVE = 45,     /* of a curve over numbers of rays */
    BB_SUMMARY_SENTENCES = 16, /* at most */
    BB_SUMMARY_NAME = 64,
};

/* 10^5, 10^6 ... 10^10 rays. */
extern const double bb_summary_counts[BB_SUMMARY_COUNTS];
/* From the first ray to 10^11, four to a power of ten. */
double bb_summary_curve_count(uint32_t i);

/* Which cells enter. */
typedef struct bb_summary_choice {
    const char *scene; /* NULL: all */
    const char *rays;  /* as in the file; NULL: all */
} bb_summary_choice;

/* A figure of a row. */
typedef struct bb_standing {
    double value;     /* NAN: not measured */
    double low, high; /* 95 % interval over the rounds; NAN: too few of them */
    bool best;        /* among the builders that are no reference */
    bool tied;        /* not the best, and this run cannot tell it from the best */
} bb_standing;

typedef struct bb_summary_row {
    const char *builder;        /* as in the file, whose it is */
    double run;                 /* of a merged file */
    char name[BB_SUMMARY_NAME]; /* short, for tables */
    bool reference;
    uint32_t sets; /* that it has figures of */
    bool
        partial; /* it lacks some of those that enter: no rank, never best, its means are of less */
    bb_standing trace; /* rate by that of the fastest reference, or of the best builder */
    double mrays_s;    /* geometric mean over its ray sets */
    /* Builders of one group cannot be told from its first by their traces. Groups count from 0,
     * from the fastest; UINT32_MAX: no figure. */
    uint32_t group;
    bb_standing build; /* million primitives per second */
    bb_standing ready; /* the same of build and layout, of the kernel that is fastest most often */
    /* Time to image, build + layout + n rays, by that of the best builder. */
    bb_standing image[BB_SUMMARY_COUNTS];
    double curve[BB_SUMMARY_CURVE];
    bool curve_first[BB_SUMMARY_CURVE]; /* best there, or not to be told from the best */
    bb_standing quality;                /* by the least of all builders */
    bb_standing overlap;                /* EPO, likewise */
    bb_standing work;                   /* counted work per ray, likewise; by the kernel of least */
    double peak;                        /* bytes, of the scene that takes most */
    double wrong;    /* rays, and builds that failed count as none; NAN: nothing was judged */
    double checked;  /* rays judged */
    uint32_t failed; /* builds and cells that failed or were refused */
    char kernel[BB_SUMMARY_NAME]; /* that is fastest most often */
} bb_summary_row;

/* An intersector beside the others on the same rays, trees and kernels. */
typedef struct bb_summary_accuracy {
    const char *intersector;
    double wrong, checked; /* rays */
    double wrong_t;        /* of the wrong ones: the right primitive at a wrong distance */
    double speed;          /* by that of `exact`, geometric mean; NAN: not beside it */
    uint32_t cells;
} bb_summary_accuracy;

typedef struct bb_sentence {
    char label[24];
    char text[1000];
} bb_sentence;

typedef struct bb_summary {
    bb_summary_row *rows; /* builders by merit, then references by merit */
    uint32_t row_count, builder_count;
    uint32_t scenes, sets; /* that enter */
    uint32_t sets_aside;   /* ray sets that too few builders traced to compare them */
    uint32_t
        rounds; /* that count, the fewest of a cell; below BB_INTERVAL_ROUNDS no ties are known */
    /* ratios of traces are to the fastest row of this (bb_results_reference()); NULL: to that of
     * the best builder */
    const char *reference;
    double noise,
        noise_worst; /* half width of a rate's interval by the rate: median, worst tenth; NAN */
    double checked, wrong; /* answers of all rows that are no reference */
    double distinct;       /* rays that these answered, each counted once */
    bb_summary_accuracy *accuracy;
    uint32_t accuracy_count;
    bb_sentence sentences[BB_SUMMARY_SENTENCES];
    uint32_t sentence_count;
} bb_summary;

/* The texts of rows are the document's: it has to outlive the summary. BB_FAILED without memory. */
bb_status bb_summary_make(const bb_results *results, const bb_summary_choice *choice,
                          bb_summary *summary);
void bb_summary_free(bb_summary *summary);

/* The summaries of everything and of each choice of a scene and of rays, for the page. For
 * cJSON_free(); NULL without memory. */
char *bb_summary_json(const bb_results *results);

enum { BB_IMPLAUSIBLE = 768 };
/* Trees of more than three times the SAH of the sweep on the same scene (where it was not run: of
 * the cheapest tree): a line that warns, or false. */
bool bb_summary_implausible(const bb_results *results, char text[BB_IMPLAUSIBLE]);

/* How busy the machine was with other work: a line that warns, or false. */
bool bb_summary_busy(const bb_results *results, char text[256]);

#endif
