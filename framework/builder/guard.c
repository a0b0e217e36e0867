#include "framework/builder/guard.h"

#include "framework/base/clock.h"
#include "framework/base/steering.h"

#include <errno.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { ROW = 512, WHO = 512, HOOK = 32, SCENE = 512, ENOUGH = 3, SUSPECTS = 3 };

typedef struct death {
    char scene[SCENE], row[ROW], words[WHO + 256];
} death;

/* Shared by guardian and guarded. The guardian reads the texts while the guarded process is in a
 * hook, or after its end, and writes deaths while there is none. */
typedef struct page {
    atomic_int ended;     /* by bb_guard_end(): 1 + the exit status */
    atomic_uint patience; /* seconds */
    _Atomic double since; /* a hook began, by bb_wall_ms(); 0: there is none */
    char scene[SCENE], row[ROW], who[WHO], hook[HOOK]; /* the last hook */
    uint32_t said;                                     /* lines of output */
    double started;
    _Alignas(16) char kept[BB_GUARD_KEPT];
    uint32_t death_count, suspects; /* suspects: deaths outside of hooks */
    death deaths[BB_DEATHS_MAX];
} page;

static page *shared; /* NULL: not guarded */

/* ---- the guarded process ---- */

static void note(char *to, size_t capacity, const char *text)
{
    snprintf(to, capacity, "%s", text);
}

void bb_guard_end(int exit_status)
{
    if (shared != NULL)
        atomic_store(&shared->ended, 1 + exit_status);
}

void bb_guard_patience(uint32_t seconds)
{
    if (shared != NULL)
        atomic_store(&shared->patience, seconds);
}

void bb_guard_enter(bb_guarded whose, const char *who, const char *hook)
{
    if (shared == NULL)
        return;
    note(shared->scene, sizeof shared->scene, whose.scene);
    note(shared->row, sizeof shared->row, whose.row);
    note(shared->who, sizeof shared->who, who);
    note(shared->hook, sizeof shared->hook, hook);
    atomic_store(&shared->since, bb_wall_ms());
}

void bb_guard_alive(void)
{
    if (shared != NULL && atomic_load(&shared->since) > 0)
        atomic_store(&shared->since, bb_wall_ms());
}

void bb_guard_leave(void)
{
    if (shared != NULL)
        atomic_store(&shared->since, 0.0);
}

void bb_guard_detach(void)
{
    shared = NULL;
}

bool bb_guard_said(void)
{
    static uint32_t count; /* by this process */
    if (shared == NULL || ++count <= shared->said)
        return shared != NULL;
    shared->said = count;
    return false;
}

double bb_guard_started(void)
{
    static double alone;
    if (shared != NULL)
        return shared->started;
    alone = alone > 0 ? alone : bb_wall_ms();
    return alone;
}

void *bb_guard_kept(void)
{
    static _Alignas(16) char alone[BB_GUARD_KEPT];
    return shared != NULL ? shared->kept : alone;
}

const char *bb_guard_death(bb_guarded whose)
{
    const death *last = NULL;
    uint32_t count = 0;
    for (uint32_t i = 0; shared != NULL && i < shared->death_count; i++) {
        const death *d = &shared->deaths[i];
        if (strncmp(d->row, whose.row, sizeof d->row - 1) != 0)
            continue;
        if (d->scene[0] == '\0' || strncmp(d->scene, whose.scene, sizeof d->scene - 1) == 0)
            return d->words;
        last = d;
        count++;
    }
    return count >= ENOUGH ? last->words : NULL;
}

/* ---- the guardian ---- */

/* Ends as the signal ends a process. */
static _Noreturn void end_by(int signal_number)
{
    sigset_t all;
    signal(signal_number, SIG_DFL);
    sigfillset(&all);
    sigprocmask(SIG_UNBLOCK, &all, NULL);
    raise(signal_number);
    _exit(128 + signal_number);
}

static bool in_hook(void)
{
    return atomic_load(&shared->since) > 0;
}

static bool is_hung(void)
{
    const double since = atomic_load(&shared->since), seconds = atomic_load(&shared->patience);
    return since > 0 && seconds > 0 && bb_wall_ms() - since > 1e3 * seconds;
}

/* Stops with its child, and goes on with it. */
static void pause_with(pid_t child)
{
    const double before = bb_wall_ms(), since = atomic_load(&shared->since);
    kill(-child, SIGTSTP); /* a guardian in the group must pass it on, too */
    raise(SIGSTOP);
    if (since > 0) /* a pause is no time of a hook */
        atomic_store(&shared->since, since + (bb_wall_ms() - before));
    kill(-child, SIGCONT);
}

/* How the child ended. */
typedef struct fate {
    int status;   /* of waitpid() */
    int passed;   /* the last signal that was passed on and may have ended it; 0: none */
    bool hung;    /* it was killed because a hook took too long */
    double cpu_s; /* that it used */
} fate;

/* Waits for the end of the child, and passes signals on. */
static fate watch(pid_t child, const sigset_t *signals)
{
    const struct timespec second = {1, 0};
    struct rusage used = {.ru_maxrss = 0};
    fate f = {0};
    while (wait4(child, &f.status, WNOHANG, &used) == 0) {
        siginfo_t info;
        const int caught = sigtimedwait(signals, &info, &second);
        if (caught == SIGTSTP)
            pause_with(child);
        else if (caught > 0 && caught != SIGCHLD) {
            f.passed = caught;
            kill(child, caught);
        }
        if (!f.hung && is_hung()) {
            f.hung = true;
            kill(child, SIGKILL);
        }
    }
    f.cpu_s = (double)(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
              1e-6 * (double)(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
    return f;
}

/* Says of a signal what probably sent it. A process gets SIGXCPU at the soft limit of CPU time, and
 * SIGKILL at the hard one, which `ulimit -t` makes the same. */
static void describe_sender(const fate *f, char *words, size_t capacity)
{
    struct rlimit limit;
    const int number = WTERMSIG(f->status);
    words[0] = '\0';
    if (number != SIGXCPU && number != SIGKILL)
        return;
    const bool known = getrlimit(RLIMIT_CPU, &limit) == 0;
    const rlim_t most = !known              ? RLIM_INFINITY
                        : number == SIGXCPU ? limit.rlim_cur
                                            : limit.rlim_max;
    if (most != RLIM_INFINITY && (number == SIGXCPU || f->cpu_s + 1 >= (double)most))
        snprintf(words, capacity, ", at the limit of %llu s of CPU time (ulimit -t)",
                 (unsigned long long)most);
    else if (number == SIGKILL)
        snprintf(words, capacity, ", probably for want of memory");
}

static void describe_end(const fate *f, char *words, size_t capacity)
{
    char sender[96];
    const int status = f->status;
    describe_sender(f, sender, sizeof sender);
    if (f->hung)
        snprintf(words, capacity, "it had not returned after %u s (--patience), and was killed",
                 atomic_load(&shared->patience));
    else if (WIFSIGNALED(status))
        snprintf(words, capacity, "signal %d (%s)%s", WTERMSIG(status), strsignal(WTERMSIG(status)),
                 sender);
    else
        snprintf(words, capacity, "it called exit(%d)", WEXITSTATUS(status));
}

/* Adds the death of the row whose hook was called last; false: there is no such row, no room, or
 * it has died there before. */
static bool add_death(const char *verb, const char *how)
{
    if (shared->row[0] == '\0' || shared->death_count == BB_DEATHS_MAX ||
        bb_guard_death((bb_guarded){shared->scene, shared->row}) != NULL)
        return false;
    death *d = &shared->deaths[shared->death_count++];
    note(d->scene, sizeof d->scene, shared->scene);
    note(d->row, sizeof d->row, shared->row);
    snprintf(d->words, sizeof d->words, "%s %s %s(): %s", shared->who, verb, shared->hook, how);
    bb_calm_text(d->words);
    return true;
}

/* "SCENE: ROW: ", without what is not known and a row that is called as who dies. */
static void describe_row(char *words, size_t capacity)
{
    const char *scene = shared->scene;
    const char *row = strcmp(shared->row, shared->who) != 0 ? shared->row : "";
    snprintf(words, capacity, "%s%s%s%s", scene, scene[0] != '\0' ? ": " : "", row,
             row[0] != '\0' ? ": " : "");
}

/* Says how the child died; returns whether to begin again. */
static bool mourn(const fate *f, bool again)
{
    char how[192], row[SCENE + ROW + 8], line[sizeof row + WHO + sizeof how + 128];
    describe_end(f, how, sizeof how);
    describe_row(row, sizeof row);
    if (in_hook()) {
        snprintf(line, sizeof line, "%s%s died in %s(): %s", row, shared->who, shared->hook, how);
        again = again && add_death("died in", how);
    } else if (shared->hook[0] != '\0') {
        snprintf(line, sizeof line, "%sthe program died: %s; the last hook was %s() of %s", row,
                 how, shared->hook, shared->who);
        again = again && shared->suspects++ < SUSPECTS &&
                add_death("is suspected: the program died after its", how);
    } else {
        snprintf(line, sizeof line, "the program died: %s", how);
        again = false;
    }
    bb_calm_text(line);
    if (isatty(STDERR_FILENO))
        fputs("\r\033[K", stderr); /* over a line of progress */
    fprintf(stderr, "bvhbench: %s%s\n", line, again ? "; beginning again without it" : "");
    return again;
}

/* Whether a user, or a reader that went away, ended it. */
static bool was_asked_to_end(const fate *f)
{
    const int number = WIFSIGNALED(f->status) ? WTERMSIG(f->status) : 0;
    return number != 0 && !f->hung && (number == f->passed || (number == SIGPIPE && !in_hook()));
}

/* Returns the child's exit status. A library that exits in its place does not make it 0. */
static int exit_status_of(int status, int exit_died)
{
    const int said = atomic_load(&shared->ended) - 1, is = WEXITSTATUS(status);
    if (is != 0 || said != 0)
        return is != 0 ? is : said;
    return shared->death_count > 0 ? exit_died : 0;
}

/* Lists the process's children; returns how many there are, at most `capacity`. */
static int list_children(pid_t *children, int capacity)
{
    int count = 0, child;
    FILE *file = fopen("/proc/thread-self/children", "r");
    while (file != NULL && count < capacity && fscanf(file, "%d", &child) == 1)
        children[count++] = child;
    if (file != NULL)
        fclose(file);
    return count;
}

enum { CHILDREN = 256 };

static struct {
    pid_t list[CHILDREN];
    int count;
} others; /* children from before this program: the shell's that it has taken the place of */

static bool is_other(pid_t child)
{
    for (int i = 0; i < others.count; i++)
        if (others.list[i] == child)
            return true;
    return false;
}

/* Kills what the child left, in its group or out of it. As the subreaper, the guardian is the
 * parent of each orphan, and next of those that it leaves. */
static void kill_left(pid_t child)
{
    pid_t left[CHILDREN];
    kill(-child, SIGKILL);
    for (bool any = others.count < CHILDREN; any;) {
        const int count = list_children(left, CHILDREN);
        any = false;
        for (int i = 0; i < count; i++)
            if (!is_other(left[i]) && kill(left[i], SIGKILL) == 0)
                any = waitpid(left[i], NULL, 0) == left[i] || any;
    }
}

/* The child has a process group of its own, so that each signal reaches it once. To the terminal it
 * is in the background then, and must not be stopped for writing to it. */
static void be_child(pid_t parent, const sigset_t *mask)
{
    setpgid(0, 0);
    signal(SIGTTOU, SIG_IGN);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent)
        _exit(1);
    sigprocmask(SIG_SETMASK, mask, NULL);
}

/* Without a guardian, which is said: a death ends the run then. */
static void work_alone(void)
{
    fprintf(stderr,
            "bvhbench: cannot start a process (%s): if a builder crashes, the run ends with it\n",
            strerror(errno));
    if (shared != MAP_FAILED)
        munmap(shared, sizeof *shared);
    shared = NULL;
}

void bb_guard_start(bool again, int exit_died, int exit_cannot)
{
    static const int passed[] = {SIGCHLD, SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGTSTP};
    const char *wanted = getenv("BVHBENCH_GUARD");
    if (wanted != NULL && strcmp(wanted, "no") == 0)
        return;
    shared = mmap(NULL, sizeof *shared, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (shared == MAP_FAILED) {
        work_alone();
        return;
    }
    shared->patience = (unsigned)atoi(BB_GUARD_PATIENCE);
    shared->started = bb_wall_ms();
    struct sigaction stop;
    sigset_t signals, mask;
    sigemptyset(&signals);
    for (size_t i = 0; i < sizeof passed / sizeof passed[0]; i++)
        if (passed[i] != SIGTSTP || sigaction(SIGTSTP, NULL, &stop) != 0 ||
            stop.sa_handler != SIG_IGN)
            sigaddset(&signals, passed[i]);
    signal(SIGCHLD, SIG_DFL); /* an ignored signal would discard the status */
    sigprocmask(SIG_BLOCK, &signals, &mask);
    others.count = list_children(others.list, CHILDREN);
    prctl(PR_SET_CHILD_SUBREAPER, 1);
    for (;;) {
        const pid_t parent = getpid();
        fflush(NULL); /* the child would write buffered text again */
        const pid_t child = fork();
        if (child <= 0) {
            if (child == 0)
                be_child(parent, &mask);
            else
                work_alone();
            sigprocmask(SIG_SETMASK, &mask, NULL);
            return;
        }
        setpgid(child, child);
        const fate f = watch(child, &signals);
        kill_left(child);
        if (WIFEXITED(f.status) && atomic_load(&shared->ended) > 0)
            _exit(exit_status_of(f.status, exit_died));
        if (was_asked_to_end(&f))
            end_by(WTERMSIG(f.status));
        if (!mourn(&f, again))
            _exit(again || (in_hook() && shared->row[0] == '\0') ? exit_cannot : exit_died);
        atomic_store(&shared->since, 0.0);
        shared->hook[0] = '\0'; /* nobody has called one in the next child */
    }
}
