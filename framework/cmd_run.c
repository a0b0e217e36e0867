/* bvhbench run: the comparison. */
#include "framework/bench.h"
#include "framework/builder.h"
#include "framework/cli.h"
#include "framework/clock.h"
#include "framework/device_option.h"
#include "framework/report.h"
#include "framework/scene.h"
#include "traversal/traversal.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const bb_cli_option options[] = {
    {"scene", "S", "a file (.gltf, .glb), a shipped or a procedural scene; default: the shipped ones", true},
    {"builder", "B", "name:key=value,...; `all`; default: those that each builder names for it", true},
    {"kernel", "K", "traversal kernel, or `all`; default: all", true},
    {"rays", "R", "workload; default: primary, ao, diffuse, shadow, random", true},
    {"intersector", "I", "rounding rules of the tests; default: exact", true},
    {"device", "D", "index or part of the name of an OpenCL device; default: the first", false},
    {"form", "F", "of the parallel primitives: auto, cpu or gpu; default: auto", false},
    {"size", "WxH", "of the primary rays' picture; default: 512x512", false},
    {"max-rays", "N", "per scene and workload that samples; default: 1048576", false},
    {"repeats", "N", "rounds that count, after a first one; default: 3", false},
    {"seed", "N", "of all that is random; default: 1", false},
    {"metrics", "M", "further metrics: epo", true},
    {"max-wrong-ppm", "X", "wrong rays per million that are still right; default: 0", false},
    {"plugin", "FILE.so", "load a builder", true},
    {"kernels-from", "DIR", "read device code from here first (edit and run)", false},
    {"out", "DIR", "folder of results.json, report.html and pictures; default: out", false},
    {"no-pictures", NULL, "make no pictures", false},
    {"quiet", NULL, "no progress", false},
    {.name = NULL},
};

enum { NAMES_MAX = 64 };

/* A list of specifications that the request points into. */
typedef struct names {
    char *items[NAMES_MAX];
    size_t count;
} names;

static bb_status add_name(names *list, const char *text)
{
    return bb_spec_list(text, list->items, NAMES_MAX, &list->count);
}

static void free_names(names *list)
{
    for (size_t i = 0; i < list->count; i++)
        free(list->items[i]);
}

static bool asks_for_all(char *const *values, uint32_t count)
{
    return count == 1 && strcmp(values[0], "all") == 0;
}

/* What was given, in order; or the default text. */
static bb_status choose(const bb_cli *cli, const char *option, const char *fallback, names *list)
{
    uint32_t count;
    char *const *values = bb_cli_values(cli, option, &count);
    if (count == 0)
        return add_name(list, fallback);
    if (count > NAMES_MAX)
        return bb_fail(BB_INVALID, "--%s: at most %d at once", option, NAMES_MAX);
    for (uint32_t i = 0; i < count; i++)
        list->items[list->count++] = strdup(values[i]);
    return BB_OK;
}

/* Builders: what was given; else what each builder names for the comparison. Then the reference rows, in every result. */
static bb_status choose_builders(const bb_cli *cli, names *list)
{
    uint32_t count;
    char *const *values = bb_cli_values(cli, "builder", &count);
    bool all = asks_for_all(values, count), referenced = false;
    for (uint32_t i = 0; i < bb_builder_count() && (all || count == 0); i++) {
        const bb_builder *builder = bb_builder_at(i);
        const char *compared = all || builder->compared == NULL ? builder->name : builder->compared;
        if (compared[0] != '\0')
            BB_TRY(add_name(list, compared));
    }
    if (!all && count > 0)
        BB_TRY(choose(cli, "builder", "", list));
    for (size_t i = 0; i < list->count; i++)
        referenced = referenced || bb_is_reference(list->items[i]);
    if (!referenced)
        BB_TRY(add_name(list, "embree-native:quality=medium,mode=robust,"
                              "embree-native:quality=medium,mode=fast,"
                              "embree-native:quality=high,mode=fast"));
    return BB_OK;
}

static bb_status choose_kernels(const bb_cli *cli, names *list)
{
    uint32_t count;
    char *const *values = bb_cli_values(cli, "kernel", &count);
    if (count > 0 && !asks_for_all(values, count))
        return choose(cli, "kernel", "", list);
    for (const bb_kernel *const *kernel = bb_kernels; *kernel != NULL; kernel++)
        BB_TRY(add_name(list, (*kernel)->name));
    return BB_OK;
}

static bb_status choose_scenes(const bb_cli *cli, names *list)
{
    uint32_t count;
    bb_cli_values(cli, "scene", &count);
    if (count > 0)
        return choose(cli, "scene", "", list);
    for (const char *const *name = bb_shipped_scenes; *name != NULL; name++)
        BB_TRY(add_name(list, *name));
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

/* Makes the folder, and makes sure now that it can be written, not after the work. */
static bb_status make_folder(const char *path)
{
    if (mkdir(path, 0777) != 0 && errno != EEXIST)
        return bb_fail(BB_INVALID, "cannot make the output folder %s: %s", path, strerror(errno));
    char probe[1100];
    snprintf(probe, sizeof probe, "%s/.bvhbench-XXXXXX", path);
    int file = mkstemp(probe);
    if (file < 0)
        return bb_fail(BB_INVALID, "cannot write into the output folder %s: %s", path,
                       strerror(errno));
    close(file);
    unlink(probe);
    return BB_OK;
}

static bb_status write_results(bb_results *results, const char *folder, bool quiet)
{
    char json[1100], html[1100];
    snprintf(json, sizeof json, "%s/results.json", folder);
    snprintf(html, sizeof html, "%s/report.html", folder);
    double start = bb_wall_ms();
    BB_TRY(bb_report_html(results, folder, html));
    BB_TRY(bb_results_add_step(results, "report", bb_wall_ms() - start));
    /* written twice: the page shows its own time only the second time */
    BB_TRY(bb_report_html(results, folder, html));
    BB_TRY(bb_results_write(results, json));
    if (!quiet)
        fprintf(stderr, "wrote %s and %s\n", json, html);
    return bb_report_table(results, stdout);
}

static char *join_command(const bb_cli *cli)
{
    size_t length = 1;
    for (int i = 0; i < cli->argc; i++)
        length += strlen(cli->argv[i]) + 1;
    char *text = calloc(1, length);
    for (int i = 0; text != NULL && i < cli->argc; i++) {
        strcat(text, i > 0 ? " " : "");
        strcat(text, i > 0 ? cli->argv[i] : "bvhbench");
    }
    return text;
}

static bb_status fill_request(const bb_cli *cli, bb_bench_request *request)
{
    uint64_t max_rays, repeats;
    request->width = request->height = 512;
    BB_TRY(bb_cli_size(cli, "size", &request->width, &request->height));
    BB_TRY(bb_cli_u64(cli, "max-rays", 1 << 20, 1, 1u << 30, &max_rays));
    BB_TRY(bb_cli_u64(cli, "repeats", 3, 1, BB_SAMPLES_MAX - 1, &repeats));
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
    names scenes = {0}, builders = {0}, kernels = {0}, workloads = {0}, intersectors = {0};
    bb_bench_request request = {0};
    bb_results *results = NULL;
    char *command = join_command(cli);
    uint32_t wrong = 0;
    bb_status status = bb_load_plugins(cli);
    if (status == BB_OK)
        status = choose_scenes(cli, &scenes);
    if (status == BB_OK)
        status = choose_builders(cli, &builders);
    if (status == BB_OK)
        status = choose_kernels(cli, &kernels);
    if (status == BB_OK)
        status = choose(cli, "rays", "primary,ao,diffuse,shadow,random", &workloads);
    if (status == BB_OK)
        status = choose(cli, "intersector", "exact", &intersectors);
    if (status == BB_OK)
        status = fill_request(cli, &request);
    request.scenes = scenes.items;
    request.scene_count = (uint32_t)scenes.count;
    request.builders = builders.items;
    request.builder_count = (uint32_t)builders.count;
    request.kernels = kernels.items;
    request.kernel_count = (uint32_t)kernels.count;
    request.workloads = workloads.items;
    request.workload_count = (uint32_t)workloads.count;
    request.intersectors = intersectors.items;
    request.intersector_count = (uint32_t)intersectors.count;
    request.picture_folder = bb_cli_value(cli, "no-pictures") == NULL ? folder : NULL;
    if (status == BB_OK)
        status = bb_bench_check(&request);
    if (status == BB_OK)
        status = make_folder(folder);
    if (status == BB_OK)
        status = bb_open_device(cli, &request.device);
    if (status == BB_OK)
        status = bb_results_create(&(bb_context){request.device, request.seed, command}, &results);
    if (status == BB_OK)
        status = bb_bench_run(&request, results, &wrong);
    if (status == BB_OK)
        status = write_results(results, folder, request.quiet);
    if (status == BB_OK && wrong > 0) {
        fprintf(stderr, "bvhbench: %u cells or builds are wrong: see the rows marked WRONG or failed\n", wrong);
        *exit_status = BB_EXIT_WRONG;
    }
    bb_results_destroy(results);
    bb_device_close(request.device);
    free_names(&scenes);
    free_names(&builders);
    free_names(&kernels);
    free_names(&workloads);
    free_names(&intersectors);
    free(command);
    return status;
}

const bb_command bb_command_run = {
    .name = "run",
    .summary = "compare builders: build, trace, judge every answer, report",
    .details = "A comma starts a new item of a list unless what follows is key=value. Exit status 1: a cell with the\n"
               "intersector `exact` has more wrong answers than --max-wrong-ppm, or a builder or kernel failed.",
    .options = options,
    .run = run,
};
