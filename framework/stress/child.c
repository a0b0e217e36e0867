#include "framework/stress/child.h"

#include "framework/base/clock.h"
#include "framework/base/interrupt.h"
#include "framework/base/steering.h"
#include "framework/builder/guard.h"

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

enum {
    DONE = 1,
    GAVE_UP = 2,
    STOPPED = 3,
    LOOK_MS = 10,         /* between checks of the child */
    FILE_BYTES = 1 << 28, /* limit of each file that the child writes */
};

/* Shared by parent and child. NULL: there is no child. */
static struct page {
    atomic_uint pieces; /* finished pieces of work */
    atomic_uint
        ended; /* work() returned: DONE, GAVE_UP or STOPPED; what a library exits with is neither */
} * page;

void bb_child_alive(void)
{
    if (page != NULL)
        atomic_fetch_add(&page->pieces, 1);
}

/* Returns the resident memory in MiB; 0: unknown. */
static double resident(pid_t child)
{
    char path[64];
    long pages = 0, shown = 0;
    snprintf(path, sizeof path, "/proc/%ld/statm", (long)child);
    FILE *file = fopen(path, "r");
    if (file == NULL)
        return 0;
    if (fscanf(file, "%ld %ld", &pages, &shown) != 2)
        shown = 0;
    fclose(file);
    return (double)shown * (double)sysconf(_SC_PAGESIZE) / (1 << 20);
}

/* Starts a process group, so that Ctrl-C reaches only the parent, and killing the group also kills
 * processes of drivers. */
static void be_child(int (*work)(void *user), void *user, int out, pid_t parent)
{
    const struct rlimit most = {FILE_BYTES, FILE_BYTES};
    setpgid(0, 0);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    setrlimit(RLIMIT_FSIZE, &most);
    signal(SIGINT, SIG_DFL); /* signals end the child: half of the work is no result */
    signal(SIGTERM, SIG_DFL);
    signal(SIGHUP, SIG_DFL);
    bb_interrupt_at(0); /* nor does a time that is over make a result */
    if (getppid() != parent)
        _exit(1);
    dup2(out, STDOUT_FILENO);
    dup2(out, STDERR_FILENO);
    setvbuf(stdout, NULL, _IOLBF, 0); /* the child ends without flushing */
    const int returned = work(user);
    atomic_store(&page->ended, returned == 0 ? DONE : returned == BB_STOP_ALL ? STOPPED : GAVE_UP);
    _exit(0);
}

/* Waits for the child, or kills it. */
static bb_child_end watch(pid_t child, const bb_child_limits *limits, int *status)
{
    double start = bb_wall_ms();
    unsigned done = 0;
    const struct timespec pause = {0, LOOK_MS * 1000000L};
    bb_child_end killed = BB_CHILD_DONE;
    for (pid_t ended = 0; (ended = waitpid(child, status, WNOHANG)) != child;) {
        if (ended < 0 && errno != EINTR)
            break; /* another thread has waited for it; the page knows how it ended */
        if (killed == BB_CHILD_DONE) {
            if (atomic_load(&page->pieces) != done) {
                done = atomic_load(&page->pieces);
                start = bb_wall_ms();
            }
            if (bb_interrupted())
                killed = BB_CHILD_INTERRUPTED;
            else if (bb_wall_ms() - start > 1e3 * limits->seconds)
                killed = BB_CHILD_HUNG;
            else if (resident(child) > (double)limits->megabytes)
                killed = BB_CHILD_FLOODED;
            if (killed != BB_CHILD_DONE) {
                kill(-child, SIGKILL);
                kill(child, SIGKILL); /* it may have no group yet */
            }
        }
        nanosleep(&pause, NULL);
    }
    kill(-child, SIGKILL); /* processes that it left */
    bb_guard_leave();
    return killed;
}

/* Reads the last line of the file that is not empty. */
static void read_last_line(int file, char *said, size_t capacity)
{
    char end[1024];
    const off_t size = lseek(file, 0, SEEK_END);
    const off_t from = size > (off_t)sizeof end - 1 ? size - ((off_t)sizeof end - 1) : 0;
    ssize_t length = pread(file, end, sizeof end - 1, from);
    while (length > 0 && end[length - 1] == '\n')
        length--;
    end[length > 0 ? length : 0] = '\0';
    const char *line = strrchr(end, '\n');
    snprintf(said, capacity, "%.*s", (int)capacity - 1, line != NULL ? line + 1 : end);
    bb_calm_text(said);
}

static void name_end(const bb_child_limits *limits, int status, unsigned ended,
                     bb_child_report *report)
{
    char *words = report->words;
    const size_t capacity = sizeof report->words;
    if (report->end == BB_CHILD_HUNG)
        snprintf(words, capacity, "killed after %g s", limits->seconds);
    else if (report->end == BB_CHILD_FLOODED)
        snprintf(words, capacity, "killed beyond %llu MiB", (unsigned long long)limits->megabytes);
    else if (report->end == BB_CHILD_INTERRUPTED)
        snprintf(words, capacity, "interrupted");
    else if (WIFSIGNALED(status)) {
        report->end = BB_CHILD_CRASHED;
        snprintf(words, capacity, "signal %d (%s)", WTERMSIG(status), strsignal(WTERMSIG(status)));
    } else if (ended == GAVE_UP) {
        report->end = BB_CHILD_GAVE_UP;
        snprintf(words, capacity, "gave up");
    } else if (ended == STOPPED) {
        report->end = BB_CHILD_STOPPED;
        snprintf(words, capacity, "stopped");
    } else if (ended != DONE) {
        report->end = BB_CHILD_CRASHED;
        snprintf(words, capacity, "ended by exit(%d)", WEXITSTATUS(status));
    }
}

static bb_status run_child(int (*work)(void *user), void *user, const bb_child_limits *limits,
                           int out, bb_child_report *report)
{
    const pid_t parent = getpid();
    int status = 0;
    signal(SIGCHLD, SIG_DFL); /* an ignored signal would discard the status */
    fflush(NULL);             /* the child would write buffered text again */
    const pid_t child = fork();
    if (child < 0)
        return bb_fail(BB_FAILED, "cannot start a process: %s", strerror(errno));
    if (child == 0)
        be_child(work, user, out, parent);
    report->end = watch(child, limits, &status);
    name_end(limits, status, atomic_load(&page->ended), report);
    read_last_line(out, report->said, sizeof report->said);
    return BB_OK;
}

bb_status bb_child_run(int (*work)(void *user), void *user, const bb_child_limits *limits,
                       bb_child_report *report)
{
    memset(report, 0, sizeof *report);
    const int out = memfd_create("bvhbench", MFD_CLOEXEC);
    if (out < 0)
        return bb_fail(BB_FAILED, "cannot start a process: %s", strerror(errno));
    page = mmap(NULL, sizeof *page, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    bb_status status = page != MAP_FAILED
                           ? run_child(work, user, limits, out, report)
                           : bb_fail(BB_FAILED, "cannot start a process: %s", strerror(errno));
    if (page != MAP_FAILED)
        munmap(page, sizeof *page);
    page = NULL;
    close(out);
    return status;
}
