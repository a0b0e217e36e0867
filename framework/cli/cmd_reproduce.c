/* bvhbench reproduce: a paper's experiments, tables and claims beside ours. */
#include "framework/cli/output.h"
#include "framework/papers/reproduce.h"

#include <stdio.h>
#include <stdlib.h>

typedef struct wanted {
    bb_device_choice device;
    bb_reproduce_request request;
    bb_bystanders watch; /* of its contests */
    bb_names scenes;
    const char *folder, *history;
    uint32_t charts;
} wanted;

static const bb_cli_option options[] = {
    {"scene", "S",
     "replace the default scenes, if an experiment allows it; `all`: the shipped scenes",
     BB_INTO(wanted, scenes)},
    {"repeats", "N",
     "measured rounds; default: each experiment's own; fewer than 6 decide no claim on times",
     BB_INTO(wanted, request.repeats), .low = 1, .high = BB_SAMPLES_MAX - 1},
    {"max-prims", "N", "most primitives in experiments that vary their number",
     BB_INTO(wanted, request.max_prims), .low = 10000, .high = 100000000, .fallback = "1000000"},
    {"quick", NULL, "small scenes, few rays, two rounds: a trial that decides no claim on times",
     BB_INTO(wanted, request.quick), .apart = "repeats",
     .presets = (const char *const[]){"max-prims", "10000", NULL}},
    {"full-size", NULL,
     "pictures and slices of the papers' sizes (volume: 2160^2, olbvh: 1024^2 and 999^2): hours",
     BB_INTO(wanted, request.full_size), .apart = "quick"},
    BB_GROUP(bb_device_options, wanted, device),
    BB_SEED_OPTION(wanted, request.seed),
    {"out", "DIR", "folder for results.json and report.html", BB_INTO(wanted, folder),
     .fallback = "out"},
    BB_HISTORY_OPTION(wanted, history),
    BB_CHARTS_OPTION(wanted, charts),
    BB_QUIET_OPTION(wanted, request.quiet),
    {.name = NULL},
};

static bb_status reproduce(void *user, bb_device *device, bb_results *results,
                           bb_bench_outcome *outcome)
{
    wanted *w = user;
    bb_bystanders_start(&w->watch);
    w->request.device = device;
    w->request.audit = &outcome->audit;
    w->request.watch = &w->watch;
    return bb_reproduce(&w->request, results, outcome);
}

static bb_status run(const bb_cli *cli, void *values, int *exit_status)
{
    wanted *w = values;
    bb_reproduce_request *request = &w->request;
    BB_TRY(bb_charts_decide(&w->charts));
    BB_TRY(bb_load_plugins(&w->device.plugins));
    if (cli->positional_count != 1)
        return bb_fail(BB_INVALID, "reproduce: give one paper: `bvhbench list papers` shows them");
    BB_TRY(bb_paper_find(cli->positional[0], &request->paper));
    if (w->scenes.count > 0) /* else each experiment has its own */
        BB_TRY(bb_choose_scenes(&w->scenes, bb_add_shipped_scenes));
    request->scenes = w->scenes.items;
    request->scene_count = (uint32_t)w->scenes.count;
    BB_TRY(bb_reproduce_check(request));
    const bb_comparison comparison = {
        .command = cli->command_line,
        .device = &w->device,
        .folder = w->folder,
        .history = w->history,
        .seed = request->seed,
        .charts = w->charts,
        .quiet = request->quiet,
        .compare = reproduce,
        .request = w,
        .print = bb_reproduction_print,
    };
    return bb_output_compare(&comparison, exit_status);
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
    .bytes = sizeof(wanted),
    .goes_on = true,
    .run = run,
};
