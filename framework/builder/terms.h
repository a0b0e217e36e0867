/* The terms under which all builders are measured: what of the process a hook could change, and
 * with it the measurements of those that follow. */
#ifndef BB_TERMS_H
#define BB_TERMS_H

#include "framework/base/status.h"
#include "framework/builder/environment.h"

#include <fenv.h>
#include <locale.h>
#include <sched.h>
#include <signal.h>
#include <stdint.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/time.h>

enum { BB_TERMS_LOCALE = 512, BB_TERMS_SIGNALS = 65, BB_TERMS_TIMERS = 3, BB_TERMS_STREAMS = 3 };

/* A descriptor that is open. */
typedef struct bb_stream {
    int copy; /* -1: it is closed */
    struct stat file;
} bb_stream;

/* How the calling thread computes floats. */
typedef struct bb_float_terms {
    fenv_t all;
    uint32_t rounding; /* of all units for floats */
    uint32_t control;  /* what else they are told; 0 where that is not known */
} bb_float_terms;

/* Floating-point environment, own locale and signal mask are those of the calling thread. */
typedef struct bb_terms {
    bb_float_terms floats;
    char locale[BB_TERMS_LOCALE];
    locale_t thread_locale;
    struct sigaction signals[BB_TERMS_SIGNALS];
    sigset_t mask;
    struct rlimit limits[RLIM_NLIMITS];
    cpu_set_t processors;
    struct stat folder; /* the working one */
    bool folder_known;
    int folder_at; /* its descriptor; -1: it cannot be opened */
    mode_t umask;
    struct itimerval
        timers[BB_TERMS_TIMERS];         /* by which: ITIMER_REAL, ITIMER_VIRTUAL, ITIMER_PROF */
    int last_timer;                      /* highest id of timer_create(); -1: there is none */
    bb_stream streams[BB_TERMS_STREAMS]; /* standard input, output and error */
    bb_environment environment;
    char message[BB_MESSAGE_MAX]; /* bb_message() */
} bb_terms;

void bb_float_terms_take(bb_float_terms *floats);

/* Puts back what has changed since. Returns what that is, for a list, or NULL: nothing. */
const char *bb_float_terms_put_back(const bb_float_terms *floats);

/* Takes the terms as they are. To be ended by bb_terms_check() or bb_terms_put_back(). */
void bb_terms_take(bb_terms *terms);

/* Puts back what has changed since, and frees what was taken. Returns `status`, unless something
 * had changed: then BB_FAILED, "WHO changed the rounding mode in HOOK()", or, if `status` was a
 * failure already, its message followed by that. */
bb_status bb_terms_check(bb_terms *terms, const char *who, const char *hook, bb_status status);

/* The same for a hook that cannot fail: says nothing, and bb_message() is what it was before. */
void bb_terms_put_back(bb_terms *terms);

#endif
