/* Simulated figures of commands beside those of `run --metrics simt`. */
#ifndef BB_TEST_SIMULATED_ROWS_H
#define BB_TEST_SIMULATED_ROWS_H

#include "tests/program_fixture.h"

static inline const char *text_in(const cJSON *row, const char *name)
{
    const char *text = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(row, name));
    return text != NULL ? text : "";
}

static inline double number_in(const cJSON *row, const char *name)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(row, name);
    if (!cJSON_IsNumber(item))
        fail_msg("%s is no number", name);
    return item->valuedouble;
}

#define H100 "simt:device=h100,width=32"

/* What a command that must succeed prints as JSON; the caller owns it. */
static inline cJSON *json_of(const char *before, const char *arguments)
{
    const outcome *o = run_with(before, arguments);
    if (o->exit_status != 0)
        fail_msg("exit %d: %s", o->exit_status, o->err);
    cJSON *json = cJSON_Parse(o->out);
    assert_non_null(json);
    return json;
}

static inline const cJSON *rows_of(const cJSON *json)
{
    return cJSON_GetObjectItemCaseSensitive(json, "rows");
}

/* Whether it has figures of a simulation. */
static inline bool is_simulated(const cJSON *row)
{
    return cJSON_GetObjectItemCaseSensitive(row, "simt_mrays_s") != NULL;
}

/* The row of `run` with this simulation, builder, kernel and rays. */
static inline const cJSON *run_row(const cJSON *rows, const char *maker, const char *builder,
                                   const char *kernel, const char *rays)
{
    const cJSON *row;
    cJSON_ArrayForEach(row, rows)
    {
        if (strcmp(text_in(row, "maker"), maker) == 0 &&
            strcmp(text_in(row, "builder"), builder) == 0 &&
            strcmp(text_in(row, "kernel"), kernel) == 0 &&
            strcmp(text_in(row, "question"), rays) == 0)
            return row;
    }
    fail_msg("no row %s, %s, %s, %s", maker, builder, kernel, rays);
    return NULL;
}

/* Every simulated figure of `row` is that of `of`, to the last bit. */
static inline void has_the_same_figures(const cJSON *row, const cJSON *of)
{
    const cJSON *figure;
    uint32_t count = 0;
    cJSON_ArrayForEach(figure, of)
    {
        if (strncmp(figure->string, "simt_", 5) != 0)
            continue;
        const cJSON *own = cJSON_GetObjectItemCaseSensitive(row, figure->string);
        if (!cJSON_Compare(own, figure, true))
            fail_msg("%s differs", figure->string);
        if (cJSON_IsNumber(figure))
            assert_true(own->valuedouble == figure->valuedouble);
        count++;
    }
    assert_true(count >= 15);
}

/* What cannot be simulated is refused before anything is done. */
static inline void refuses_bad_simulations(const char *command)
{
    static const char *const bad[][2] = {
        {"simt:device=h10", "did you mean 'h100'"},
        {"simt:device=nowhere.json", "nowhere.json"},
        {"simt:width=48", "must be one of 32|64"},
        {"simt:units=4", "units"},
        {"simt,simt:device=h100", "is given twice"},
        {"sah", "there is no 'sah' here, only simt"},
        {"simt,simt:width=64,simt:cache=2,simt:cache=4,simt:cache=0.5", "at most 4 simulations"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        char arguments[1024];
        snprintf(arguments, sizeof arguments, "%s --metrics %s", command, bad[i][0]);
        refuses("", arguments, bad[i][1]);
    }
}

#endif
