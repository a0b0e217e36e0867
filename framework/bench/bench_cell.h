/* One cell of a ray set: prepared, traced, judged, counted. */
#ifndef BB_BENCH_CELL_H
#define BB_BENCH_CELL_H

#include "framework/bench/bench_private.h"
#include "framework/builder/guard.h"
#include "framework/workload/workload.h"

/* A cell of a ray set. */
typedef struct bb_traced_cell {
    bb_entrant *entrant;
    uint32_t kernel; /* index of the kernel's choice */
    uint32_t layout; /* index of the layout that it reads */
    const bb_intersector *intersector;
    bb_traverser *traverser;
    uint32_t count; /* rays that it traces, the first of the set */
    uint32_t batch; /* most rays of a launch */
    double sort_ms; /* of the last trace: sorting its rays */
    bb_trace_record record;
    uint64_t hits_hash;
    bool judged;
} bb_traced_cell;

/* All cells of one ray set. */
typedef struct bb_trace_set {
    bb_bench *bench;
    bb_rays *rays;
    bb_answers answers;
    size_t bytes;    /* size of one ray's answer */
    char *results;   /* answers of the last trace, on the host */
    char *first;     /* the first full answer of an `exact` cell, which all others must equal */
    char whose[256]; /* that cell; "": none yet */
    uint32_t loaded_from, loaded; /* the rays of the set that are on the device */
    bool warming;                 /* the round does not count */
    bb_traced_cell *cells;
    uint32_t count;
} bb_trace_set;

/* Returns what would be missing if the cell's trace died. */
bb_guarded bb_trace_guarded(const bb_trace_record *r);

/* Records a failure, unless it failed because the run was interrupted. */
void bb_trace_note_failure(bb_traced_cell *c, bb_status status);

/* Uploads rays [from, from + count), unless they are on the device already. */
bb_status bb_trace_load(bb_trace_set *set, uint32_t from, uint32_t count);

/* Makes the traverser, and compiles it for its group size. */
bb_status bb_trace_prepare(bb_trace_set *set, bb_traced_cell *c);
/* Traces the cell's rays once, in batches, into set->results. A reference's event time is that of
 * its threads. */
bb_status bb_trace_once(bb_trace_set *set, bb_traced_cell *c, bb_timing *timing);
/* Judges set->results, and compares them with those of other cells. */
bb_status bb_trace_judge(bb_trace_set *set, bb_traced_cell *c);
/* Counts tests per ray on a sample; none of a reference. */
bb_status bb_trace_count(bb_trace_set *set, bb_traced_cell *c);

/* Simulates the trace, if that was asked for, on a sample of the set. What cannot be simulated is
 * left out, with a note. */
bb_status bb_trace_simulate(bb_trace_set *set, bb_traced_cell *c);

/* After all rounds: has each tracer that is a plug-in trace rays that it has not seen. Whoever
 * answers them wrong, or took more than 1.5 times its slowest round for each of four such sets,
 * fails ("it remembers answers"; bench_unseen_rays.c). */
bb_status bb_trace_unseen(bb_trace_set *set);

#endif
