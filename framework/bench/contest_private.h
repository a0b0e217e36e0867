/* What the parts of a contest share: contest_make.c, contest_simulate.c, and above them
 * contest.c. */
#ifndef BB_CONTEST_PRIVATE_H
#define BB_CONTEST_PRIVATE_H

#include "framework/bench/contest.h"
#include "framework/bench/turns.h"

/* A search, or a kernel, and the index of the layout that it reads. */
typedef struct bb_contest_search_choice {
    bb_spec spec;
    const bb_kernel *kernel;    /* NULL: searches tetrahedra */
    uint32_t layout, simulated; /* the same to be simulated: of the tree in preorder */
} bb_contest_search_choice;

/* A builder: per scene its tree. */
typedef struct bb_contest_entrant {
    bb_resident *trees;
    uint32_t tree_count;
    bb_contest_runner *runners; /* one per choice */
    const bb_contest_search_choice *choices;
    uint32_t choice_count;
} bb_contest_entrant;

/* How many ways the request has, with the one without a tree. */
uint32_t bb_contest_count_ways(const bb_contest_request *request);

typedef struct bb_contest {
    const bb_contest_request *request;
    const bb_contest_task *task;
    bb_contest_way ways[BB_CONTEST_WAYS_MAX];
    bb_contest_runner runners[BB_CONTEST_WAYS_MAX]; /* of all ways */
    uint32_t way_count, first;                      /* way with a tree */
    bb_contest_entrant *entrants;
    bb_contest_search_choice *choices; /* searches, then kernels of faces */
    bb_residency residency;            /* scene by scene of each builder */
    uint32_t base;                     /* the way that others are compared with */
    uint32_t repeats;                  /* the request's, or those that fit into its time */
    unsigned char *without, *with;
    bb_count *counts;
    bb_buffer d_answers, d_counts;
    bb_random random;  /* of the orders of rounds */
    uint64_t items;    /* of all questions */
    bb_audit *audit;   /* the request's, or the next */
    bb_audit no_audit; /* nobody asks for it */
} bb_contest;

/* Makes trees, layouts and programs of all ways, and chooses the base. */
bb_status bb_contest_make(bb_contest *contest);

/* Simulates all ways on the present question, of so many items, whose answers by the base are in
 * contest->without. */
bb_status bb_contest_simulate(bb_contest *contest, uint32_t items);
void bb_contest_clean_up(bb_contest *contest);

/* Keeps the builder's trees of all scenes beside each other, until another builder's are pinned. */
void bb_contest_pin(bb_contest *contest, const bb_contest_entrant *entrant);

/* Sees to it that an entrant's trees are on the device, with this layout. */
bb_status bb_contest_bring(bb_contest *contest, const bb_contest_entrant *entrant, uint32_t layout);

#endif
