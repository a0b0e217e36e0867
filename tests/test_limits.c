/* Limits of control groups, of both versions, as files have them; Slurm's; what the program makes
 * of affinity and ulimit. How processors are run, as files have it. */
#include "framework/base/limits.h"
#include "framework/base/memory.h"
#include "framework/device/processors.h"
#include "tests/program_fixture.h"

#include <math.h>

/* `files`: lines "NAME TEXT", of files in the folder fs. */
static bb_group_limits read_groups(const char *groups, const char *files)
{
    char command[4096], paths[2][128];
    snprintf(command, sizeof command,
             "cd %s && rm -rf fs && printf '%s' >groups && printf '%s' | while read -r name text; "
             "do mkdir -p \"fs/$(dirname \"$name\")\"; echo \"$text\" >\"fs/$name\"; done",
             folder, groups, files);
    assert_int_equal(system(command), 0);
    snprintf(paths[0], sizeof paths[0], "%s/groups", folder);
    snprintf(paths[1], sizeof paths[1], "%s/fs", folder);
    return bb_group_limits_read(paths[0], paths[1]);
}

typedef struct group_case {
    const char *groups, *files;
    double bytes, cores; /* INFINITY: none */
} group_case;

static void the_least_of_all_groups_counts(void **state)
{
    (void)state;
    static const group_case cases[] = {
        {"0::/\\n", "memory.max 1000000\\ncpu.max 150000 100000\\n", 1e6, 1.5},
        {"0::/\\n", "memory.max max\\ncpu.max max 100000\\n", INFINITY, INFINITY},
        {"0::/a/b\\n", "a/b/memory.max 3000\\na/memory.max 2000\\nmemory.max 4000\\n", 2000,
         INFINITY},
        {"0::/a/b\\n", "a/b/cpu.max max 100000\\na/cpu.max 50000 100000\\n", INFINITY, 0.5},
        {"3:memory:/a\\n2:cpu,cpuacct:/a\\n0::/\\n",
         "memory/a/memory.limit_in_bytes 5000\\nmemory/memory.limit_in_bytes 9223372036854771712\\n"
         "cpu,cpuacct/a/cpu.cfs_quota_us 400000\\ncpu,cpuacct/a/cpu.cfs_period_us 100000\\n",
         5000, 4},
        {"4:cpuacct,cpu:/a\\n", "cpu/a/cpu.cfs_quota_us 100000\\ncpu/a/cpu.cfs_period_us 100000\\n",
         INFINITY, 1},
        {"2:cpu:/\\n", "cpu/cpu.cfs_quota_us -1\\ncpu/cpu.cfs_period_us 100000\\n", INFINITY,
         INFINITY},
        /* the host's path is not there in the container */
        {"3:memory:/docker/0123\\n", "memory/memory.limit_in_bytes 7000\\n", 7000, INFINITY},
        {"1:cpuset:/a\\n", "cpuset/a/memory.max 1\\n", INFINITY, INFINITY},
        {"nothing\\n:\\n1:memory\\n0::/\\n", "memory.max -5\\ncpu.max x 1\\n", INFINITY, INFINITY},
        {"0::/../..\\n", "memory.max 8000\\n", 8000, INFINITY},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const bb_group_limits found = read_groups(cases[i].groups, cases[i].files);
        const double bytes = found.bytes == UINT64_MAX ? INFINITY : (double)found.bytes;
        if (bytes != cases[i].bytes || found.cores != cases[i].cores)
            fail_msg("%s %s: %g bytes, %g cores", cases[i].groups, cases[i].files, bytes,
                     found.cores);
    }
    const bb_group_limits none = bb_group_limits_read("/nowhere/groups", "/nowhere");
    assert_true(none.bytes == UINT64_MAX && none.cores == INFINITY);
}

static void slurm_tells_its_memory(void **state)
{
    (void)state;
    unsetenv("SLURM_JOB_ID");
    setenv("SLURM_MEM_PER_NODE", "2048", 1);
    assert_true(bb_slurm_bytes() == UINT64_MAX);
    setenv("SLURM_JOB_ID", "7", 1);
    assert_true(bb_slurm_bytes() == 2048ull << 20);
    setenv("SLURM_MEM_PER_NODE", "0", 1); /* all of it */
    assert_true(bb_slurm_bytes() == UINT64_MAX);
    setenv("SLURM_MEM_PER_CPU", "512", 1);
    setenv("SLURM_CPUS_ON_NODE", "4", 1);
    assert_true(bb_slurm_bytes() == 2048ull << 20);
    unsetenv("SLURM_JOB_ID");
}

static void the_program_keeps_to_them(void **state)
{
    (void)state;
    const outcome *o = run_with("SLURM_JOB_ID=7 SLURM_MEM_PER_NODE=64",
                                "run --scene soup:n=1000000 --builder lbvh --rays none --out big");
    if (o->exit_status != 2 ||
        strstr(o->err, "three quarters of the memory that Slurm allows are 50331648") == NULL)
        fail_msg("exit %d: %s", o->exit_status, o->err);
    o = run_with("taskset -c 0", "list devices");
    if (strstr(o->out, "pthread") != NULL && strstr(o->out, "/ 1 compute units") == NULL)
        fail_msg("%s", o->out);
}

static void how_processors_are_run(void **state)
{
    (void)state;
    static const struct {
        const char *files, *mine, *governor, *smt, *boost, *list;
    } cases[] = {
        {"online 0-3\n", "0123", "", "", "", "all"}, /* a virtual machine */
        {"online 0-3\n", "013", "", "", "", "0-1,3"},
        {"online 0,2-3\nsmt/active 0\ncpufreq/boost 0\n", "023", "", "off", "off", "all"},
        {"online 0-3\nsmt/active 1\nintel_pstate/no_turbo 0\n"
         "cpu1/cpufreq/scaling_governor performance\ncpu2/cpufreq/scaling_governor powersave\n",
         "1", "performance", "on", "on", "1"},
        {"online 0-3\nintel_pstate/no_turbo 1\ncpu1/cpufreq/scaling_governor performance\n"
         "cpu2/cpufreq/scaling_governor powersave\ncpu3/cpufreq/scaling_governor performance\n",
         "123", "performance powersave", "", "off", "1-3"},
        {"cpufreq/boost 1\n", "2", "", "", "on", "2"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char root[128];
        bb_processors found;
        cpu_set_t mine;
        (void)read_groups("", cases[i].files);
        snprintf(root, sizeof root, "%s/fs", folder);
        CPU_ZERO(&mine);
        for (const char *c = cases[i].mine; *c != '\0'; c++)
            CPU_SET(*c - '0', &mine);
        bb_processors_read(root, &mine, &found);
        if (strcmp(found.governor, cases[i].governor) != 0 ||
            strcmp(found.smt, cases[i].smt) != 0 || strcmp(found.boost, cases[i].boost) != 0 ||
            strcmp(found.list, cases[i].list) != 0)
            fail_msg("case %zu: '%s', '%s', '%s', '%s'", i, found.governor, found.smt, found.boost,
                     found.list);
    }
}

/* The context of a run has it. */
static void a_run_says_where_it_may_run(void **state)
{
    (void)state;
    const outcome *o =
        run_with("taskset -c 0", "run --scene single --builder sah --rays none --quiet --repeats 1 "
                                 "--no-pictures --charts no --out pinned");
    if (o->exit_status != 0)
        fail_msg("%s", o->err);
    cJSON *json = read_results("pinned/results.json");
    const cJSON *where = cJSON_GetObjectItem(cJSON_GetObjectItem(json, "context"), "processors");
    const bool only = sysconf(_SC_NPROCESSORS_ONLN) == 1;
    assert_string_equal(cJSON_GetStringValue(where), only ? "all" : "0");
    cJSON_Delete(json);
}

/* What is gone is in the peak since the mark before it, not in that after it, and never lost. */
static void a_peak_is_counted_from_its_mark(void **state)
{
    (void)state;
    const uint64_t bytes = 64 << 20, most = bytes / 8; /* of other pages, that come and go */
    bb_host_mark_peak();
    const uint64_t before = bb_host_resident();
    char *block = NULL;
    assert_int_equal(bb_host_alloc(NULL, bytes, "a block", &block), BB_OK);
    memset(block, 1, bytes);
    bb_host_free(block);
    const uint64_t peak = bb_host_peak_since_mark();
    assert_true(peak >= before + bytes - most);
    bb_host_mark_peak();
#ifndef __SANITIZE_ADDRESS__ /* which keeps what is freed for a while */
    assert_true(bb_host_peak_since_mark() < before + most);
#endif
    assert_true(bb_host_peak() >= peak);
}

/* PoCL with a core for each thread aborts if there are more threads than cores. */
static void more_threads_than_cores_are_allowed(void **state)
{
    (void)state;
    char before[128];
    const unsigned cores = (unsigned)bb_core_count();
    snprintf(before, sizeof before, "POCL_MAX_PTHREAD_COUNT=%u POCL_CPU_MAX_CU_COUNT=%u", cores + 1,
             cores + 1);
    const outcome *o = run_with(before, "check --builder lbvh --scene cube --side 6 --quiet");
    if (o->exit_status != 0)
        fail_msg("%s: exit %d: %s", before, o->exit_status, o->err);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(more_threads_than_cores_are_allowed),
        cmocka_unit_test(the_least_of_all_groups_counts),
        cmocka_unit_test(slurm_tells_its_memory),
        cmocka_unit_test(the_program_keeps_to_them),
        cmocka_unit_test(how_processors_are_run),
        cmocka_unit_test(a_run_says_where_it_may_run),
        cmocka_unit_test(a_peak_is_counted_from_its_mark),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
