/* Whether a hook has left work behind, which would slow down whoever comes next: threads that go
 * on, or processes. */
#ifndef BB_IDLE_H
#define BB_IDLE_H

#include <stdbool.h>
#include <stdint.h>

enum { BB_IDLE_THREADS = 512 };

/* The threads of this process, and whether it has children. */
typedef struct bb_idle {
    uint32_t count;
    int ids[BB_IDLE_THREADS];
    bool children;
} bb_idle;

/* Looks at what there is before a hook. */
void bb_idle_take(bb_idle *before);

/* A hook of this builder has returned: waits until all threads sleep, half a millisecond if they
 * do, a second at most. Returns what it has left behind, as "a thread at work (NAME, 50
 * ms since)", or NULL: nothing. A thread belongs to the builder in whose hook it began; if it works
 * in another's time, that builder is told at the end of its next hook. Nobody is told twice.
 * Threads beyond BB_IDLE_THREADS are not seen. The text stays until the next call. */
const char *bb_idle_left(const bb_idle *before, const char *builder);

#endif
