/* What the tests of papers share: made-up results whose answers are known, and the claims that
 * follow. */
#ifndef BB_PAPER_FIXTURE_H
#define BB_PAPER_FIXTURE_H

#include "framework/base/random.h"
#include "framework/judge/queries.h"
#include "framework/papers/reproduce.h"
#include "framework/record/record_private.h"
#include "tests/document.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static char flat[] = "flat", cubic[] = "cubic";
static char *scenes[] = {flat, cubic};
static int rounds = 7;   /* that count */
static double noise = 0; /* of the times: at most this share */
static bb_random noise_source;

/* ---- made-up results ---- */

static inline bb_results *new_results(void)
{
    bb_results *results = NULL;
    assert_int_equal(bb_results_create(&(bb_context){NULL, 1, "test"}, &results), BB_OK);
    for (int i = 0; i < 2; i++) {
        bb_scene scene = {
            .prim_count = 1000, .prims = {[BB_TRIANGLE] = {.count = 1000}}, .kinds = BB_TRIANGLES};
        snprintf(scene.name, sizeof scene.name, "%s", scenes[i]);
        scene.profile.flatness = i == 0 ? 0.01 : 0.9;
        scene.view_count = 3;
        snprintf(scene.views[0].name, sizeof scene.views[0].name, "front");
        snprintf(scene.views[1].name, sizeof scene.views[1].name, "back");
        snprintf(scene.views[2].name, sizeof scene.views[2].name, "top");
        assert_int_equal(bb_results_add_scene(results, &scene, NULL), BB_OK);
    }
    return results;
}

/* Times are those given times 1, 2, 1 ... per round, which a paired ratio does not see. */
static inline void add_rounds(bb_samples *samples, double ms)
{
    for (int i = 0; i <= rounds; i++)
        bb_samples_add(samples,
                       ms * (1 + i % 2) * (1 + bb_random_range(&noise_source, -noise, noise)));
}

/* Returns the row of the build. */
static inline uint32_t add_build_of(bb_results *results, const char *scene, const char *builder,
                                    double sah, double ms, uint64_t bytes_peak)
{
    bb_build_record record;
    bb_spec spec;
    assert_int_equal(bb_spec_parse(builder, &spec), BB_OK);
    bb_build_record_init(&record);
    record.spec = &spec;
    snprintf(record.scene, sizeof record.scene, "%s", scene);
    add_rounds(&record.build_ms, ms);
    record.has_tree = true;
    record.bytes_peak = bytes_peak;
    record.metrics[bb_metric_find("sah")].value = sah;
    assert_int_equal(bb_results_add_build(results, &record), BB_OK);
    return bb_place_of(results->sections[BB_BUILDS].last);
}

static inline uint32_t add_build(bb_results *results, const char *scene, const char *builder,
                                 double sah, double ms)
{
    return add_build_of(results, scene, builder, sah, ms, 0);
}

/* emc costs 2 and 4, lbvh 1 and 8. */
static inline void add_two_builders(bb_results *results)
{
    add_build(results, flat, "emc", 2, 1);
    add_build(results, cubic, "emc", 4, 1);
    add_build(results, flat, "lbvh", 1, 1);
    add_build(results, cubic, "lbvh", 8, 1);
}

/* `simulated`: bounds on Mrays/s of so many simulations, "simt:0", "simt:1" ... */
static inline void add_simulated_trace(bb_results *results, uint32_t build, const char *kernel,
                                       const char *view, const char *rays, double ms, double boxes,
                                       const double *simulated, uint32_t simulations)
{
    const bb_entry *entry = results->entries[build];
    bb_trace_record record;
    bb_trace_record_init(&record);
    for (uint32_t i = 0; i < simulations; i++) {
        snprintf(record.simulated[i].name, sizeof record.simulated[i].name, "simt:%u", i);
        record.simulated[i].simulation.mrays_s = simulated[i];
    }
    record.simulated_count = simulations;
    record.query = &bb_query_closest;
    snprintf(record.scene, sizeof record.scene, "%s", bb_get_text(entry, BB_F_BUILD_SCENE));
    snprintf(record.builder, sizeof record.builder, "%s", bb_get_text(entry, BB_F_BUILD_BUILDER));
    snprintf(record.view, sizeof record.view, "%s", view);
    snprintf(record.kernel, sizeof record.kernel, "%s", kernel);
    snprintf(record.rays, sizeof record.rays, "%s", rays);
    record.count = 1000;
    record.counted = 1000;
    record.node_tests_per_ray = boxes;
    record.prim_tests_per_ray = 1;
    add_rounds(&record.ms, ms);
    assert_int_equal(bb_results_add_trace(results, &record), BB_OK);
}

static inline void add_trace_of(bb_results *results, uint32_t build, const char *kernel,
                                const char *view, const char *rays, double ms, double boxes)
{
    add_simulated_trace(results, build, kernel, view, rays, ms, boxes, NULL, 0);
}

static inline void add_trace_by(bb_results *results, uint32_t build, const char *kernel,
                                const char *view, double ms, double boxes)
{
    add_trace_of(results, build, kernel, view, "diffuse", ms, boxes);
}

static inline void add_trace(bb_results *results, uint32_t build, const char *view, double ms,
                             double boxes)
{
    add_trace_by(results, build, "stack", view, ms, boxes);
}

/* Tables of the findings below, which live until the program ends. */
static bb_table *paper_tables[512];
static size_t paper_table_count;

static void free_paper_tables(void)
{
    while (paper_table_count > 0)
        bb_table_free(paper_tables[--paper_table_count]);
}

static inline bb_findings findings_of(bb_results *results, uint32_t run)
{
    static const char *names[BB_SIMT_MAX];
    bb_findings f = {.scenes = scenes, .scene_count = 2, .simulations = names};
    f.simulation_count = bb_results_simulations(results, names);
    if (paper_table_count == 0)
        atexit(free_paper_tables);
    ASSERT_OK(bb_table_create("reproduce", &f.table));
    ASSERT_OK(bb_paper_measured(results, run, &f));
    assert_true(paper_table_count < sizeof paper_tables / sizeof paper_tables[0]);
    return paper_tables[paper_table_count++] = f.table, f;
}

/* A figure on a scene, or (NULL) the mean of all. */
static inline bb_estimate figure_at(const bb_findings *f, const char *scene, int view,
                                    bb_figure figure)
{
    bool timed;
    const bb_paper_place at = {.all = f, .scene = scene, .view = view};
    return bb_figure_at(at, &figure, &timed);
}

static inline double value_at(const bb_findings *f, const char *scene, bb_figure figure)
{
    return figure_at(f, scene, -1, figure).value;
}

/* ---- claims ---- */

/* The reproduction of the paper by these findings, which is added to the results. */
static inline const cJSON *reproduce(const char *name, const bb_findings *all, bb_results *results)
{
    const bb_paper *paper;
    ASSERT_OK(bb_paper_find(name, &paper));
    ASSERT_OK(bb_reproduction_add(paper, all, results));
    const cJSON *list = cJSON_GetObjectItem(document_of(results), "reproductions");
    return cJSON_GetArrayItem(list, cJSON_GetArraySize(list) - 1);
}

/* The codes' costs on both scenes; experiment 2 of the paper emc has what it varies. */
typedef struct code_costs {
    double sort[2], var[2];
} code_costs;

static const char *const mc64 = "emc:code=mc64,box=scene";
static const char *const sort64 = "emc:code=emc64-sort,box=scene";
static const char *const var64 = "emc:code=emc64-var,box=scene";

static inline const cJSON *reproduce_emc(bb_results *results, code_costs cost,
                                         const double speed[2])
{
    bb_findings all[BB_EXPERIMENTS_MAX];
    for (int e = 0; e < BB_EXPERIMENTS_MAX; e++) /* of those after the fourth there is nothing */
        all[e] = findings_of(results, UINT32_MAX);
    for (int e = 0; e < 4; e++) {
        uint32_t run = bb_results_begin_run(results);
        for (int s = 0; s < 2; s++) {
            uint32_t plain = add_build(results, scenes[s], mc64, 100, 10);
            uint32_t sort = add_build(results, scenes[s], sort64, 100 * cost.sort[s], 10.1);
            uint32_t var = add_build(results, scenes[s], var64, 100 * cost.var[s], 12);
            if (e != 0)
                continue;
            add_trace(results, plain, "", 6, 40);
            add_trace(results, sort, "", 6, 40);
            add_trace(results, var, "", 6 / speed[s], 30);
        }
        all[e] = findings_of(results, run);
    }
    return reproduce("emc", all, results);
}

/* "" if there is none. */
static inline const char *json_text(const cJSON *object, const char *name)
{
    const char *text = cJSON_GetStringValue(cJSON_GetObjectItem(object, name));
    return text != NULL ? text : "";
}

static inline const cJSON *claim_of(const cJSON *reproduction, const char *words)
{
    const cJSON *claim;
    cJSON_ArrayForEach(claim, cJSON_GetObjectItem(reproduction, "claims"))
    {
        if (strstr(json_text(claim, "claim"), words) != NULL)
            return claim;
    }
    fail_msg("no claim with '%s'", words);
    return NULL;
}

/* Whether the claim with these words held. */
static inline const cJSON *claim_with(const cJSON *reproduction, const char *words)
{
    return cJSON_GetObjectItem(claim_of(reproduction, words), "held");
}

/* A text that comes after it in the same claim. */
static inline const char *text_after(const cJSON *held, const char *name)
{
    const cJSON *item = held;
    while (strcmp(item->string, name) != 0)
        item = item->next;
    return item->valuestring != NULL ? item->valuestring : "";
}

/* The verdict on it. */
static inline const char *verdict_with(const cJSON *reproduction, const char *words)
{
    return json_text(claim_of(reproduction, words), "verdict");
}

static inline const char *why_of(const cJSON *held)
{
    return text_after(held, "why");
}

/* ---- tables ---- */

/* The first table whose title has these words. */
static inline const cJSON *table_with(const cJSON *reproduction, const char *words)
{
    const cJSON *table;
    cJSON_ArrayForEach(table, cJSON_GetObjectItem(reproduction, "tables"))
    {
        if (strstr(json_text(table, "title"), words) != NULL)
            return table;
    }
    fail_msg("no table with '%s'", words);
    return NULL;
}

static inline const cJSON *cell_of(const cJSON *table, const char *row_name, int column)
{
    const cJSON *row;
    cJSON_ArrayForEach(row, cJSON_GetObjectItem(table, "rows"))
    {
        const char *name = cJSON_GetStringValue(cJSON_GetArrayItem(row, 0));
        if (name != NULL && strcmp(name, row_name) == 0)
            return cJSON_GetArrayItem(row, column);
    }
    fail_msg("no row '%s'", row_name);
    return NULL;
}

#endif
