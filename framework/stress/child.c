#include "framework/stress/child.h"

#include "framework/base/clock.h"
#include "framework/base/interrupt.h"

#include <errno.h>
#include <fcntl.h>
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
    LOOK_MS = 10,         /* between looks at the child */
    FILE_BYTES = 1 << 28, /* that the child may write into one file: its log, say */
};

/* Shared by parent and child. NULL: there is no child. */
static struct page {
    atomic_uint pieces; /* of work that were done */
    atomic_uint ended;  /* work() returned: DONE or GAVE_UP; what a library exits with is neither */
} * page;

void bb_child_alive(void)
{
    if (page != NULL)
        atomic_fetch_add(&page->pieces, 1);
}

/* Resident memory, in MiB; 0: not known. */
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

/* In a process group of its own: Ctrl-C is for the parent, and killing the group also gets what
 * drivers start. */
static void be_child(int (*work)(void *user), void *user, const char *log, pid_t parent)
{
    int out = open(log, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    const struct rlimit most = {FILE_BYTES, FILE_BYTES};
    setpgid(0, 0);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    setrlimit(RLIMIT_FSIZE, &most);
    signal(SIGINT, SIG_DFL); /* it ends by them: half of the work is no result */
    signal(SIGTERM, SIG_DFL);
    signal(SIGHUP, SIG_DFL);
    if (getppid() != parent)
        _exit(1);
    if (out >= 0) {
        dup2(out, STDOUT_FILENO);
        dup2(out, STDERR_FILENO);
    }
    atomic_store(&page->ended, work(user) == 0 ? DONE : GAVE_UP);
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
            break; /* somebody else has waited for it: the page says how it ended */
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
                kill(child, SIGKILL); /* before it has a group */
            }
        }
        nanosleep(&pause, NULL);
    }
    kill(-child, SIGKILL); /* what it may have left */
    return killed;
}

bb_status bb_child_run(int (*work)(void *user), void *user, const bb_child_limits *limits,
                       const char *log, bb_child_end *end, char *words, size_t capacity)
{
    pid_t parent = getpid();
    signal(SIGCHLD, SIG_DFL); /* ignored, it leaves no status */
    page = mmap(NULL, sizeof *page, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (page == MAP_FAILED) {
        page = NULL;
        return bb_fail(BB_FAILED, "cannot start a process: %s", strerror(errno));
    }
    fflush(NULL); /* or the child would write it too */
    pid_t child = fork();
    int status = 0;
    words[0] = '\0';
    if (child == 0)
        be_child(work, user, log, parent);
    const int problem = errno;
    if (child > 0)
        *end = watch(child, limits, &status);
    const unsigned ended = atomic_load(&page->ended);
    munmap(page, sizeof *page);
    page = NULL;
    if (child < 0)
        return bb_fail(BB_FAILED, "cannot start a process: %s", strerror(problem));
    if (*end == BB_CHILD_HUNG)
        snprintf(words, capacity, "killed after %g s", limits->seconds);
    else if (*end == BB_CHILD_FLOODED)
        snprintf(words, capacity, "killed beyond %llu MiB", (unsigned long long)limits->megabytes);
    else if (*end == BB_CHILD_INTERRUPTED)
        snprintf(words, capacity, "interrupted");
    else if (WIFSIGNALED(status)) {
        *end = BB_CHILD_CRASHED;
        snprintf(words, capacity, "signal %d (%s)", WTERMSIG(status), strsignal(WTERMSIG(status)));
    } else if (ended == GAVE_UP) {
        *end = BB_CHILD_GAVE_UP;
        snprintf(words, capacity, "gave up");
    } else if (ended != DONE) {
        *end = BB_CHILD_CRASHED;
        snprintf(words, capacity, "ended by exit(%d)", WEXITSTATUS(status));
    }
    return BB_OK;
}
