/* bvhbench run: the comparison. */
#include "framework/base/interrupt.h"
#include "framework/bench/bench.h"
#include "framework/cli/cells_option.h"
#include "framework/cli/charts_option.h"
#include "framework/cli/choice.h"
#include "framework/cli/cli.h"
#include "framework/cli/output.h"
#include "framework/cli/shard_option.h"
#include "framework/device/device_private.h"
#include "framework/report/report.h"
#include "framework/scene/scene.h"
#include "framework/workload/workload.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const bb_cli_option options[] = {
    {"scene", "S",
     "file (.gltf, .glb, .obj, .ply), shipped or procedural scene; `all` and default: shipped",
     true},
    {"builder", "B", "name:key=value,...; A+B; `all`; default: the variants to compare", true},
    {"kernel", "K", "kernel; `all`; default: those to compare, and those that keep a tree's shape",
     true},
    {"rays", "R",
     "workload; `all`; `none`: builds only; default: primary, ao, diffuse, shadow, random", true},
    {"intersector", "I", "intersection tests: see `list intersectors`; `all`; default: exact",
     true},
    {"cell", "KEY", "measure exactly this cell, instead of all of the above", BB_CLI_REPEATED},
    BB_DEVICE_OPTION,
    BB_FORM_OPTION,
    {"handover", "H", "how work-groups hand over data: auto, fence or levels; default: auto",
     false},
    {"size", "WxH",
     "image size for primary rays; default: 512x512, or 256x256 if nothing is chosen", false},
    {"max-rays", "N",
     "most rays of a workload that samples, per scene; default: 1048576, or 65536 likewise; see "
     "below",
     false},
    {"repeats", "N",
     "measured rounds, after a discarded one; default: 6, the fewest for a 95 % interval", false},
    {"seed", "N", "random seed; default: 1", false},
    {"metrics", "M", "additional metrics of trees: see below; `all`", true},
    {"max-wrong-ppm", "X", "wrong rays per million that are tolerated; default: 0", false},
    {"plugin", "FILE.so", "load a builder, besides those in BVHBENCH_PLUGINS", true},
    {"kernels-from", "DIR", "take device code from here first (edit and run)", false},
    {"out", "DIR", "folder for results.json, report.html and pictures; default: out", false},
    {"history", "DB", "append the run to this database (SQLite; made if there is none)", false},
    {"shard", "I/N", "measure part I of N of the cells; see below", false},
    {"table", NULL, "print the full tables instead of the summary", false},
    {"quick", NULL, "a first look: one view, two rounds, and few rays except on a GPU", false},
    {"no-pictures", NULL, "make no pictures", false},
    BB_CHARTS_OPTION,
    {"quiet", NULL, "do not show progress", false},
    {.name = NULL},
};

/* The builders, and the reference rows, which are in every result. */
static bb_status choose_builders(const bb_cli *cli, bb_names *names)
{
    bool referenced = false;
    BB_TRY(bb_choose_builders(cli, false, names));
    for (size_t i = 0; i < names->count; i++)
        referenced = referenced || bb_is_reference(names->items[i]);
    if (referenced)
        return BB_OK;
    return bb_names_add(names, "embree-native:quality=medium,mode=robust,"
                               "embree-native:quality=medium,mode=fast,"
                               "embree-native:quality=high,mode=fast");
}

/* Nothing was chosen: the default comparison, which is to take two minutes, with fewer rays, and
 * which compares accuracy too. */
static bool is_default(const bb_cli *cli)
{
    static const char *const choices[] = {"scene", "builder", "kernel",
                                          "rays",  "cell",    "intersector"};
    for (size_t i = 0; i < sizeof choices / sizeof choices[0]; i++) {
        uint32_t count;
        bb_cli_values(cli, choices[i], &count);
        if (count > 0)
            return false;
    }
    return true;
}

/* Rays of a set on a GPU, at least: the largest keep 270,000 work-items in flight, and the last of
 * a launch leave most of it idle. */
enum { GPU_RAYS = 1 << 20 };

/* Whether sets are to fill a GPU: the device is one, and nobody said how large they are to be. */
static bool fills_gpu(const bb_cli *cli, uint32_t device)
{
    return device == BB_FOR_GPU && bb_cli_value(cli, "size") == NULL &&
           bb_cli_value(cli, "max-rays") == NULL;
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
static bb_status suit_device(const bb_cli *cli, uint32_t device, bb_names *workloads)
{
    if (fills_gpu(cli, device))
        return add_rays(workloads);
    if (device == BB_FOR_GPU && workloads->count > 0 && bb_cli_value(cli, "quiet") == NULL)
        fprintf(stderr,
                "bvhbench: --size or --max-rays is given: sets may have fewer than the %d rays "
                "that a GPU takes to be busy\n",
                GPU_RAYS);
    return BB_OK;
}

static bb_status fill_request(const bb_cli *cli, uint32_t device, bb_bench_request *request)
{
    uint64_t max_rays, repeats;
    const bool quick = bb_cli_value(cli, "quick") != NULL, few = quick || is_default(cli);
    const bool many = !few || fills_gpu(cli, device);
    request->width = request->height = few ? 256 : 512;
    request->max_views = quick ? 1 : 0;
    BB_TRY(bb_cli_size(cli, "size", &request->width, &request->height));
    BB_TRY(bb_cli_u64(cli, "max-rays", many ? 1 << 20 : 1 << 16, 1, 1u << 30, &max_rays));
    BB_TRY(bb_cli_u64(cli, "repeats", quick ? 2 : BB_INTERVAL_ROUNDS, 1, BB_SAMPLES_MAX - 1,
                      &repeats));
    BB_TRY(bb_cli_u64(cli, "seed", 1, 0, UINT64_MAX, &request->seed));
    BB_TRY(bb_cli_double(cli, "max-wrong-ppm", 0, 0, 1e6, &request->max_wrong_ppm));
    request->max_rays = (uint32_t)max_rays;
    request->repeats = (uint32_t)repeats;
    request->quiet = bb_cli_value(cli, "quiet") != NULL;
    return BB_OK;
}

/* `none` of the rays: no workloads, and no kernels but those that were asked for, whose layouts are
 * made. */
static bb_status choose_traces(const bb_cli *cli, bb_names *kernels, bb_names *workloads)
{
    uint32_t rays_given, kernels_given;
    char *const *rays = bb_cli_values(cli, "rays", &rays_given);
    bb_cli_values(cli, "kernel", &kernels_given);
    bool none = false;
    for (uint32_t i = 0; i < rays_given; i++)
        none = none || strcmp(rays[i], "none") == 0;
    if (none && rays_given > 1)
        return bb_fail(BB_INVALID, "--rays none means no rays: it cannot be combined with others");
    if (!none)
        BB_TRY(bb_choose_rays(cli, workloads));
    return none && kernels_given == 0 ? BB_OK : bb_choose_kernels(cli, kernels);
}

/* What is compared: lists of the command line, or of what there is. */
typedef struct lists {
    bb_names scenes, builders, kernels, workloads, intersectors, metrics;
} lists;

static bb_status choose(const bb_cli *cli, lists *l, bb_bench_request *request)
{
    const uint32_t device = bb_device_find_kind(bb_cli_value(cli, "device"));
    uint32_t kernels_given;
    bb_cli_values(cli, "kernel", &kernels_given);
    BB_TRY(bb_choose_scenes(cli, bb_add_shipped_scenes, &l->scenes));
    BB_TRY(choose_builders(cli, &l->builders));
    BB_TRY(choose_traces(cli, &l->kernels, &l->workloads));
    BB_TRY(bb_choose_intersectors(cli, &l->intersectors));
    BB_TRY(bb_choose_metrics(cli, &l->metrics));
    BB_TRY(suit_device(cli, device, &l->workloads));
    BB_TRY(fill_request(cli, device, request));
    request->scenes = l->scenes.items;
    request->scene_count = (uint32_t)l->scenes.count;
    request->builders = l->builders.items;
    request->builder_count = (uint32_t)l->builders.count;
    request->kernels = l->kernels.items;
    request->kernel_count = (uint32_t)l->kernels.count;
    request->native = kernels_given == 0 && l->workloads.count > 0;
    request->workloads = l->workloads.items;
    request->workload_count = (uint32_t)l->workloads.count;
    request->intersectors = l->intersectors.items;
    request->intersector_count = (uint32_t)l->intersectors.count;
    request->metrics = l->metrics.items;
    request->metric_count = (uint32_t)l->metrics.count;
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

typedef struct comparison {
    bb_bench_request request;
    bool telling;   /* accuracy is compared too */
    bb_cells cells; /* if there are any, one run for each of their groups */
} comparison;

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

static bb_status run(const bb_cli *cli, int *exit_status)
{
    const char *folder = bb_cli_value(cli, "out") != NULL ? bb_cli_value(cli, "out") : "out";
    lists chosen = {0};
    comparison wanted = {.request.picture_folder =
                             bb_cli_value(cli, "no-pictures") == NULL ? folder : NULL};
    bool charts = false, sharded = false;
    bb_shard shard;
    BB_TRY(bb_shard_read(cli, &shard, &sharded));
    wanted.request.shard = sharded ? &shard : NULL;
    wanted.telling = is_default(cli);
    BB_TRY(bb_charts_wanted(cli, &charts));
    BB_TRY(bb_load_plugins(cli));
    bb_status status = bb_cells_read(cli, &wanted.cells);
    if (status == BB_OK)
        status = choose(cli, &chosen, &wanted.request);
    if (status == BB_OK && wanted.cells.group_count > 0)
        bb_cells_request(&wanted.cells.groups[0], &wanted.request);
    if (status == BB_OK) {
        const bb_comparison all = {
            .cli = cli,
            .folder = folder,
            .history = bb_cli_value(cli, "history"),
            .shard = bb_cli_value(cli, "shard"),
            .shard_of = hash_of(&wanted),
            .seed = wanted.request.seed,
            .charts = charts,
            .quiet = wanted.request.quiet,
            .compare = compare,
            .request = &wanted,
            .print = bb_cli_value(cli, "table") != NULL ? bb_report_table : bb_report_verdict,
        };
        status = bb_output_compare(&all, exit_status);
    }
    bb_cells_free(&wanted.cells);
    bb_names_free(&chosen.scenes);
    bb_names_free(&chosen.builders);
    bb_names_free(&chosen.kernels);
    bb_names_free(&chosen.workloads);
    bb_names_free(&chosen.intersectors);
    bb_names_free(&chosen.metrics);
    return status;
}

static void list_metrics(FILE *out)
{
    fputs("\nmetrics of trees for --metrics:\n", out);
    for (uint32_t i = 0; i < bb_metric_count(); i++)
        if (bb_metrics[i]->on_request)
            fprintf(out, "  %-14s %s\n", bb_metrics[i]->name, bb_metrics[i]->full_title);
}

extern const bb_command bb_command_run;
const bb_command bb_command_run = {
    .name = "run",
    .summary = "compare builders: build, trace, judge every answer, report",
    .details =
        "Three embree-native:... are added as reference rows unless one is among the builders.\n"
        "--cell takes the key of a measurement: `cell` of a build or trace in results.json.\n"
        "--history appends the run when it is done, in one transaction; whether it can be written "
        "is\n"
        "found out before. Interrupted runs are appended too, and marked.\n"
        "--shard deals the cells out by ray set, so that cells that are compared by ratios stay\n"
        "together; N shards have each cell once, and `bvhbench merge` makes one run of them:\n"
        "  parallel -j 1 bvhbench run --shard {}/4 --out out/{} ::: 1 2 3 4; bvhbench merge "
        "out/[1-4]\n"
        "On a GPU a set has at least 1,048,576 rays (least=N of those that are made of pictures),\n"
        "unless --size or --max-rays says otherwise.\n"
        "2 to 5 --repeats give a range instead of an interval, 1 gives neither.\n"
        "A comma starts a new item of a list unless what follows it is key=value.\n"
        "Exit status 1: a cell with the intersector `exact` has more wrong answers than\n"
        "--max-wrong-ppm, or answers that differ from those of other cells; a builder or kernel\n"
        "failed; no answer of a scene was judged; or figures of the run contradict each other.",
    .more_help = list_metrics,
    .options = options,
    .run = run,
};
