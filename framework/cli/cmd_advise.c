/* bvhbench advise: the least that a scene needs. */
#include "framework/advise/advise.h"
#include "framework/base/interrupt.h"
#include "framework/base/json.h"
#include "framework/base/shell_word.h"
#include "framework/cli/charts_option.h"
#include "framework/cli/choice.h"
#include "framework/cli/output.h"
#include "framework/device/device_private.h"

#include <cjson/cJSON.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const bb_cli_option options[] = {
    {"scene", "S", "file (.gltf, .glb, .obj, .ply), shipped or procedural scene", BB_CLI_REPEATED},
    {"max-wrong-ppm", "X", "wrong rays per million that are tolerated; default: 0", false},
    {"rays", "R", "kinds of rays; default: primary, ao, diffuse, shadow", true},
    {"count", "N", "rays for which the time to image is asked, all kinds together; default: 1e6",
     false},
    {"builder", "B", "to try; default: those that `run` compares, and least variants of them",
     true},
    {"kernel", "K", "to try; default: those that `run` compares, and some that take less", true},
    {"intersector", "I", "to try; default: exact, or all if wrong rays are tolerated", true},
    {"exhaustive", NULL, "measure everything at the end: how far is the choice from the best?",
     false},
    {"size", "WxH", "image size for primary rays, in the last heat; default: 256x256", false},
    {"max-rays", "N", "most rays of a kind that samples, likewise; default: 65536", false},
    {"repeats", "N", "measured rounds of the last heat, 6 or more; default: 10, or 6 with --quick",
     false},
    {"memory", "BYTES",
     "for trees and layouts at a time: what takes more is measured in turns; default: 1500M",
     false},
    {"quick", NULL, "fewer rays, and one heat less", false},
    {"seed", "N", "random seed; default: 1", false},
    {"json", NULL, "print the advice as JSON", false},
    BB_DEVICE_OPTION,
    BB_FORM_OPTION,
    {"handover", "H", "how work-groups hand over data: auto, fence or levels; default: auto",
     false},
    {"plugin", "FILE.so", "load a builder, besides those in BVHBENCH_PLUGINS", true},
    {"kernels-from", "DIR", "take device code from here first (edit and run)", false},
    {"out", "DIR", "folder for results.json and report.html of the last heat; default: none",
     false},
    BB_CHARTS_OPTION,
    {"quiet", NULL, "do not show progress", false},
    {.name = NULL},
};

typedef struct advising {
    bb_advise_request request;
    bool found;
} advising;

/* ---- the request ---- */

static bb_status copy(const bb_names *names, bb_tried *list)
{
    for (size_t i = 0; i < names->count; i++)
        BB_TRY(bb_tried_add(list, names->items[i]));
    return BB_OK;
}

/* One list: what is given, else what there is to try, if that is said. */
static bb_status choose(const bb_cli *cli, const char *option,
                        bb_status (*given)(const bb_cli *cli, bb_names *names),
                        bb_status (*by_default)(bb_tried *list), bb_tried *list)
{
    uint32_t count;
    bb_names names = {.count = 0};
    bb_cli_values(cli, option, &count);
    if (count == 0)
        return by_default != NULL ? by_default(list) : BB_OK;
    bb_status status = given(cli, &names);
    if (status == BB_OK)
        status = copy(&names, list);
    bb_names_free(&names);
    return status;
}

static bb_status given_builders(const bb_cli *cli, bb_names *names)
{
    return bb_choose_builders(cli, false, names);
}

static bb_status exact_alone(bb_tried *list)
{
    return bb_tried_add(list, "exact");
}

static bb_status choose_lists(const bb_cli *cli, bb_advise_request *r)
{
    BB_TRY(choose(cli, "builder", given_builders, bb_tried_builders, &r->builders));
    BB_TRY(choose(cli, "kernel", bb_choose_kernels, NULL, &r->kernels));
    if (r->kernels.count == 0)
        BB_TRY(bb_tried_kernels(&r->kernels, bb_device_find_kind(bb_cli_value(cli, "device"))));
    return choose(cli, "intersector", bb_choose_intersectors,
                  r->max_wrong_ppm > 0 ? bb_tried_intersectors : exact_alone, &r->intersectors);
}

static bb_status choose_rays(const bb_cli *cli, bb_names *names, bb_advise_request *r)
{
    uint32_t count;
    bb_cli_values(cli, "rays", &count);
    BB_TRY(count > 0 ? bb_choose_rays(cli, names)
                     : bb_names_add(names, "primary,ao,diffuse,shadow"));
    r->rays = names->items;
    r->ray_count = (uint32_t)names->count;
    return BB_OK;
}

static bb_status read_numbers(const bb_cli *cli, bb_advise_request *r)
{
    uint64_t rays, count, repeats, memory;
    const bool quick = bb_cli_value(cli, "quick") != NULL;
    r->width = r->height = quick ? 128 : 256;
    BB_TRY(bb_cli_size(cli, "size", &r->width, &r->height));
    BB_TRY(bb_cli_u64(cli, "max-rays", quick ? 1 << 14 : 1 << 16, 1, 1u << 30, &rays));
    BB_TRY(bb_cli_u64(cli, "count", 1000000, 1, UINT64_C(1) << 50, &count));
    BB_TRY(bb_cli_u64(cli, "repeats", quick ? BB_INTERVAL_ROUNDS : 10, BB_INTERVAL_ROUNDS,
                      BB_SAMPLES_MAX - 1, &repeats));
    BB_TRY(bb_cli_u64(cli, "seed", 1, 0, UINT64_MAX, &r->seed));
    BB_TRY(bb_cli_double(cli, "max-wrong-ppm", 0, 0, 1e6, &r->max_wrong_ppm));
    BB_TRY(bb_cli_u64(cli, "memory", 1500000000, 1, UINT64_C(1) << 50, &memory));
    r->memory = (double)memory;
    r->max_rays = (uint32_t)rays;
    r->image_rays = (double)count;
    r->repeats = (uint32_t)repeats;
    r->max_views = quick ? 1 : 2;
    r->quick = quick;
    r->exhaustive = bb_cli_value(cli, "exhaustive") != NULL;
    r->quiet = bb_cli_value(cli, "quiet") != NULL;
    return BB_OK;
}

static bb_status choose_scene(const bb_cli *cli, bb_advise_request *r)
{
    uint32_t count;
    char *const *scenes = bb_cli_values(cli, "scene", &count);
    if (count != 1)
        return bb_fail(BB_INVALID, "advise: give one --scene: what is least depends on it");
    r->scene = scenes[0];
    return bb_check_scene(r->scene);
}

/* What was given of all that `run` takes likewise and its times or answers depend on. */
static bb_status keep_options(const bb_cli *cli, char **text)
{
    static const char *const kept[] = {"size", "max-rays", "seed",   "device",
                                       "form", "handover", "plugin", "kernels-from"};
    size_t size;
    FILE *out = open_memstream(text, &size);
    if (out == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    for (size_t k = 0; k < sizeof kept / sizeof kept[0]; k++) {
        uint32_t count;
        char *const *values = bb_cli_values(cli, kept[k], &count);
        for (uint32_t i = 0; i < count; i++) {
            fprintf(out, " --%s ", kept[k]);
            bb_put_shell_word(out, values[i]);
        }
    }
    return fclose(out) == 0 ? BB_OK : bb_fail(BB_FAILED, "out of memory");
}

static bb_status fill_request(const bb_cli *cli, bb_names *rays, bb_advise_request *r)
{
    BB_TRY(choose_scene(cli, r));
    BB_TRY(read_numbers(cli, r));
    BB_TRY(choose_rays(cli, rays, r));
    BB_TRY(choose_lists(cli, r));
    return bb_advise_check(r);
}

/* ---- the answer ---- */

static bb_status advise(void *user, bb_device *device, bb_results *results,
                        bb_bench_outcome *outcome)
{
    advising *a = user;
    a->request.device = device;
    return bb_advise(&a->request, results, outcome, &a->found);
}

/* After an interrupt before anything was measured. */
static bool is_advised(const bb_results *results)
{
    const bool advised = bb_results_member(results, "advice") != NULL;
    if (!advised && bb_interrupted())
        fprintf(stderr, "bvhbench: interrupted: there is no advice\n");
    return advised || !bb_interrupted();
}

static bb_status print_text(const bb_results *results, FILE *out)
{
    const cJSON *context = bb_results_context(results);
    if (!is_advised(results))
        return BB_OK;
    fprintf(out, "%s\n", bb_get_text(context, BB_F_CONTEXT_DEVICE));
    return bb_advice_print(results, out);
}

static bb_status print_json(const bb_results *results, FILE *out)
{
    if (!is_advised(results))
        return BB_OK;
    char *text = bb_json_print(bb_results_member(results, "advice"), true);
    if (text == NULL)
        return bb_fail(BB_FAILED, "advise: no memory");
    bool written = fprintf(out, "%s\n", text) > 0;
    cJSON_free(text);
    return written ? BB_OK : bb_fail(BB_FAILED, "cannot write the advice");
}

/* Without a folder: nothing is written. */
static bb_status answer(const bb_cli *cli, advising *a,
                        bb_status (*print)(const bb_results *results, FILE *out), int *exit_status)
{
    bb_device *device = NULL;
    bb_results *results = NULL;
    bb_bench_outcome outcome = {0};
    bb_interrupt_catch();
    bb_status status = bb_open_device(cli, &device);
    if (status == BB_OK)
        status =
            bb_results_create(&(bb_context){device, a->request.seed, a->request.command}, &results);
    if (status == BB_OK)
        status = advise(a, device, results, &outcome);
    if (bb_interrupted()) { /* a signal makes compilers fail */
        *exit_status = BB_EXIT_INTERRUPTED;
        status = BB_OK;
    }
    if (status == BB_OK && results != NULL)
        status = print(results, stdout);
    bb_results_destroy(results);
    bb_device_close(device);
    return status;
}

static bb_status run(const bb_cli *cli, int *exit_status)
{
    advising a = {.found = false};
    bb_names rays = {.count = 0};
    bool charts = false;
    const char *folder = bb_cli_value(cli, "out");
    const bool json = bb_cli_value(cli, "json") != NULL;
    BB_TRY(bb_charts_wanted(cli, &charts));
    BB_TRY(bb_load_plugins(cli));
    char *command = bb_cli_command_line(cli);
    a.request.command = command;
    char *further = NULL;
    bb_status status = keep_options(cli, &further);
    a.request.further = further;
    if (status == BB_OK)
        status = fill_request(cli, &rays, &a.request);
    const bb_comparison comparison = {
        .cli = cli,
        .folder = folder,
        .seed = a.request.seed,
        .charts = charts,
        .quiet = a.request.quiet || json,
        .compare = advise,
        .request = &a,
        .print = json ? print_json : print_text,
    };
    if (status == BB_OK)
        status = folder != NULL ? bb_output_compare(&comparison, exit_status)
                                : answer(cli, &a, comparison.print, exit_status);
    if (status == BB_OK && *exit_status == BB_EXIT_OK && !a.found)
        *exit_status = BB_EXIT_WRONG;
    bb_names_free(&rays);
    bb_tried_free(&a.request.builders);
    bb_tried_free(&a.request.kernels);
    bb_tried_free(&a.request.intersectors);
    free(command);
    free(further);
    return status;
}

extern const bb_command bb_command_advise;
const bb_command bb_command_advise = {
    .name = "advise",
    .summary = "the least that a scene needs: builder, code, kernel, stack, intersector",
    .details =
        "Tries what matters, drops early what is surely too slow, and of what is right often "
        "enough\n"
        "and within 5 % of the fastest names what takes least: memory, bits of the code, stack,\n"
        "kinds of primitives, in this order. Says what it left out, what that would have cost, "
        "and\n"
        "the command that measures the choice again.\n"
        "Exit status 1: nothing that was tried is within --max-wrong-ppm.",
    .options = options,
    .run = run,
};
