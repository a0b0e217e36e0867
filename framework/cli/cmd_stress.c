/* bvhbench stress: where methods fail. */
#include "framework/base/file.h"
#include "framework/base/identity.h"
#include "framework/base/interrupt.h"
#include "framework/base/json.h"
#include "framework/builder/registry.h"
#include "framework/cli/choice.h"
#include "framework/cli/cli.h"
#include "framework/cli/out_option.h"
#include "framework/report/report.h"
#include "framework/stress/stress.h"
#include "traversal/traversal.h"

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static const bb_cli_option options[] = {
    {"axis", "A", "an axis of `list axes`, or a file with one; default: all", true},
    {"builder", "B", "name:key=value,...; `all`; default: all, and Embree's own trees", true},
    {"kernel", "K", "kernel; default: all", true},
    {"intersector", "I", "intersection tests; default: all", true},
    {"quick", NULL,
     "minutes: small scenes, few rays and values; judges no times, misses what is rare", false},
    {"limit", "SECONDS", "what takes longer, for one value of an axis, hangs; default: 120", false},
    {"memory", "MIB", "what takes more floods the memory; default: 8192", false},
    BB_DEVICE_OPTION,
    BB_FORM_OPTION,
    {"handover", "H", "how work-groups hand over data: auto, fence or levels; default: auto",
     false},
    {"seed", "N", "random seed; default: 1", false},
    {"plugin", "FILE.so", "load a builder, besides those in BVHBENCH_PLUGINS", true},
    {"kernels-from", "DIR", "take device code from here first (edit and run)", false},
    {"out", "DIR", "folder for stress.json, stress.html and pictures; default: out", false},
    {"no-pictures", NULL, "make no pictures", false},
    {"quiet", NULL, "do not show progress", false},
    {.name = NULL},
};

/* ---- methods ---- */

typedef struct lists {
    bb_names axes, builders, kernels, intersectors;
    bb_method methods[BB_METHODS_MAX];
    uint32_t method_count;
} lists;

static bool given(const bb_cli *cli, const char *option)
{
    uint32_t count;
    bb_cli_values(cli, option, &count);
    return count > 0;
}

/* A choice among one part of the methods leaves the others out. */
static bool takes_part(const bb_cli *cli, const char *option)
{
    return given(cli, option) ||
           (!given(cli, "builder") && !given(cli, "kernel") && !given(cli, "intersector"));
}

static bb_status choose_builders(const bb_cli *cli, bb_names *names)
{
    BB_TRY(bb_choose_builders(cli, true, names));
    if (given(cli, "builder"))
        return BB_OK;
    BB_TRY(bb_names_add_role(names, BB_ROLE_STRESSED));
    return bb_names_add(names, "embree-native:quality=medium,mode=robust,"
                               "embree-native:quality=medium,mode=fast");
}

static bb_status choose_kernels(const bb_cli *cli, bb_names *names)
{
    if (given(cli, "kernel"))
        return bb_choose_kernels(cli, names);
    for (const bb_kernel *const *k = bb_kernels; *k != NULL; k++)
        BB_TRY(bb_names_add(names, (*k)->name));
    return BB_OK;
}

static bb_status choose_intersectors(const bb_cli *cli, bb_names *names)
{
    if (given(cli, "intersector"))
        return bb_choose_intersectors(cli, names);
    for (const bb_intersector *i = bb_intersectors; i->name != NULL; i++)
        BB_TRY(bb_names_add(names, i->name));
    return BB_OK;
}

static bb_status add_methods(const bb_names *names, bb_method_part part, lists *l)
{
    for (size_t i = 0; i < names->count; i++) {
        bb_method *m = &l->methods[l->method_count];
        bb_intersector intersector;
        if (l->method_count == BB_METHODS_MAX)
            return bb_fail(BB_INVALID, "stress: more than %d methods: choose fewer",
                           BB_METHODS_MAX);
        *m = (bb_method){part, names->items[i], !bb_is_reference(names->items[i])};
        if (part == BB_AN_INTERSECTOR) {
            BB_TRY(bb_intersector_parse(m->text, &intersector));
            m->exact = bb_intersector_is_exact(&intersector);
        }
        l->method_count++;
    }
    return BB_OK;
}

static bb_status choose_methods(const bb_cli *cli, lists *l)
{
    if (takes_part(cli, "builder"))
        BB_TRY(choose_builders(cli, &l->builders));
    if (takes_part(cli, "kernel"))
        BB_TRY(choose_kernels(cli, &l->kernels));
    if (takes_part(cli, "intersector"))
        BB_TRY(choose_intersectors(cli, &l->intersectors));
    BB_TRY(add_methods(&l->builders, BB_A_BUILDER, l));
    BB_TRY(add_methods(&l->kernels, BB_A_KERNEL, l));
    return add_methods(&l->intersectors, BB_AN_INTERSECTOR, l);
}

static bb_status choose_axes(const bb_cli *cli, bb_names *names)
{
    uint32_t count;
    char *const *values = bb_cli_values(cli, "axis", &count);
    bool all = count == 0;
    for (uint32_t i = 0; i < count; i++)
        if (strcmp(values[i], "all") != 0)
            BB_TRY(bb_names_add(names, values[i]));
        else
            all = true;
    if (!all)
        return BB_OK;
    for (const bb_axis_source *s = bb_axis_sources; s->name != NULL; s++)
        BB_TRY(bb_names_add(names, s->name));
    return BB_OK;
}

/* ---- what a point depends on besides its own parameters ---- */

static const char here[] = "in the library's code";

/* The library's code, the plug-ins', device code of a folder, and the options that choose a device.
 */
static bb_status identify(const bb_cli *cli, uint64_t *hash)
{
    static const char *const words[] = {"device", "form", "handover", "kernels-from"};
    bb_identity *identity = bb_identity_begin();
    const char *folder = bb_cli_value(cli, "kernels-from");
    Dl_info info;
    uint32_t count;
    char *const *plugins = bb_cli_values(cli, "plugin", &count);
    if (dladdr(here, &info) != 0)
        bb_identity_add_file(identity, info.dli_fname);
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++)
        bb_identity_add_text(identity, bb_cli_value(cli, words[i]));
    for (const char *path = getenv("BVHBENCH_PLUGINS"); path != NULL && *path != '\0';) {
        char one[4096];
        size_t length = strcspn(path, ":");
        snprintf(one, sizeof one, "%.*s", (int)length, path);
        bb_identity_add_file(identity, one);
        path += length + (path[length] == ':');
    }
    if (folder != NULL)
        bb_identity_add_folder(identity, folder);
    for (uint32_t i = 0; i < count; i++)
        bb_identity_add_file(identity, plugins[i]);
    return bb_identity_end(identity, "stress", hash);
}

/* ---- the command ---- */

static bb_status open_device(void *user, bb_device **device)
{
    return bb_open_device(user, device);
}

static bb_status read_request(const bb_cli *cli, const lists *l, bb_stress_request *r)
{
    uint64_t seconds;
    BB_TRY(bb_cli_u64(cli, "seed", 1, 0, UINT64_MAX, &r->seed));
    BB_TRY(bb_cli_u64(cli, "limit", 120, 1, 86400, &seconds));
    BB_TRY(bb_cli_u64(cli, "memory", 8192, 64, 1u << 30, &r->limits.megabytes));
    BB_TRY(identify(cli, &r->identity));
    r->limits.seconds = (double)seconds;
    r->axes = l->axes.items;
    r->axis_count = (uint32_t)l->axes.count;
    r->methods = l->methods;
    r->method_count = l->method_count;
    r->quick = bb_cli_value(cli, "quick") != NULL;
    r->pictures = bb_cli_value(cli, "no-pictures") == NULL;
    r->quiet = bb_cli_value(cli, "quiet") != NULL;
    r->folder = bb_cli_value(cli, "out") != NULL ? bb_cli_value(cli, "out") : "out";
    r->open_device = open_device;
    r->user = (void *)cli;
    return bb_stress_check(r);
}

static bb_status write_all(const bb_cli *cli, const bb_stress *stress)
{
    char path[1200];
    char *command = bb_cli_command_line(cli);
    bb_table *atlas;
    bb_status status = bb_atlas_table(stress, command, &atlas);
    snprintf(path, sizeof path, "%s/stress.json", stress->request->folder);
    if (status == BB_OK)
        status = bb_table_write(atlas, path);
    snprintf(path, sizeof path, "%s/stress.html", stress->request->folder);
    if (status == BB_OK)
        status = bb_report_atlas(atlas, stress->request->folder, path);
    bb_table_free(atlas);
    free(command);
    return status;
}

static bb_status stress(const bb_cli *cli, const bb_stress_request *request, int *exit_status)
{
    bb_stress found;
    bb_interrupt_catch();
    bb_status status = bb_stress_run(request, &found);
    if (status == BB_OK)
        status = write_all(cli, &found);
    if (status == BB_OK)
        status = bb_atlas_print(&found, stdout);
    if (status == BB_OK && !request->quiet)
        printf("\n atlas    %s/stress.html\n figures  %s/stress.json\n", request->folder,
               request->folder);
    if (status == BB_OK && bb_stress_blame(&found, stderr) > 0)
        *exit_status = BB_EXIT_WRONG;
    if (status == BB_OK && bb_interrupted())
        *exit_status = BB_EXIT_INTERRUPTED;
    bb_stress_free(&found);
    return status;
}

static bb_status run(const bb_cli *cli, int *exit_status)
{
    lists *l = calloc(1, sizeof *l);
    bb_stress_request request = {0};
    if (l == NULL)
        return bb_fail(BB_FAILED, "stress: no memory");
    bb_status status = bb_load_plugins(cli);
    if (status == BB_OK)
        status = choose_axes(cli, &l->axes);
    if (status == BB_OK)
        status = choose_methods(cli, l);
    if (status == BB_OK)
        status = read_request(cli, l, &request);
    if (status == BB_OK)
        status = bb_out_folder(request.folder);
    if (status == BB_OK)
        status = stress(cli, &request, exit_status);
    bb_names_free(&l->axes);
    bb_names_free(&l->builders);
    bb_names_free(&l->kernels);
    bb_names_free(&l->intersectors);
    free(l);
    return status;
}

extern const bb_command bb_command_stress;
const bb_command bb_command_stress = {
    .name = "stress",
    .summary = "where methods fail: thresholds of builders, kernels and intersectors",
    .details =
        "Each axis has one parameter that drives methods into a failure; where it begins, for "
        "each\n"
        "method, is found by bisection: wrong answers, a refusal, twice its own time, tests or\n"
        "memory. Given any of --builder, --kernel and --intersector, only those are tried.\n"
        "Each value is measured in a process of its own, and kept in DIR/points: the same command\n"
        "goes on where it was cut off. Remove that folder to measure anew.\n"
        "Exit status 1: a crash, a hang, a flood of memory, a failure, no verdict, or wrong\n"
        "answers of what must be exact.",
    .options = options,
    .run = run,
};
