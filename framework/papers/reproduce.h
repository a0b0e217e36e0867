/* Papers and what becomes of their results here: their experiments are run as ordinary comparisons,
 * and their tables and claims are set beside what was measured.
 *
 * A paper is one constant struct, `const bb_paper bb_paper_NAME`, in framework/papers/paper_NAME.c;
 * CMake finds the file.
 */
#ifndef BB_REPRODUCE_H
#define BB_REPRODUCE_H

#include "framework/bench/bench.h"

#include <stdio.h>

enum { BB_EXPERIMENTS_MAX = 8 }; /* of a paper */

/* One comparison that a paper makes. Lists are by commas, as on the command line. */
typedef struct bb_experiment {
    const char *name;
    const char *builders;
    const char *kernels; /* "" with rays "": builds only */
    const char *rays;
    /* '#' in a name stands for a number of primitives: 10^4, 3*10^4, ... up to what is asked for */
    const char *scenes;
    const char *quick_scenes;
    bool native;       /* what none of the kernels keeps the shape of goes to a native one, too */
    bool takes_scenes; /* scenes that are asked for take the place of these */
    /* of its builders, those with a stage that is not registered are left out (bb_missing_stage())
     */
    bool optional_builders;
    uint32_t width, height; /* of primary rays */
    uint32_t max_rays;
    uint32_t max_views; /* 0: all */
    /* rounds that count; below BB_INTERVAL_ROUNDS no claim on its times is decided */
    uint32_t repeats;
} bb_experiment;

/* What an experiment measured: its builds in the document are those with ids in [first, end). */
typedef struct bb_findings {
    const bb_experiment *experiment;
    bb_results *results;
    uint32_t first, end;
    char **scenes;
    size_t scene_count;
    const char *rays; /* only traces of these are looked at; NULL: of all */
} bb_findings;

typedef struct bb_reproduction bb_reproduction;
typedef struct bb_reproduce_request bb_reproduce_request;

typedef struct bb_paper {
    const char *name;                 /* as the command takes it */
    const char *title;                /* authors, year, title */
    const bb_experiment *experiments; /* ends with name NULL */
    /* Measures what is no comparison of builds and rays, such as pictures of volumes; *wrong:
     * whether answers are. evaluate() gets it, then release(), also after a failure. Optional. */
    bb_status (*measure)(const bb_reproduce_request *request, void **measured, bool *wrong);
    const char *builders;            /* which that needs, by commas */
    void (*release)(void *measured); /* NULL is allowed */
    /* Adds the tables and the claims. `findings`: one per experiment, in order. */
    void (*evaluate)(const bb_findings *findings, const void *measured, bb_reproduction *out);
} bb_paper;

extern const bb_paper *const bb_papers[]; /* generated table; ends with NULL */

/* BB_INVALID with the names there are. */
bb_status bb_paper_find(const char *name, const bb_paper **paper);

/* ---- running ---- */

struct bb_reproduce_request {
    const bb_paper *paper;
    bb_device *device;
    char *const *scenes; /* instead of the experiments' own, where they take any */
    uint32_t scene_count;
    bool quick;       /* small scenes, few rays, two rounds: shows that it works, measures little */
    uint32_t repeats; /* 0: as the experiments say */
    uint64_t max_prims; /* the largest '#' */
    uint64_t seed;
    bool quiet;
};

/* Checks that all builders, kernels and rays that the paper needs are there and take these
 * parameters, and loads no scene. */
bb_status bb_reproduce_check(const bb_reproduce_request *request);

/* Whether a stage of this builder is not registered, here or by a plug-in; `name` gets the first
 * such stage's. False too for a text that is none of a builder. */
bool bb_missing_stage(const char *builder, char *name, size_t capacity);

/* Runs all experiments into `results` and adds the reproduction to it. *outcome as
 * bb_bench_run(). */
bb_status bb_reproduce(const bb_reproduce_request *request, bb_results *results,
                       bb_bench_outcome *outcome);

/* Evaluates what was measured and adds the reproduction to the document. */
bb_status bb_reproduction_add(const bb_paper *paper, const bb_findings *findings,
                              const void *measured, bb_results *results);

/* Prints the reproductions of the document: tables, then claims. */
bb_status bb_reproduction_print(const bb_results *results, FILE *out);

/* ---- for papers: what was measured; NAN, or NULL, where it was not ---- */

/* A build that succeeded. */
const cJSON *bb_found_build(const bb_findings *f, const char *scene, const char *builder);
double bb_found_sah(const bb_findings *f, const char *scene, const char *builder);
double bb_found_build_ms(const bb_findings *f, const char *scene, const char *builder);
/* A figure of the tree: BB_F_TREE_... */
double bb_found_tree(const bb_findings *f, const char *scene, const char *builder,
                     bb_field_id field);
/* The builder's words on its tree; "" if there are none. */
const char *bb_found_about(const bb_findings *f, const char *scene, const char *builder);
double bb_found_phase_ms(const bb_findings *f, const char *scene, const char *builder,
                         const char *phase);
/* Which traces: of one builder, with one kernel, from one view or (NULL) all of them together. */
typedef struct bb_selection {
    const char *scene, *builder, *kernel, *view;
} bb_selection;
double bb_found_trace_ms(const bb_findings *f, bb_selection cell); /* of all rays of the views */
double bb_found_mrays(const bb_findings *f, bb_selection cell);
/* BB_F_TRACE_NODE_TESTS or BB_F_TRACE_PRIM_TESTS, a mean over the views. */
double bb_found_tests(const bb_findings *f, bb_selection cell, bb_field_id tests);
/* Counted work per ray, in the units of the surface area heuristic: 1.2 for each inner node that is
 * visited, 1 for each primitive that is tested. Of kernels on binary nodes, which test the boxes of
 * both children of a node that they visit. */
double bb_found_work(const bb_findings *f, bb_selection cell);

/* Of a cell: the time of its build, of its traces, or of both together. */
typedef enum bb_times { BB_BUILD_TIME, BB_TRACE_TIME, BB_FRAME_TIME } bb_times;
/* Time of `cell` over that of `base` with the same rays, paired by rounds. */
bb_estimate bb_found_ratio(const bb_findings *f, bb_times what, bb_selection cell,
                           bb_selection base);

/* Arithmetic mean of such ratios over scenes or views, taken in each round. A zeroed one is empty.
 */
typedef struct bb_ratio_mean {
    bb_samples sum;
    uint32_t count;
    bool uneven; /* not all have the same rounds */
} bb_ratio_mean;
/* A ratio that was not measured is left out. */
void bb_ratio_mean_add(bb_ratio_mean *mean, const bb_findings *f, bb_times what, bb_selection cell,
                       bb_selection base);
bb_estimate bb_ratio_mean_estimate(const bb_ratio_mean *mean);

/* Time over that of `base`: geometric mean over all scenes, round by round, which noise does not
 * push one way. Not measured if one scene is not. `kernel` may be NULL for build times. */
bb_estimate bb_found_mean_ratio(const bb_findings *f, bb_times what, const char *kernel,
                                const char *builder, const char *base);
/* The same of build times. */
bb_estimate bb_found_build_ratios(const bb_findings *f, const char *builder, const char *base);

/* A figure of the scene or its profile: BB_F_SCENE_PRIMS, BB_F_PROFILE_... */
double bb_found_scene(const bb_findings *f, const char *scene, bb_field_id field);
/* Name of a scene's view by number; "" if there is none. */
const char *bb_found_view(const bb_findings *f, const char *scene, int number);

/* Arithmetic mean of those that are no NAN, as papers average ratios; NAN if none is. */
double bb_mean(const double *values, size_t count);

/* One figure per scene of an experiment. */
enum { BB_FIGURES_MAX = 128 };
typedef struct bb_paper_figures {
    const bb_findings *f;
    double values[BB_FIGURES_MAX];
} bb_paper_figures;

/* Over those that are no NAN; NAN if none is. */
double bb_figures_mean(const bb_paper_figures *s);
double bb_figures_least(const bb_paper_figures *s);
double bb_figures_most(const bb_paper_figures *s);

/* ---- for papers: tables and claims ---- */

/* Texts are copied. None of these fails: if memory has run out, bb_reproduction_add() says so. */

/* Begins a table; columns end with NULL. Behind the 32nd they are recorded, not printed. */
void bb_paper_table(bb_reproduction *r, const char *title, const char *const *columns);
/* Begins a row of the last table, to which the following add a cell each, from the left. */
void bb_paper_row(bb_reproduction *r);
void bb_paper_text(bb_reproduction *r, const char *text);
/* Rounded to so many decimals; NAN becomes an empty cell. */
void bb_paper_number(bb_reproduction *r, double value, int decimals);

/* In rising order of what decides over several that are to hold together. */
typedef enum bb_claim_verdict {
    BB_HELD,
    BB_OPEN,           /* an interval reaches to both sides */
    BB_TOO_FEW_ROUNDS, /* for an interval */
    BB_NOT_TESTED,     /* a figure is missing */
    BB_NOT_HELD,
} bb_claim_verdict;

/* For figures without noise: costs, bytes, tests per ray. BB_NOT_TESTED where one is NAN. */
bb_claim_verdict bb_verdict_of(bool holds, double figure, double other);
/* For times: is the whole interval above, below, between? */
bb_claim_verdict bb_above(bb_estimate e, double bound);
bb_claim_verdict bb_below(bb_estimate e, double bound);
bb_claim_verdict bb_within(bb_estimate e, double least, double most);
/* All together; BB_NOT_TESTED for none. */
bb_claim_verdict bb_all(const bb_claim_verdict *each, size_t count);
/* More than half of those that were tested. */
bb_claim_verdict bb_most(const bb_claim_verdict *each, size_t count);
/* As the record says it: "held", "undecided: too few rounds" ... */
const char *bb_verdict_words(bb_claim_verdict verdict);

/* A text that grows; what does not fit is left out. A zeroed one is empty. */
typedef struct bb_words {
    char text[4000];
    size_t length;
} bb_words;
__attribute__((format(printf, 2, 3))) void bb_say(bb_words *words, const char *format, ...);

/* "WHAT 0.83 on average, 0.56 (city) to 1.02 (scorpion)", after "; " if there is something before
 * it. */
void bb_say_range(bb_words *words, const char *what, const bb_paper_figures *s);

/* "1.20 [95 %: 1.10 to 1.30]", with the range, or without brackets, where there is no interval. */
void bb_say_estimate(bb_words *words, bb_estimate e);

/* Adds a claim: the paper's statement, shortened, with any threshold that `verdict` rests on; the
 * paper's figures ("" for none), ours, and figures of the same run that say why ("": none). The
 * record has the verdict as held, not held, or undecided with the reason. */
void bb_claim(bb_reproduction *r, bb_claim_verdict verdict, const char *claim, const char *paper,
              const bb_words *ours, const bb_words *why);

#endif
