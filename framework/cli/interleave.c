#include "framework/cli/interleave.h"

#include "framework/base/clock.h"
#include "framework/base/file.h"
#include "framework/base/interrupt.h"
#include "framework/base/number.h"
#include "framework/base/random.h"
#include "framework/cli/inputs.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* ---- one program, once ---- */

/* Runs the program in the child process, which ends with its parent. Its output is discarded. */
static void become(char *const *arguments, const char *log)
{
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    int nothing = open("/dev/null", O_RDWR);
    int errors = open(log, O_WRONLY | O_CREAT | O_TRUNC, 0666);
    if (nothing < 0 || errors < 0 || dup2(nothing, 0) < 0 || dup2(nothing, 1) < 0 ||
        dup2(errors, 2) < 0)
        _exit(127);
    execv(arguments[0], arguments);
    dprintf(2, "cannot be run: %s\n", strerror(errno));
    _exit(127);
}

/* Waits for the child, and looks now and then for a signal that only the parent got. */
static int wait_for(pid_t child)
{
    const struct timespec pause = {0, 50 * 1000000L};
    int status = 0;
    bool told = false;
    for (pid_t ended; (ended = waitpid(child, &status, WNOHANG)) != child;
         nanosleep(&pause, NULL)) {
        if (ended < 0 && errno != EINTR)
            return -1;
        if (bb_interrupted() && !told)
            told = kill(child, SIGTERM) == 0;
    }
    return status;
}

/* Reads the last line that the program wrote to standard error. */
static void last_line(const char *log, char *line, size_t capacity)
{
    char text[1024];
    FILE *file = fopen(log, "r");
    snprintf(line, capacity, "it says nothing");
    while (file != NULL && fgets(text, sizeof text, file) != NULL) {
        text[strcspn(text, "\n")] = '\0';
        if (text[0] != '\0')
            snprintf(line, capacity, "%.500s", text);
    }
    if (file != NULL)
        fclose(file);
}

/* Checks the exit status. A run that found wrong answers exits with 1 and still counts. */
static bb_status check_end(const char *program, int status, const char *log)
{
    char line[600];
    if (WIFEXITED(status) && WEXITSTATUS(status) <= 1)
        return BB_OK;
    last_line(log, line, sizeof line);
    if (WIFSIGNALED(status))
        return bb_fail(BB_FAILED, "compare: %s run was killed by signal %d: %s", program,
                       WTERMSIG(status), line);
    return bb_fail(BB_INVALID, "compare: %s run: exit status %d: %s", program, WEXITSTATUS(status),
                   line);
}

static bb_status run_once(const bb_interleaving *wanted, const char *program, const char *out,
                          const char *log)
{
    static const char *const own[] = {"--quiet", "--no-pictures", "--charts", "no", "--out"};
    enum { OWN = sizeof own / sizeof own[0] };
    char **arguments = calloc(wanted->argument_count + OWN + 4, sizeof *arguments);
    if (arguments == NULL)
        return bb_fail(BB_FAILED, "compare: no memory");
    size_t n = 0;
    arguments[n++] = (char *)(uintptr_t)program;
    arguments[n++] = (char *)(uintptr_t) "run";
    for (uint32_t i = 0; i < wanted->argument_count; i++)
        arguments[n++] = wanted->arguments[i];
    for (size_t i = 0; i < OWN; i++)
        arguments[n++] = (char *)(uintptr_t)own[i];
    arguments[n++] = (char *)(uintptr_t)out;
    fflush(NULL);
    pid_t child = fork();
    if (child == 0)
        become(arguments, log);
    bb_status status = child > 0 ? check_end(program, wait_for(child), log)
                                 : bb_fail(BB_FAILED, "compare: fork: %s", strerror(errno));
    free(arguments);
    return status;
}

/* ---- all of them ---- */

static bb_status measure(const bb_interleaving *wanted, const char *folder, uint32_t round, int k,
                         bb_cell_set *set)
{
    char name[48], out[PATH_MAX], log[PATH_MAX], file[PATH_MAX];
    bb_results *results = NULL;
    snprintf(name, sizeof name, "%u-%s", round, k == 0 ? "before" : "after");
    BB_TRY(bb_join_path(out, folder, name));
    snprintf(name, sizeof name, "%u-%s.log", round, k == 0 ? "before" : "after");
    BB_TRY(bb_join_path(log, folder, name));
    BB_TRY(run_once(wanted, wanted->programs[k], out, log));
    if (bb_interrupted())
        return BB_OK;
    BB_TRY(bb_join_path(file, out, "results.json"));
    BB_TRY(bb_results_read(file, &results));
    bb_status status = bb_cell_set_of_pair(bb_results_table(results), wanted->programs[k], set);
    bb_results_destroy(results);
    return status;
}

/* Says what all pairs take, by the discarded one, and fits their number into the time. */
static bb_status foretell(const bb_interleaving *wanted, double pair_ms, uint32_t *rounds)
{
    const double left = wanted->ends_ms - bb_wall_ms();
    char pair[BB_TIME_TEXT], all[BB_TIME_TEXT];
    if (wanted->ends_ms > 0 && *rounds * pair_ms > left)
        *rounds = left > 0 ? (uint32_t)(left / pair_ms) : 0;
    bb_time_words(pair_ms / 1e3, pair);
    if (*rounds < wanted->least)
        return bb_fail(BB_REFUSED,
                       "compare --time: a pair takes %s, and fewer than %u tell nothing: give more "
                       "time, or arguments of run with which it takes less",
                       pair, wanted->least);
    if (!wanted->quiet)
        fprintf(stderr, "a pair takes about %s, %u of them %s\n", pair, *rounds,
                bb_time_words(*rounds * pair_ms / 1e3, all));
    return BB_OK;
}

static bb_status run_pairs(const bb_interleaving *wanted, const char *folder, bb_cell_set *sets[2],
                           uint32_t *pairs)
{
    bb_random random = bb_random_make(wanted->seed, 0);
    uint32_t rounds = wanted->rounds;
    for (uint32_t round = 0; round <= rounds; round++) {
        const double start_ms = bb_wall_ms();
        int first = (int)bb_random_below(&random, 2);
        if (!wanted->quiet)
            fprintf(stderr, "pair %u of %u%s\n", round, rounds,
                    round == 0 ? ": to warm up, discarded" : "");
        for (int turn = 0; turn < 2; turn++) {
            int k = turn == 0 ? first : 1 - first;
            BB_TRY(measure(wanted, folder, round, k, &sets[k][round]));
            if (bb_interrupted())
                return BB_OK;
        }
        *pairs = round;
        if (round == 0)
            BB_TRY(foretell(wanted, bb_wall_ms() - start_ms, &rounds));
    }
    return BB_OK;
}

static bb_status check_program(const char *path)
{
    struct stat info;
    if (stat(path, &info) != 0)
        return bb_fail(BB_INVALID, "compare: program %s: %s", path, strerror(errno));
    if (!S_ISREG(info.st_mode) || access(path, X_OK) != 0)
        return bb_fail(BB_INVALID, "compare: %s is no program that can be run", path);
    return BB_OK;
}

bb_status bb_interleave(const bb_interleaving *wanted, bb_cell_set *sets[2], uint32_t *pairs)
{
    char temporary[PATH_MAX] = "";
    *pairs = 0;
    BB_TRY(check_program(wanted->programs[0]));
    BB_TRY(check_program(wanted->programs[1]));
    if (wanted->folder == NULL)
        BB_TRY(bb_temporary_folder(temporary));
    bb_interrupt_catch();
    bb_status status =
        run_pairs(wanted, wanted->folder != NULL ? wanted->folder : temporary, sets, pairs);
    bb_remove_folder(temporary);
    return bb_interrupted() ? BB_OK : status;
}
