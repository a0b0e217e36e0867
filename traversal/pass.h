/* Traces rays: a traverser and a layout give answers. All kernels trace through here, timed or not.
 */
#ifndef BB_PASS_H
#define BB_PASS_H

#include "traversal/traversal.h"

/* All objects are owned by others and already on the device. */
typedef struct bb_pass {
    const bb_query *query;
    bb_traverser *traverser; /* NULL if the pass only poisons */
    const bb_layout_data *layout;
    const bb_buffer *rays; /* bb_ray[count] */
    bb_buffer *results;    /* type as the query says: bb_hit[count] for closest and any hits */
    bb_buffer *counts;     /* bb_count[count] if the traverser counts, else NULL */
    const bb_recording *recording; /* if the traverser records, else NULL */
    const bb_arg *more;            /* additional arguments of the query's kernels */
    uint32_t more_count;
} bb_pass;

/* Fills the results with BB_POISON, so that unwritten ones are detected. Waits for the device. */
bb_status bb_pass_poison(const bb_pass *pass, uint32_t count);

/* Enqueues the first `count` rays; does not wait. Only this is timed. */
bb_status bb_pass_launch(const bb_pass *pass, uint32_t count);

/* The parts of a launch, for separate clocks. The first does nothing unless the traverser sorts. */
bb_status bb_pass_sort(const bb_pass *pass, uint32_t count);
bb_status bb_pass_trace(const bb_pass *pass, uint32_t count);

/* Poisons, launches, reads results and, if the traverser counts, counts. `counts` may be NULL. */
bb_status bb_pass_run(const bb_pass *pass, uint32_t count, void *results, bb_count *counts);

#endif
