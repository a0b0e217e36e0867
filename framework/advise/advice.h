/* What was found out on the way to an advice, and how it gets into a table. */
#ifndef BB_ADVICE_H
#define BB_ADVICE_H

#include "framework/advise/advise.h"
#include "framework/advise/figures.h"
#include "framework/advise/race.h"

enum { BB_SAVINGS_MAX = 5, BB_NONE_CHOSEN = UINT32_MAX };

/* What is within 5 % of the fastest does the same. */
#define BB_ADVISE_SLACK 1.05
/* On another tree a kernel may do so much better, or worse, beside another one. */
#define BB_SCOUT_SLACK (1.25 * BB_ADVISE_SLACK)
/* A contender may do so much better, or worse, than what others took, or a sample, foretells. */
#define BB_FORETOLD_SLACK (1.6 * BB_SCOUT_SLACK)

/* A scene that is measured on, or a sample of its primitives. */
typedef struct bb_ground {
    bb_scene *scene;
    bb_oracle *oracle;
    double factor; /* of how many primitives of the whole each one stands for */
} bb_ground;

/* Contenders with their race and their last figures. `racers` is as long as `who`. */
typedef struct bb_entered {
    bb_contender *who;
    bb_racer *racers;
    bb_tried_figures *figures;
    uint32_t count;
} bb_entered;

/* What contenders take in memory, as scouts found it: of kernels, of builders. */
typedef struct bb_sizes {
    const bb_entered *scouts[2];
    double room; /* bytes for trees, scratch and layouts at a time */
} bb_sizes;

/* What an advice takes. */
typedef struct bb_takings {
    double seconds;
    double host_bytes,
        device_bytes;  /* at their peak; what is on a CPU's device is the host's too */
    double held_bytes; /* of these, by trees, scratch and layouts */
} bb_takings;

#define BB_EXACTNESS "exactness"

/* The choice with one setting replaced by a generous one. */
typedef struct bb_saving {
    const char *what;       /* "builder", "stack", "kinds", "all of these", BB_EXACTNESS */
    char was[32], kept[32]; /* the setting: of the choice, and in its place */
    char builder[600], kernel[600], intersector[64];
    double wrong, checked; /* rays */
    double bytes;          /* more than the choice */
    bb_samples ms;         /* likewise, paired by rounds */
    bool measured;
    char reason[256]; /* why not */
} bb_saving;

typedef struct bb_advice {
    const bb_advise_request *request;
    const bb_entry *scene; /* its entry, in the first document of the whole scene; NULL: none yet */
    bb_ground whole, sample; /* the same where there are few primitives */
    bb_entered scouts;       /* kernels and intersectors, on one builder's trees of the sample */
    bb_entered builders;     /* builders, by one kernel, on the sample */
    double scout_slack;      /* by which they drop */
    uint32_t unlikely;       /* how many bb_scouts_keep_likely() left out */
    bb_sizes sizes;
    bb_takings foretold, taken;
    const char *preliminary; /* what was measured last when it was interrupted; NULL: it was not */
    bb_entered field;
    uint32_t best, choice; /* of the field; BB_NONE_CHOSEN */
    uint32_t within;       /* how many are within 5 % of the best */
    uint32_t heats;
    bb_saving savings[BB_SAVINGS_MAX];
    uint32_t saving_count;
    bb_entered all; /* of the exhaustive search; count 0: none */
    uint32_t all_best, all_least, all_choice;
} bb_advice;

/* Chooses among those of a last heat: *best the fastest by pairs that is not out, *least the least
 * within the slack of it, *within how many are. BB_NONE_CHOSEN for both if all are out. */
void bb_choose_least(const bb_entered *field, uint32_t *best, uint32_t *least, uint32_t *within);

/* Sets best, choice and within from the field. */
void bb_choose(bb_advice *advice);

/* The same after an interrupt, from what was measured before it: the field, else the scouts, which
 * become the field. Nothing is chosen if nothing was measured. */
void bb_choose_preliminary(bb_advice *advice);

/* What becomes of a contender. The first ones are the states of its racer, in their order. */
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

/* Fills a table, whose run has a row, with rows of the scene, of its decisions, of each contender
 * and of each saving. README.md has its columns. */
bb_status bb_advice_fill(const bb_advice *advice, bb_table *table);

#endif
