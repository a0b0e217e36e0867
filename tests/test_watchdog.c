/* The watch over `check`: what it gives up, and that it does not count the driver's compiler. What
 * compiling took, and from where it came. About 10 s, of waiting. */
#include "framework/base/clock.h"
#include "framework/cli/cli.h"
#include "framework/cli/watchdog.h"
#include "tests/device_fixture.h"

#include <dlfcn.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

/* In place of the driver's: it takes this many seconds longer, the first time for each source. */
static double slower;
static char slowed[1 << 20];

cl_int clBuildProgram(cl_program program, cl_uint count, const cl_device_id *devices,
                      const char *options,
                      void(CL_CALLBACK *notify)(cl_program program, void *data), void *data)
{
    __typeof__(&clBuildProgram) real;
    *(void **)&real = dlsym(RTLD_NEXT, "clBuildProgram");
    char source[sizeof slowed];
    if (slower > 0 &&
        clGetProgramInfo(program, CL_PROGRAM_SOURCE, sizeof source, source, NULL) == CL_SUCCESS &&
        strcmp(source, slowed) != 0) {
        const double end = bb_wall_ms() + 1e3 * slower; /* the watch's signal ends a sleep */
        while (bb_wall_ms() < end)
            usleep(1000);
        strcpy(slowed, source);
    }
    return real(program, count, devices, options, notify, data);
}

/* The exit status of a process that does `work` under a watch of one second, and what it wrote. */
static int watched(void (*work)(void), char *said, size_t capacity)
{
    int ends[2], status = -1;
    assert_int_equal(pipe(ends), 0);
    pid_t child = fork();
    if (child == 0) {
        dup2(ends[1], STDOUT_FILENO);
        bb_watchdog_start(1, "given up\n");
        work();
        bb_watchdog_stop();
        _exit(BB_EXIT_OK);
    }
    close(ends[1]);
    ssize_t length = read(ends[0], said, capacity - 1);
    said[length > 0 ? length : 0] = '\0';
    close(ends[0]);
    assert_int_equal(waitpid(child, &status, 0), child);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

static void wait_s(double seconds)
{
    for (double end = bb_wall_ms() + 1e3 * seconds; bb_wall_ms() < end;)
        usleep(10000);
}

static void hang(void)
{
    wait_s(60);
}

static void be_quick(void)
{
    wait_s(0.1);
}

static void compile_long(void)
{
    bb_uncounted_begin();
    wait_s(2.5);
    bb_uncounted_end();
    wait_s(0.2);
}

static void compile_and_hang(void)
{
    bb_uncounted_begin();
    wait_s(1.5);
    bb_uncounted_end();
    hang();
}

static void test_watch(void **state)
{
    (void)state;
    static const struct {
        void (*work)(void);
        int status;
        const char *said;
    } cases[] = {
        {be_quick, BB_EXIT_OK, ""},
        {hang, BB_EXIT_WRONG, "given up\n"},
        {compile_long, BB_EXIT_OK, ""},
        {compile_and_hang, BB_EXIT_WRONG, "given up\n"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char said[64];
        int status = watched(cases[i].work, said, sizeof said);
        if (status != cases[i].status || strcmp(said, cases[i].said) != 0)
            fail_msg("case %zu: exit status %d, '%s'", i, status, said);
    }
}

/* A driver that compiles for more than the limit does not hang. */
static void test_compiling_is_not_counted(void **state)
{
    (void)state;
    cl_program program;
    double before = bb_uncounted_ms();
    slower = 1.5;
    bb_watchdog_start(1, "test_watchdog: compiling was counted\n");
    ASSERT_OK(bb_program_build(device, bb_source_find("scan_cpu.cl"), "-DBB_WATCHED", &program));
    bb_watchdog_stop();
    slower = 0;
    bb_program_release(program);
    assert_true(bb_uncounted_ms() - before >= 1500);
}

static void test_what_compiling_took(void **state)
{
    (void)state;
    bb_compiling before, after;
    cl_program program;
    bb_programs_clear(device);
    bb_programs_measure(device, &before);
    assert_int_equal(before.programs, 0);
    assert_string_equal(before.cache, "not known");
    slower = 4; /* far more than a busy machine takes for a program from the cache */
    slowed[0] = '\0';
    ASSERT_OK(bb_program_build(device, bb_source_find("scan_cpu.cl"), "-DBB_TOOK", &program));
    bb_program_release(program);
    bb_programs_measure(device, &after);
    assert_int_equal(after.programs, 1);
    assert_true(after.ms >= 4000);
    assert_string_equal(after.cache, "cold");

    /* What takes as long each time came from the cache, or there is none. Where another program
     * takes the processor, one of the two takes longer: three tries. */
    slower = 0;
    for (int i = 0; i < 3 && strcmp(after.cache, "warm") != 0; i++) {
        bb_programs_clear(device);
        for (int twice = 0; twice < 2; twice++) {
            ASSERT_OK(
                bb_program_build(device, bb_source_find("scan_cpu.cl"), "-DBB_TOOK", &program));
            bb_program_release(program);
        }
        bb_programs_measure(device, &after);
        assert_int_equal(after.programs, 1);
    }
    assert_string_equal(after.cache, "warm");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_watch),
        cmocka_unit_test(test_compiling_is_not_counted),
        cmocka_unit_test(test_what_compiling_took),
    };
    return cmocka_run_group_tests(tests, open_device, close_device);
}
