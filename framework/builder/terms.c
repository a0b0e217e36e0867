#include "framework/builder/terms.h"

#include "framework/base/interrupt.h"
#include "framework/builder/guard.h"

#include <fcntl.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/syscall.h>
#include <unistd.h>
#if defined(__SSE__)
#include <xmmintrin.h>
#endif

/* ---- one term each: take it, compare it, put it back ---- */

/* How floats are rounded, and what else their units are told, without the flags that operations
 * raise. x86 has two units: SSE computes floats and doubles, and the x87 long doubles, whose
 * rounding is all that fegetround() says. */
static void look_at_floats(uint32_t *rounding, uint32_t *control)
{
#if defined(__SSE__)
    uint16_t x87;
    __asm__ volatile("fnstcw %0" : "=m"(x87));
    const uint32_t sse = _mm_getcsr();
    *rounding = (sse & 0x6000u) | (x87 & 0x0C00u);
    *control = (sse & 0x9FC0u) | (uint32_t)(x87 & 0x033Fu) << 16;
#elif defined(__aarch64__)
    uint64_t fpcr;
    __asm__ volatile("mrs %0, fpcr" : "=r"(fpcr));
    *rounding = (uint32_t)fpcr & 0xC00000u;
    *control = (uint32_t)fpcr & ~0xC00000u;
#else
    *rounding = (uint32_t)fegetround();
    *control = 0;
#endif
}

void bb_float_terms_take(bb_float_terms *floats)
{
    fegetenv(&floats->all);
    look_at_floats(&floats->rounding, &floats->control);
}

#define ROUNDING "the rounding mode"
#define CONTROL "how floats are computed (denormals, traps or precision)"

const char *bb_float_terms_put_back(const bb_float_terms *floats)
{
    static const char *const changed[] = {NULL, ROUNDING, CONTROL, ROUNDING ", " CONTROL};
    uint32_t rounding, control;
    look_at_floats(&rounding, &control);
    const char *what = changed[(rounding != floats->rounding) + 2 * (control != floats->control)];
    if (what != NULL)
        fesetenv(&floats->all);
    return what;
}

/* Compares the handler and how it is called. Where there is none, one flag alone has a meaning. */
static bool same_handler(const struct sigaction *a, const struct sigaction *b)
{
    const bool none = a->sa_handler == SIG_DFL || a->sa_handler == SIG_IGN;
    const int how = SA_SIGINFO | SA_RESETHAND | SA_NODEFER | SA_RESTART | SA_ONSTACK;
    const int flags = (none ? 0 : how) | SA_NOCLDWAIT;
    return a->sa_handler == b->sa_handler && (a->sa_flags & flags) == (b->sa_flags & flags);
}

static bool handlers_changed(const bb_terms *terms)
{
    bool changed = false;
    for (int s = 1; s < BB_TERMS_SIGNALS; s++) {
        struct sigaction now;
        if (sigaction(s, NULL, &now) != 0 || same_handler(&now, &terms->signals[s]) ||
            bb_interrupt_changed(s, &terms->signals[s], &now))
            continue;
        changed = true;
        sigaction(s, &terms->signals[s], NULL);
    }
    return changed;
}

static bool mask_changed(const bb_terms *terms)
{
    sigset_t now;
    pthread_sigmask(SIG_BLOCK, NULL, &now);
    for (int s = 1; s < BB_TERMS_SIGNALS; s++)
        if (sigismember(&now, s) != sigismember(&terms->mask, s))
            return true;
    return false;
}

/* Puts back what can be. *lowered: whether a hard limit stays lowered, for want of privilege. */
static bool limits_changed(const bb_terms *terms, bool *lowered)
{
    *lowered = false;
    bool changed = false;
    for (int r = 0; r < RLIM_NLIMITS; r++) {
        struct rlimit now;
        const struct rlimit *then = &terms->limits[r];
        if (getrlimit((unsigned)r, &now) != 0 ||
            (now.rlim_cur == then->rlim_cur && now.rlim_max == then->rlim_max))
            continue;
        changed = true;
        if (setrlimit((unsigned)r, then) == 0)
            continue;
        const rlim_t soft = then->rlim_cur < now.rlim_max ? then->rlim_cur : now.rlim_max;
        setrlimit((unsigned)r, &(struct rlimit){soft, now.rlim_max});
        *lowered = true;
    }
    return changed;
}

/* The first name also leads to a folder that nobody may search, or that was removed. */
static const char *const working_folder[] = {"/proc/self/cwd", "."};

static bool look_at_folder(struct stat *folder)
{
    return stat(working_folder[0], folder) == 0 || stat(working_folder[1], folder) == 0;
}

static int open_folder(void)
{
    const int flags = O_PATH | O_DIRECTORY | O_CLOEXEC, at = open(working_folder[0], flags);
    return at >= 0 ? at : open(working_folder[1], flags);
}

static bool same_file(const struct stat *a, const struct stat *b)
{
    return a->st_dev == b->st_dev && a->st_ino == b->st_ino;
}

/* What cannot be looked at is nobody's fault: others may have changed its permissions. */
static bool folder_changed(const bb_terms *terms)
{
    struct stat now;
    return terms->folder_known && look_at_folder(&now) && !same_file(&now, &terms->folder);
}

/* It can only be read by setting it. Meanwhile, files that other threads make are too private. */
static mode_t umask_now(void)
{
    const mode_t now = umask(077);
    umask(now);
    return now;
}

/* How long a timer still has to run is nobody's change: `check`'s watchdog sets its own anew. */
static bool timers_changed(const bb_terms *terms)
{
    bool changed = false;
    for (int t = 0; t < BB_TERMS_TIMERS; t++) {
        struct itimerval now;
        const struct itimerval *then = &terms->timers[t];
        getitimer((__itimer_which_t)t, &now);
        if (timerisset(&now.it_value) == timerisset(&then->it_value) &&
            !timercmp(&now.it_interval, &then->it_interval, !=))
            continue;
        changed = true;
        setitimer((__itimer_which_t)t, then, NULL);
    }
    return changed;
}

/* Returns the highest id of timer_create(); -1: there is none, or the kernel does not show them.
 * Ids only rise, and the kernel lists the latest first. */
static int last_timer(void)
{
    char text[32] = "";
    int id = -1;
    const int file = open("/proc/self/timers", O_RDONLY | O_CLOEXEC);
    if (file < 0)
        return -1;
    if (read(file, text, sizeof text - 1) > 0)
        (void)sscanf(text, "ID: %d", &id);
    close(file);
    return id;
}

static bool created_timers(const bb_terms *terms)
{
    bool changed = false;
    for (int id; (id = last_timer()) > terms->last_timer; changed = true)
        if (syscall(SYS_timer_delete, id) != 0)
            break;
    return changed;
}

static void take_streams(bb_stream *streams)
{
    for (int s = 0; s < BB_TERMS_STREAMS; s++) {
        streams[s].copy = fcntl(s, F_DUPFD_CLOEXEC, BB_TERMS_STREAMS);
        fstat(s, &streams[s].file);
    }
}

/* Other descriptors are not looked at: a driver's threads open and close theirs at any time. *lost:
 * whether the copy is closed as well. */
static bool streams_changed(const bb_terms *terms, bool *lost)
{
    bool changed = false;
    *lost = false;
    for (int s = 0; s < BB_TERMS_STREAMS; s++) {
        const bb_stream *then = &terms->streams[s];
        struct stat now;
        if (then->copy < 0 || (fstat(s, &now) == 0 && same_file(&now, &then->file)))
            continue;
        changed = true;
        if (fstat(then->copy, &now) != 0 || !same_file(&now, &then->file) ||
            dup2(then->copy, s) != s)
            *lost = true;
    }
    return changed;
}

/* ---- all ---- */

void bb_terms_take(bb_terms *terms)
{
    memset(terms, 0, sizeof *terms);
    bb_float_terms_take(&terms->floats);
    snprintf(terms->locale, sizeof terms->locale, "%s", setlocale(LC_ALL, NULL));
    terms->thread_locale = uselocale((locale_t)0);
    for (int s = 1; s < BB_TERMS_SIGNALS; s++)
        sigaction(s, NULL, &terms->signals[s]);
    pthread_sigmask(SIG_BLOCK, NULL, &terms->mask);
    for (int r = 0; r < RLIM_NLIMITS; r++)
        getrlimit((unsigned)r, &terms->limits[r]);
    sched_getaffinity(0, sizeof terms->processors, &terms->processors);
    terms->folder_at = open_folder();
    terms->folder_known = look_at_folder(&terms->folder);
    terms->umask = umask_now();
    for (int t = 0; t < BB_TERMS_TIMERS; t++)
        getitimer((__itimer_which_t)t, &terms->timers[t]);
    terms->last_timer = last_timer();
    take_streams(terms->streams);
    bb_environment_take(&terms->environment);
    snprintf(terms->message, sizeof terms->message, "%s", bb_message());
}

static void add(char *list, size_t capacity, const char *what)
{
    const size_t length = strlen(list);
    snprintf(list + length, capacity - length, "%s%s", length > 0 ? ", " : "", what);
}

static bool processors_changed(const bb_terms *terms)
{
    cpu_set_t now;
    return sched_getaffinity(0, sizeof now, &now) == 0 && !CPU_EQUAL(&now, &terms->processors);
}

static const char not_put_back[] = "which could not be put back";

/* Puts back what changed, and lists it. */
static void list_and_put_back(const bb_terms *terms, char *list, size_t capacity)
{
    const char *floats = bb_float_terms_put_back(&terms->floats);
    if (floats != NULL)
        add(list, capacity, floats);
    if (strncmp(setlocale(LC_ALL, NULL), terms->locale, sizeof terms->locale - 1) != 0) {
        add(list, capacity, "the locale");
        setlocale(LC_ALL, terms->locale);
    }
    if (uselocale((locale_t)0) != terms->thread_locale) {
        add(list, capacity, "the thread's locale");
        uselocale(terms->thread_locale);
    }
    if (handlers_changed(terms))
        add(list, capacity, "a signal's handler");
    if (mask_changed(terms)) {
        add(list, capacity, "the signal mask");
        pthread_sigmask(SIG_SETMASK, &terms->mask, NULL);
    }
    bool lowered;
    if (limits_changed(terms, &lowered))
        add(list, capacity, "a resource limit");
    if (lowered)
        add(list, capacity, "whose hard limit stays lowered");
    if (processors_changed(terms)) {
        add(list, capacity, "the processors to run on");
        sched_setaffinity(0, sizeof terms->processors, &terms->processors);
    }
    if (folder_changed(terms)) {
        add(list, capacity, "the working folder");
        if (terms->folder_at < 0 || fchdir(terms->folder_at) != 0)
            add(list, capacity, not_put_back);
    }
    if (umask_now() != terms->umask) {
        add(list, capacity, "the umask");
        umask(terms->umask);
    }
    const bool timers = timers_changed(terms);
    if (created_timers(terms) || timers)
        add(list, capacity, "a timer");
    bool lost;
    if (streams_changed(terms, &lost))
        add(list, capacity, "standard input, output or error");
    if (lost)
        add(list, capacity, not_put_back);
    const bool variables = bb_environment_changed(&terms->environment);
    const bool there = bb_environment_put_back(&terms->environment); /* pointers in any case */
    if (variables)
        add(list, capacity, "the environment's variables");
    if (variables && !there)
        add(list, capacity, not_put_back);
}

/* Frees what was taken, too. */
static void end(bb_terms *terms, char *list, size_t capacity)
{
    list[0] = '\0';
    bb_guard_leave();
    list_and_put_back(terms, list, capacity);
    if (terms->folder_at >= 0)
        close(terms->folder_at);
    for (int s = 0; s < BB_TERMS_STREAMS; s++)
        if (terms->streams[s].copy >= 0)
            close(terms->streams[s].copy);
    bb_environment_free(&terms->environment);
}

bb_status bb_terms_check(bb_terms *terms, const char *who, const char *hook, bb_status status)
{
    char list[400];
    end(terms, list, sizeof list);
    if (list[0] == '\0')
        return status;
    if (status == BB_OK)
        return bb_fail(BB_FAILED,
                       "%s changed %s in %s(): what all builders share, no hook may change", who,
                       list, hook);
    return bb_fail(BB_FAILED, "%.500s; and %s changed %s in %s()", bb_message(), who, list, hook);
}

void bb_terms_put_back(bb_terms *terms)
{
    char list[400];
    end(terms, list, sizeof list);
    (void)bb_fail(BB_FAILED, "%s", terms->message);
}
