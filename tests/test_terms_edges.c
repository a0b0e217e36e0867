/* Terms at their edges: what is nobody's fault, what can be put back in part, and what looking at
 * them must not do. Cases that change the process for good run in a child. */
#include "framework/base/interrupt.h"
#include "framework/builder/terms.h"
#include "tests/fixture.h"

#include <stdio.h>
#include <string.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

/* In a child: ends it. */
static void need(bool right, const char *what)
{
    if (right)
        return;
    fprintf(stderr, "not so: %s (%s)\n", what, bb_message());
    _exit(1);
}
#define NEED(right) need((right), #right)

static void in_a_child(void (*work)(void))
{
    int status = -1;
    const pid_t child = fork();
    if (child == 0) {
        work();
        _exit(0);
    }
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

enum { NOBODY = 65534 };

static void drop_privilege(void)
{
    if (geteuid() == 0)
        NEED(setresgid(NOBODY, NOBODY, NOBODY) == 0 && setresuid(NOBODY, NOBODY, NOBODY) == 0);
}

static bool is_blamed(bb_terms *terms, const char *words)
{
    return bb_terms_check(terms, "it", "build", BB_OK) == BB_FAILED &&
           strstr(bb_message(), words) != NULL;
}

static bool is_well(bb_terms *terms)
{
    return bb_terms_check(terms, "it", "build", BB_OK) == BB_OK;
}

/* ---- umask ---- */

static mode_t loosest; /* of the masks that were set: what all of them hid */

mode_t umask(mode_t mask)
{
    loosest &= mask;
    return (mode_t)syscall(SYS_umask, mask);
}

/* Another thread could make a file at any moment. */
static void the_umask_is_never_loosened(void **state)
{
    (void)state;
    bb_terms terms;
    const mode_t before = umask(027);
    loosest = 0777;
    bb_terms_take(&terms);
    ASSERT_OK(bb_terms_check(&terms, "it", "build", BB_OK));
    assert_int_equal(loosest & 027, 027);
    assert_int_equal(umask(before), 027);
}

/* ---- limits ---- */

static void lower_a_hard_limit(void)
{
    bb_terms terms;
    struct rlimit now;
    const struct rlimit before = {100, 200}, low = {50, 150}, lower = {20, 80};
    NEED(setrlimit(RLIMIT_NOFILE, &before) == 0);
    drop_privilege();
    bb_terms_take(&terms);
    NEED(setrlimit(RLIMIT_NOFILE, &low) == 0);
    NEED(is_blamed(&terms, "it changed a resource limit, whose hard limit stays lowered in build"));
    NEED(getrlimit(RLIMIT_NOFILE, &now) == 0 && now.rlim_cur == 100 && now.rlim_max == 150);
    bb_terms_take(&terms);
    NEED(setrlimit(RLIMIT_NOFILE, &lower) == 0);
    NEED(is_blamed(&terms, "a resource limit"));
    NEED(getrlimit(RLIMIT_NOFILE, &now) == 0 && now.rlim_cur == 80 && now.rlim_max == 80);
    bb_terms_take(&terms);
    NEED(is_well(&terms)); /* it is not said of the next hook */
}

static void of_a_lowered_hard_limit_the_soft_one_comes_back(void **state)
{
    (void)state;
    in_a_child(lower_a_hard_limit);
}

/* ---- the working folder ---- */

static char folder[] = "/tmp/bvhbench-test-XXXXXX";

static void lose_the_folder(void)
{
    bb_terms terms;
    struct stat before, now;
    NEED(mkdtemp(folder) != NULL);
    NEED(geteuid() != 0 || chown(folder, NOBODY, NOBODY) == 0);
    drop_privilege();
    NEED(chdir(folder) == 0);
    bb_terms_take(&terms);
    NEED(chmod(folder, 0) == 0);
    NEED(stat(".", &now) != 0);
    NEED(is_well(&terms));
    bb_terms_take(&terms);
    NEED(chdir("/") == 0);
    NEED(is_blamed(&terms, "the working folder, which could not be put back"));
    NEED(chmod(folder, 0700) == 0 && chdir(folder) == 0 && chmod(folder, 0) == 0);
    bb_terms_take(&terms);
    NEED(chmod(folder, 0700) == 0);
    NEED(is_well(&terms));
    NEED(stat(".", &before) == 0);
    bb_terms_take(&terms);
    NEED(rmdir(folder) == 0);
    NEED(is_well(&terms));
    bb_terms_take(&terms);
    NEED(chdir("/") == 0);
    NEED(is_blamed(&terms, "it changed the working folder in build"));
    NEED(stat(".", &now) == 0 && now.st_ino == before.st_ino);
}

/* Others may close it or take it away at any time. */
static void a_lost_folder_is_nobodys_fault(void **state)
{
    (void)state;
    in_a_child(lose_the_folder);
}

/* ---- interrupts ---- */

static void handle(int signal_number)
{
    (void)signal_number;
}

static void interrupt(void)
{
    bb_terms terms;
    struct sigaction now;
    signal(SIGUSR1, handle);
    bb_interrupt_catch();
    bb_terms_take(&terms);
    raise(SIGINT);
    NEED(bb_interrupted());
    NEED(is_well(&terms));
    NEED(sigaction(SIGINT, NULL, &now) == 0 && now.sa_handler == SIG_DFL); /* the next one ends */

    bb_terms_take(&terms);
    signal(SIGTERM, SIG_DFL); /* none came */
    NEED(is_blamed(&terms, "it changed a signal's handler in build"));
    NEED(sigaction(SIGTERM, NULL, &now) == 0 && now.sa_handler != SIG_DFL);
    bb_terms_take(&terms);
    signal(SIGUSR1, SIG_DFL);
    NEED(is_blamed(&terms, "it changed a signal's handler in build"));
    NEED(sigaction(SIGUSR1, NULL, &now) == 0 && now.sa_handler == handle);
    bb_terms_take(&terms);
    signal(SIGINT, SIG_IGN);
    NEED(is_blamed(&terms, "it changed a signal's handler in build"));
    NEED(sigaction(SIGINT, NULL, &now) == 0 && now.sa_handler == SIG_DFL);
}

static void an_interrupt_changes_its_own_handler_alone(void **state)
{
    (void)state;
    in_a_child(interrupt);
}

/* ---- timers ---- */

static void leave_a_timer(void)
{
    bb_terms terms;
    alarm(1000);
    bb_terms_take(&terms);
    alarm(500);
    NEED(is_well(&terms));
    bb_terms_take(&terms);
    alarm(0);
    NEED(is_blamed(&terms, "it changed a timer in build"));
    NEED(alarm(0) > 400);
}

/* As `check` does, whose watchdog may set its alarm anew while a hook runs. */
static void a_timer_that_runs_may_be_set_anew(void **state)
{
    (void)state;
    in_a_child(leave_a_timer);
}

/* ---- standard input, output and error ---- */

static void close_all(void)
{
    bb_terms terms;
    NEED(close(STDIN_FILENO) == 0);
    bb_terms_take(&terms);
    NEED(is_well(&terms)); /* it was closed before */
    bb_terms_take(&terms);
    for (int descriptor = 0; descriptor < 1024; descriptor++)
        close(descriptor);
    NEED(is_blamed(&terms, "standard input, output or error, which could not be put back"));
}

static void who_closes_all_descriptors_is_blamed(void **state)
{
    (void)state;
    in_a_child(close_all);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_umask_is_never_loosened),
        cmocka_unit_test(of_a_lowered_hard_limit_the_soft_one_comes_back),
        cmocka_unit_test(a_lost_folder_is_nobodys_fault),
        cmocka_unit_test(an_interrupt_changes_its_own_handler_alone),
        cmocka_unit_test(a_timer_that_runs_may_be_set_anew),
        cmocka_unit_test(who_closes_all_descriptors_is_blamed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
