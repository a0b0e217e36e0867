/* What this process may use of the machine: what the machine has, or the least that control groups
 * (v1 and v2: containers), Slurm, affinity and ulimit leave of it. */
#ifndef BB_LIMITS_H
#define BB_LIMITS_H

#include <stdint.h>

/* Returns the number of cores this process may use, at least 1. Half a core is one. */
uint32_t bb_core_count(void);

/* Returns the memory that this process may use, in bytes; UINT64_MAX: unknown. It is read once. */
uint64_t bb_memory_limit(void);
/* Returns what that is: "the machine's memory", or "the memory that ..." a control group, Slurm or
 * ulimit allows. */
const char *bb_memory_limit_by(void);

/* ---- for tests: the same, of other files ---- */

/* The least limits of the groups of a process and of all groups above them. `groups` is its
 * /proc/PID/cgroup, `folder` where control groups are mounted: /sys/fs/cgroup. */
typedef struct bb_group_limits {
    uint64_t bytes; /* UINT64_MAX: none */
    double cores;   /* INFINITY: none */
} bb_group_limits;
bb_group_limits bb_group_limits_read(const char *groups, const char *folder);

/* Bytes that a Slurm job's environment tells (SLURM_MEM_PER_NODE, or SLURM_MEM_PER_CPU of
 * SLURM_CPUS_ON_NODE); UINT64_MAX: no job, or no limit. */
uint64_t bb_slurm_bytes(void);

#endif
