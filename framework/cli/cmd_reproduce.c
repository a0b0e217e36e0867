/* bvhbench reproduce: a paper's experiments, tables and claims beside ours. */
#include "framework/cli/charts_option.h"
#include "framework/cli/choice.h"
#include "framework/cli/output.h"
#include "framework/papers/reproduce.h"

#include <stdio.h>
#include <stdlib.h>

static const bb_cli_option options[] = {
    {"scene", "S",
     "instead of the default scenes, where an experiment allows it; `all`: the shipped ones", true},
    {"repeats", "N",
     "measured rounds; default: each experiment's own; fewer than 6 decide no claim on times",
     false},
    {"max-prims", "N", "most primitives, where their number varies; default: 1000000", false},
    {"quick", NULL, "small scenes, few rays, two rounds: a trial that decides no claim on times",
     false},
    BB_DEVICE_OPTION,
    BB_FORM_OPTION,
    {"handover", "H", "how work-groups hand over data: auto, fence or levels; default: auto",
     false},
    {"seed", "N", "random seed; default: 1", false},
    {"plugin", "FILE.so", "load a builder, besides those in BVHBENCH_PLUGINS", true},
    {"kernels-from", "DIR", "take device code from here first (edit and run)", false},
    {"out", "DIR", "folder for results.json and report.html; default: out", false},
    BB_CHARTS_OPTION,
    {"quiet", NULL, "do not show progress", false},
    {.name = NULL},
};

/* None: each experiment has its own. */
static bb_status choose_scenes(const bb_cli *cli, bb_names *scenes, bb_reproduce_request *request)
{
    uint32_t given;
    bb_cli_values(cli, "scene", &given);
    if (given > 0)
        BB_TRY(bb_choose_scenes(cli, bb_add_shipped_scenes, scenes));
    request->scenes = scenes->items;
    request->scene_count = (uint32_t)scenes->count;
    return BB_OK;
}

static bb_status fill_request(const bb_cli *cli, bb_names *scenes, bb_reproduce_request *request)
{
    uint64_t repeats;
    if (cli->positional_count != 1)
        return bb_fail(BB_INVALID, "reproduce: give one paper: `bvhbench list papers` shows them");
    BB_TRY(bb_paper_find(cli->positional[0], &request->paper));
    BB_TRY(bb_cli_u64(cli, "repeats", 0, 1, BB_SAMPLES_MAX - 1, &repeats));
    BB_TRY(bb_cli_u64(cli, "max-prims", 1000000, 10000, 100000000, &request->max_prims));
    BB_TRY(bb_cli_u64(cli, "seed", 1, 0, UINT64_MAX, &request->seed));
    request->repeats = (uint32_t)repeats;
    request->quick = bb_cli_value(cli, "quick") != NULL;
    request->quiet = bb_cli_value(cli, "quiet") != NULL;
    if (request->quick && bb_cli_value(cli, "repeats") != NULL)
        return bb_fail(BB_INVALID, "reproduce: --quick sets the number of rounds: drop --repeats");
    if (request->quick && bb_cli_value(cli, "max-prims") == NULL)
        request->max_prims = 10000;
    BB_TRY(choose_scenes(cli, scenes, request));
    return bb_reproduce_check(request);
}

static bb_status reproduce(void *user, bb_device *device, bb_results *results,
                           bb_bench_outcome *outcome)
{
    bb_reproduce_request *request = user;
    request->device = device;
    return bb_reproduce(request, results, outcome);
}

static bb_status run(const bb_cli *cli, int *exit_status)
{
    bb_reproduce_request request = {0};
    bb_names scenes = {0};
    bool charts = false;
    BB_TRY(bb_charts_wanted(cli, &charts));
    BB_TRY(bb_load_plugins(cli));
    bb_status status = fill_request(cli, &scenes, &request);
    const bb_comparison comparison = {
        .cli = cli,
        .folder = bb_cli_value(cli, "out") != NULL ? bb_cli_value(cli, "out") : "out",
        .seed = request.seed,
        .charts = charts,
        .quiet = request.quiet,
        .compare = reproduce,
        .request = &request,
        .print = bb_reproduction_print,
    };
    if (status == BB_OK)
        status = bb_output_compare(&comparison, exit_status);
    bb_names_free(&scenes);
    return status;
}

extern const bb_command bb_command_reproduce;
const bb_command bb_command_reproduce = {
    .name = "reproduce",
    .summary = "repeat a paper's experiments; show its tables and claims beside ours",
    .arguments = "PAPER",
    .details =
        "`bvhbench list papers` shows the papers. Exit status 1: an answer is wrong, or a builder\n"
        "or kernel failed. A claim that does not hold is not a failure.",
    .options = options,
    .run = run,
};
