/* One attack on the judge: rays, tracer and judge are run, and the judge's counts read. */
#ifndef CHEATS_ATTACK_H
#define CHEATS_ATTACK_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>

#include <cmocka.h>

#include <cjson/cJSON.h>

static char folder[1024];
static unsigned long long seed = 1;
static uint32_t failures; /* of the test that runs */

/* One tracer on one ray set of one scene. */
typedef struct attack {
    const char *scene, *rays, *cheat;
    const char *class; /* what the most of the found ones are; NULL: any */
} attack;

/* What became of it. */
typedef struct outcome {
    int exit_status; /* of the judge */
    uint32_t rays, hits, altered, plain;
    uint32_t missed, false_hits, wrong_t, ties, margin_limited;
    double t_off;     /* NAN: not in the record */
    double t_ulp_max; /* NAN: no hit was right */
} outcome;

/* ---- programs ---- */

static inline size_t read_file(const char *name, char *text, size_t capacity)
{
    char path[1200];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    size_t size = fread(text, 1, capacity - 1, file);
    text[size] = '\0';
    fclose(file);
    return size;
}

static inline int run(const char *command)
{
    char line[3000];
    snprintf(line, sizeof line, "cd '%s' && %s >stdout 2>stderr </dev/null", folder, command);
    int status = system(line);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

static inline void rays_command(const attack *a, char text[1024])
{
    snprintf(text, 1024,
             "%s rays --scene %s --rays %s --size 48x48 --max-rays 2000 --seed %llu --out a.rays",
             BB_TEST_PROGRAM, a->scene, a->rays, seed);
}

static inline void tracer_command(const attack *a, char text[1024])
{
    snprintf(text, 1024, "%s a.rays a.hits --cheat %s", BB_TEST_CHEAT_TRACER, a->cheat);
}

static inline void judge_command(const attack *a, char text[1024])
{
    snprintf(text, 1024, "%s judge --scene %s --rays-file a.rays --hits a.hits --out judged",
             BB_TEST_PROGRAM, a->scene);
}

/* Notes a failure, with what repeats it. */
static inline void fail_case(const attack *a, const outcome *o, const char *why)
{
    char commands[3][1024], err[2000] = "";
    rays_command(a, commands[0]);
    tracer_command(a, commands[1]);
    judge_command(a, commands[2]);
    if (o->exit_status != 0 && o->exit_status != 1)
        read_file("stderr", err, sizeof err);
    failures++;
    print_error("FAILED: %s on %s, %s: %s\n", a->cheat, a->scene, a->rays, why);
    print_error("  %u rays, %u hits; altered %u, plainly wrong %u; found: missed %u, false %u, "
                "wrong t %u; exit %d\n%s",
                o->rays, o->hits, o->altered, o->plain, o->missed, o->false_hits, o->wrong_t,
                o->exit_status, err);
    print_error("  cd %s\n  %s\n  %s\n  %s\n", folder, commands[0], commands[1], commands[2]);
}

static inline uint32_t count_in(const cJSON *row, const char *name)
{
    const cJSON *item = cJSON_GetObjectItem(row, name);
    assert_true(cJSON_IsNumber(item));
    return (uint32_t)cJSON_GetNumberValue(item);
}

static inline void read_accuracy(outcome *o)
{
    static char text[1 << 20];
    read_file("judged/results.json", text, sizeof text);
    cJSON *json = cJSON_Parse(text);
    assert_non_null(json);
    const cJSON *trace = cJSON_GetObjectItem(json, "rows");
    for (trace = trace->child; trace != NULL && !cJSON_HasObjectItem(trace, "checked");)
        trace = trace->next;
    assert_int_equal(count_in(trace, "checked"), o->rays);
    o->missed = count_in(trace, "missed");
    o->false_hits = count_in(trace, "false");
    o->wrong_t = count_in(trace, "wrong_t");
    o->ties = count_in(trace, "ties");
    o->margin_limited = count_in(trace, "margin_limited");
    o->t_ulp_max = cJSON_GetNumberValue(cJSON_GetObjectItem(trace, "t_ulp_max"));
    o->t_off = cJSON_GetNumberValue(cJSON_GetObjectItem(trace, "t_off"));
    cJSON_Delete(json);
}

/* The rays of the last attack are taken again if this one wants the same. False, and noted as a
 * failure, if rays, tracer or judge could not do it. */
static inline bool perform(const attack *a, outcome *o)
{
    static char made[1024];
    char command[1024], text[256];
    *o = (outcome){.exit_status = -1, .t_off = (double)NAN};
    rays_command(a, command);
    if (strcmp(command, made) != 0 && run(command) != 0) {
        made[0] = '\0';
        fail_case(a, o, "no rays");
        return false;
    }
    snprintf(made, sizeof made, "%s", command);
    tracer_command(a, command);
    int status = run(command);
    read_file("stdout", text, sizeof text);
    if (status != 0 || sscanf(text, "rays %u hits %u altered %u plain %u", &o->rays, &o->hits,
                              &o->altered, &o->plain) != 4) {
        fail_case(a, o, "the tracer failed");
        return false;
    }
    judge_command(a, command);
    o->exit_status = run(command);
    if (o->exit_status != 0 && o->exit_status != 1) {
        fail_case(a, o, "the judge failed");
        return false;
    }
    read_accuracy(o);
    return true;
}

static inline uint32_t found_in(const outcome *o)
{
    return o->missed + o->false_hits + o->wrong_t;
}

#endif
