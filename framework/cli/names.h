/* Lists of names on the command line: their defaults, `all`, and what is misspelt or given twice.
 */
#ifndef BB_NAMES_H
#define BB_NAMES_H

#include "framework/cli/cli.h"

enum { BB_NAMES_MAX = 128 };

/* A list of specifications. A zeroed one is empty. */
typedef struct bb_names {
    char *items[BB_NAMES_MAX];
    size_t count;
} bb_names;

/* Appends the items of a list that may be given by commas. */
bb_status bb_names_add(bb_names *names, const char *list);
/* Appends the variants that builders have in a role (base/variants.h). */
bb_status bb_names_add_role(bb_names *names, const char *role);
void bb_names_free(bb_names *names);

/* What was given for an option, in order, which may not be one thing in two spellings. `all` stands
 * for what there is; nothing given, for the default. */

/* --scene: `all` and the default are what `add_all` adds. */
bb_status bb_choose_scenes(const bb_cli *cli, bb_status (*add_all)(bb_names *names),
                           bb_names *names);
bb_status bb_add_shipped_scenes(bb_names *names);

/* --builder: `all` is every builder by its name, a splitter or an optimiser beside a builder
 * (bb_pipeline_complete()). The default: what each builder names for the comparison, and, with
 * `every`, the name of those that stay out of it. */
bb_status bb_choose_builders(const bb_cli *cli, bool every, bb_names *names);

/* Default: those to compare on the device. */
bb_status bb_choose_kernels(const bb_cli *cli, bb_names *names);
bb_status bb_choose_rays(const bb_cli *cli, bb_names *names);         /* default: five kinds */
bb_status bb_choose_intersectors(const bb_cli *cli, bb_names *names); /* default: exact */
bb_status bb_choose_metrics(const bb_cli *cli, bb_names *names);      /* default: none */

/* BB_INVALID if `text` is most likely a scene's name that is misspelt, or the scenes are looked for
 * where nothing is. All else bb_scene_load() finds out. */
bb_status bb_check_scene(const char *text);

#endif
