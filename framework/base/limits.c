#ifndef _GNU_SOURCE
#define _GNU_SOURCE /* sched_getaffinity() */
#endif
#include "framework/base/limits.h"

#include <math.h>
#include <pthread.h>
#include <sched.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

/* ---- control groups ---- */

/* Reads up to two numbers of a small file; returns how many there were. "max" is none. */
static int read_numbers(const char *folder, const char *name, double numbers[2])
{
    char path[4200];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "r");
    if (file == NULL)
        return 0;
    int count = fscanf(file, "%lf %lf", &numbers[0], &numbers[1]);
    fclose(file);
    return count > 0 ? count : 0;
}

static void take_bytes(bb_group_limits *limits, const char *folder, const char *name)
{
    double bytes[2];
    if (read_numbers(folder, name, bytes) == 1 && bytes[0] > 0 && bytes[0] < 0x1p60 &&
        (uint64_t)bytes[0] < limits->bytes)
        limits->bytes = (uint64_t)bytes[0];
}

static void take_cores(bb_group_limits *limits, double quota, double period)
{
    if (quota > 0 && period > 0 && quota / period < limits->cores)
        limits->cores = quota / period;
}

/* Takes what one group's folder says, whichever version it is of. */
static void take_group(bb_group_limits *limits, const char *folder)
{
    double numbers[2], period[2];
    take_bytes(limits, folder, "memory.max");
    take_bytes(limits, folder, "memory.limit_in_bytes");
    if (read_numbers(folder, "cpu.max", numbers) == 2)
        take_cores(limits, numbers[0], numbers[1]);
    if (read_numbers(folder, "cpu.cfs_quota_us", numbers) == 1 &&
        read_numbers(folder, "cpu.cfs_period_us", period) == 1)
        take_cores(limits, numbers[0], period[0]);
}

/* Takes the group at FOLDER/CONTROLLER/PATH and all above it. In a container, a path may be that of
 * the host and not be there: what is mounted is the container's own group then. */
static void take_groups(bb_group_limits *limits, const char *folder, const char *controller,
                        const char *path)
{
    char group[4096];
    const int root = snprintf(group, sizeof group, "%s%s%s", folder,
                              controller[0] != '\0' ? "/" : "", controller);
    const int length = snprintf(group + root, sizeof group - (size_t)root, "%s", path);
    if (length < 0 || (size_t)(root + length) >= sizeof group)
        return;
    for (char *end = group + root + length; end != NULL; end = strrchr(group + root, '/')) {
        *end = '\0';
        take_group(limits, group);
    }
}

/* Whether a list "cpu,cpuacct" has the word. */
static bool lists(const char *list, const char *word)
{
    const size_t length = strlen(word);
    for (const char *at = list; at != NULL; at = strchr(at, ',')) {
        at += *at == ',';
        if (strncmp(at, word, length) == 0 && (at[length] == ',' || at[length] == '\0'))
            return true;
    }
    return false;
}

bb_group_limits bb_group_limits_read(const char *groups, const char *folder)
{
    bb_group_limits limits = {UINT64_MAX, INFINITY};
    char line[4096];
    FILE *file = fopen(groups, "r");
    while (file != NULL && fgets(line, sizeof line, file) != NULL) {
        /* NUMBER:CONTROLLERS:PATH; version 2 has no list of controllers */
        line[strcspn(line, "\n")] = '\0';
        char *controllers = strchr(line, ':');
        char *path = controllers != NULL ? strchr(controllers + 1, ':') : NULL;
        if (path == NULL)
            continue;
        *path++ = '\0';
        controllers++;
        if (controllers[0] == '\0') {
            take_groups(&limits, folder, "", path);
            take_groups(&limits, folder, "unified", path);
            continue;
        }
        /* those that are mounted together have a link each, whatever the order of their list */
        if (lists(controllers, "memory"))
            take_groups(&limits, folder, "memory", path);
        if (lists(controllers, "cpu"))
            take_groups(&limits, folder, "cpu", path);
        if (lists(controllers, "memory") || lists(controllers, "cpu"))
            take_groups(&limits, folder, controllers, path);
    }
    if (file != NULL)
        fclose(file);
    return limits;
}

static bb_group_limits group_limits(void)
{
    return bb_group_limits_read("/proc/self/cgroup", "/sys/fs/cgroup");
}

/* ---- Slurm ---- */

/* The variable as a number > 0; 0: there is none. */
static double variable(const char *name)
{
    const char *text = getenv(name);
    const double value = text != NULL ? strtod(text, NULL) : 0;
    return value > 0 && value < 0x1p53 ? value : 0;
}

uint64_t bb_slurm_bytes(void)
{
    if (getenv("SLURM_JOB_ID") == NULL)
        return UINT64_MAX;
    double megabytes = variable("SLURM_MEM_PER_NODE");
    if (megabytes == 0)
        megabytes = variable("SLURM_MEM_PER_CPU") * variable("SLURM_CPUS_ON_NODE");
    return megabytes > 0 && megabytes < 0x1p40 ? (uint64_t)megabytes << 20 : UINT64_MAX;
}

/* ---- all of them ---- */

uint32_t bb_core_count(void)
{
    cpu_set_t set;
    const double groups = group_limits().cores;
    const double slurm = getenv("SLURM_JOB_ID") != NULL ? variable("SLURM_CPUS_PER_TASK") : 0;
    double cores = (double)sysconf(_SC_NPROCESSORS_ONLN);
    if (sched_getaffinity(0, sizeof set, &set) == 0 && CPU_COUNT(&set) > 0)
        cores = CPU_COUNT(&set);
    cores = groups < cores ? ceil(groups) : cores;
    cores = slurm > 0 && slurm < cores ? slurm : cores;
    return cores >= 1 ? (uint32_t)cores : 1;
}

typedef struct memory {
    uint64_t bytes;
    const char *by;
} memory;

static memory limit;
static pthread_once_t limit_once = PTHREAD_ONCE_INIT;

static void lower(uint64_t bytes, const char *by)
{
    if (bytes < limit.bytes)
        limit = (memory){bytes, by};
}

static void read_memory(void)
{
    const long pages = sysconf(_SC_PHYS_PAGES), size = sysconf(_SC_PAGESIZE);
    struct rlimit space;
    limit = (memory){UINT64_MAX, "the machine's memory"};
    if (pages > 0 && size > 0)
        lower((uint64_t)pages * (uint64_t)size, limit.by);
    lower(group_limits().bytes, "the memory that a control group allows");
    lower(bb_slurm_bytes(), "the memory that Slurm allows");
    for (int i = 0; i < 2; i++)
        if (getrlimit(i == 0 ? RLIMIT_AS : RLIMIT_DATA, &space) == 0 &&
            space.rlim_cur != RLIM_INFINITY)
            lower(space.rlim_cur, "the memory that ulimit allows");
}

uint64_t bb_memory_limit(void)
{
    pthread_once(&limit_once, read_memory);
    return limit.bytes;
}

const char *bb_memory_limit_by(void)
{
    pthread_once(&limit_once, read_memory);
    return limit.by;
}
