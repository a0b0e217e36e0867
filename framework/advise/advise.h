/* `bvhbench advise` finds the least configuration of builder, kernel and intersector for a scene.
 *
 *   scout    tries kernels, intersectors and builders on a sample, and removes parts that are far
 *            too slow and pairs that are wrong too often (scouts.h)
 *   race     measures the rest in heats with more and more rays (race.h)
 *   choice   takes the least of those that are accurate enough and within 5 % of the fastest
 *            (leastness.h)
 *   savings  compares the choice with generous settings
 *   search   on request, measures all contenders with the rays of the last heat
 *
 * Each step is an ordinary comparison (bb_bench_run()). The caller gets the results of the last
 * one, and the advice as a table.
 */
#ifndef BB_ADVISE_H
#define BB_ADVISE_H

#include "framework/advise/contenders.h"
#include "framework/bench/bench.h"
#include "framework/table/outline.h"

typedef struct bb_advise_request {
    bb_device *device;
    const char *scene;
    bb_tried builders, kernels, intersectors; /* to try, in order */
    char *const *rays;                        /* kinds of rays */
    uint32_t ray_count;
    double image_rays;      /* rays of an image, all kinds together */
    double max_wrong_ppm;   /* tolerated rate of wrong rays */
    uint32_t width, height; /* primary rays of the last heat; earlier heats have fewer */
    uint32_t max_rays;      /* the same for each sampled kind */
    uint32_t max_views;     /* 0: all views of the scene */
    uint32_t repeats;       /* rounds of the last heat, at least 6 */
    double memory;          /* bytes for trees, scratch and layouts at a time */
    /* Simulations by which the least is found, too, apart from all that is measured; and the
     * kernels for that, which simulations have bounds for */
    char *const *metrics;
    const bb_simt *simts; /* the same, read */
    uint32_t simt_count;
    bb_tried simulated_kernels;
    bool quick; /* leaves out one heat */
    bool exhaustive;
    bool quiet;
    uint64_t seed;
    const char *command; /* the command line */
    const char *further; /* more options for the command that measures the choice again, each after
                            a blank and quoted for a shell; "": none */
} bb_advise_request;

/* Checks names and parameters before the scene is loaded. */
bb_status bb_advise_check(const bb_advise_request *request);

/* Advises. `results`, empty at first, gets the last comparison, and `outcome` is that comparison's.
 * `table` gets the advice, or no row if an interrupt came before any measurement. *found is false
 * if no contender is accurate enough; the table has their figures then, too. */
bb_status bb_advise(const bb_advise_request *request, bb_results *results,
                    bb_bench_outcome *outcome, bb_table *table, bool *found);

/* The page of the table. The second outline is for the terminal and shows fewer rows of each view.
 */
extern const bb_page_outline bb_advise_outline, bb_advise_outline_briefly;

#endif
