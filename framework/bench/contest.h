/* Builders and searches against each other on one task: trees and layouts are made, all are asked
 * the same and their answers compared, then all are measured in turns.
 *
 * A task asks questions, such as pictures of several views or slices at several heights, of items,
 * such as pixels; the answer of a question is so many bytes for each item.
 */
#ifndef BB_CONTEST_H
#define BB_CONTEST_H

#include "framework/bench/audit.h"
#include "framework/bench/contest_table.h"
#include "framework/bench/resident.h"
#include "framework/bench/tet_search.h"
#include "framework/simulate/simulate.h"
#include "traversal/traversal.h"

enum { BB_CONTEST_SCENES_MAX = 2 };

/* What all contests are asked for. */
typedef struct bb_contest_request {
    bb_device *device;
    const char *name;            /* the scene's name in the table */
    const char *const *builders; /* specifications */
    uint32_t builder_count;
    const char *const *searches; /* bb_tet_search_parse(); of volumes, kernels */
    uint32_t search_count;
    const char *const *kernels; /* of builders over faces: "faces/lbvh" */
    uint32_t kernel_count;
    bool without;     /* also without a tree; the others are compared with this way */
    uint32_t repeats; /* rounds that count, after one that does not */
    double ends_ms;   /* bb_wall_ms() at which they are to end: then there are fewer; 0: any time */
    uint64_t seed;
    bool quiet;           /* no progress */
    const char *pictures; /* the beginning of paths of pictures; NULL: none are written */
    const char *files;    /* the beginning of their names, from the table's folder */
    bb_audit *audit;      /* gets all timings; NULL: none is asked for */
    bb_bystanders *watch; /* of other programs; NULL: nobody is warned */
    const bb_simt *simts; /* simulations of each way's answer to the first question */
    uint32_t simt_count;
} bb_contest_request;

/* A way at work: per scene a tree with its layout; without a tree, a list. */
typedef struct bb_contest_runner {
    bb_contest_way *way;
    bool without;            /* there is no tree */
    const bb_layout *layout; /* NULL without a tree */
    const bb_layout_data *data[BB_CONTEST_SCENES_MAX];
    bb_buffer lists[BB_CONTEST_SCENES_MAX];
    const bb_kernel *kernel; /* that traces, by its specification; NULL: a search */
    const bb_spec *spec;
    bb_traverser *traversers[2]; /* the task's to fill: not counting, counting; NULL: a search */
    bool by_boundary;            /* flags of the boundary are used */
    uint32_t entrant, choice;    /* the contest's own */
} bb_contest_runner;

/* Answers on the device; `counts` (bb_count) is NULL if they are not asked for. */
typedef struct bb_contest_answers {
    bb_buffer *items, *counts;
    const bb_recording *recording; /* steps are recorded, and counted; NULL: they are not */
} bb_contest_answers;

/* What is asked. Functions return BB_UNSUPPORTED or BB_REFUSED in compile() for what the way cannot
 * do; all other failures end the contest. */
typedef struct bb_contest_task {
    void *self;
    bb_scene *const *scenes; /* on the device */
    uint32_t scene_count;
    bb_scene *faces;     /* what builders named "faces/..." build over; NULL: there is none */
    uint64_t face_bytes; /* that an answer by faces reads beside the layout */
    bool summed;         /* the questions make one answer, whose times are added up */
    bool light; /* answers are bb_light: primitives tested are samples, and compare() is there */
    bool blank; /* there is nothing to build over: trees are empty, and answers are these */
    const void *blank_answer;
    size_t answer_bytes; /* of an item */
    uint32_t most_items; /* of a question */
    uint32_t questions;
    /* Makes a question ready, and says how many items it has. */
    bb_status (*take)(void *self, uint32_t question, uint32_t *items);
    /* Compiles the kernel of a way, whose layout is on the device. NULL: ways search tetrahedra;
     * with faces, so do all ways but theirs. */
    bb_status (*compile)(void *self, bb_contest_runner *runner);
    /* Enqueues the question. */
    bb_status (*ask)(void *self, const bb_contest_runner *runner, bb_contest_answers answers);
    /* Says what a way's steps read, whose layout is in the runner. BB_UNSUPPORTED if they cannot be
     * recorded. NULL: those of no way can. */
    bb_status (*code)(void *self, const bb_contest_runner *runner, bb_simulated_code *code);
    /* Adds to what the way has of differences beside `differ`. */
    void (*compare)(void *self, const void *first, const void *own, uint32_t items,
                    bb_contest_way *way);
    /* Looks at the answer of the first way. Optional. */
    bb_status (*see)(void *self, uint32_t question, const void *first, uint32_t items);
    /* Whether what builders were handed is as it was. Optional. */
    bb_status (*check)(void *self);
    /* Measures in each round what belongs to no way. Optional. */
    bb_status (*time)(void *self);
    /* Measures more, once all ways are measured. `first`: the first with a tree that is not
     * refused; NULL: none. Not called after an interruption. Optional. */
    bb_status (*end)(void *self, const bb_contest_runner *first, bb_contest_answers answers);
    /* Puts figures of the scene into its row, before those of the ways. */
    void (*fill)(void *self, bb_table *table, uint32_t row);
} bb_contest_task;

/* The search of scene `number` by a runner's layouts, or by its lists. */
bb_status bb_contest_search(const bb_contest_runner *runner, const bb_contest_task *task,
                            uint32_t number, bb_tet_search *search);

/* Compares all answers, measures, and puts figures into the table; nothing after a failure. What a
 * builder or search cannot do is said in its row. Interrupted after a round that counts, it ends
 * with the rounds that there are; before that it fails. */
bb_status bb_contest_run(const bb_contest_request *request, const bb_contest_task *task,
                         bb_table *table);

#endif
