/* bvhbench run: the comparison. */
#include "framework/base/interrupt.h"
#include "framework/bench/bench.h"
#include "framework/bench/forecast.h"
#include "framework/cli/cells_option.h"
#include "framework/cli/choice.h"
#include "framework/cli/cli.h"
#include "framework/cli/foretell.h"
#include "framework/cli/out_option.h"
#include "framework/cli/output.h"
#include "framework/cli/shard_option.h"
#include "framework/cli/time_option.h"
#include "framework/device/device_private.h"
#include "framework/report/report.h"
#include "framework/scene/scene.h"
#include "framework/workload/workload.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct comparison {
    bb_device_choice device;
    bb_entrants entrants;
    bb_names keys, metrics;
    bb_bench_request request;
    const char *folder, *history, *part, *time;
    uint32_t charts;
    bool table, quick, no_pictures;
    bb_names tracers;
    bb_shard shard;   /* `part`, read */
    bool telling;     /* nothing is chosen: accuracy is compared too */
    bb_thrift thrift; /* with `time`: how much is left out */
    bb_cells cells;   /* if there are any, one run for each of their groups */
} comparison;

static const bb_cli_option options[] = {
    {"scene", "S",
     "file (.gltf, .glb, .obj, .ply), shipped or procedural scene; `all` and default: the shipped "
     "scenes",
     BB_INTO(comparison, entrants.scenes)},
    {"builder", "B",
     "builder with parameters, name:key=value,..., or A+B, or `all`; default: the variants to "
     "compare",
     BB_INTO(comparison, entrants.builders)},
    {"tracer", "T",
     "tracer, beside the builders: FILE.so, FILE.so:key=value,... or name:key=value,...; see `list "
     "tracers`",
     BB_INTO(comparison, tracers)},
    {"kernel", "K",
     "kernel, or `all`; default: those to compare, and those that keep a tree's shape",
     BB_INTO(comparison, entrants.kernels)},
    {"rays", "R", "workload, or `all`; `none`: builds only",
     BB_INTO(comparison, entrants.workloads), .fallback = BB_COMPARED_RAYS},
    {"intersector", "I", "intersection tests, or `all`: see `list intersectors`",
     BB_INTO(comparison, entrants.intersectors), .fallback = BB_COMPARED_INTERSECTORS},
    {"cell", "KEY", "measure exactly this cell, instead of all of the above",
     BB_INTO_EACH(comparison, keys),
     .apart = "scene|builder|kernel|rays|intersector|size|max-rays|seed"},
    BB_GROUP(bb_device_options, comparison, device),
    {"size", "WxH",
     "image size for primary rays; default: 512x512, or 256x256 if nothing is chosen",
     BB_INTO_SIZE(comparison, request.width)},
    {"max-rays", "N",
     "most rays per scene of a workload that samples; default: 1048576, or 65536 if nothing is "
     "chosen; see below",
     BB_INTO(comparison, request.max_rays), .low = 1, .high = 1u << 30},
    {"repeats", "N", "measured rounds, after a discarded one; 6 are the fewest for a 95 % interval",
     BB_INTO(comparison, request.repeats), .low = 1, .high = BB_SAMPLES_MAX - 1, .fallback = "6"},
    BB_SEED_OPTION(comparison, request.seed),
    {"metrics", "M", "additional metrics: see below; `all`: those of trees",
     BB_INTO(comparison, metrics)},
    {"max-wrong-ppm", "X", "tolerated wrong rays per million",
     BB_INTO(comparison, request.max_wrong_ppm), .high = 1e6, .fallback = "0"},
    {"out", "DIR", "folder for results.json, report.html and pictures", BB_INTO(comparison, folder),
     .fallback = "out"},
    BB_HISTORY_OPTION(comparison, history),
    {"shard", "I/N", "measure part I of N of the cells; see below", BB_INTO(comparison, part)},
    {"time", "T",
     "take at most about this long, such as 90s or 5min, with fewer rays, views and rounds if need "
     "be",
     BB_INTO(comparison, time), .apart = "size|max-rays|repeats|cell|shard|quick"},
    {"table", NULL, "print the full tables instead of the summary", BB_INTO(comparison, table)},
    {"quick", NULL, "a first look: one view, two rounds, and few rays except on a GPU",
     BB_INTO(comparison, quick), .presets = (const char *const[]){"repeats", "2", NULL}},
    {"no-pictures", NULL, "make no pictures", BB_INTO(comparison, no_pictures)},
    BB_CHARTS_OPTION(comparison, charts),
    BB_QUIET_OPTION(comparison, request.quiet),
    {.name = NULL},
};

/* Nothing was chosen: the default comparison, which is to take two minutes, with fewer rays, and
 * which compares accuracy too. */
static bool is_default(const bb_cli *cli, const comparison *c)
{
    const bb_names *const choices[] = {&c->entrants.scenes,    &c->entrants.builders,
                                       &c->entrants.kernels,   &c->keys,
                                       &c->entrants.workloads, &c->entrants.intersectors};
    for (size_t i = 0; i < sizeof choices / sizeof choices[0]; i++)
        if (bb_cli_given(cli, choices[i]))
            return false;
    return true;
}

/* Rays of a set on a GPU, at least: the largest keep 270,000 work-items in flight, and the last of
 * a launch leave most of it idle. */
enum { GPU_RAYS = 1 << 20 };

/* Whether sets are to fill a GPU: the device is one, and nobody said how large they are to be. */
static bool fills_gpu(const comparison *c, uint32_t device)
{
    return device == BB_FOR_GPU && c->request.width == 0 && c->request.max_rays == 0;
}

static bb_status add_rays(bb_names *workloads)
{
    for (size_t i = 0; i < workloads->count; i++) {
        char more[512];
        BB_TRY(bb_workload_at_least(workloads->items[i], GPU_RAYS, more, sizeof more));
        char *text = strdup(more);
        if (text == NULL)
            return bb_fail(BB_FAILED, "out of memory");
        free(workloads->items[i]);
        workloads->items[i] = text;
    }
    return BB_OK;
}

/* As many as a GPU needs, or else a word on it. */
static bb_status suit_device(const comparison *c, uint32_t device, bb_names *workloads)
{
    if (fills_gpu(c, device))
        return add_rays(workloads);
    if (device == BB_FOR_GPU && workloads->count > 0 && !c->request.quiet)
        fprintf(stderr,
                "bvhbench: --size or --max-rays is given: sets may have fewer than the %d rays "
                "that a GPU takes to be busy\n",
                GPU_RAYS);
    return BB_OK;
}

static void choose_sizes(comparison *c, uint32_t device)
{
    bb_bench_request *request = &c->request;
    const bool few = c->quick || c->telling, many = !few || fills_gpu(c, device);
    if (request->max_rays == 0)
        request->max_rays = many ? 1 << 20 : 1 << 16;
    if (request->width == 0)
        request->width = request->height = few ? 256 : 512;
    request->max_views = c->quick ? 1 : c->telling ? 2 : 0;
}

/* `none` of the rays: no workloads, and no kernels but those that were asked for, whose layouts are
 * made. If traces are simulated, the default is the kernels of that role. */
static bb_status choose_traces(comparison *c)
{
    bb_names *rays = &c->entrants.workloads, *kernels = &c->entrants.kernels;
    bool none = false, simulated = false;
    for (size_t i = 0; i < c->metrics.count; i++)
        simulated = simulated || bb_is_simt(c->metrics.items[i]);
    for (size_t i = 0; i < rays->count; i++)
        none = none || strcmp(rays->items[i], "none") == 0;
    if (none && rays->count > 1)
        return bb_fail(BB_INVALID, "--rays none means no rays: it cannot be combined with others");
    c->request.native = kernels->count == 0 && !none;
    if (none)
        bb_names_free(rays);
    else
        BB_TRY(bb_choose_rays(rays));
    if (none && kernels->count == 0)
        return BB_OK;
    if (simulated && kernels->count == 0)
        return bb_add_kernels(kernels, BB_ROLE_SIMULATED, BB_FOR_GPU);
    return bb_choose_kernels(kernels, c->device.name);
}

static bb_status choose(comparison *c)
{
    const uint32_t device = bb_device_find_kind(c->device.name);
    bb_bench_request *request = &c->request;
    BB_TRY(bb_choose_entrants(&c->entrants.builders, &c->tracers));
    BB_TRY(choose_traces(c));
    BB_TRY(bb_choose_intersectors(&c->entrants.intersectors));
    BB_TRY(bb_choose_metrics(&c->metrics));
    BB_TRY(suit_device(c, device, &c->entrants.workloads));
    choose_sizes(c, device);
    bb_entrants_request(&c->entrants, request);
    request->metrics = c->metrics.items;
    request->metric_count = (uint32_t)c->metrics.count;
    return bb_bench_check(request);
}

/* Where speed is paid for with wrong answers: beside what was chosen, one builder and kernel with
 * intersectors from careless to exact, on rays that tell them apart. */
static char *const telling_scenes[] = {"sphere-mesh:n=64", "boards:length=1e3"};
static char *const telling_rays[] = {"edges:jitter=64"};
static char *const telling_intersectors[] = {"exact", "watertight", "pluecker", "fast"};

static bb_bench_request telling_request(const bb_bench_request *of, uint32_t device)
{
    bb_bench_request request = *of;
    request.scenes = telling_scenes;
    request.scene_count = sizeof telling_scenes / sizeof telling_scenes[0];
    request.builder_count = 1;
    request.kernel_count = 1;
    request.native = false;
    request.workloads = telling_rays;
    request.workload_count = sizeof telling_rays / sizeof telling_rays[0];
    request.intersectors = telling_intersectors;
    request.intersector_count = sizeof telling_intersectors / sizeof telling_intersectors[0];
    const uint32_t most = device == BB_FOR_GPU ? GPU_RAYS : 1 << 18;
    request.max_rays = of->max_rays < most ? of->max_rays : most;
    request.picture_folder = NULL;
    return request;
}

static bb_status compare(void *user, bb_device *device, bb_results *results,
                         bb_bench_outcome *outcome)
{
    comparison *c = user;
    bb_bench_outcome more;
    c->request.device = device;
    if (c->cells.group_count == 0) {
        BB_TRY(bb_bench_run(&c->request, results, outcome));
        if (!c->telling || bb_interrupted())
            return BB_OK;
        const bb_bench_request telling = telling_request(&c->request, bb_device_kind(device));
        BB_TRY(bb_bench_run(&telling, results, &more));
        bb_bench_outcome_add(outcome, &more);
        return BB_OK;
    }
    for (uint32_t i = 0; i < c->cells.group_count && !bb_interrupted(); i++) {
        bb_cells_request(&c->cells.groups[i], &c->request);
        BB_TRY(bb_bench_run(&c->request, results, &more));
        bb_bench_outcome_add(outcome, &more);
    }
    return BB_OK;
}

static uint64_t hash_of(const comparison *c)
{
    bb_bench_request request = c->request;
    uint64_t hash = c->telling;
    if (c->cells.group_count == 0)
        return bb_bench_request_hash(&request, hash);
    for (uint32_t i = 0; i < c->cells.group_count; i++) {
        bb_cells_request(&c->cells.groups[i], &request);
        hash = bb_bench_request_hash(&request, hash);
    }
    return hash;
}

static bb_status choose_for_forecast(void *user, const bb_bench_request **request)
{
    comparison *c = user;
    *request = &c->request;
    return choose(c);
}

/* Only after places that cannot be written are refused, since it may take minutes. */
static bb_status foretell(comparison *c)
{
    bb_foretelling what = {&c->entrants.scenes, &c->device, choose_for_forecast, c, 0};
    BB_TRY(bb_time_option(c->time, &what.ends_ms));
    if (c->cells.group_count > 0 || c->telling || c->quick || (c->request.quiet && c->time == NULL))
        return BB_OK;
    BB_TRY(bb_out_folder(c->folder));
    BB_TRY(bb_output_append(c->history, NULL));
    bb_interrupt_catch();
    return bb_foretell(&what, &c->thrift);
}

static bb_status run(const bb_cli *cli, void *values, int *exit_status)
{
    comparison *c = values;
    bb_bench_request *request = &c->request;
    c->telling = is_default(cli, c) && c->time == NULL;
    request->picture_folder = c->no_pictures ? NULL : c->folder;
    if (c->part != NULL) {
        BB_TRY(bb_shard_parse(c->part, "--shard", &c->shard));
        request->shard = &c->shard;
    }
    BB_TRY(bb_charts_decide(&c->charts));
    BB_TRY(bb_load_plugins(&c->device.plugins));
    BB_TRY(bb_load_tracers(&c->tracers));
    BB_TRY(bb_cells_read(&c->keys, &c->cells));
    BB_TRY(bb_choose_scenes(&c->entrants.scenes, bb_add_shipped_scenes));
    BB_TRY(foretell(c));
    if (bb_interrupted()) {
        fprintf(stderr, "bvhbench: interrupted before anything was measured\n");
        *exit_status = BB_EXIT_INTERRUPTED;
        return BB_OK;
    }
    BB_TRY(choose(c));
    *request = bb_bench_thrifty(request, c->thrift.number);
    if (c->cells.group_count > 0)
        bb_cells_request(&c->cells.groups[0], request);
    const bb_comparison all = {
        .command = cli->command_line,
        .device = &c->device,
        .folder = c->folder,
        .history = c->history,
        .shard = c->part,
        .shard_of = hash_of(c),
        .reduced_to = c->thrift.reduced_to,
        .seed = request->seed,
        .charts = c->charts,
        .quiet = request->quiet,
        .compare = compare,
        .request = c,
        .print = c->table ? bb_report_table : bb_report_verdict,
    };
    return bb_output_compare(&all, exit_status);
}

static void release(void *values)
{
    bb_cells_free(&((comparison *)values)->cells);
}

static void list_metrics(FILE *out)
{
    fputs("\nmetrics of trees for --metrics, and one of traces and builds:\n", out);
    for (uint32_t i = 0; i < bb_metric_count(); i++)
        if (bb_metrics[i]->on_request)
            fprintf(out, "  %-14s %s\n", bb_metrics[i]->name, bb_metrics[i]->full_title);
    fprintf(out, "  %-14s %s\n", BB_SIMT,
            "each trace and each build on the device, simulated on a GPU on paper, such as "
            "simt:device=h100,width=32; the default kernels are then those for GPUs");
}

extern const bb_command bb_command_run;
const bb_command bb_command_run = {
    .name = "run",
    .summary = "compare builders: build, trace, judge every answer, report",
    .details =
        "Tracers build trees of their own and trace them by code of their own. Embree's is in "
        "each\n"
        "run, as the reference: embree-native, ray by ray, by packets and by streams, unless "
        "rows of it\n"
        "are given.\n"
        "--cell takes the key of a measurement: `cell` of a build or trace in results.json.\n"
        "--history appends the run when it is done, in one transaction; before measuring, it "
        "checks that\n"
        "the database can be written. Interrupted runs are appended too, and marked.\n"
        "--shard deals the cells out by ray set, so that cells that are compared by ratios stay\n"
        "together; N shards have each cell once, and `bvhbench merge` makes one run of them:\n"
        "  parallel -j 1 bvhbench run --shard {}/4 --out out/{} ::: 1 2 3 4; bvhbench merge "
        "out/[1-4]\n"
        "On a GPU a set has at least 1,048,576 rays (by least=N for rays that start from "
        "pictures), unless\n"
        "--size or --max-rays is given.\n"
        "If neither scenes, builders, kernels, rays nor intersectors are chosen, two views of each "
        "scene are\n"
        "taken, else all.\n"
        "What a scene of more than 65,536 primitives takes is foretold first, from a small "
        "comparison on a\n"
        "sample of it: on a processor, for scenes without volume or motion, and not with --cell, "
        "--quick,\n"
        "--quiet or if nothing is chosen. --time foretells all scenes, and halves the sides of "
        "pictures, takes\n"
        "a quarter of the rays of other sets, one view or two rounds until the time is kept; what "
        "it leaves out\n"
        "is said, and noted in the results. It refuses what cannot be foretold, or takes longer "
        "even so. The\n"
        "comparison of intersectors, which runs if nothing is chosen, is left out.\n"
        "2 to 5 --repeats give a range instead of an interval, 1 gives neither.\n"
        "A comma starts a new item of a list unless what follows it is key=value.\n"
        "Exit status 1: a cell with the intersector `exact` has more wrong answers than\n"
        "--max-wrong-ppm, or answers that differ from those of other cells; a builder or kernel\n"
        "failed; no answer of a scene was judged; or figures of the run contradict each other.",
    .more_help = list_metrics,
    .options = options,
    .bytes = sizeof(comparison),
    .goes_on = true,
    .run = run,
    .release = release,
};
