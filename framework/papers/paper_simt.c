/* What simulations of GPUs (framework/simulate/) are worth: replays against the lockstep reference,
 * SIMT efficiency of each kernel, and how far the ranking of builders depends on what is assumed of
 * the device: caches of half and twice the size, and groups of 64. No paper's: but shown as they
 * are.
 */
#include "framework/builder/instance.h"
#include "framework/judge/queries.h"
#include "framework/papers/reproduce.h"
#include "framework/simulate/lockstep.h"
#include "framework/simulate/trace_steps.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { RANKED, REPLAYED }; /* tables: of the experiment, of measure() */
enum { RAYS = 150 };       /* in lockstep: groups of 32 and of 64, the last ones not whole */
enum { QUERIES = 2, BUILDERS_MOST = 16 };

#define OF_LOCKSTEP "hploc"
#define BUILDERS "lbvh,emc,hlbvh,ploc,hploc,bonsai,lbvh+trbvh,bonsai+reinsert,sah,sah:method=sweep"
#define KERNELS "stack,stack8,stackless,cwbvh"

static const bb_experiment experiments[] = {
    [RANKED] = {.name = "ranking of builders",
                .builders = BUILDERS,
                .kernels = KERNELS,
                .rays = "primary,ao,diffuse",
                .scenes = "coffee,scorpion,mountain,interior:n=200000",
                .quick_scenes = "interior:n=2000",
                .takes_scenes = true,
                .width = 256,
                .height = 256,
                .max_rays = 1 << 16,
                .max_views = 2,
                .repeats = 1},
    {.name = NULL},
};

/* ---- replays ---- */

static const bb_column issued = BB_FOUND_NUMBER("issued", "Steps, of both widths and queries."),
                       in_lockstep = BB_FOUND_NUMBER("in_lockstep", "The same of the reference."),
                       apart = BB_FOUND_NUMBER("apart", "Kinds of steps whose sums differ.");

/* Of a kernel and a scene: steps, and in how many comparisons they differ. */
typedef struct comparison {
    uint64_t issued, in_lockstep;
    uint32_t apart;
} comparison;

static bb_status compare(bb_device *device, const bb_lockstep_case *which,
                         const bb_traverser_request *request, const bb_layout_data *layout,
                         const bb_ray *rays, comparison *c)
{
    const bb_footing footing = bb_footing_of(request, layout);
    bb_steps steps;
    BB_TRY(bb_trace_steps(device, request, layout, rays, RAYS, BB_SAMPLE_ALL, &steps));
    bb_issued sums[BB_LOCKSTEP_WIDTHS][BB_ISSUE_KINDS];
    bb_status status = bb_lockstep_run(device, which, request, layout, rays, RAYS, sums);
    for (uint32_t w = 0; w < BB_LOCKSTEP_WIDTHS && status == BB_OK; w++) {
        bb_traffic traffic;
        const bb_machine machine = {.width = 32u << w,
                                    .units = 2,
                                    .in_flight = 2,
                                    .first_bytes = 1 << 16,
                                    .first_ways = 4,
                                    .second_bytes = 1 << 20,
                                    .second_ways = 16};
        status = bb_machine_run(&machine, &footing, &steps, &traffic);
        for (uint32_t k = 0; k < BB_ISSUE_KINDS && status == BB_OK; k++) {
            c->issued += traffic.issued[k].count;
            c->in_lockstep += sums[w][k].count;
        }
        if (status == BB_OK)
            c->apart += bb_lockstep_differs(traffic.issued, sums[w]) < BB_ISSUE_KINDS;
    }
    bb_steps_release(&steps);
    return status;
}

static bb_status compare_in(bb_device *device, bb_layout_maker *maker, const bb_scene *scene,
                            bb_tree *tree, const bb_lockstep_case *which, const bb_ray *rays,
                            comparison *c)
{
    static const bb_query *const queries[QUERIES] = {&bb_query_closest, &bb_query_any};
    bb_spec spec;
    bb_traverser_request request = {.spec = &spec, .intersector = &bb_intersectors[0]};
    bb_layout_data layout = {.buffer_count = 0};
    BB_TRY(bb_kernel_parse(which->kernel, &spec, &request.kernel));
    maker->wish.preorder = true;
    bb_status status =
        bb_layout_maker_make(maker, scene, tree, which->leaf, BB_FORMAT_VERTICES, &layout);
    for (uint32_t q = 0; q < QUERIES && status == BB_OK; q++) {
        request.query = queries[q];
        status = compare(device, which, &request, &layout, rays, c);
    }
    bb_layout_data_release(&layout);
    return status;
}

static bb_status replay(const bb_reproduce_request *request, const char *name, bb_findings *f,
                        const bb_scene *scene, bb_tree *tree, bool *wrong)
{
    bb_ray rays[RAYS];
    bb_lockstep_rays(scene, request->seed, rays, RAYS);
    for (const bb_lockstep_case *which = bb_lockstep_cases; which->kernel != NULL; which++) {
        bb_spec spec;
        const bb_kernel *kernel;
        bb_layout_maker maker;
        comparison c = {0};
        BB_TRY(bb_kernel_parse(which->kernel, &spec, &kernel));
        BB_TRY(bb_layout_maker_create(bb_layout_find(kernel->layout), request->device, &maker));
        const bb_status status = compare_in(request->device, &maker, scene, tree, which, rays, &c);
        bb_layout_maker_destroy(&maker);
        BB_TRY(status);
        const bb_cell cell = {{[BB_SCENE] = name, [BB_INTERSECTOR] = which->kernel}};
        const uint32_t row = bb_table_row(f->table, cell);
        bb_table_set_number(f->table, row, &issued, (double)c.issued);
        bb_table_set_number(f->table, row, &in_lockstep, (double)c.in_lockstep);
        bb_table_set_number(f->table, row, &apart, c.apart);
        *wrong = *wrong || c.apart > 0;
    }
    return BB_OK;
}

static bb_status replay_scene(const bb_reproduce_request *request, const char *name, bb_findings *f,
                              bool *wrong)
{
    bb_scene *scene;
    bb_instance instance;
    BB_TRY(bb_paper_add_scene(f, name));
    BB_TRY(bb_scene_load(name, &scene));
    bb_status status = bb_scene_upload(scene, request->device);
    if (status == BB_OK)
        status = bb_instance_create(request->device, OF_LOCKSTEP, scene, request->seed, &instance);
    if (status == BB_OK) {
        status = bb_instance_build(&instance, scene, false, NULL);
        if (status == BB_OK)
            status = bb_tree_download(&instance.tree, NULL);
        if (status == BB_OK)
            status = replay(request, name, f, scene, &instance.tree, wrong);
        bb_instance_destroy(&instance);
    }
    bb_scene_free(scene);
    bb_traversers_clear(request->device);
    return status;
}

/* ---- rankings ---- */

static const bb_column stability[BB_SIMT_MAX] = {
    BB_FOUND_NUMBER("stability1", "Kendall's tau of builders' ranks with the first simulation."),
    BB_FOUND_NUMBER("stability2", "Likewise, of the second."),
    BB_FOUND_NUMBER("stability3", "Likewise, of the third."),
    BB_FOUND_NUMBER("stability4", "Likewise, of the fourth.")};
static const bb_column swaps[BB_SIMT_MAX] = {
    BB_FOUND_TEXT("swaps1", "Pairs that change places against the first simulation."),
    BB_FOUND_TEXT("swaps2", "Likewise."), BB_FOUND_TEXT("swaps3", "Likewise."),
    BB_FOUND_TEXT("swaps4", "Likewise.")};

/* A builder's simulated time for all rays, by its best kernel. */
static double time_of(const bb_findings *f, const char *scene, const char *builder,
                      uint32_t simulation)
{
    char column[64], kernels[sizeof KERNELS];
    double least = INFINITY;
    snprintf(column, sizeof column, BB_SIMULATED_TIME, simulation + 1, "trace_ms");
    snprintf(kernels, sizeof kernels, "%s", KERNELS);
    for (char *rest = kernels, *kernel; (kernel = strtok_r(rest, ",", &rest)) != NULL;) {
        const bb_cell cell = {
            {[BB_SCENE] = scene, [BB_BUILDER] = builder, [BB_INTERSECTOR] = kernel}};
        least = fmin(least, bb_find(f, &cell, column).number);
    }
    return least;
}

/* Puts Kendall's tau-a of the ranks by a simulation with those by the first, and the pairs that
 * change places. */
static void rank(bb_findings *f, const char *scene, uint32_t simulation, char *const *builders,
                 size_t count)
{
    double first[BUILDERS_MOST], own[BUILDERS_MOST];
    bb_words words = {0};
    for (size_t b = 0; b < count; b++) {
        first[b] = time_of(f, scene, builders[b], 0);
        own[b] = time_of(f, scene, builders[b], simulation);
    }
    for (size_t a = 0; a < count; a++)
        for (size_t b = 0; b < a; b++)
            if ((first[a] - first[b]) * (own[a] - own[b]) < 0)
                bb_say(&words, "%s%s and %s", words.length > 0 ? ", " : "", builders[a],
                       builders[b]);
    const uint32_t row = bb_table_row(f->table, (bb_cell){{[BB_SCENE] = scene}});
    bb_table_set_number(f->table, row, &stability[simulation], bb_kendall(first, own, count));
    bb_table_set_text(f->table, row, &swaps[simulation],
                      words.length > 0 ? words.text : "none changes places");
}

static bb_status rank_all(bb_findings *f)
{
    char *builders[BUILDERS_MOST];
    size_t count = 0;
    const bb_status status = bb_spec_list(BUILDERS, builders, BUILDERS_MOST, &count);
    for (size_t s = 0; s < f->scene_count && status == BB_OK; s++)
        for (uint32_t i = 0; i < f->simulation_count; i++)
            rank(f, f->scenes[s], i, builders, count);
    for (size_t b = 0; b < count; b++)
        free(builders[b]);
    return status;
}

static bb_status measure(const bb_reproduce_request *request, bb_findings *f, bool *wrong)
{
    static const char *const scenes[] = {"interior:n=1000", "soup:n=500", "sphere-mesh:n=12"};
    for (int s = 0; s < 3; s++)
        BB_TRY(replay_scene(request, scenes[s], &f[REPLAYED], wrong));
    return rank_all(&f[RANKED]);
}

/* ---- tables ---- */

#define BY(kernel_) .name = kernel_, .builder = "", .kernel = kernel_
static const bb_paper_entrant replayed[] = {
    {BY("stack")},
    {BY("stack8")},
    {BY("stackless")},
    {BY("short:entries=4")},
    {BY("cwbvh")},
    {BY("packet8:group=64")},
    {BY("packet:rays=16,few=2,group=256")},
    {BY("packet8:stack=8,few=0")},
    {.name = NULL},
};
#define WITH(kernel_) .name = kernel_, .builder = OF_LOCKSTEP, .kernel = kernel_
static const bb_paper_entrant traced[] = {
    {WITH("stack")}, {WITH("stack8")}, {WITH("stackless")}, {WITH("cwbvh")}, {.name = NULL}};

static const bb_figure differ = {.what = "apart"};
static const bb_paper_column replays[] = {
    BB_COLUMN_OF("scene", BB_SHOW_SCENE),
    BB_COLUMN_OF("kernel", BB_SHOW_ROW),
    BB_COLUMN_AS("steps replayed", 0, .what = "issued"),
    BB_COLUMN_AS("steps in lockstep", 0, .what = "in_lockstep"),
    BB_COLUMN_AS("comparisons that differ, of 4", 0, .what = "apart"),
    {.heading = NULL},
};
#define OF_RAYS(rays_)                                                                             \
    BB_COLUMN_AS(rays_ ": all", 2, .what = "simt_efficiency", .rays = rays_),                      \
        BB_COLUMN_AS("nodes", 2, .what = "simt_node_efficiency", .rays = rays_),                   \
        BB_COLUMN_AS("primitives", 2, .what = "simt_prim_efficiency", .rays = rays_)
static const bb_paper_column efficiencies[] = {
    BB_COLUMN_OF("scene", BB_SHOW_SCENE),
    BB_COLUMN_OF("kernel", BB_SHOW_ROW),
    OF_RAYS("primary"),
    OF_RAYS("ao"),
    OF_RAYS("diffuse"),
    {.heading = NULL},
};
#define STABILITY(number_) BB_COLUMN_AS("tau", 2, .what = "stability" number_)
#define SWAPS(number_)                                                                             \
    {                                                                                              \
        .heading = "pairs that change places", .shown = BB_SHOW_TEXT, .note = "swaps" number_      \
    }
static const bb_paper_column rankings[] = {
    BB_COLUMN_OF("scene", BB_SHOW_SCENE),
    STABILITY("2"),
    SWAPS("2"),
    STABILITY("3"),
    SWAPS("3"),
    STABILITY("4"),
    SWAPS("4"),
    {.heading = NULL},
};

static void say_simulations(bb_paper_place at, bb_words *title)
{
    for (uint32_t i = 1; i < at.all->simulation_count; i++)
        bb_say(title, "%s%s", i > 1 ? ", " : "", at.all->simulations[i]);
    bb_say(title, "; against %s",
           at.all->simulation_count > 0 ? at.all->simulations[0] : "no simulation");
}

static const bb_paper_table tables[] = {
    {.title = "Replays of recorded steps, and work-groups that trace in lockstep on the device: "
              "groups of 32 and of 64, closest and any hits",
     .columns = replays,
     .rows = replayed,
     .of = REPLAYED,
     .by_scene = true},
    {.title = "SIMT efficiency: active lanes per lane issued, by the first simulation, tree "
              "by " OF_LOCKSTEP,
     .columns = efficiencies,
     .rows = traced,
     .by_scene = true},
    {.title = "Kendall's tau of the builders' ranks, each by its best kernel, one column for each "
              "other simulation: ",
     .columns = rankings,
     .by_scene = true,
     .title_words = say_simulations},
    {.title = NULL},
};

/* ---- claims ---- */

static const bb_figure half = {.what = "stability2"}, twice = {.what = "stability3"},
                       wide = {.what = "stability4"};

static void say_unvalidated(bb_paper_place at, bb_said *said)
{
    (void)at;
    bb_say(&said->why,
           "no published efficiency or bound of such kernels is at hand as a text; until one is "
           "within 25 %%, all bounds are called unvalidated. Ratios that papers give are in their "
           "own pages: `reproduce emc --metrics simt`. Left out are latency beyond what the groups "
           "in flight hide, the scheduler, and hardware for ray tracing");
}

static const bb_paper_claim claims[] = {
    {.text =
         "Replayed steps, lanes, sectors and lines are those of a lockstep run, to the last one",
     .paper = "",
     .of = REPLAYED,
     .rows = replayed,
     .together = true,
     .of_scenes = true,
     .figures = {&differ},
     .tests = {BB_TEST_EACH(0, BB_BELOW, 1)}},
    {.text =
         "Builders keep their ranks with caches of half the size: Kendall's tau is at least 0.9",
     .paper = "",
     .figures = {&half},
     .tests = {BB_TEST_EACH(0, BB_AT_LEAST, 0.9)},
     .ours = {{.each = true, .text = "{scene}: {0.2}"}}},
    {.text =
         "Builders keep their ranks with caches of twice the size: Kendall's tau is at least 0.9",
     .paper = "",
     .figures = {&twice},
     .tests = {BB_TEST_EACH(0, BB_AT_LEAST, 0.9)},
     .ours = {{.each = true, .text = "{scene}: {0.2}"}}},
    {.text = "Builders keep their ranks with groups of 64 rays: Kendall's tau is at least 0.9",
     .paper = "",
     .figures = {&wide},
     .tests = {BB_TEST_EACH(0, BB_AT_LEAST, 0.9)},
     .ours = {{.each = true, .text = "{scene}: {0.2}"}}},
    {.text = "Bounds are those that were measured on such a GPU",
     .paper = "",
     .judge = say_unvalidated},
    {.text = NULL},
};

extern const bb_paper bb_paper_simt;
const bb_paper bb_paper_simt = {
    .name = "simt",
    .title = "Simulated GPUs: what the simulations of this bench are worth",
    .experiments = experiments,
    .builders = OF_LOCKSTEP,
    .metrics = "simt,simt:cache=0.5,simt:cache=2,simt:width=64",
    .measure = measure,
    .tables = tables,
    .claims = {claims},
};
