/* Lists of names: their defaults, `all`, and names that are misspelt or given twice. */
#ifndef BB_NAMES_H
#define BB_NAMES_H

#include "framework/base/variants.h"
#include "framework/cli/cli.h"
#include "framework/simulate/simulate.h"

/* Appends one item, in which commas mean nothing. */
bb_status bb_names_add_item(bb_names *names, const char *item);
/* Appends the items of a list with commas. */
bb_status bb_names_add(bb_names *names, const char *list);
/* Appends the variants that builders have in a role (base/variants.h). */
bb_status bb_names_add_role(bb_names *names, const char *role);

/* Each of these functions completes a list from the command line: `all` is replaced by all names,
 * an empty list by the default. BB_INVALID: a name is given twice, perhaps in two spellings. */

/* --scene: `all` and the default are the names that `add_all` adds. */
bb_status bb_choose_scenes(bb_names *names, bb_status (*add_all)(bb_names *names));
bb_status bb_add_shipped_scenes(bb_names *names);

/* --builder: `all` is every builder by its name, a splitter or an optimiser beside a builder
 * (bb_pipeline_complete()). The default: the variants that builders declare for the comparison,
 * and, with `every`, the names of builders that stay out of it. */
bb_status bb_choose_builders(bb_names *names, bool every);

/* The builders, the tracers (NULL: none), and, unless it is among them, the tracer that is the
 * reference, which is in every result of `run`. */
bb_status bb_choose_entrants(bb_names *names, const bb_names *tracers);

/* Default rays and intersectors of `run`. */
#define BB_COMPARED_RAYS "primary,ao,diffuse,shadow,random"
#define BB_COMPARED_INTERSECTORS "exact"

/* The default: the kernels to compare on the device that `device` selects. */
bb_status bb_choose_kernels(bb_names *names, const char *device);
/* Adds the variants of kernels with this role on devices of this kind: BB_FOR_... */
bb_status bb_add_kernels(bb_names *names, const char *role, uint32_t kind);
/* An empty list stays empty. */
bb_status bb_choose_rays(bb_names *names);
bb_status bb_choose_intersectors(bb_names *names);
bb_status bb_choose_metrics(bb_names *names);
/* Reads metrics that can only be simulations. */
bb_status bb_choose_simulations(const bb_names *names, bb_simt simts[BB_SIMT_MAX], uint32_t *count);
bb_status bb_choose_axes(bb_names *names);

/* BB_INVALID if `text` is most likely a misspelt name of a scene, or the folder of the shipped
 * scenes is missing. bb_scene_load() finds all other errors. */
bb_status bb_check_scene(const char *text);

#endif
