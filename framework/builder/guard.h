/* A guardian: a process without threads or devices, which waits for the one that works. Code of
 * others runs in the process that works, and may crash, call exit() or never return: the guardian
 * then says who it was, and starts the work again without it.
 *
 * Both share a page, in which the working process notes whose hook it has called. The guardian only
 * waits, so it costs a fork() before the work begins, and nothing while something is timed. */
#ifndef BB_GUARD_H
#define BB_GUARD_H

#include <stdbool.h>
#include <stdint.h>

/* Forks, and returns in the child, which works. The parent never returns: it passes on SIGINT,
 * SIGTERM, SIGHUP, SIGQUIT and SIGTSTP, and ends as the child does. If the child ends within a hook
 * or before bb_guard_end(), one line on standard error says so. With `again` it then forks once
 * more, up to BB_DEATHS_MAX times, and the dead row stays out; after a death outside of hooks,
 * three times at most, that is the row of the last hook. The exit status is not 0 then:
 * `exit_died`, or `exit_cannot` if nothing was done. Without a fork, or if the
 * environment has BVHBENCH_GUARD=no, it returns unguarded. The process must not have other
 * threads. */
void bb_guard_start(bool again, int exit_died, int exit_cannot);
/* The work is done: from now on the process may end, with this status. Safe in a signal handler. */
void bb_guard_end(int exit_status);

enum { BB_DEATHS_MAX = 256 };
#define BB_GUARD_PATIENCE "600"

/* Who may die. */
typedef struct bb_guarded {
    const char *scene; /* on which it works; "": none */
    const char *row;   /* what would be missing: a builder's specification, a cell; "": all */
} bb_guarded;

/* The following calls do nothing in processes that are not guarded, except for bb_guard_started()
 * and bb_guard_kept(). */

/* A hook takes at most so many seconds of wall time; 0: no limit. Before the first call it is
 * BB_GUARD_PATIENCE. */
void bb_guard_patience(uint32_t seconds);
/* A hook of `who` is about to be called. */
void bb_guard_enter(bb_guarded whose, const char *who, const char *hook);
/* The hook has returned. */
void bb_guard_leave(void);
/* A kernel is launched once more between the two: its patience begins anew. */
void bb_guard_alive(void);
/* Counts a line of output. Returns whether a process before this one, which died, has printed it:
 * for commands that print as they go. */
bool bb_guard_said(void);
/* Returns the bb_wall_ms() at which the work began for the first time. */
double bb_guard_started(void);
/* Returns BB_GUARD_KEPT bytes, zero at first, which a process leaves to those that begin its work
 * again. */
void *bb_guard_kept(void);
enum { BB_GUARD_KEPT = 2048 };
/* For a child process whose hooks are nobody's business: from now on it is not guarded. */
void bb_guard_detach(void);
/* Returns how the row died, as "WHO died in HOOK(): how", if it did at this scene, at none, or at
 * three others, else NULL. The text stays until the process ends. */
const char *bb_guard_death(bb_guarded whose);

#endif
