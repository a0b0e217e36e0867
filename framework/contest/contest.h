/* Builders and searches against each other on one task: trees and layouts are made, all are asked
 * the same and their answers compared, then all are measured in turns.
 *
 * A task asks questions, such as pictures of several views or slices at several heights, of items,
 * such as pixels; the answer of a question is so many bytes for each item.
 */
#ifndef BB_CONTEST_H
#define BB_CONTEST_H

#include "framework/base/statistics.h"
#include "framework/builder/instance.h"
#include "traversal/traversal.h"

enum { BB_CONTEST_WAYS_MAX = 64, BB_CONTEST_SCENES_MAX = 2 };

/* A phase of a build. */
typedef struct bb_contest_phase {
    char name[48];
    bb_samples ms;
} bb_contest_phase;

/* A builder with a search, or no tree. Times in ms; of answers the mean over all questions, or
 * their sum, in each round. Of several scenes, sums. */
typedef struct bb_contest_way {
    const char *builder, *search; /* the request's; "": no tree */
    char refused[320];            /* why there are no figures; "": there are */
    /* layout: with the transfer of a tree that was made on the host */
    bb_samples build, layout, answer, answer_cpu;
    uint32_t phase_count;
    bb_contest_phase phases[BB_PHASES_MAX];
    uint32_t nodes, leaves;
    uint32_t references;
    uint64_t tree_bytes;
    uint64_t bytes;      /* of trees and scratch at most, and of layouts */
    double visits, work; /* nodes and primitives of bb_count, per item */
    double most;         /* what compare() makes of differences from the base, */
    uint32_t most_8;     /* in 8 bits */
    uint64_t differ;     /* items whose answers differ at all */
    uint64_t overflown;  /* items for which a stack was too small */
} bb_contest_way;

/* A way at work: per scene a tree, its layout and what makes that. */
typedef struct bb_contest_runner {
    bb_contest_way *way;
    uint32_t leaf; /* most references in one, of layouts */
    bb_layout_maker makers[BB_CONTEST_SCENES_MAX];
    bb_layout_data layouts[BB_CONTEST_SCENES_MAX];
    bb_tracer *tracers[2]; /* the task's to fill: not counting, counting */
    bool by_boundary;      /* the task's to fill: flags of the boundary are used */
} bb_contest_runner;

/* What is asked. Functions return BB_UNSUPPORTED or BB_REFUSED in make() for what the way cannot
 * do; all other failures end the contest. */
typedef struct bb_contest_task {
    void *self;
    bool without; /* there is a way without a tree, the first: ask() gets NULL */
    bool summed;  /* the questions make one answer, whose times are added up */
    bool blank;   /* there is nothing to build over: trees are empty, and answers are these */
    const void *blank_answer;
    size_t answer_bytes; /* of an item */
    uint32_t questions;
    bb_buffer *answers, *counts; /* on the device; the latter of bb_count */
    /* Makes a question ready, and says how many items it has. */
    bb_status (*take)(void *self, uint32_t question, uint32_t *items);
    /* Makes layouts and programs of a way, whose trees are on the device. */
    bb_status (*make)(void *self, const char *search, bb_tree *const *trees,
                      bb_contest_runner *runner);
    /* Enqueues the question; with `counting`, its counts too. */
    bb_status (*ask)(void *self, const bb_contest_runner *runner, bool counting);
    /* Adds to what the way has of differences beside `differ`. Optional. */
    void (*compare)(void *self, const void *first, const void *own, uint32_t items,
                    bb_contest_way *way);
    /* Looks at the answer of the first way. Optional. */
    bb_status (*see)(void *self, uint32_t question, const void *first, uint32_t items);
    /* Whether what builders were handed is as it was. Optional. */
    bb_status (*check)(void *self);
    /* Measures in each round what belongs to no way. Optional. */
    bb_status (*time)(void *self);
} bb_contest_task;

typedef struct bb_contest_request {
    bb_device *device;
    bb_scene *const *scenes; /* on the device */
    uint32_t scene_count;
    const char *const *builders; /* specifications */
    uint32_t builder_count;
    const char *const *searches;
    uint32_t search_count;
    uint32_t most_items; /* of a question */
    uint32_t repeats;    /* rounds that count, after one that does not */
    uint64_t seed;
    bool quiet; /* no progress */
} bb_contest_request;

typedef struct bb_contest bb_contest;

/* Makes trees and layouts. `ways` (BB_CONTEST_WAYS_MAX) and the task outlive the contest, and the
 * texts of the request the ways; the task gets its questions later. Owned by the caller. */
bb_status bb_contest_create(const bb_contest_request *request, const bb_contest_task *task,
                            bb_contest_way *ways, uint32_t *way_count, bb_contest **out);
void bb_contest_destroy(bb_contest *contest); /* NULL is allowed */

/* Compares all answers, then measures. Interrupted after a round that counts, it ends with the
 * rounds that there are; before that it fails. */
bb_status bb_contest_run(bb_contest *contest);

/* The first way that has a tree and is not refused; NULL: none. */
const bb_contest_runner *bb_contest_first(const bb_contest *contest);

#endif
