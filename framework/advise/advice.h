/* The findings of an advice, and the table of them. */
#ifndef BB_ADVICE_H
#define BB_ADVICE_H

#include "framework/advise/advise.h"
#include "framework/advise/figures.h"
#include "framework/advise/race.h"

enum { BB_SAVINGS_MAX = 5, BB_NONE_CHOSEN = UINT32_MAX };

/* Contenders within 5 % of the fastest count as equally fast. */
#define BB_ADVISE_SLACK 1.05
/* The ratio of two kernels may differ by 1.25 from tree to tree. */
#define BB_SCOUT_SLACK (1.25 * BB_ADVISE_SLACK)
/* Times may differ by 1.6 from those predicted from a sample or from other contenders. */
#define BB_FORETOLD_SLACK (1.6 * BB_SCOUT_SLACK)

/* A scene to measure on, or a sample of its primitives. */
typedef struct bb_ground {
    bb_scene *scene;
    bb_oracle *oracle;
    double factor; /* primitives of the whole scene per primitive here */
} bb_ground;

/* Contenders with their racers and their last figures, in arrays of `count`. */
typedef struct bb_entered {
    bb_contender *who;
    bb_racer *racers;
    bb_tried_figures *figures;
    uint32_t count;
} bb_entered;

/* Memory of contenders, as measured by the scouts. */
typedef struct bb_sizes {
    const bb_entered *scouts[2]; /* of kernels, of builders */
    double room;                 /* bytes for trees, scratch and layouts at a time */
} bb_sizes;

/* Time and memory of an advice. */
typedef struct bb_takings {
    double seconds;
    double host_bytes, device_bytes; /* peaks; those of a CPU's device are part of the host's */
    double held_bytes;               /* the part of trees, scratch and layouts */
} bb_takings;

#define BB_EXACTNESS "exactness"
#define BB_BY_SIMULATION "race, simulated"

/* The choice with one setting replaced by a generous value. */
typedef struct bb_saving {
    const char *what;       /* "builder", "stack", "kinds", "all of these", BB_EXACTNESS */
    char was[32], kept[32]; /* the choice's value, the generous value */
    char builder[600], kernel[600], intersector[64];
    double wrong, checked; /* rays */
    double bytes;          /* more than the choice */
    bb_samples ms;         /* likewise, paired by rounds */
    bool measured;
    char reason[256]; /* why not */
} bb_saving;

/* The least by a simulation, from a course of its own, in which nothing is measured. */
typedef struct bb_simulated_advice {
    char name[80];       /* of the simulation: "simt:device=h100,width=32" */
    bb_entered kernels;  /* scouts: all kernels with one builder */
    bb_entered builders; /* likewise: all builders with one kernel */
    bb_entered field;    /* the pairs that they left; its count is 0 if it was interrupted */
    uint32_t best, choice, within; /* as in bb_advice */
} bb_simulated_advice;

typedef struct bb_advice {
    const bb_advise_request *request;
    const bb_entry *scene;   /* in the first document of the whole scene; NULL: none yet */
    bb_ground whole, sample; /* the same for scenes of few primitives */
    bb_entered scouts;       /* kernels and intersectors with one builder, on the sample */
    bb_entered builders;     /* builders with one kernel, on the sample */
    double scout_slack;      /* the slack of both */
    uint32_t unlikely;       /* number that bb_scouts_keep_likely() left out */
    bb_sizes sizes;
    bb_takings foretold, taken;
    const char *preliminary; /* the last measurement before an interrupt; NULL: not interrupted */
    bb_entered field;
    uint32_t best, choice; /* indices into the field, or BB_NONE_CHOSEN */
    uint32_t within;       /* number within 5 % of the best */
    uint32_t heats;
    bb_saving savings[BB_SAVINGS_MAX];
    uint32_t saving_count;
    bb_simulated_advice simulated[BB_SIMT_MAX];
    uint32_t simulated_count; /* those that were not interrupted */
    bb_entered all;           /* the exhaustive search; its count is 0 without one */
    uint32_t all_best, all_least, all_choice;
} bb_advice;

/* Chooses from a last heat. *best: the fastest by pairs that is still in. *least: the least within
 * the slack of *best. *within: how many are within it. Both are BB_NONE_CHOSEN if none is in. */
void bb_choose_least(const bb_entered *field, uint32_t *best, uint32_t *least, uint32_t *within);

/* Sets best, choice and within of the field. */
void bb_choose(bb_advice *advice);

/* Does the same after an interrupt. If the field was not measured, the scouts take its place.
 * Chooses nothing if nothing was measured. */
void bb_choose_preliminary(bb_advice *advice);

/* The fate of a contender. The first four are the states of its racer (bb_racer_state). */
enum {
    BB_RACED,
    BB_WAS_SLOW,
    BB_WAS_WRONG,
    BB_WAS_NOT_RUN,
    BB_CHOSEN,
    BB_MORE_THAN_NEEDED,
    BB_SLOWER,
    BB_FATES
};
extern const char *const bb_fates[BB_FATES]; /* in words */

/* Fills a table with rows for the scene, its decisions, each contender and each saving. README.md
 * describes the rows. */
bb_status bb_advice_fill(const bb_advice *advice, bb_table *table);

#endif
