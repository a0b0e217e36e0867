/* bvhbench stress: where methods fail. */
#include "framework/base/interrupt.h"
#include "framework/builder/registry.h"
#include "framework/builder/tracers.h"
#include "framework/cli/choice.h"
#include "framework/cli/out_option.h"
#include "framework/cli/output.h"
#include "framework/cli/time_option.h"
#include "framework/report/report.h"
#include "framework/stress/stress.h"
#include "traversal/traversal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

typedef struct wanted {
    bb_device_choice device;
    bb_names axes, builders, kernels, intersectors, metrics;
    bb_simt simts[BB_SIMT_MAX];
    const char *history;
    bb_stress_request request;
    uint32_t seconds;
    const char *time;
    bool no_pictures;
    bb_method methods[BB_METHODS_MAX];
} wanted;

static const bb_cli_option options[] = {
    {"axis", "A", "an axis of `list axes`, or a file with one", BB_INTO(wanted, axes),
     .fallback = "all"},
    {"builder", "B",
     "builder with parameters, name:key=value,..., or `all`; default: all, and Embree's own trees",
     BB_INTO(wanted, builders)},
    {"kernel", "K", "kernel; default: all", BB_INTO(wanted, kernels)},
    {"intersector", "I", "intersection tests; default: all", BB_INTO(wanted, intersectors)},
    {"quick", NULL,
     "take minutes: small scenes, few rays and values; times are not judged, rare failures are "
     "missed",
     BB_INTO(wanted, request.quick)},
    BB_SIMULATIONS_OPTION(wanted, metrics, "traces at each value of an axis"),
    {"limit", "SECONDS",
     "time limit of a method at one value of an axis; beyond it, the method hangs",
     BB_INTO(wanted, seconds), .low = 1, .high = 86400, .fallback = "120"},
    {"memory", "MIB", "memory limit of a method; beyond it, the method floods the memory",
     BB_INTO(wanted, request.limits.megabytes), .low = 64, .high = 1u << 30, .fallback = "8192"},
    BB_TIME_OPTION(wanted, time,
                   "end after about this long, such as 30min; the same command continues"),
    BB_GROUP(bb_device_options, wanted, device),
    BB_SEED_OPTION(wanted, request.seed),
    {"out", "DIR", "folder for stress.json, stress.html and pictures",
     BB_INTO(wanted, request.folder), .fallback = "out"},
    {"no-pictures", NULL, "make no pictures", BB_INTO(wanted, no_pictures)},
    BB_HISTORY_OPTION(wanted, history),
    BB_QUIET_OPTION(wanted, request.quiet),
    {.name = NULL},
};

/* ---- methods ---- */

static bb_status add_default_builders(bb_names *names)
{
    BB_TRY(bb_choose_builders(names, true));
    BB_TRY(bb_names_add_role(names, BB_ROLE_STRESSED));
    return bb_names_add(names, "embree-native:quality=medium,mode=robust,"
                               "embree-native:quality=medium,mode=fast");
}

static bb_status add_methods(const bb_names *names, bb_method_part part, wanted *w)
{
    for (size_t i = 0; i < names->count; i++) {
        bb_method *m = &w->methods[w->request.method_count];
        bb_intersector intersector;
        if (w->request.method_count == BB_METHODS_MAX)
            return bb_fail(BB_INVALID, "stress: more than %d methods: choose fewer",
                           BB_METHODS_MAX);
        *m = (bb_method){part, names->items[i], bb_tracer_of(names->items[i]) == NULL};
        if (part == BB_AN_INTERSECTOR) {
            BB_TRY(bb_intersector_parse(m->text, &intersector));
            m->exact = bb_intersector_is_exact(&intersector);
        }
        w->request.method_count++;
    }
    return BB_OK;
}

/* A choice among one part of the methods leaves the others out. */
static bb_status choose_methods(wanted *w)
{
    if (w->builders.count + w->kernels.count + w->intersectors.count == 0) {
        BB_TRY(add_default_builders(&w->builders));
        BB_TRY(bb_names_add(&w->kernels, "all"));
        BB_TRY(bb_names_add(&w->intersectors, "all"));
    } else if (w->builders.count > 0) {
        BB_TRY(bb_choose_builders(&w->builders, true));
    }
    if (w->kernels.count > 0)
        BB_TRY(bb_choose_kernels(&w->kernels, w->device.name));
    BB_TRY(bb_choose_intersectors(&w->intersectors));
    BB_TRY(add_methods(&w->builders, BB_A_BUILDER, w));
    BB_TRY(add_methods(&w->kernels, BB_A_KERNEL, w));
    return add_methods(&w->intersectors, BB_AN_INTERSECTOR, w);
}

/* What a point depends on besides its own parameters. */
static bb_status identify(const bb_cli *cli, const bb_device_choice *device, uint64_t *hash)
{
    bb_identity *identity = bb_identity_begin();
    bb_identity_add_choice(identity, cli, device);
    return bb_identity_end(identity, "stress", hash);
}

/* ---- the command ---- */

static bb_status open_device(void *user, bb_device **device)
{
    return bb_open_device(user, device);
}

static bb_status write_all(const bb_cli *cli, const char *history, const bb_stress *stress)
{
    char path[1200];
    bb_table *atlas;
    bb_status status = bb_atlas_table(stress, cli->command_line, &atlas);
    snprintf(path, sizeof path, "%s/stress.json", stress->request->folder);
    if (status == BB_OK)
        status = bb_table_write(atlas, path);
    snprintf(path, sizeof path, "%s/stress.html", stress->request->folder);
    if (status == BB_OK)
        status = bb_report_atlas(atlas, stress->request->folder, path);
    if (status == BB_OK)
        status = bb_output_append(history, atlas);
    bb_table_free(atlas);
    return status;
}

static bb_status stress(const bb_cli *cli, const char *history, const bb_stress_request *request,
                        int *exit_status)
{
    bb_stress found;
    bb_interrupt_catch();
    bb_status status = bb_stress_run(request, &found);
    const bool is_over = bb_interrupted_by_time();
    bb_interrupt_at(0);
    if (status == BB_OK)
        status = write_all(cli, history, &found);
    if (status == BB_OK)
        status = bb_atlas_print(&found, stdout);
    if (status == BB_OK && !request->quiet)
        printf("\n atlas    %s/stress.html\n figures  %s/stress.json\n", request->folder,
               request->folder);
    if (status == BB_OK && bb_stress_blame(&found, stderr) > 0)
        *exit_status = BB_EXIT_WRONG;
    if (status == BB_OK && is_over)
        fprintf(stderr, "bvhbench: --time was over: the same command continues\n");
    else if (status == BB_OK && bb_interrupted())
        *exit_status = BB_EXIT_INTERRUPTED;
    bb_stress_free(&found);
    return status;
}

static bb_status run(const bb_cli *cli, void *values, int *exit_status)
{
    wanted *w = values;
    bb_stress_request *r = &w->request;
    double ends_ms;
    BB_TRY(bb_time_option(w->time, &ends_ms));
    BB_TRY(bb_load_plugins(&w->device.plugins));
    BB_TRY(bb_choose_axes(&w->axes));
    BB_TRY(choose_methods(w));
    BB_TRY(bb_choose_simulations(&w->metrics, w->simts, &r->simt_count));
    r->metrics = w->metrics.items;
    r->simts = w->simts;
    BB_TRY(identify(cli, &w->device, &r->identity));
    r->limits.seconds = w->seconds;
    r->axes = w->axes.items;
    r->axis_count = (uint32_t)w->axes.count;
    r->methods = w->methods;
    r->pictures = !w->no_pictures;
    r->open_device = open_device;
    r->user = &w->device;
    BB_TRY(bb_stress_check(r));
    BB_TRY(bb_out_folder(r->folder));
    BB_TRY(bb_output_append(w->history, NULL));
    bb_interrupt_at(ends_ms);
    return stress(cli, w->history, r, exit_status);
}

extern const bb_command bb_command_stress;
const bb_command bb_command_stress = {
    .name = "stress",
    .summary = "find where builders, kernels and intersectors begin to fail",
    .details =
        "Each axis has a parameter that drives methods into failure. Bisection finds the value at "
        "which each\n"
        "method begins to fail: wrong answers, a refusal, or twice its own time, tests or memory. "
        "Only the\n"
        "given methods are tried if there is --builder, --kernel or --intersector.\n"
        "Each value is measured in a process of its own and kept in DIR/points, so that the same "
        "command\n"
        "continues after an interruption. Remove that folder to measure anew.\n"
        "Exit status 1: a crash, a hang, a flood of memory, a failure, no verdict, or wrong\n"
        "answers of an exact method.",
    .options = options,
    .bytes = sizeof(wanted),
    .run = run,
};
