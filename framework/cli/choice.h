/* What the commands share: lists of names with their defaults and `all`, the device that was asked
 * for, plug-ins, views, output folders. */
#ifndef BB_CHOICE_H
#define BB_CHOICE_H

#include "framework/cli/cli.h"
#include "framework/device/device.h"
#include "framework/scene/scene.h"

enum { BB_NAMES_MAX = 128 };

/* A list of specifications. A zeroed one is empty. */
typedef struct bb_names {
    char *items[BB_NAMES_MAX];
    size_t count;
} bb_names;

/* Appends the items of a list that may be given by commas. */
bb_status bb_names_add(bb_names *names, const char *list);
void bb_names_free(bb_names *names);

/* What was given for a list option, in order; else the items of `fallback`. */
bb_status bb_choose(const bb_cli *cli, const char *option, const char *fallback, bb_names *names);

/* --builder: `all` stands for every builder by its name, a splitter or an optimiser beside a
 * builder (bb_pipeline_complete()). If none is given: what each builder names for the comparison,
 * and, with `every`, the name of those that stay out of it. */
bb_status bb_choose_builders(const bb_cli *cli, bool every, bb_names *names);

/* --kernel: `all` stands for every kernel; if none is given: those for the comparison. */
bb_status bb_choose_kernels(const bb_cli *cli, bb_names *names);

/* By --device, --form and --kernels-from. */
bb_status bb_open_device(const bb_cli *cli, bb_device **device);
/* The same in a form of the caller's. */
bb_status bb_open_device_as(const bb_cli *cli, bb_form form, bb_device **device);

/* Those of BVHBENCH_PLUGINS in the environment, then all of --plugin. */
bb_status bb_load_plugins(const bb_cli *cli);

/* The scene's view of that name, its first for NULL. */
bb_status bb_choose_view(const bb_scene *scene, const char *name, const bb_view **view);

/* Makes an output folder unless it is there, and makes sure now that it can be written, not after
 * the work. */
bb_status bb_make_folder(const char *path);

#endif
