#include "framework/cli/choice.h"

#include "framework/base/progress.h"
#include "framework/builder/registry.h"
#include "framework/device/device_private.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static bb_status parse_handover(const bb_cli *cli, bb_handover *handover)
{
    const char *word = bb_cli_value(cli, "handover");
    *handover = BB_HANDOVER_AUTO;
    if (word != NULL && strcmp(word, "fence") == 0)
        *handover = BB_HANDOVER_FENCE;
    else if (word != NULL && strcmp(word, "levels") == 0)
        *handover = BB_HANDOVER_LEVELS;
    else if (word != NULL && strcmp(word, "auto") != 0)
        return bb_fail(BB_INVALID, "--handover is '%s', must be auto, fence or levels", word);
    return BB_OK;
}

/* A misspelt name would leave the embedded text in place, and what was to be tried untried. */
static bb_status check_folder(const char *path)
{
    uint32_t found = 0;
    bb_status status = BB_OK;
    DIR *folder = opendir(path);
    if (folder == NULL)
        return BB_OK; /* bb_device_open() says why */
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

static bb_status parse_form(const bb_cli *cli, bb_form *form)
{
    const char *word = bb_cli_value(cli, "form");
    *form = BB_FORM_AUTO;
    if (word != NULL && strcmp(word, "cpu") == 0)
        *form = BB_FORM_CPU;
    else if (word != NULL && strcmp(word, "gpu") == 0)
        *form = BB_FORM_GPU;
    else if (word != NULL && strcmp(word, "auto") != 0)
        return bb_fail(BB_INVALID, "--form is '%s', must be auto, cpu or gpu", word);
    return BB_OK;
}

bb_status bb_open_device(const bb_cli *cli, bb_device **device)
{
    bb_form form;
    BB_TRY(parse_form(cli, &form));
    return bb_open_device_as(cli, form, device);
}

bb_status bb_open_device_as(const bb_cli *cli, bb_form form, bb_device **device)
{
    bb_handover handover;
    const char *folder = bb_cli_value(cli, "kernels-from");
    BB_TRY(parse_handover(cli, &handover));
    if (folder != NULL)
        BB_TRY(check_folder(folder));
    BB_TRY(bb_device_open(bb_cli_value(cli, "device"), form, folder, device));
    if ((*device)->litmus_stale > 0)
        fprintf(stderr,
                "bvhbench: the fence of %s is unreliable: %u words of %u messages between "
                "work-groups came late; bottom-up passes use one launch per level instead\n",
                (*device)->name, (*device)->litmus_stale, (*device)->litmus_pairs);
    bb_progress_head("device: %s (%s, driver %s)", (*device)->name, (*device)->version,
                     (*device)->driver);
    bb_status status = bb_device_set_handover(*device, handover);
    if (status == BB_OK)
        return BB_OK;
    bb_device_close(*device);
    *device = NULL;
    return status;
}

/* Paths with ':' between them, as in PATH; empty ones are passed over. */
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

bb_status bb_load_plugins(const bb_cli *cli)
{
    uint32_t count;
    char *const *paths = bb_cli_values(cli, "plugin", &count);
    BB_TRY(load_from_environment());
    for (uint32_t i = 0; i < count; i++)
        BB_TRY(bb_plugin_load(paths[i]));
    return BB_OK;
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
