/* `bvhbench advise`: the least configuration of builder, kernel and intersector that a scene needs.
 *
 *   scout    kernels and intersectors are tried on one builder's trees; kernels and intersectors
 *            that are far too slow there, and pairs that are wrong too often, are tried no further
 *            (scouts.h)
 *   race     what is left is tried with all builders, in heats with more and more rays (race.h)
 *   choice   of those that are not wrong too often and within 5 % of the fastest, the least
 *            (leastness.h)
 *   savings  the choice beside itself with one generous setting in place of what the scene asked
 *            for, all of them interleaved
 *   search   if asked for: everything that was ever tried, with as many rays as the last heat, to
 *            see how far the choice is from the best
 *
 * Each is an ordinary comparison (bb_bench_run()); the results that are handed back are those of
 * the last one. The advice is a table.
 */
#ifndef BB_ADVISE_H
#define BB_ADVISE_H

#include "framework/advise/contenders.h"
#include "framework/bench/bench.h"
#include "framework/show/outline.h"

typedef struct bb_advise_request {
    bb_device *device;
    const char *scene;
    bb_tried builders, kernels, intersectors; /* what is tried, in order */
    char *const *rays;                        /* kinds of rays */
    uint32_t ray_count;
    double image_rays;      /* for which the time to image is asked, all kinds together */
    double max_wrong_ppm;   /* that is tolerated */
    uint32_t width, height; /* of primary rays in the last heat; fewer before */
    uint32_t max_rays;      /* likewise, of a kind that samples */
    uint32_t max_views;     /* of the scene; 0: all */
    uint32_t repeats;       /* rounds of the last heat; 6 or more, or nothing can be dropped */
    double memory;          /* bytes for trees, scratch and layouts at a time */
    bool quick;             /* one heat less */
    bool exhaustive;
    bool quiet;
    uint64_t seed;
    const char *command; /* the command line */
    const char *further; /* options for the command that measures the choice again, each after a
                            blank and quoted for a shell; "": none */
} bb_advise_request;

/* Checks the names and parameters before anything is loaded. */
bb_status bb_advise_check(const bb_advise_request *request);

/* Advises. `results`: an empty document; `outcome`: of the comparison that is in it. `table` gets
 * the rows of the scene, none if an interrupt came before anything was measured. *found: false if
 * nothing that was tried is within the limit; then the table says how far off it was. */
bb_status bb_advise(const bb_advise_request *request, bb_results *results,
                    bb_bench_outcome *outcome, bb_table *table, bool *found);

/* The page of such a table; the second one is for the terminal, with fewer rows of each view. */
extern const bb_page_outline bb_advise_outline, bb_advise_outline_briefly;

#endif
