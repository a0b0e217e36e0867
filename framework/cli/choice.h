/* Options that several commands share: the device with its plug-ins, and charts. */
#ifndef BB_CHOICE_H
#define BB_CHOICE_H

#include "framework/base/identity.h"
#include "framework/cli/cli.h"
#include "framework/cli/names.h"
#include "framework/device/device.h"
#include "framework/scene/scene.h"
#include "framework/simulate/simulate.h"

#define BB_FORM_HELP "which variant of device code to use if there are two"

/* The values of --device, --form, --handover, --plugin and --kernels-from. */
typedef struct bb_device_choice {
    const char *name; /* index or part of the name; NULL: the first device */
    const char *kernels_from;
    uint32_t patience; /* seconds that a hook may take; 0: no limit */
    uint32_t form;     /* bb_form */
    uint32_t handover; /* bb_handover */
    bb_names plugins;
} bb_device_choice;

/* Groups of rows for a bb_device_choice; the second has --plugin alone. */
extern const bb_cli_option bb_device_options[], bb_plugin_options[];

/* Opens the device. The first line of progress is then the device's name. */
bb_status bb_open_device(const bb_device_choice *choice, bb_device **device);

/* Loads the plug-ins of BVHBENCH_PLUGINS in the environment, then all of --plugin. */
bb_status bb_load_plugins(const bb_names *plugins);

/* Loads the files that --tracer names, each once. FILE.so:key=value becomes the tracer's name with
 * these parameters, FILE.so alone the variants that the tracer declares for comparisons. */
bb_status bb_load_tracers(bb_names *tracers);

/* Adds the library's code, the plug-ins', device code of a folder, and the options that choose a
 * device. */
void bb_identity_add_choice(bb_identity *identity, const bb_cli *cli,
                            const bb_device_choice *choice);

/* Finds the scene's view of that name; NULL: its first view. */
bb_status bb_choose_view(const bb_scene *scene, const char *name, const bb_view **view);

/* --metrics of commands that have only simulations; `what` is simulated. */
#define BB_SIMULATIONS_OPTION(type, member, what)                                                  \
    {                                                                                              \
        "metrics", "M",                                                                            \
            "simulate a GPU on paper, such as " BB_SIMT ":device=h100,width=32: " what,            \
            BB_INTO(type, member)                                                                  \
    }

/* The value of --charts. */
enum { BB_CHARTS_AUTO, BB_CHARTS_YES, BB_CHARTS_NO };

#define BB_CHARTS_OPTION(type, member)                                                             \
    {                                                                                              \
        "charts", NULL, "write the charts as SVG and PNG too; auto: if gnuplot is installed",      \
            BB_INTO(type, member), .words = "auto|yes|no", .fallback = "auto"                      \
    }

/* Changes BB_CHARTS_AUTO to BB_CHARTS_YES if gnuplot is installed. BB_INVALID: charts are asked
 * for, but gnuplot is not installed. To be called before the work. */
bb_status bb_charts_decide(uint32_t *charts);
/* Says on standard error, after the work, that gnuplot was missing for charts; says nothing after
 * BB_CHARTS_YES and BB_CHARTS_NO. */
void bb_charts_note(uint32_t charts);

#endif
