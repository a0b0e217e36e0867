/* What the commands share: the device that was asked for, plug-ins, scenes, views, output folders.
 */
#ifndef BB_CHOICE_H
#define BB_CHOICE_H

#include "framework/cli/cli.h"
#include "framework/cli/names.h"
#include "framework/device/device.h"
#include "framework/scene/scene.h"

/* --form: what it is, and the option as all commands have it that open a device in one form. */
#define BB_FORM_HELP "which variant of device code to use where there are two"
#define BB_FORM_OPTION                                                                             \
    {                                                                                              \
        "form", "F", BB_FORM_HELP ": auto, cpu or gpu; default: auto", BB_CLI_ONCE                 \
    }

#define BB_DEVICE_OPTION                                                                           \
    {                                                                                              \
        "device", "D",                                                                             \
            "index of an OpenCL device, or part of its name; default: the first of "               \
            "`list devices`",                                                                      \
            BB_CLI_ONCE                                                                            \
    }

/* By --device, --form and --kernels-from. Progress then begins with the device's name. */
bb_status bb_open_device(const bb_cli *cli, bb_device **device);
/* The same in a form of the caller's. */
bb_status bb_open_device_as(const bb_cli *cli, bb_form form, bb_device **device);

/* Those of BVHBENCH_PLUGINS in the environment, then all of --plugin. */
bb_status bb_load_plugins(const bb_cli *cli);

/* The scene's view of that name, its first for NULL. */
bb_status bb_choose_view(const bb_scene *scene, const char *name, const bb_view **view);

#endif
