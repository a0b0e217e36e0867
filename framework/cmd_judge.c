/* bvhbench judge: classes the hits of a tracer that is no plug-in, by the oracle and the arbiter of `run`. */
#include "framework/choice.h"
#include "framework/clock.h"
#include "framework/exchange_file.h"
#include "framework/oracle.h"
#include "framework/record.h"
#include "framework/report.h"
#include "framework/threads.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const bb_cli_option options[] = {
    {"scene", "S", "the scene of the rays", false},
    {"rays-file", "FILE", "what `bvhbench rays` wrote", false},
    {"hits", "FILE", "what the tracer answered", false},
    {"mrays-s", "X", "its speed in million rays per second, for the record", false},
    {"name", "TEXT", "its name; default: as in the file of hits, else `outside`", false},
    {"max-wrong-ppm", "X", "wrong rays per million that are still right; default: 0", false},
    {"out", "DIR", "folder of results.json and report.html; default: none are written", false},
    {.name = NULL},
};

typedef struct job {
    const char *scene_name, *rays_path, *hits_path, *folder;
    double mrays_s; /* 0: not given */
    double max_wrong_ppm;
    double start;
    bb_spec name;
    bb_scene *scene;
    bb_rays *rays;
    bb_outside_hits outside;
    bb_oracle *oracle;
    bb_answers answers;
    bb_accuracy accuracy;
} job;

static bb_status read_options(const bb_cli *cli, job *j)
{
    j->scene_name = bb_cli_value(cli, "scene");
    j->rays_path = bb_cli_value(cli, "rays-file");
    j->hits_path = bb_cli_value(cli, "hits");
    j->folder = bb_cli_value(cli, "out");
    if (j->scene_name == NULL || j->rays_path == NULL || j->hits_path == NULL)
        return bb_fail(BB_INVALID, "judge needs --scene, --rays-file and --hits: see `bvhbench "
                                   "judge --help`");
    BB_TRY(bb_cli_double(cli, "mrays-s", 0, 1e-9, 1e9, &j->mrays_s));
    BB_TRY(bb_cli_double(cli, "max-wrong-ppm", 0, 0, 1e6, &j->max_wrong_ppm));
    const char *name = bb_cli_value(cli, "name");
    return name != NULL ? bb_spec_parse(name, &j->name) : BB_OK;
}

static bb_status judge(job *j)
{
    BB_TRY(bb_scene_load(j->scene_name, &j->scene));
    BB_TRY(bb_exchange_read_rays(j->rays_path, j->scene, &j->rays));
    BB_TRY(bb_exchange_read_hits(j->hits_path, j->scene, j->rays, &j->outside));
    if (j->name.name == NULL)
        BB_TRY(
            bb_spec_parse(j->outside.tracer[0] != '\0' ? j->outside.tracer : "outside", &j->name));
    BB_TRY(bb_oracle_create(j->scene, bb_core_count(), &j->oracle));
    BB_TRY(bb_answers_make(j->oracle, j->rays, &j->answers));
    return bb_judge(j->oracle, &j->answers, j->outside.hits, j->outside.count, NULL, &j->accuracy);
}

/* ---- what it says ---- */

/* 95 % interval of `wrong` of `checked` rays, in rays per million: of a Poisson count by Byar's approximation (Breslow and Day:
 * Statistical Methods in Cancer Research II, 1987, section 2.3); if there is none, from 0 to 3/n (rule of three; Hanley and
 * Lippman-Hand, JAMA 249, 1983). */
static void wrong_interval(double wrong, double checked, double *low, double *high)
{
    const double z = 1.959964; /* 97.5 % of a normal distribution */
    double next = wrong + 1, million = 1e6 / checked;
    *low = 0;
    *high = 3 * million;
    if (wrong == 0)
        return;
    *low = million * wrong * pow(1 - 1 / (9 * wrong) - z / (3 * sqrt(wrong)), 3);
    *high = million * next * pow(1 - 1 / (9 * next) + z / (3 * sqrt(next)), 3);
}

/* Three figures, and never an exponent of ten. */
static const char *figure(double value, char text[32])
{
    snprintf(text, 32, value >= 100 ? "%.0f" : "%.3g", value);
    return text;
}

static void print_first_wrong(const job *j)
{
    uint32_t i = j->accuracy.first_wrong;
    if (i == BB_NONE)
        return;
    const bb_ray *ray = &j->rays->rays[i];
    const bb_hit *hits[] = {&j->outside.hits[i], &j->answers.hits[i]};
    static const char *const names[] = {"the tracer", "Embree"};
    printf("the first wrong one is ray %u: o %.9g %.9g %.9g, d %.9g %.9g %.9g, t from %.9g to "
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

static void print_classes(const job *j)
{
    const bb_accuracy *a = &j->accuracy;
    uint64_t wrong = a->missed + a->false_hits + a->wrong_t;
    double low, high;
    char ppm[32], least[32], most[32];
    wrong_interval((double)wrong, (double)a->checked, &low, &high);
    printf("%s on %s, %s%s%s, %s hit: %llu hits for %u rays\n", j->name.text, j->scene->name,
           j->rays->name, j->rays->view[0] != '\0' ? " from " : "", j->rays->view,
           bb_query_name(j->rays->query), (unsigned long long)a->checked, j->rays->count);
    printf("  right     %10llu   of them %llu ties, %llu by the margin alone\n",
           (unsigned long long)a->right, (unsigned long long)a->ties,
           (unsigned long long)a->forgiven);
    printf("  missed    %10llu\n  false     %10llu\n  wrong t   %10llu\n",
           (unsigned long long)a->missed, (unsigned long long)a->false_hits,
           (unsigned long long)a->wrong_t);
    printf("  wrong ppm %10s   [%s, %s] %s\n", figure(a->wrong_ppm, ppm), figure(low, least),
           figure(high, most), wrong == 0 ? "none found: below 3/n at 95 %" : "at 95 %");
    if (!isnan(a->t_ulp_max))
        printf("  error of t of the right hits, in units of the last place: 99 %% below %.3g, at "
               "most %.3g\n",
               a->t_ulp_p99, a->t_ulp_max);
    print_first_wrong(j);
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
             j->mrays_s > 0 ? "is as given" : "is not known");
    build->spec = &j->name;
    bb_status status = bb_results_add_build(results, build);
    free(build);
    return status;
}

static bb_status add_trace(const job *j, bb_results *results)
{
    bb_trace_record *trace = calloc(1, sizeof *trace);
    if (trace == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    bb_trace_record_init(trace);
    snprintf(trace->scene, sizeof trace->scene, "%s", j->scene->name);
    snprintf(trace->view, sizeof trace->view, "%s", j->rays->view);
    snprintf(trace->builder, sizeof trace->builder, "%s", j->name.text);
    snprintf(trace->kernel, sizeof trace->kernel, "outside");
    snprintf(trace->rays, sizeof trace->rays, "%s", j->rays->name);
    trace->rays_spec = &j->rays->spec;
    trace->rays_options = j->rays->workload->options;
    trace->query = j->rays->query;
    trace->count = j->outside.count;
    trace->rays_hash = j->rays->hash;
    trace->mrays_s_given = j->mrays_s;
    trace->has_accuracy = true;
    trace->accuracy = j->accuracy;
    trace->counts_for_exit = true;
    trace->wrong = j->accuracy.wrong_ppm > j->max_wrong_ppm;
    bb_status status = bb_results_add_trace(results, trace);
    free(trace);
    return status;
}

static bb_status path_in(const char *folder, const char *name, char path[PATH_MAX])
{
    if (snprintf(path, PATH_MAX, "%s/%s", folder, name) >= PATH_MAX)
        return bb_fail(BB_INVALID, "%.80s...: the path is too long", folder);
    return BB_OK;
}

static bb_status write_results(const bb_cli *cli, const job *j)
{
    char json[PATH_MAX], html[PATH_MAX];
    BB_TRY(path_in(j->folder, "results.json", json));
    BB_TRY(path_in(j->folder, "report.html", html));
    char *command = bb_cli_command_line(cli);
    bb_results *results = NULL;
    bb_status status = bb_results_create(&(bb_context){.command = command}, &results);
    if (status == BB_OK)
        status = bb_results_add_scene(results, j->scene);
    if (status == BB_OK)
        status = add_build(j, results);
    if (status == BB_OK)
        status = add_trace(j, results);
    if (status == BB_OK)
        status = bb_results_add_step(results, "judge answers", bb_wall_ms() - j->start);
    if (status == BB_OK)
        status = bb_results_set_total(results, 0, 0, bb_wall_ms() - j->start);
    if (status == BB_OK)
        status = bb_results_write(results, json);
    if (status == BB_OK)
        status = bb_report_html(results, j->folder, html);
    if (status == BB_OK)
        fprintf(stderr, "wrote %s and %s\n", json, html);
    bb_results_destroy(results);
    free(command);
    return status;
}

static bb_status run(const bb_cli *cli, int *exit_status)
{
    job j = {.start = bb_wall_ms()};
    bb_status status = read_options(cli, &j);
    if (status == BB_OK && j.folder != NULL)
        status = bb_make_folder(j.folder);
    if (status == BB_OK)
        status = judge(&j);
    if (status == BB_OK)
        print_classes(&j);
    if (status == BB_OK && j.folder != NULL)
        status = write_results(cli, &j);
    if (status == BB_OK && j.accuracy.wrong_ppm > j.max_wrong_ppm)
        *exit_status = BB_EXIT_WRONG;
    bb_answers_release(&j.answers);
    bb_oracle_destroy(j.oracle);
    bb_outside_hits_release(&j.outside);
    bb_rays_free(j.rays);
    bb_scene_free(j.scene);
    return status;
}

const bb_command bb_command_judge = {
    .name = "judge",
    .summary = "class the hits that a tracer from outside made for the rays of `rays`",
    .details = "A hit is a primitive and a t; framework/exchange.h is the format of both files. "
               "Classes and\n"
               "margins are those of `run`; [ , ] is a 95 % interval. Fewer hits than rays are "
               "those of the\n"
               "first rays. With --out, `bvhbench report DIR OTHER...` puts the tracer into one "
               "report with\n"
               "other results. Exit status 1: more wrong rays than --max-wrong-ppm; 2: a file that "
               "is damaged,\n"
               "of another scene or other rays, or holds what is no answer.",
    .options = options,
    .run = run,
};
