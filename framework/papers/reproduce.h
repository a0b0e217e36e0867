/* Papers and what becomes of their results here: their experiments are run as ordinary comparisons,
 * and their tables and claims are set beside what was measured.
 *
 * A paper is one constant struct, `const bb_paper bb_paper_NAME`, in framework/papers/paper_NAME.c;
 * CMake finds the file.
 */
#ifndef BB_REPRODUCE_H
#define BB_REPRODUCE_H

#include "framework/bench/bench.h"
#include "framework/bench/contest.h"
#include "framework/papers/figures.h"
#include "framework/table/page.h"

#include <stdio.h>

enum { BB_EXPERIMENTS_MAX = 8 }; /* of a paper */

/* One comparison that a paper makes. Lists are by commas, as on the command line. */
typedef struct bb_experiment {
    const char *name;
    const char *builders;
    const bb_paper_entrant *entrants; /* more builders; NULL: none */
    const char *fills;                /* each of them with these, by spaces, for its '$' */
    const char *kernels;              /* "" with rays "": builds only */
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

typedef struct bb_reproduction bb_reproduction;
typedef struct bb_reproduce_request bb_reproduce_request;

typedef struct bb_paper {
    const char *name;                 /* as the command takes it */
    const char *title;                /* authors, year, title */
    const bb_experiment *experiments; /* ends with name NULL; NULL: none */
    const bb_paper_table *tables;     /* ends with title NULL */
    const bb_paper_claim *claims[2];  /* each ends with text NULL */
    /* Instead of experiments: measures what is no comparison of builds and rays, such as pictures
     * of volumes, into tables that are there. *wrong: whether answers are. */
    bb_status (*measure)(const bb_reproduce_request *request, bb_findings *findings, bool *wrong);
    const char *builders; /* which that needs, by commas */
    const char *metrics;  /* simulations, by commas, if none are asked for; NULL: none */
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
    bool full_size;   /* pictures and slices of the paper's size */
    uint32_t repeats; /* 0: as the experiments say */
    uint64_t max_prims;   /* the largest '#' */
    char *const *metrics; /* simulations, by which claims on times are judged once more */
    const bb_simt *simts; /* the same, read */
    uint32_t simt_count;
    uint64_t seed;
    bool quiet;
    bb_audit *audit;      /* gets all timings of measure(); NULL: none is asked for */
    bb_bystanders *watch; /* of other programs, for measure(); NULL: nobody is warned */
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

/* Evaluates what was measured, one for each experiment, and adds the reproduction to the results.
 */
bb_status bb_reproduction_add(const bb_paper *paper, const bb_findings *findings,
                              bb_results *results);

/* Puts the reproductions of the results on a page: tables, then claims. */
void bb_reproduction_show(const bb_results *results, bb_page *page);
/* Prints them. */
bb_status bb_reproduction_print(const bb_results *results, FILE *out);

/* Adds what a comparison measured to the table: builds with ids from `first` on, all scenes. */
bb_status bb_paper_measured(const bb_results *results, uint32_t first, bb_findings *f);

/* Puts simulated answers of contests into the rows of their ways. */
void bb_paper_add_simulated_answers(bb_findings *f);

/* ---- for measure() ---- */

/* Rounds that are asked for; `usual` if none are. */
uint32_t bb_paper_rounds(const bb_reproduce_request *request, uint32_t usual);
/* A contest of 7 rounds, unless others are asked for; builders and searches are left to fill in. */
bb_contest_request bb_paper_contest(const bb_reproduce_request *request, const char *name);
/* Adds a scene to what was measured; a byte of its name that is no UTF-8 becomes %XX. */
bb_status bb_paper_add_scene(bb_findings *f, const char *name);

/* Fills tables and judges claims. */
void bb_paper_add_tables(const bb_paper_table *tables, const bb_findings *all, bb_reproduction *r);
/* `simulated`: as in bb_paper_place; then only claims on times that it has. */
void bb_paper_add_claims(const bb_paper_claim *claims, const bb_findings *all, uint32_t simulated,
                         bb_reproduction *r);

/* ---- for papers: tables and claims ---- */

/* Texts are copied. None of these fails: if memory has run out, bb_reproduction_add() says so. */

/* Begins a table; columns end with NULL. Behind the 32nd they are recorded, not printed. */
void bb_paper_table_begin(bb_reproduction *r, const char *title, const char *const *columns);
/* Begins a row of the last table, to which the following add a cell each, from the left. */
void bb_paper_row(bb_reproduction *r);
void bb_paper_text(bb_reproduction *r, const char *text);
/* Rounded to so many decimals; NAN becomes an empty cell. */
void bb_paper_number(bb_reproduction *r, double value, int decimals);

/* Adds a claim: the paper's statement, shortened; the paper's figures ("" for none); by which
 * simulation it was judged (0: by what was measured); and what is said of it here. */
void bb_claim(bb_reproduction *r, const char *claim, const char *paper, uint32_t simulated,
              const bb_said *said);

#endif
