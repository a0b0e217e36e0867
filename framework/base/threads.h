/* A small pool of host threads that sleeps when idle. */
#ifndef BB_THREADS_H
#define BB_THREADS_H

#include "framework/base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct bb_pool bb_pool;

/* Creates a pool of `threads` threads, including the caller's; 0 takes bb_core_count(). The caller
 * owns it. */
bb_status bb_pool_create(uint32_t threads, bb_pool **out);
void bb_pool_destroy(bb_pool *pool); /* NULL is allowed */
uint32_t bb_pool_threads(const bb_pool *pool);

/* Returns the wall time of the last bb_parallel_for() in ms, from the first thread that began to
 * the last that ended. */
double bb_pool_span_ms(const bb_pool *pool);

/* Lets all threads run where the caller's may. Returns whether one might not. */
bool bb_pool_put_back(bb_pool *pool);

/* Calls function(context, begin, end, thread) for [0, count) in chunks of at most `chunk`. All
 * threads, including the caller's, take chunks from one counter; returns when all are done. thread
 * < bb_pool_threads(pool) identifies the thread. One call at a time per pool; `function` must not
 * call it again on the same pool. */
void bb_parallel_for(bb_pool *pool, size_t count, size_t chunk,
                     void (*function)(void *context, size_t begin, size_t end, uint32_t thread),
                     void *context);

#endif
