/* Bugs planted in the device code, one at a time (`--kernels-from`): what makes `exact` exact is
 * exercised end to end, so `run` must say that answers are wrong, or unlike those of another
 * kernel. Without a bug it must not. The bugs are those of tests/mutants/kernels.txt that have a
 * `run`; scripts/mutants plants them and the others, and asks all tests. */
#include "framework/base/random.h"
#include "tests/fixture.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>

static const char list[] = BB_TEST_SOURCE_DIR "/tests/mutants/kernels.txt";
static const char *folder; /* has the device code in place of the program's */

typedef struct plant {
    char name[64], file[128], run[256];
    char before[1024], after[1024]; /* `before` stands there once */
} plant;

enum { PLANTS_MAX = 128, SOME = 8, FEW = 2 };
static plant plants[PLANTS_MAX];
static int plant_count;

static const char common[] = /* as scripts/mutants has it */
    "--repeats 1 --no-pictures --charts no --quiet --rays edges:jitter=64 "
    "--rays edges:jitter=64,from=around --rays primary --rays random --size 64x64 "
    "--max-rays 65536";

static void read_file(const char *path, char *text, size_t capacity)
{
    FILE *file = fopen(path, "rb");
    if (file == NULL)
        fail_msg("%s: cannot be read", path);
    size_t length = fread(text, 1, capacity, file);
    fclose(file);
    assert_true(length < capacity);
    text[length] = '\0';
}

/* What a line of a text adds to it. */
static void add_line(char *text, size_t capacity, const char *line)
{
    size_t used = strlen(text);
    int length = snprintf(text + used, capacity - used, "%s%s", used > 0 ? "\n" : "", line);
    assert_true(length >= 0 && used + (size_t)length < capacity);
}

static void read_line(plant *p, const char *line)
{
    const char *rest = line + strcspn(line, " ");
    rest += strspn(rest, " ");
    if (line[0] == '-')
        add_line(p->before, sizeof p->before, line + 1);
    else if (line[0] == '+')
        add_line(p->after, sizeof p->after, line + 1);
    else if (strncmp(line, "mutant ", 7) == 0)
        snprintf(p->name, sizeof p->name, "%s", rest);
    else if (strncmp(line, "file ", 5) == 0)
        snprintf(p->file, sizeof p->file, "%s", rest);
    else if (strncmp(line, "run ", 4) == 0)
        snprintf(p->run, sizeof p->run, "%s", rest);
}

/* Keeps what has a run. */
static void read_plants(void)
{
    char line[1024];
    FILE *file = fopen(list, "rb");
    assert_non_null(file);
    for (bool more = true; more;) {
        plant *p = &plants[plant_count];
        more = fgets(line, sizeof line, file) != NULL;
        line[more ? strcspn(line, "\n") : 0] = '\0';
        if (line[0] != '\0') {
            read_line(p, line);
            continue;
        }
        plant_count += p->run[0] != '\0';
        assert_true(plant_count < PLANTS_MAX);
        plants[plant_count] = (plant){0};
    }
    fclose(file);
}

/* The file of kernels/ with the bug, or as it is. */
static void write_planted(const plant *p, int planted, char *path, size_t capacity)
{
    static char text[65536];
    const char *name = strrchr(p->file, '/');
    assert_non_null(name);
    snprintf(path, capacity, BB_TEST_SOURCE_DIR "/%s", p->file);
    read_file(path, text, sizeof text);
    char *at = strstr(text, p->before);
    if (at == NULL || strstr(at + 1, p->before) != NULL)
        fail_msg("%s: '%s' must stand there once: mend the plant", path, p->before);
    snprintf(path, capacity, "%s%s", folder, name);
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    fwrite(text, 1, (size_t)(at - text), file);
    fputs(planted ? p->after : p->before, file);
    fputs(at + strlen(p->before), file);
    assert_int_equal(fclose(file), 0);
}

/* Exit status of `run`, and what it printed. */
static int run(const plant *p, char *out, size_t capacity)
{
    char command[2048], path[512];
    snprintf(path, sizeof path, "%s.txt", folder);
    snprintf(command, sizeof command,
             "timeout 300 " BB_TEST_PROGRAM
             " run %s %s --kernels-from %s --out %s.out >%s 2>&1 </dev/null",
             p->run, common, folder, folder, path);
    int status = system(command);
    read_file(path, out, capacity);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/* All with BVHBENCH_TEST_LONG; else some, others with each seed; few where it is only the host's
 * code that counts. They come first; how many. */
static int choose_plants(void)
{
    const char *seed = getenv("BVHBENCH_TEST_SEED");
    if (getenv("BVHBENCH_TEST_LONG") != NULL)
        return plant_count;
    bb_random random = bb_random_make(seed != NULL ? strtoull(seed, NULL, 10) : 1, 0);
    for (int i = 0; i < SOME; i++) {
        int other = i + (int)bb_random_below(&random, (uint32_t)(plant_count - i));
        plant chosen = plants[other];
        plants[other] = plants[i];
        plants[i] = chosen;
    }
    return getenv("BVHBENCH_TEST_SMALL") != NULL ? FEW : SOME;
}

static void each_bug_is_found(void **state)
{
    (void)state;
    static char out[65536];
    read_plants();
    assert_true(plant_count >= 20);
    const int count = choose_plants();
    for (int planted = 1; planted >= 0; planted--)
        for (int i = 0; i < count; i++) {
            const plant *p = &plants[i];
            char path[512];
            int seen = 0; /* without a bug what was run once tells for all */
            for (int k = 0; k < i && !planted; k++)
                seen = seen || strcmp(plants[k].run, p->run) == 0;
            if (seen)
                continue;
            write_planted(p, planted, path, sizeof path);
            int status = run(p, out, sizeof out);
            int said = strstr(out, "cells or builds are wrong") != NULL;
            print_message("%-30s %-8s exit %d\n", p->name, planted ? "planted" : "mended", status);
            if (status != planted || said != planted)
                print_error("%s", out);
            assert_int_equal(status, planted);
            assert_int_equal(said, planted);
            assert_int_equal(remove(path), 0);
        }
}

static int make_folder(void **state)
{
    (void)state;
    static char path[512];
    const char *parent = getenv("BVHBENCH_TEST_DIR");
    snprintf(path, sizeof path, "%s", parent != NULL ? parent : "/tmp");
    mkdir(path, 0777);
    strcat(path, "/plants");
    mkdir(path, 0777);
    folder = path;
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(each_bug_is_found)};
    return cmocka_run_group_tests(tests, make_folder, NULL);
}
