/* What tests of the program from outside share: a folder of their own, programs run in it, what
 * they wrote. */
#ifndef BB_TEST_PROGRAM_FIXTURE_H
#define BB_TEST_PROGRAM_FIXTURE_H

#include "framework/record/record.h"
#include "tests/fixture.h"

#include <cjson/cJSON.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static char folder[] = "/tmp/bvhbench-test-XXXXXX";

typedef struct outcome {
    int exit_status; /* -1: killed */
    char out[1 << 18];
    char err[8192];
} outcome;

/* Of a file in the folder; returns its size. */
static inline size_t read_file(const char *name, char *text, size_t capacity)
{
    char path[1024];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    size_t size = fread(text, 1, capacity - 1, file);
    text[size] = '\0';
    fclose(file);
    return size;
}

static inline void write_file(const char *name, const void *data, size_t size)
{
    char path[512];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(data, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

/* Runs a program with `arguments` (as the shell splits them) in the folder, after `before`
 * (variables, say). */
static inline const outcome *run_program(const char *before, const char *program,
                                         const char *arguments)
{
    static outcome o;
    char command[20000];
    snprintf(command, sizeof command, "cd %s && %s %s %s >stdout 2>stderr </dev/null", folder,
             before, program, arguments);
    int status = system(command);
    o.exit_status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    assert_true(read_file("stdout", o.out, sizeof o.out) < sizeof o.out - 1); /* all of it */
    read_file("stderr", o.err, sizeof o.err);
    return &o;
}

static inline const outcome *run_with(const char *before, const char *arguments)
{
    return run_program(before, BB_TEST_PROGRAM, arguments);
}

static inline const outcome *run(const char *arguments)
{
    return run_with("", arguments);
}

/* Its standard output must hold `words`. */
static inline const outcome *expect(int exit_status, const char *arguments, const char *words)
{
    const outcome *o = run(arguments);
    if (o->exit_status != exit_status || strstr(o->out, words) == NULL)
        fail_msg("bvhbench %s: exit %d, not %d with '%s':\n%s%s", arguments, o->exit_status,
                 exit_status, words, o->out, o->err);
    return o;
}

/* Exit 2, nothing on standard output, one line on standard error that holds `words`. */
static inline void refuses(const char *before, const char *arguments, const char *words)
{
    const outcome *o = run_with(before, arguments);
    const char *newline = strchr(o->err, '\n');
    if (o->exit_status != 2 || newline == NULL || newline[1] != '\0' || o->out[0] != '\0' ||
        strncmp(o->err, "bvhbench: ", 10) != 0 || strstr(o->err, words) == NULL)
        fail_msg("bvhbench %s: exit %d, '%s', expected one line with '%s'", arguments,
                 o->exit_status, o->err, words);
}

/* Writes what a script of sed makes of the file `from` into the file `to`. */
static inline void edit_file(const char *from, const char *script, const char *to)
{
    char command[1024];
    snprintf(command, sizeof command, "sed '%s' %s/%s >%s/%s", script, folder, from, folder, to);
    assert_int_equal(system(command), 0);
}

/* Set-up and tear-down of a group. */
static inline int make_folder(void **state)
{
    (void)state;
    return mkdtemp(folder) != NULL ? 0 : -1;
}

static inline int remove_folder(void **state)
{
    (void)state;
    char command[256];
    snprintf(command, sizeof command, "rm -rf %s", folder);
    return system(command);
}

/* The file parsed; for cJSON_Delete(). */
static inline cJSON *read_json(const char *name)
{
    static char text[4 << 20];
    read_file(name, text, sizeof text);
    cJSON *json = cJSON_Parse(text);
    assert_non_null(json);
    return json;
}

/* The results of a run, section by section; for cJSON_Delete(). */
static inline cJSON *read_results(const char *name)
{
    char path[1024];
    bb_results *results;
    snprintf(path, sizeof path, "%s/%s", folder, name);
    if (bb_results_read(path, &results) != BB_OK)
        fail_msg("%s", bb_message());
    char *json = bb_results_json(results);
    cJSON *document = cJSON_Parse(json);
    free(json);
    bb_results_destroy(results);
    assert_non_null(document);
    return document;
}

/* The first build by this builder. */
static inline const cJSON *build_of(const cJSON *builds, const char *builder)
{
    const cJSON *build;
    cJSON_ArrayForEach(build, builds)
    {
        if (strcmp(cJSON_GetStringValue(cJSON_GetObjectItem(build, "builder")), builder) == 0)
            return build;
    }
    fail_msg("no build by %s", builder);
    return NULL;
}

#endif
