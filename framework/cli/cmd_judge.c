/* bvhbench judge: classifies the hits of an external tracer with the oracle and arbiter of `run`.
 */
#include "framework/base/clock.h"
#include "framework/base/limits.h"
#include "framework/base/number.h"
#include "framework/base/statistics.h"
#include "framework/cli/choice.h"
#include "framework/cli/inputs.h"
#include "framework/cli/out_option.h"
#include "framework/cli/output.h"
#include "framework/judge/judge.h"
#include "framework/record/record.h"
#include "framework/report/report.h"
#include "framework/table/figure.h"
#include "framework/workload/exchange_file.h"
#include "framework/workload/workload.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* A rays file and its answers. */
typedef struct ray_set {
    const char *rays_path, *hits_path;
    double mrays_s; /* 0: not given */
    bb_rays *rays;
    bb_outside_hits outside;
    bb_answers answers; /* the oracle's */
    bb_accuracy accuracy;
} ray_set;

enum { SETS_MAX = 64 };

typedef struct job {
    bb_names rays, hits, speeds;
    const char *scene_name, *tracer;
    const char *folder; /* NULL: no results are written */
    const char *history;
    uint32_t by_hand; /* --verify no: no workload made the rays */
    double max_wrong_ppm;
    double start;
    bb_spec name;
    bb_scene *scene;
    bb_oracle *oracle;
    ray_set sets[SETS_MAX];
    uint32_t set_count;
} job;

static const bb_cli_option options[] = {
    {"scene", "S", "scene of the rays", BB_INTO(job, scene_name), .needed = true},
    {"rays-file", "FILE", "file written by `bvhbench rays`", BB_INTO(job, rays), .needed = true},
    {"hits", "FILE", "the tracer's answers to it", BB_INTO(job, hits), .needed = true},
    {"mrays-s", "X", "the tracer's speed in million rays per second, for the record",
     BB_INTO(job, speeds)},
    {"name", "TEXT", "the tracer's name; default: the name in the hits file, else `outside`",
     BB_INTO(job, tracer)},
    {"max-wrong-ppm", "X", "tolerated wrong rays per million", BB_INTO(job, max_wrong_ppm),
     .high = 1e6, .fallback = "0"},
    {"verify", NULL, "generate the rays again and compare them; no: the rays were made by hand",
     BB_INTO(job, by_hand), .words = "yes|no", .fallback = "yes"},
    {"out", "DIR", "folder for results.json and report.html; default: not written",
     BB_INTO(job, folder)},
    BB_HISTORY_OPTION(job, history),
    {.name = NULL},
};

static bb_status read_speeds(job *j)
{
    const bb_names *speeds = &j->speeds;
    if (speeds->count > 0 && speeds->count != j->set_count)
        return bb_fail(BB_INVALID, "%zu --mrays-s for %u files: give one per file, or none",
                       speeds->count, j->set_count);
    for (size_t i = 0; i < speeds->count; i++) {
        double *speed = &j->sets[i].mrays_s;
        if (!bb_read_real(speeds->items[i], speed) || *speed < 1e-9 || *speed > 1e9)
            return bb_fail(BB_INVALID, "--mrays-s is '%s', must be a number from 1e-9 to 1e9",
                           speeds->items[i]);
    }
    return BB_OK;
}

static bb_status read_options(job *j)
{
    if (j->rays.count != j->hits.count || j->rays.count > SETS_MAX)
        return bb_fail(BB_INVALID,
                       "%zu --rays-file but %zu --hits: give the same number of both, at most %d",
                       j->rays.count, j->hits.count, SETS_MAX);
    BB_TRY(bb_check_scene(j->scene_name));
    j->set_count = (uint32_t)j->rays.count;
    for (uint32_t i = 0; i < j->set_count; i++) {
        j->sets[i].rays_path = j->rays.items[i];
        j->sets[i].hits_path = j->hits.items[i];
    }
    BB_TRY(read_speeds(j));
    return j->tracer != NULL ? bb_spec_parse(j->tracer, &j->name) : BB_OK;
}

/* Refuses a ray set that is given twice, since both would be one record. */
static bb_status check_new(const job *j, uint32_t set)
{
    for (uint32_t i = 0; i < set; i++)
        if (j->sets[i].rays->hash == j->sets[set].rays->hash)
            return bb_fail(BB_INVALID, "rays files %s and %s hold the same rays: drop one of them",
                           j->sets[i].rays_path, j->sets[set].rays_path);
    return BB_OK;
}

/* Reads all files and verifies all rays before any hit is judged, so that refusals come at once. */
static bb_status read_files(job *j)
{
    BB_TRY(bb_scene_load(j->scene_name, &j->scene));
    for (uint32_t i = 0; i < j->set_count; i++) {
        ray_set *set = &j->sets[i];
        BB_TRY(bb_exchange_read_rays(set->rays_path, j->scene, j->by_hand != 0, &set->rays));
        BB_TRY(check_new(j, i));
        BB_TRY(bb_exchange_read_hits(set->hits_path, j->scene, set->rays, &set->outside));
    }
    const char *tracer = j->sets[0].outside.tracer;
    if (j->name.name == NULL)
        BB_TRY(bb_spec_parse(tracer[0] != '\0' ? tracer : "outside", &j->name));
    BB_TRY(bb_oracle_create(j->scene, bb_core_count(), &j->oracle));
    for (uint32_t i = 0; i < j->set_count && !j->by_hand; i++)
        BB_TRY(bb_exchange_verify_rays(j->sets[i].rays_path, j->scene, j->oracle, j->sets[i].rays));
    return BB_OK;
}

static bb_status judge(job *j)
{
    for (uint32_t i = 0; i < j->set_count; i++) {
        ray_set *set = &j->sets[i];
        BB_TRY(bb_answers_make(j->oracle, set->rays, &set->answers));
        const bb_verdict_request wanted = {
            .results = set->outside.hits, .count = set->outside.count, .may_be_unnamed = true};
        BB_TRY(bb_judge(j->oracle, &set->answers, &wanted, &set->accuracy));
    }
    return BB_OK;
}

/* ---- output ---- */

static void print_first_wrong(const ray_set *set)
{
    uint32_t i = set->accuracy.first_wrong;
    if (i == BB_NONE)
        return;
    const bb_ray *ray = &set->rays->rays[i];
    const bb_hit *hits[] = {&set->outside.hits[i], &set->answers.hits[i]};
    static const char *const names[] = {"the tracer", "Embree"};
    printf("first wrong ray: %u, o %.9g %.9g %.9g, d %.9g %.9g %.9g, t from %.9g to "
           "%.9g\n",
           i, (double)ray->o[0], (double)ray->o[1], (double)ray->o[2], (double)ray->d[0],
           (double)ray->d[1], (double)ray->d[2], (double)ray->tmin, (double)ray->tmax);
    for (int k = 0; k < 2; k++) {
        if (hits[k]->prim == BB_NONE)
            printf("  %-10s misses\n", names[k]);
        else if (hits[k]->prim == BB_UNNAMED)
            printf("  %-10s hits something\n", names[k]);
        else
            printf("  %-10s hits primitive %u at t = %.9g\n", names[k], hits[k]->prim,
                   (double)hits[k]->t);
    }
}

static void print_classes(const job *j, const ray_set *set)
{
    const bb_rays *rays = set->rays;
    const bb_accuracy *a = &set->accuracy;
    uint64_t wrong = a->missed + a->false_hits + a->wrong_t;
    bb_wrong_rate rate = bb_wrong_rate_of((double)wrong, (double)a->checked);
    char ppm[BB_FIGURE_MAX], low[BB_FIGURE_MAX], high[BB_FIGURE_MAX];
    printf("%s on %s, %s%s%s%s, %s hit: %llu hits for %u rays\n", j->name.text, j->scene->name,
           rays->name, j->by_hand ? " (rays as given)" : "", rays->view[0] != '\0' ? " from " : "",
           rays->view, rays->query->name, (unsigned long long)a->checked, rays->count);
    printf("  right     %10llu   of them %llu ties, %llu by the margin alone\n",
           (unsigned long long)a->right, (unsigned long long)a->ties,
           (unsigned long long)a->forgiven);
    printf("  missed    %10llu\n  false     %10llu\n  wrong t   %10llu\n",
           (unsigned long long)a->missed, (unsigned long long)a->false_hits,
           (unsigned long long)a->wrong_t);
    printf("  wrong ppm %10s   [%s, %s] %s\n", bb_figure(ppm, a->wrong_ppm, -1),
           bb_figure(low, rate.low, -1), bb_figure(high, rate.high, -1),
           wrong == 0 ? "none found: below 3/n at 95 %" : "at 95 %");
    if (!isnan(a->t_ulp_max))
        printf("  error of t of the right hits, in units of the last place: 99 %% below %.3g, at "
               "most %.3g; %.3g %% off by more than 1/1024 of t\n",
               a->t_ulp_p99, a->t_ulp_max, 100.0 * (double)a->t_off / (double)a->right);
    print_first_wrong(set);
}

/* ---- the record ---- */

static bb_status add_build(const job *j, bb_results *results)
{
    bb_build_record *build = calloc(1, sizeof *build);
    if (build == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    bb_build_record_init(build);
    snprintf(build->scene, sizeof build->scene, "%s", j->scene->name);
    snprintf(build->about, sizeof build->about,
             "an outside tracer: its hits were read from a file, its speed %s",
             j->sets[0].mrays_s > 0 ? "is as given" : "is not known");
    build->spec = &j->name;
    bb_status status = bb_results_add_build(results, build);
    free(build);
    return status;
}

/* Makes the key of an external tracer's answers. Rays made by hand are known by their hash alone.
 */
static void name_cell(const job *j, const ray_set *set, char key[BB_CELL_KEY])
{
    const bb_rays *rays = set->rays;
    bb_cell_parts cell = {.width = rays->primary_width,
                          .height = rays->primary_height,
                          .max_rays = rays->max_rays,
                          .seed = rays->seed,
                          .known_by_hash = j->by_hand,
                          .rays_hash = rays->hash};
    snprintf(cell.scene, sizeof cell.scene, "%s", j->scene->name);
    snprintf(cell.rays, sizeof cell.rays, "%s", rays->name);
    snprintf(cell.view, sizeof cell.view, "%s", rays->view);
    snprintf(cell.builder, sizeof cell.builder, "%s", j->name.text);
    snprintf(cell.kernel, sizeof cell.kernel, "outside");
    snprintf(cell.intersector, sizeof cell.intersector, "own");
    bb_cell_canonical(&cell);
    if (bb_cell_key_format(&cell, key) != BB_OK)
        key[0] = '\0';
}

static bb_status add_trace(const job *j, const ray_set *set, bb_results *results)
{
    bb_trace_record *trace = calloc(1, sizeof *trace);
    if (trace == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    bb_trace_record_init(trace);
    snprintf(trace->scene, sizeof trace->scene, "%s", j->scene->name);
    snprintf(trace->view, sizeof trace->view, "%s", set->rays->view);
    snprintf(trace->builder, sizeof trace->builder, "%s", j->name.text);
    snprintf(trace->kernel, sizeof trace->kernel, "outside");
    snprintf(trace->intersector, sizeof trace->intersector, "own");
    snprintf(trace->rays, sizeof trace->rays, "%s", set->rays->name);
    trace->rays_as_given = j->by_hand;
    if (!j->by_hand) {
        trace->rays_spec = &set->rays->spec;
        trace->rays_options = set->rays->options;
    }
    name_cell(j, set, trace->cell);
    trace->query = set->rays->query;
    trace->count = set->outside.count;
    trace->rays_hash = set->rays->hash;
    trace->mrays_s_given = set->mrays_s;
    trace->has_accuracy = true;
    trace->accuracy = set->accuracy;
    trace->counts_for_exit = true;
    trace->wrong = set->accuracy.wrong_ppm > j->max_wrong_ppm;
    bb_status status = bb_results_add_trace(results, trace);
    free(trace);
    return status;
}

/* Rays of one name and view are of runs of their own: else they were one cell. */
static bb_status begin_again(const job *j, uint32_t set, bb_results *results)
{
    for (uint32_t i = 0; i < set; i++)
        if (strcmp(j->sets[i].rays->name, j->sets[set].rays->name) == 0 &&
            strcmp(j->sets[i].rays->view, j->sets[set].rays->view) == 0) {
            bb_results_begin_run(results);
            return add_build(j, results);
        }
    return BB_OK;
}

static bb_status write_folder(bb_results *results, const char *folder)
{
    char json[PATH_MAX], html[PATH_MAX];
    BB_TRY(bb_join_path(json, folder, "results.json"));
    BB_TRY(bb_join_path(html, folder, "report.html"));
    BB_TRY(bb_results_write(results, json));
    BB_TRY(bb_report_html(results, folder, html));
    fprintf(stderr, "wrote %s and %s\n", json, html);
    return BB_OK;
}

static bb_status keep_results(const bb_cli *cli, const job *j)
{
    bb_results *results = NULL;
    bb_status status = bb_results_create(&(bb_context){.command = cli->command_line}, &results);
    if (status == BB_OK)
        status = bb_results_add_scene(results, j->scene, NULL);
    if (status == BB_OK)
        status = add_build(j, results);
    for (uint32_t i = 0; i < j->set_count && status == BB_OK; i++) {
        status = begin_again(j, i, results);
        if (status == BB_OK)
            status = add_trace(j, &j->sets[i], results);
    }
    if (status == BB_OK)
        status = bb_results_add_step(results, "judge answers", bb_wall_ms() - j->start);
    if (status == BB_OK)
        status = bb_results_set_total(results, 0, 0, bb_wall_ms() - j->start);
    if (status == BB_OK && j->folder != NULL)
        status = write_folder(results, j->folder);
    if (status == BB_OK)
        status = bb_output_append(j->history, bb_results_table(results));
    bb_results_destroy(results);
    return status;
}

static bb_status run(const bb_cli *cli, void *values, int *exit_status)
{
    job *j = values;
    j->start = bb_wall_ms();
    BB_TRY(read_options(j));
    if (j->folder != NULL)
        BB_TRY(bb_out_folder(j->folder));
    BB_TRY(bb_output_append(j->history, NULL));
    BB_TRY(read_files(j));
    BB_TRY(judge(j));
    for (uint32_t i = 0; i < j->set_count; i++) {
        print_classes(j, &j->sets[i]);
        if (j->sets[i].accuracy.wrong_ppm > j->max_wrong_ppm)
            *exit_status = BB_EXIT_WRONG;
    }
    return j->folder != NULL || j->history != NULL ? keep_results(cli, j) : BB_OK;
}

static void release(void *values)
{
    job *j = values;
    for (uint32_t i = 0; i < j->set_count; i++) {
        bb_answers_release(&j->sets[i].answers);
        bb_outside_hits_release(&j->sets[i].outside);
        bb_rays_free(j->sets[i].rays);
    }
    bb_oracle_destroy(j->oracle);
    bb_scene_free(j->scene);
}

extern const bb_command bb_command_judge;
const bb_command bb_command_judge = {
    .name = "judge",
    .summary = "judge the hits that an external tracer found for the rays from `bvhbench rays`",
    .details =
        "A hit is a primitive and a t; framework/workload/exchange.h has the format of both "
        "files.\n"
        "Answers are judged as in `run`; brackets show a 95 % interval. If there are fewer hits "
        "than\n"
        "rays, they belong to the first rays. The rays are generated again from scene and header\n"
        "and must equal those in the file; with --verify no they are judged as given, under a "
        "name\n"
        "that is not a workload's, and the record says so. Files of several views or workloads\n"
        "become one record: give --hits, and --mrays-s, once per --rays-file, in the same order.\n"
        "With --out, `bvhbench report DIR OTHER...` makes one report of the tracer and other\n"
        "results. Exit status 1: more wrong rays than --max-wrong-ppm; 2: a file is damaged,\n"
        "belongs to another scene or other rays, or holds something that is not an answer.",
    .options = options,
    .bytes = sizeof(job),
    .run = run,
    .release = release,
};
