/* One way through: rays by a tracer through a layout to answers. Whoever traces goes this way, the
 * clock's holder included. */
#ifndef BB_PASS_H
#define BB_PASS_H

#include "traversal/traversal.h"

/* All of it lives elsewhere and is on the device already. */
typedef struct bb_pass {
    const bb_query *query;
    bb_tracer *tracer; /* NULL for who only poisons */
    const bb_layout_data *layout;
    const bb_buffer *rays; /* bb_ray[count] */
    bb_buffer *results;    /* as the query has them: bb_hit[count] of closest and any hits */
    bb_buffer *counts;     /* bb_count[count], if the tracer counts; else NULL */
} bb_pass;

/* Fills the results with BB_POISON, so that those that nobody writes are found; waits. */
bb_status bb_pass_poison(const bb_pass *pass, uint32_t count);

/* Enqueues the first `count` rays; does not wait. This alone is what a clock may hold. */
bb_status bb_pass_launch(const bb_pass *pass, uint32_t count);

/* Poisons, launches, and reads results and, if the tracer counts, counts. `counts` may be NULL. */
bb_status bb_pass_run(const bb_pass *pass, uint32_t count, void *results, bb_count *counts);

#endif
