/* A paper's experiments, run one after the other as ordinary comparisons into one document. */
#include "framework/papers/reproduce.h"

#include "framework/base/clock.h"
#include "framework/base/steering.h"
#include "framework/builder/instance.h"
#include "framework/builder/registry.h"
#include "framework/builder/tracers.h"

#include <stdlib.h>
#include <string.h>

enum { NAMES_MAX = 128, QUICK_RAYS = 4096, QUICK_WIDTH = 64, QUICK_HEIGHT = 48 };

typedef struct names {
    char *items[NAMES_MAX];
    size_t count;
} names;

/* An experiment with its lists taken apart. */
typedef struct plan {
    names builders, kernels, rays, scenes;
    bb_bench_request request;
} plan;

bb_status bb_paper_find(const char *name, const bb_paper **paper)
{
    bb_words there = {0};
    for (const bb_paper *const *p = bb_papers; *p != NULL; p++) {
        if (strcmp((*p)->name, name) == 0) {
            *paper = *p;
            return BB_OK;
        }
        bb_say(&there, "%s%s", there.length > 0 ? ", " : "", (*p)->name);
    }
    return bb_fail(BB_INVALID, "unknown paper '%s': there are %s", name, there.text);
}

static void free_names(names *n)
{
    for (size_t i = 0; i < n->count; i++)
        free(n->items[i]);
    n->count = 0;
}

static void free_plan(plan *p)
{
    free_names(&p->builders);
    free_names(&p->kernels);
    free_names(&p->rays);
    free_names(&p->scenes);
}

static bb_status add_list(names *n, const char *list)
{
    return list[0] == '\0' ? BB_OK : bb_spec_list(list, n->items, NAMES_MAX, &n->count);
}

static bb_status add_name(names *n, const char *name)
{
    if (n->count == NAMES_MAX)
        return bb_fail(BB_INVALID, "more than %d scenes, or builders", NAMES_MAX);
    n->items[n->count] = strdup(name);
    return n->items[n->count++] != NULL ? BB_OK : bb_fail(BB_FAILED, "out of memory");
}

/* A list whose '#' becomes each number of primitives in turn. */
static bb_status add_sizes(names *n, const char *list, uint64_t max_prims)
{
    const char *mark = strchr(list, '#');
    if (mark == NULL)
        return add_list(n, list);
    for (uint64_t size = 10000, i = 0; size <= max_prims; i++) {
        char text[512];
        snprintf(text, sizeof text, "%.*s%llu%s", (int)(mark - list), list,
                 (unsigned long long)size, mark + 1);
        BB_TRY(add_list(n, text));
        size = i % 2 == 0 ? 3 * size : size / 3 * 10;
    }
    return BB_OK;
}

static bool is_there(const names *n, const char *name)
{
    for (size_t i = 0; i < n->count; i++)
        if (strcmp(n->items[i], name) == 0)
            return true;
    return false;
}

/* Each builder of the rows with each of the fills for its '$'. */
static bb_status add_entrants(const bb_experiment *e, names *n)
{
    for (const bb_paper_entrant *row = e->entrants; row != NULL && row->name != NULL; row++) {
        const char *fill = e->fills != NULL ? e->fills : "", *pattern = row->builder;
        const int before = (int)strcspn(pattern, "$");
        do {
            const int length = (int)strcspn(fill, " ");
            char name[256];
            snprintf(name, sizeof name, "%.*s%.*s%s", before, pattern, length, fill,
                     pattern + before + (pattern[before] == '$'));
            if (!is_there(n, name))
                BB_TRY(add_name(n, name));
            fill += length + (fill[length] == ' ');
        } while (*fill != '\0');
    }
    return BB_OK;
}

static bb_status choose_scenes(const bb_reproduce_request *request, const bb_experiment *e,
                               names *n)
{
    if (!e->takes_scenes || request->scene_count == 0)
        return add_sizes(n, request->quick ? e->quick_scenes : e->scenes, request->max_prims);
    for (uint32_t i = 0; i < request->scene_count; i++)
        BB_TRY(add_name(n, request->scenes[i]));
    return BB_OK;
}

bool bb_missing_stage(const char *builder, char *name, size_t capacity)
{
    bb_spec stages[BB_STAGES_MAX];
    uint32_t count = 0;
    if (bb_spec_stages(builder, stages, BB_STAGES_MAX, &count) != BB_OK)
        return false;
    for (uint32_t i = 0; i < count; i++)
        if (bb_builder_find(stages[i].name) == NULL && bb_tracer_find(stages[i].name) == NULL) {
            snprintf(name, capacity, "%s", stages[i].name);
            return true;
        }
    return false;
}

static void leave_out_missing(names *builders)
{
    char name[64];
    size_t kept = 0;
    for (size_t i = 0; i < builders->count; i++)
        if (bb_missing_stage(builders->items[i], name, sizeof name))
            free(builders->items[i]);
        else
            builders->items[kept++] = builders->items[i];
    builders->count = kept;
}

static bb_status make_plan(const bb_reproduce_request *request, const bb_experiment *e, plan *p)
{
    static char exact[] = "exact";
    static char *const intersectors[] = {exact};
    *p = (plan){0};
    BB_TRY(add_list(&p->builders, e->builders));
    BB_TRY(add_entrants(e, &p->builders));
    if (e->optional_builders)
        leave_out_missing(&p->builders);
    BB_TRY(add_list(&p->kernels, e->kernels));
    BB_TRY(add_list(&p->rays, e->rays));
    BB_TRY(choose_scenes(request, e, &p->scenes));
    uint32_t repeats = request->repeats > 0 ? request->repeats : e->repeats;
    p->request = (bb_bench_request){
        .device = request->device,
        .scenes = p->scenes.items,
        .scene_count = (uint32_t)p->scenes.count,
        .builders = p->builders.items,
        .builder_count = (uint32_t)p->builders.count,
        .kernels = p->kernels.items,
        .kernel_count = (uint32_t)p->kernels.count,
        .native = e->native,
        .intersectors = intersectors,
        .intersector_count = 1,
        .workloads = p->rays.items,
        .workload_count = (uint32_t)p->rays.count,
        .width = request->quick ? QUICK_WIDTH : e->width,
        .height = request->quick ? QUICK_HEIGHT : e->height,
        .max_rays = request->quick ? QUICK_RAYS : e->max_rays,
        .max_views = e->max_views,
        .repeats = request->quick ? 2 : repeats,
        .metrics = request->metrics,
        .metric_count = request->simt_count,
        .seed = request->seed,
        .quiet = request->quiet,
    };
    return BB_OK;
}

/* The same failure, with the paper and the experiment (NULL: none) in front. */
static bb_status blame(const bb_paper *paper, const bb_experiment *e, bb_status status)
{
    char reason[1024];
    snprintf(reason, sizeof reason, "%s", bb_message());
    return bb_fail(status, "reproduce %s%s%s: %s", paper->name, e != NULL ? ", " : "",
                   e != NULL ? e->name : "", reason);
}

static bb_status check_builders(const bb_paper *paper)
{
    names builders = {.count = 0};
    bb_status status = paper->builders != NULL ? add_list(&builders, paper->builders) : BB_OK;
    for (size_t i = 0; i < builders.count && status == BB_OK; i++)
        status = bb_instance_check(builders.items[i]);
    free_names(&builders);
    return status == BB_OK ? BB_OK : blame(paper, NULL, status);
}

bb_status bb_reproduce_check(const bb_reproduce_request *request)
{
    bb_status status = check_builders(request->paper);
    if (status != BB_OK)
        return status;
    for (const bb_experiment *e = request->paper->experiments; e != NULL && e->name != NULL; e++) {
        plan p;
        status = make_plan(request, e, &p);
        if (status == BB_OK)
            status = bb_bench_check(&p.request);
        free_plan(&p);
        if (status != BB_OK)
            return blame(request->paper, e, status);
    }
    return BB_OK;
}

/* Runs the experiment into the results, and makes its table. */
static bb_status run(const bb_reproduce_request *request, const bb_experiment *e, plan *p,
                     bb_findings *f, bb_results *results, bb_bench_outcome *outcome)
{
    const uint32_t run = bb_results_begin_run(results);
    bb_bench_outcome more;
    BB_TRY(make_plan(request, e, p));
    const bb_status status = bb_bench_run(&p->request, results, &more);
    bb_bench_outcome_add(outcome, &more);
    BB_TRY(status);
    for (size_t s = 0; s < p->scenes.count; s++)
        BB_TRY(bb_paper_add_scene(f, p->scenes.items[s]));
    return bb_paper_measured(results, run, f);
}

uint32_t bb_paper_rounds(const bb_reproduce_request *request, uint32_t usual)
{
    return request->quick ? 2 : request->repeats > 0 ? request->repeats : usual;
}

bb_contest_request bb_paper_contest(const bb_reproduce_request *request, const char *name)
{
    return (bb_contest_request){.device = request->device,
                                .name = name,
                                .repeats = bb_paper_rounds(request, 7),
                                .seed = request->seed,
                                .simts = request->simts,
                                .simt_count = request->simt_count,
                                .quiet = request->quiet,
                                .audit = request->audit,
                                .watch = request->watch};
}

bb_status bb_paper_add_scene(bb_findings *f, const char *name)
{
    char **scenes = realloc(f->scenes, (f->scene_count + 1) * sizeof *scenes);
    if (scenes == NULL)
        return bb_fail(BB_REFUSED, "reproduce: no memory");
    f->scenes = scenes;
    scenes[f->scene_count] = bb_utf8_text(name); /* as tables have it */
    return scenes[f->scene_count++] != NULL ? BB_OK : bb_fail(BB_REFUSED, "reproduce: no memory");
}

static void free_findings(bb_findings *findings)
{
    for (int i = 0; i < BB_EXPERIMENTS_MAX; i++) {
        bb_table_free(findings[i].table);
        for (size_t s = 0; s < findings[i].scene_count; s++)
            free(findings[i].scenes[s]);
        free(findings[i].scenes);
    }
}

bb_status bb_reproduce(const bb_reproduce_request *request, bb_results *results,
                       bb_bench_outcome *outcome)
{
    const bb_paper *paper = request->paper;
    bb_findings findings[BB_EXPERIMENTS_MAX] = {0};
    const char *simulations[BB_SIMT_MAX];
    bb_status status = BB_OK;
    bool wrong = false;
    for (uint32_t i = 0; i < request->simt_count; i++)
        simulations[i] = request->simts[i].name;
    for (int i = 0; i < BB_EXPERIMENTS_MAX && status == BB_OK; i++) {
        status = bb_table_create("reproduce", &findings[i].table);
        findings[i].simulations = simulations;
        findings[i].simulation_count = request->simt_count;
    }
    for (const bb_experiment *e = paper->experiments; e != NULL && e->name != NULL; e++) {
        plan p = {.builders = {.count = 0}};
        if (status == BB_OK) {
            status = run(request, e, &p, &findings[e - paper->experiments], results, outcome);
            status = status != BB_OK ? blame(paper, e, status) : BB_OK;
        }
        free_plan(&p);
    }
    if (status == BB_OK && paper->measure != NULL) {
        const double start = bb_wall_ms();
        status = paper->measure(request, findings, &wrong);
        const double ms = bb_wall_ms() - start;
        for (int i = 0; i < BB_EXPERIMENTS_MAX && status == BB_OK; i++)
            bb_paper_add_simulated_answers(&findings[i]);
        outcome->times.total_ms += ms;
        if (status == BB_OK)
            status = bb_results_add_step(results, "contests", ms);
    }
    for (int i = 0; i < BB_EXPERIMENTS_MAX && status == BB_OK; i++)
        status = bb_table_status(findings[i].table);
    if (status == BB_OK)
        status = bb_reproduction_add(paper, findings, results);
    outcome->wrong += wrong;
    free_findings(findings);
    return status;
}
