#include "framework/builder/idle.h"

#include "framework/base/clock.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>
#include <xxhash.h>

static const double watch_ms = 0.5;
/* Threads may go on for so long: pools that wait actively, for the next piece of work, end this
 * soon, and so does what a driver does after a command. On a busy machine they need longer, and are
 * told from those that work by how much. */
static const double patience_ms = 100, longest_ms = 1000, work_ms = 40;
/* A thread sleeps unless it runs for so much of the time in which it is watched, or waits for a
 * processor after it. */
static const double awake = 0.25;

/* What is known of a thread. */
typedef struct thread {
    int id;
    uint64_t builder; /* hash of the builder to which it belongs; 0: none */
    bool found, told; /* it went on working; its builder knows */
    bool awake;       /* when it was watched last */
    double since_ms;  /* processor time since the hook has returned */
} thread;

static thread threads[BB_IDLE_THREADS];
static uint32_t thread_count;

static bool has_children(void)
{
    siginfo_t unused;
    return waitid(P_ALL, 0, &unused, WEXITED | WNOHANG | WNOWAIT | __WALL) == 0;
}

void bb_idle_take(bb_idle *now)
{
    DIR *folder = opendir("/proc/self/task");
    now->count = 0;
    for (struct dirent *e; folder != NULL && (e = readdir(folder)) != NULL;)
        if (e->d_name[0] != '.' && now->count < BB_IDLE_THREADS)
            now->ids[now->count++] = atoi(e->d_name);
    if (folder != NULL)
        closedir(folder);
    now->children = has_children();
}

static bool is_among(const bb_idle *some, int id)
{
    bool among = false;
    for (uint32_t i = 0; i < some->count; i++)
        among = among || some->ids[i] == id;
    return among;
}

/* Returns the processor time of a thread of this process, by the clock that Linux gives each
 * (clock_getcpuclockid(3) for its id); 0 if it has ended. */
static double thread_ms(int id)
{
    struct timespec time = {0};
    clock_gettime((clockid_t)(~(unsigned)id << 3 | 6), &time);
    return 1e3 * (double)time.tv_sec + 1e-6 * (double)time.tv_nsec;
}

static bool is_runnable(int id)
{
    char path[64], state = 'S';
    snprintf(path, sizeof path, "/proc/self/task/%d/stat", id);
    FILE *file = fopen(path, "r");
    if (file == NULL)
        return false;
    if (fscanf(file, "%*d (%*[^)]) %c", &state) != 1)
        state = 'S';
    fclose(file);
    return state == 'R';
}

/* Gets the thread's own name, as its library gave it; "" if it has ended. */
static void get_name(int id, char *name, size_t size)
{
    char path[64];
    snprintf(path, sizeof path, "/proc/self/task/%d/comm", id);
    FILE *file = fopen(path, "r");
    name[0] = '\0';
    if (file == NULL)
        return;
    if (fgets(name, (int)size, file) == NULL)
        name[0] = '\0';
    name[strcspn(name, "\n")] = '\0';
    fclose(file);
}

/* Forgets threads that have ended, and takes those that are new as the builder's. */
static void update(const bb_idle *before, const bb_idle *now, uint64_t builder)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < thread_count; i++)
        if (is_among(now, threads[i].id))
            threads[kept++] = threads[i];
    thread_count = kept;
    for (uint32_t i = 0; i < now->count && thread_count < BB_IDLE_THREADS; i++) {
        bool known = false;
        for (uint32_t k = 0; k < thread_count; k++)
            known = known || threads[k].id == now->ids[i];
        if (!known)
            threads[thread_count++] =
                (thread){.id = now->ids[i], .builder = is_among(before, now->ids[i]) ? 0 : builder};
    }
}

/* Watches all threads but those that were found. Returns whether one is awake. */
static bool watch(void)
{
    const int own = gettid();
    const double start = bb_wall_ms();
    double before[BB_IDLE_THREADS];
    bool any = false;
    for (uint32_t i = 0; i < thread_count; i++)
        before[i] = thread_ms(threads[i].id);
    nanosleep(&(struct timespec){.tv_nsec = (long)(watch_ms * 1e6)}, NULL);
    const double most = awake * (bb_wall_ms() - start);
    for (uint32_t i = 0; i < thread_count; i++) {
        thread *t = &threads[i];
        const double ms = thread_ms(t->id) - before[i];
        t->since_ms += ms;
        t->awake = t->id != own && !t->found && (ms > most || is_runnable(t->id));
        any = any || t->awake;
    }
    return any;
}

/* Notes threads that have worked since the hook has returned. Returns whether others are awake. */
static bool find_those_at_work(void)
{
    bool any = false;
    for (uint32_t i = 0; i < thread_count; i++) {
        thread *t = &threads[i];
        if (!t->awake)
            continue;
        t->found = t->since_ms > work_ms;
        any = any || !t->found;
    }
    return any;
}

/* Waits until all threads sleep. Else notes those that have worked. */
static void wait_for_sleep(const bb_idle *before, uint64_t builder, bb_idle *now)
{
    const double start = bb_wall_ms();
    for (uint32_t i = 0; i < thread_count; i++)
        threads[i].since_ms = 0;
    for (bool any = true; any && bb_wall_ms() - start < longest_ms;) {
        bb_idle_take(now);
        update(before, now, builder);
        any = watch();
        if (bb_wall_ms() - start > patience_ms)
            any = find_those_at_work();
    }
}

const char *bb_idle_left(const bb_idle *before, const char *builder)
{
    static char text[160];
    const uint64_t hash = XXH3_64bits(builder, strlen(builder));
    bb_idle now;
    wait_for_sleep(before, hash, &now);
    uint32_t count = 0;
    const thread *first = NULL;
    for (uint32_t i = 0; i < thread_count; i++) {
        thread *t = &threads[i];
        if (!t->found || t->told || (t->builder != 0 && t->builder != hash))
            continue;
        t->told = true;
        first = count++ == 0 ? t : first;
    }
    if (first == NULL)
        return now.children && !before->children ? "a process" : NULL;
    char name[32];
    get_name(first->id, name, sizeof name);
    if (count == 1)
        snprintf(text, sizeof text, "a thread at work (%s, %.0f ms since)", name, first->since_ms);
    else
        snprintf(text, sizeof text, "%u threads at work (one: %s, %.0f ms since)", count, name,
                 first->since_ms);
    return text;
}
