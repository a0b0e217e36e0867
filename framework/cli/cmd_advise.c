/* bvhbench advise: the least that a scene needs. */
#include "framework/advise/advise.h"
#include "framework/base/interrupt.h"
#include "framework/base/shell_word.h"
#include "framework/cli/contest_output.h"
#include "framework/cli/output.h"
#include "framework/device/device_private.h"
#include "framework/device/run_row.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct advising {
    bb_contest_choice choice;
    bb_advise_request request;
    bb_names rays, builders, kernels, intersectors, metrics;
    bb_simt simts[BB_SIMT_MAX];
    uint64_t count, memory;
    uint32_t charts;
    char *further; /* bb_advise_request.further */
    bb_contest_output output;
    bool found;
    double ends_ms; /* bb_wall_ms() when the time is over; 0: never */
    bool is_over;   /* it was, before the work was done */
} advising;

static const bb_cli_option options[] = {
    {"scene", "S", "file (.gltf, .glb, .obj, .ply), shipped or procedural scene",
     BB_INTO(advising, request.scene), .needed = true},
    {"max-wrong-ppm", "X", "tolerated wrong rays per million",
     BB_INTO(advising, request.max_wrong_ppm), .high = 1e6, .fallback = "0"},
    {"rays", "R", "kinds of rays", BB_INTO(advising, rays),
     .fallback = "primary,ao,diffuse,shadow"},
    {"count", "N", "rays of the image whose time is compared, all kinds together",
     BB_INTO(advising, count), .low = 1, .high = (double)(UINT64_C(1) << 50), .fallback = "1e6"},
    {"builder", "B",
     "builders to try; default: those that `run` compares, some more, and their least variants",
     BB_INTO(advising, builders)},
    {"kernel", "K", "kernels to try; default: those that `run` compares, and some that need less",
     BB_INTO(advising, kernels)},
    {"intersector", "I", "intersectors to try; default: exact, or all if wrong rays are tolerated",
     BB_INTO(advising, intersectors)},
    BB_SIMULATIONS_OPTION(advising, metrics, "the least by the bound of the rays, shown apart"),
    {"exhaustive", NULL,
     "measure all combinations at the end, and compare the choice with the best",
     BB_INTO(advising, request.exhaustive)},
    {"size", "WxH", "image size for primary rays, in the last heat",
     BB_INTO_SIZE(advising, request.width), .fallback = "256x256"},
    {"max-rays", "N", "most rays of each sampled kind, in the last heat",
     BB_INTO(advising, request.max_rays), .low = 1, .high = 1u << 30, .fallback = "65536"},
    {"repeats", "N", "measured rounds of the last heat, 6 or more",
     BB_INTO(advising, request.repeats), .low = BB_INTERVAL_ROUNDS, .high = BB_SAMPLES_MAX - 1,
     .fallback = "10"},
    BB_TIME_OPTION(advising, choice.time,
                   "end after about this long, such as 5min, with the best that was found by then"),
    {"memory", "BYTES",
     "memory for trees and layouts; if they need more, they are measured in turns",
     BB_INTO(advising, memory), .low = 1, .high = (double)(UINT64_C(1) << 50), .fallback = "1500M"},
    {"quick", NULL, "fewer rays, and one heat less", BB_INTO(advising, request.quick),
     .presets =
         (const char *const[]){"size", "128x128", "max-rays", "16384", "repeats", "6", NULL}},
    BB_SEED_OPTION(advising, request.seed),
    BB_GROUP(bb_contest_options, advising, choice),
    {"out", "DIR",
     "folder for advise.json and advise.html, and for results.json and report.html of the last "
     "heat; default: none",
     BB_INTO(advising, choice.out)},
    BB_HISTORY_OPTION(advising, choice.history),
    BB_CHARTS_OPTION(advising, charts),
    BB_QUIET_OPTION(advising, request.quiet),
    {.name = NULL},
};

/* ---- the request ---- */

static bb_status copy(const bb_names *names, bb_tried *list)
{
    for (size_t i = 0; i < names->count; i++)
        BB_TRY(bb_tried_add(list, names->items[i]));
    return BB_OK;
}

static bb_status choose_builders(advising *a)
{
    if (a->builders.count == 0)
        return bb_tried_builders(&a->request.builders);
    BB_TRY(bb_choose_builders(&a->builders, false));
    return copy(&a->builders, &a->request.builders);
}

static bb_status choose_kernels(advising *a)
{
    if (a->kernels.count == 0)
        return bb_tried_kernels(&a->request.kernels, bb_device_find_kind(a->choice.device.name));
    BB_TRY(bb_choose_kernels(&a->kernels, a->choice.device.name));
    return copy(&a->kernels, &a->request.kernels);
}

/* Those given, or those for a GPU, as far as simulations have bounds for them. */
static bb_status choose_simulated(advising *a)
{
    bb_advise_request *r = &a->request;
    bb_tried for_gpus = {.count = 0};
    BB_TRY(bb_choose_simulations(&a->metrics, a->simts, &r->simt_count));
    r->metrics = a->metrics.items;
    r->simts = a->simts;
    if (r->simt_count == 0)
        return BB_OK;
    if (a->kernels.count > 0)
        return bb_tried_bounded(&r->kernels, &r->simulated_kernels);
    bb_status status = bb_tried_kernels(&for_gpus, BB_FOR_GPU);
    if (status == BB_OK)
        status = bb_tried_bounded(&for_gpus, &r->simulated_kernels);
    bb_tried_free(&for_gpus);
    return status;
}

static bb_status choose_intersectors(advising *a)
{
    bb_tried *list = &a->request.intersectors;
    if (a->intersectors.count == 0)
        return a->request.max_wrong_ppm > 0 ? bb_tried_intersectors(list)
                                            : bb_tried_add(list, "exact");
    BB_TRY(bb_choose_intersectors(&a->intersectors));
    return copy(&a->intersectors, list);
}

/* Writes the given options that `run` has too and that affect its times or answers. */
static bb_status keep_options(const bb_cli *cli, char **text)
{
    static const char *const kept[] = {"size", "max-rays", "seed",   "device",
                                       "form", "handover", "plugin", "kernels-from"};
    size_t size;
    FILE *out = open_memstream(text, &size);
    if (out == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    for (size_t k = 0; k < sizeof kept / sizeof kept[0]; k++) {
        const bb_cli_row *row = bb_cli_find(cli, kept[k]);
        for (uint32_t i = 0; i < row->count; i++) {
            fprintf(out, " --%s ", kept[k]);
            bb_put_shell_word(out, row->given[i]);
        }
    }
    return fclose(out) == 0 ? BB_OK : bb_fail(BB_FAILED, "out of memory");
}

static bb_status fill_request(advising *a)
{
    bb_advise_request *r = &a->request;
    r->memory = (double)a->memory;
    r->image_rays = (double)a->count;
    r->max_views = r->quick ? 1 : 2;
    BB_TRY(bb_check_scene(r->scene));
    BB_TRY(bb_choose_rays(&a->rays));
    r->rays = a->rays.items;
    r->ray_count = (uint32_t)a->rays.count;
    BB_TRY(choose_builders(a));
    BB_TRY(choose_kernels(a));
    BB_TRY(choose_intersectors(a));
    BB_TRY(choose_simulated(a));
    return bb_advise_check(r);
}

/* ---- the answer ---- */

static bool is_advised(const advising *a)
{
    return a->output.table != NULL && bb_table_row_count(a->output.table) > 1;
}

static bb_status advise(void *user, bb_device *device, bb_results *results,
                        bb_bench_outcome *outcome)
{
    advising *a = user;
    a->request.device = device;
    bb_interrupt_at(a->ends_ms);
    BB_TRY(bb_contest_output_begin(&a->output, device, a->request.seed));
    bb_status status = bb_advise(&a->request, results, outcome, a->output.table, &a->found);
    a->output.audit = outcome->audit;
    a->is_over = bb_interrupted_by_time();
    bb_interrupt_at(0); /* what is left to do takes no time to speak of */
    if (status != BB_OK || !a->is_over)
        return status;
    if (is_advised(a))
        bb_table_set_text(a->output.table, 0, &bb_run_columns[BB_RUN_INTERRUPTED], "yes");
    return is_advised(a) ? bb_results_set_interrupted(results)
                         : bb_fail(BB_REFUSED, "advise: --time was over before anything was "
                                               "measured: give more time");
}

/* Advises without a folder: the comparisons are not kept. */
static bb_status advise_alone(advising *a, int *exit_status)
{
    bb_device *device = NULL;
    bb_results *results = NULL;
    bb_bench_outcome outcome = {0};
    bb_interrupt_catch();
    bb_status status = bb_open_device(&a->choice.device, &device);
    if (status == BB_OK)
        status =
            bb_results_create(&(bb_context){device, a->request.seed, a->request.command}, &results);
    if (status == BB_OK)
        status = advise(a, device, results, &outcome);
    if (bb_interrupted()) { /* a signal makes compilers fail */
        *exit_status = BB_EXIT_INTERRUPTED;
        status = BB_OK;
    }
    bb_results_destroy(results);
    bb_device_close(device);
    return status;
}

static bb_status print_nothing(const bb_results *results, FILE *out)
{
    (void)results;
    (void)out;
    return BB_OK;
}

static bb_status advise_in_folder(advising *a, int *exit_status)
{
    const bb_comparison comparison = {
        .command = a->request.command,
        .device = &a->choice.device,
        .folder = a->choice.out,
        .seed = a->request.seed,
        .charts = a->charts,
        .quiet = a->request.quiet || a->choice.json,
        .compare = advise,
        .request = a,
        .print = print_nothing,
    };
    return bb_output_compare(&comparison, exit_status);
}

/* The advice comes last, so that it stays on the screen. */
static bb_status answer(advising *a, bb_status status, bool *blamed)
{
    if (status == BB_OK && !is_advised(a))
        fprintf(stderr, "bvhbench: interrupted: there is no advice\n");
    else if (status == BB_OK)
        status = bb_contest_output_scene(&a->output);
    /* in a folder, bb_output_compare() has said what clocks are wrong */
    return bb_contest_output_end(&a->output, status, a->choice.out == NULL ? blamed : NULL);
}

static bb_status run(const bb_cli *cli, void *values, int *exit_status)
{
    advising *a = values;
    BB_TRY(bb_charts_decide(&a->charts));
    BB_TRY(bb_load_plugins(&a->choice.device.plugins));
    BB_TRY(keep_options(cli, &a->further));
    a->request.command = cli->command_line;
    a->request.further = a->further;
    a->output = (bb_contest_output){.outline = &bb_advise_outline,
                                    .printed = &bb_advise_outline_briefly,
                                    .choice = &a->choice,
                                    .command_line = cli->command_line};
    BB_TRY(bb_time_option(a->choice.time, &a->ends_ms));
    BB_TRY(fill_request(a));
    bool blamed = false;
    const bb_status status =
        a->choice.out != NULL ? advise_in_folder(a, exit_status) : advise_alone(a, exit_status);
    BB_TRY(answer(a, status, &blamed));
    if (a->is_over)
        fprintf(stderr, "bvhbench: --time was over: this is the best that was found by then\n");
    if (*exit_status == BB_EXIT_OK && (!a->found || blamed))
        *exit_status = BB_EXIT_WRONG;
    return BB_OK;
}

static void release(void *values)
{
    advising *a = values;
    bb_tried_free(&a->request.builders);
    bb_tried_free(&a->request.kernels);
    bb_tried_free(&a->request.intersectors);
    bb_tried_free(&a->request.simulated_kernels);
    free(a->further);
}

extern const bb_command bb_command_advise;
const bb_command bb_command_advise = {
    .name = "advise",
    .summary =
        "find the least configuration for a scene: builder, code, kernel, stack, intersector",
    .details =
        "Measures configurations and drops early those that are certainly too slow. Among "
        "those that are\n"
        "accurate enough and within 5 % of the fastest, it chooses the one with the least "
        "memory, then with\n"
        "the fewest bits of the code, stack entries and kinds of primitives. It shows the "
        "cost of generous\n"
        "settings, and the command that measures the choice again.\n"
        "Exit status 1: no configuration is within --max-wrong-ppm, or clocks contradict each "
        "other.",
    .options = options,
    .bytes = sizeof(advising),
    .goes_on = true,
    .run = run,
    .release = release,
};
