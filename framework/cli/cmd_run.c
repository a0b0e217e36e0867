/* bvhbench run: the comparison. */
#include "framework/base/clock.h"
#include "framework/bench/bench.h"
#include "framework/cli/charts_option.h"
#include "framework/cli/choice.h"
#include "framework/cli/cli.h"
#include "framework/cli/output.h"
#include "framework/report/report.h"
#include "framework/scene/scene.h"
#include "traversal/traversal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const bb_cli_option options[] = {
    {"scene", "S",
     "a file (.gltf, .glb), a shipped or a procedural scene; default: the shipped ones", true},
    {"builder", "B", "name:key=value,...; `all`; default: what each builder names for it", true},
    {"kernel", "K",
     "traversal kernel; `all`; default: those for the comparison, and what keeps a tree's shape",
     true},
    {"rays", "R", "workload; default: primary, ao, diffuse, shadow, random", true},
    {"intersector", "I", "rounding rules of the tests; default: exact", true},
    {"device", "D", "index or part of the name of an OpenCL device; default: the first", false},
    {"form", "F", "of the parallel primitives: auto, cpu or gpu; default: auto", false},
    {"handover", "H", "between work-groups: auto, fence or levels; default: auto", false},
    {"size", "WxH", "of the primary rays' picture; default: 512x512", false},
    {"max-rays", "N", "per scene and workload that samples; default: 1048576", false},
    {"repeats", "N",
     "rounds that count, after a first one; default: 6, the least that give a 95 % interval; 2 to "
     "5 "
     "give a range only, 1 neither",
     false},
    {"seed", "N", "of all that is random; default: 1", false},
    {"metrics", "M", "further metrics: epo", true},
    {"max-wrong-ppm", "X", "wrong rays per million that are still right; default: 0", false},
    {"plugin", "FILE.so", "load a builder", true},
    {"kernels-from", "DIR", "read device code from here first (edit and run)", false},
    {"out", "DIR", "folder of results.json, report.html and pictures; default: out", false},
    {"no-pictures", NULL, "make no pictures", false},
    BB_CHARTS_OPTION,
    {"quiet", NULL, "no progress", false},
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

static bb_status choose_scenes(const bb_cli *cli, bb_names *names)
{
    uint32_t count;
    bb_cli_values(cli, "scene", &count);
    if (count > 0)
        return bb_choose(cli, "scene", "", names);
    for (const char *const *name = bb_shipped_scenes; *name != NULL; name++)
        BB_TRY(bb_names_add(names, *name));
    return BB_OK;
}

static bb_status read_metrics(const bb_cli *cli, bool *epo)
{
    uint32_t count;
    char *const *values = bb_cli_values(cli, "metrics", &count);
    for (uint32_t i = 0; i < count; i++) {
        if (strcmp(values[i], "epo") != 0)
            return bb_fail(BB_INVALID, "unknown metric '%s': there is epo", values[i]);
        *epo = true;
    }
    return BB_OK;
}

static bb_status fill_request(const bb_cli *cli, bb_bench_request *request)
{
    uint64_t max_rays, repeats;
    request->width = request->height = 512;
    BB_TRY(bb_cli_size(cli, "size", &request->width, &request->height));
    BB_TRY(bb_cli_u64(cli, "max-rays", 1 << 20, 1, 1u << 30, &max_rays));
    BB_TRY(bb_cli_u64(cli, "repeats", BB_INTERVAL_ROUNDS, 1, BB_SAMPLES_MAX - 1, &repeats));
    BB_TRY(bb_cli_u64(cli, "seed", 1, 0, UINT64_MAX, &request->seed));
    BB_TRY(bb_cli_double(cli, "max-wrong-ppm", 0, 0, 1e6, &request->max_wrong_ppm));
    BB_TRY(read_metrics(cli, &request->epo));
    request->max_rays = (uint32_t)max_rays;
    request->repeats = (uint32_t)repeats;
    request->quiet = bb_cli_value(cli, "quiet") != NULL;
    return BB_OK;
}

static bb_status run(const bb_cli *cli, int *exit_status)
{
    const char *folder = bb_cli_value(cli, "out") != NULL ? bb_cli_value(cli, "out") : "out";
    bb_names scenes = {0}, builders = {0}, kernels = {0}, workloads = {0}, intersectors = {0};
    bb_bench_request request = {0};
    bb_bench_outcome outcome = {0};
    bb_results *results = NULL;
    char *command = bb_cli_command_line(cli);
    uint32_t kernels_given;
    bool charts = false;
    bb_cli_values(cli, "kernel", &kernels_given);
    bb_status status = bb_charts_wanted(cli, &charts);
    if (status == BB_OK)
        status = bb_load_plugins(cli);
    if (status == BB_OK)
        status = choose_scenes(cli, &scenes);
    if (status == BB_OK)
        status = choose_builders(cli, &builders);
    if (status == BB_OK)
        status = bb_choose_kernels(cli, &kernels);
    if (status == BB_OK)
        status = bb_choose(cli, "rays", "primary,ao,diffuse,shadow,random", &workloads);
    if (status == BB_OK)
        status = bb_choose(cli, "intersector", "exact", &intersectors);
    if (status == BB_OK)
        status = fill_request(cli, &request);
    request.scenes = scenes.items;
    request.scene_count = (uint32_t)scenes.count;
    request.builders = builders.items;
    request.builder_count = (uint32_t)builders.count;
    request.kernels = kernels.items;
    request.kernel_count = (uint32_t)kernels.count;
    request.native = kernels_given == 0;
    request.workloads = workloads.items;
    request.workload_count = (uint32_t)workloads.count;
    request.intersectors = intersectors.items;
    request.intersector_count = (uint32_t)intersectors.count;
    request.picture_folder = bb_cli_value(cli, "no-pictures") == NULL ? folder : NULL;
    if (status == BB_OK)
        status = bb_bench_check(&request);
    if (status == BB_OK)
        status = bb_make_folder(folder);
    if (status == BB_OK)
        status = bb_open_device(cli, &request.device);
    if (status == BB_OK)
        status = bb_results_create(&(bb_context){request.device, request.seed, command}, &results);
    if (status == BB_OK)
        status = bb_bench_run(&request, results, &outcome);
    if (status == BB_OK)
        status = bb_output_write(results, &(bb_output_request){folder, &outcome, charts,
                                                               request.quiet, bb_report_table});
    else if (results != NULL)
        status = bb_output_keep(results, folder, status);
    if (status == BB_OK && !charts)
        bb_charts_note(cli);
    if (status == BB_OK && bb_output_blame(&outcome))
        *exit_status = BB_EXIT_WRONG;
    bb_results_destroy(results);
    bb_device_close(request.device);
    bb_names_free(&scenes);
    bb_names_free(&builders);
    bb_names_free(&kernels);
    bb_names_free(&workloads);
    bb_names_free(&intersectors);
    free(command);
    return status;
}

extern const bb_command bb_command_run;
const bb_command bb_command_run = {
    .name = "run",
    .summary = "compare builders: build, trace, judge every answer, report",
    .details = "Unless an embree-native:... is among the builders, three of them are added as "
               "reference rows.\n"
               "A comma starts a new item of a list unless what follows is key=value.\n"
               "Exit status 1: a cell with the intersector `exact` has more wrong answers than "
               "--max-wrong-ppm, or\n"
               "others than the other cells; a builder or kernel failed; no answer of a scene was "
               "judged; or figures\n"
               "of the run contradict each other.",
    .options = options,
    .run = run,
};
