#include "framework/cli/choice.h"

#include "framework/base/progress.h"
#include "framework/builder/guard.h"
#include "framework/builder/registry.h"
#include "framework/builder/tracers.h"
#include "framework/device/device_private.h"
#include "framework/report/report.h"

#include <dirent.h>
#include <dlfcn.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

const bb_cli_option bb_plugin_options[] = {
    {"plugin", "FILE.so", "load a builder from this file, in addition to those in BVHBENCH_PLUGINS",
     BB_INTO(bb_device_choice, plugins)},
    {.name = NULL},
};

const bb_cli_option bb_device_options[] = {
    {"device", "D",
     "index of an OpenCL device, or part of its name; default: the first of `list devices`",
     BB_INTO(bb_device_choice, name)},
    {"form", NULL, BB_FORM_HELP, BB_INTO(bb_device_choice, form), .words = "auto|cpu|gpu",
     .fallback = "auto"},
    {"handover", NULL, "how work-groups hand over data", BB_INTO(bb_device_choice, handover),
     .words = "auto|fence|levels", .fallback = "auto"},
    {.kind = BB_CLI_GROUP, .group = bb_plugin_options},
    {"patience", "S",
     "seconds that one call of a builder, or one launch of a kernel, may take before it is left "
     "out; 0: no limit",
     BB_INTO(bb_device_choice, patience), .high = 1u << 30, .fallback = BB_GUARD_PATIENCE},
    {"kernels-from", "DIR", "folder whose files replace the built-in device code of the same names",
     BB_INTO(bb_device_choice, kernels_from)},
    {.name = NULL},
};

/* Refuses files whose names no device code has: a misspelt file would be ignored silently. */
static bb_status check_folder(const char *path)
{
    uint32_t found = 0;
    bb_status status = BB_OK;
    DIR *folder = opendir(path);
    if (folder == NULL)
        return BB_OK; /* bb_device_open() reports why */
    for (const struct dirent *e = readdir(folder); e != NULL && status == BB_OK;
         e = readdir(folder)) {
        const char *end = strrchr(e->d_name, '.');
        if (end == NULL ||
            (strcmp(end, ".cl") != 0 && strcmp(end, ".clh") != 0 && strcmp(end, ".h") != 0))
            continue;
        found++;
        if (bb_device_file_find(e->d_name) == NULL)
            status = bb_fail(BB_INVALID,
                             "--kernels-from %s: %s would not be used: give it the name of a "
                             "file in kernels/ or in a builder's folder",
                             path, e->d_name);
    }
    closedir(folder);
    if (status == BB_OK && found == 0)
        return bb_fail(BB_INVALID, "--kernels-from %s: there is no .cl, .clh or .h file", path);
    return status;
}

bb_status bb_open_device(const bb_device_choice *choice, bb_device **device)
{
    const char *folder = choice->kernels_from;
    bb_guard_patience(choice->patience);
    if (folder != NULL)
        BB_TRY(check_folder(folder));
    BB_TRY(bb_device_open(choice->name, (bb_form)choice->form, folder, device));
    if ((*device)->litmus_stale > 0)
        fprintf(stderr,
                "bvhbench: the fence of %s is unreliable: %u words of %u messages between "
                "work-groups came late; bottom-up passes use one launch per level instead\n",
                (*device)->name, (*device)->litmus_stale, (*device)->litmus_pairs);
    bb_progress_head("device: %s (%s, driver %s)", (*device)->name, (*device)->version,
                     (*device)->driver);
    bb_status status = bb_device_set_handover(*device, (bb_handover)choice->handover);
    if (status == BB_OK)
        return BB_OK;
    bb_device_close(*device);
    *device = NULL;
    return status;
}

/* Loads paths that are separated by ':', as in PATH. Empty ones are skipped. */
static bb_status load_from_environment(void)
{
    const char *list = getenv("BVHBENCH_PLUGINS");
    for (const char *path = list; path != NULL && *path != '\0';) {
        size_t length = strcspn(path, ":");
        char one[4096];
        if (length >= sizeof one)
            return bb_fail(BB_INVALID, "BVHBENCH_PLUGINS: a path of %zu characters is too long",
                           length);
        snprintf(one, sizeof one, "%.*s", (int)length, path);
        bb_status status = length > 0 ? bb_plugin_load(one) : BB_OK;
        if (status != BB_OK)
            return bb_fail(status, "BVHBENCH_PLUGINS: %s", bb_message());
        path += length + (path[length] == ':');
    }
    return BB_OK;
}

bb_status bb_load_plugins(const bb_names *plugins)
{
    BB_TRY(load_from_environment());
    for (size_t i = 0; i < plugins->count; i++)
        BB_TRY(bb_plugin_load(plugins->items[i]));
    return BB_OK;
}

/* Returns the length of the file's name with which the item begins; 0: it names no file. */
static size_t file_of(const char *item)
{
    static const char ending[] = ".so";
    const char *end = strstr(item, ending);
    while (end != NULL && end[sizeof ending - 1] != '\0' && end[sizeof ending - 1] != ':')
        end = strstr(end + 1, ending);
    return end != NULL ? (size_t)(end - item) + sizeof ending - 1 : 0;
}

static bb_status load_tracer(const char *path, const bb_tracer **tracer)
{
    const uint32_t before = bb_tracer_count();
    BB_TRY(bb_plugin_load(path));
    *tracer = bb_tracer_at(before);
    return *tracer != NULL
               ? BB_OK
               : bb_fail(BB_INVALID, "--tracer %s: is a builder: give it to --plugin", path);
}

/* The tracer of the file that items[i] names, which is loaded unless an item before it names it. */
static bb_status tracer_of_file(const bb_names *items, size_t i, const bb_tracer **loaded)
{
    char path[4096];
    const size_t length = file_of(items->items[i]);
    for (size_t k = 0; k < i; k++)
        if (file_of(items->items[k]) == length &&
            memcmp(items->items[k], items->items[i], length) == 0) {
            loaded[i] = loaded[k];
            return BB_OK;
        }
    snprintf(path, sizeof path, "%.*s", (int)length, items->items[i]);
    return load_tracer(path, &loaded[i]);
}

bb_status bb_load_tracers(bb_names *tracers)
{
    const bb_tracer *loaded[BB_NAMES_MAX] = {NULL};
    bb_names all = {.count = 0};
    bb_status status = BB_OK;
    for (size_t i = 0; i < tracers->count && status == BB_OK; i++) {
        const char *item = tracers->items[i], *rest = item + file_of(item);
        char named[1024] = "";
        if (rest > item)
            status = tracer_of_file(tracers, i, loaded);
        if (status != BB_OK)
            break;
        if (rest > item)
            snprintf(named, sizeof named, "%s", loaded[i]->name);
        strncat(named, rest, sizeof named - strlen(named) - 1);
        status = rest > item && *rest == '\0' ? bb_names_add(&all, bb_tracer_compared(loaded[i]))
                                              : bb_names_add_item(&all, named);
    }
    bb_names_free(tracers);
    *tracers = all;
    return status;
}

static const char here[] = "in the library's code";

void bb_identity_add_choice(bb_identity *identity, const bb_cli *cli,
                            const bb_device_choice *choice)
{
    static const char *const words[] = {"device", "form", "handover", "kernels-from"};
    Dl_info info;
    if (dladdr(here, &info) != 0)
        bb_identity_add_file(identity, info.dli_fname);
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++)
        bb_identity_add_text(identity, bb_cli_find(cli, words[i])->given[0]);
    for (const char *path = getenv("BVHBENCH_PLUGINS"); path != NULL && *path != '\0';) {
        char one[4096];
        size_t length = strcspn(path, ":");
        snprintf(one, sizeof one, "%.*s", (int)length, path);
        bb_identity_add_file(identity, one);
        path += length + (path[length] == ':');
    }
    if (choice->kernels_from != NULL)
        bb_identity_add_folder(identity, choice->kernels_from);
    for (size_t i = 0; i < choice->plugins.count; i++)
        bb_identity_add_file(identity, choice->plugins.items[i]);
}

bb_status bb_choose_view(const bb_scene *scene, const char *name, const bb_view **view)
{
    char known[512] = "";
    for (uint32_t i = 0; i < scene->view_count; i++) {
        *view = &scene->views[i];
        if (name == NULL || strcmp(scene->views[i].name, name) == 0)
            return BB_OK;
        snprintf(known + strlen(known), sizeof known - strlen(known), "%s%s", i > 0 ? ", " : "",
                 scene->views[i].name);
    }
    return bb_fail(BB_INVALID, "%s has no view '%s': it has %s", scene->name, name, known);
}

static const char advice[] =
    "gnuplot is not installed: apt-get install gnuplot-nox, or --charts no";

bb_status bb_charts_decide(uint32_t *charts)
{
    if (*charts == BB_CHARTS_AUTO && bb_report_can_draw())
        *charts = BB_CHARTS_YES;
    if (*charts == BB_CHARTS_YES && !bb_report_can_draw())
        return bb_fail(BB_INVALID, "--charts yes: %s", advice);
    return BB_OK;
}

void bb_charts_note(uint32_t charts)
{
    if (charts == BB_CHARTS_AUTO)
        fprintf(stderr, "bvhbench: charts were not written as SVG and PNG: %s\n", advice);
}
