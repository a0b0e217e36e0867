#include "framework/cli/names.h"

#include "framework/base/suggest.h"
#include "framework/builder/metric.h"
#include "framework/builder/pipeline.h"
#include "framework/builder/registry.h"
#include "framework/builder/tracers.h"
#include "framework/device/device_private.h"
#include "framework/record/cell.h"
#include "framework/scene/scene.h"
#include "framework/stress/axis.h"
#include "framework/workload/workload.h"
#include "traversal/traversal.h"

#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

bb_status bb_names_add(bb_names *names, const char *list)
{
    return bb_spec_list(list, names->items, BB_NAMES_MAX, &names->count);
}

bb_status bb_names_add_role(bb_names *names, const char *role)
{
    for (uint32_t i = 0; i < bb_builder_count(); i++) {
        const char *variants = bb_builder_variants(bb_builder_at(i), role);
        if (variants != NULL)
            BB_TRY(bb_names_add(names, variants));
    }
    return BB_OK;
}

bb_status bb_names_add_item(bb_names *names, const char *item)
{
    if (names->count == BB_NAMES_MAX)
        return bb_fail(BB_INVALID, "more than %d names, up to '%.80s'", BB_NAMES_MAX, item);
    names->items[names->count] = strdup(item);
    if (names->items[names->count] == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    names->count++;
    return BB_OK;
}

/* ---- what every list has ---- */

typedef bb_status adder(bb_names *names);

/* Room for a name: those that a cell has, and other names. */
typedef struct spelt {
    bb_cell_parts cell;
    char other[BB_CELL_TEXT];
} spelt;

typedef struct list {
    const char *option;
    adder *add_all;
    size_t place; /* offset of such a name in `spelt` */
} list;

/* Returns the spelling by which names are compared: that of a cell's key. */
static bb_status respell(const list *l, const char *item, char **spelling)
{
    spelt *all = calloc(1, sizeof *all);
    if (all == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    char *text = (char *)all + l->place;
    snprintf(text, BB_CELL_TEXT, "%s", item);
    bb_cell_canonical(&all->cell);
    *spelling = strdup(text);
    free(all);
    return *spelling != NULL ? BB_OK : bb_fail(BB_FAILED, "out of memory");
}

/* Refuses names that are the same: their keys in the results would be equal. */
static bb_status refuse_twins(const list *l, const bb_names *names)
{
    char *spellings[BB_NAMES_MAX] = {NULL};
    bb_status status = BB_OK;
    for (size_t i = 0; i < names->count && status == BB_OK; i++) {
        const char *item = names->items[i];
        status = respell(l, item, &spellings[i]);
        for (size_t k = 0; k < i && status == BB_OK; k++)
            if (strcmp(spellings[k], spellings[i]) == 0)
                status = strcmp(names->items[k], item) == 0
                             ? bb_fail(BB_INVALID, "--%s: '%s' is given twice", l->option, item)
                             : bb_fail(BB_INVALID, "--%s: '%s' and '%s' are the same: give one",
                                       l->option, names->items[k], item);
    }
    for (size_t i = 0; i < names->count; i++)
        free(spellings[i]);
    return status;
}

static bb_status expand(const list *l, const bb_names *given, bb_names *all)
{
    for (size_t i = 0; i < given->count; i++)
        BB_TRY(strcmp(given->items[i], "all") == 0 ? l->add_all(all)
                                                   : bb_names_add_item(all, given->items[i]));
    return refuse_twins(l, all);
}

static bb_status choose(const list *l, adder *add_default, bb_names *names)
{
    bb_names all = {.count = 0};
    if (names->count == 0)
        return add_default != NULL ? add_default(names) : BB_OK;
    bb_status status = expand(l, names, &all);
    bb_names_free(names);
    *names = all;
    return status;
}

/* ---- scenes ---- */

bb_status bb_add_shipped_scenes(bb_names *names)
{
    for (const char *const *name = bb_shipped_scenes; *name != NULL; name++)
        BB_TRY(bb_names_add_item(names, *name));
    return BB_OK;
}

/* Refuses a missing BVHBENCH_SCENES, in place of which the shipped scenes would be taken silently.
 */
static bb_status check_scene_folder(void)
{
    const char *folder = getenv("BVHBENCH_SCENES");
    struct stat info;
    if (folder == NULL || (stat(folder, &info) == 0 && S_ISDIR(info.st_mode)))
        return BB_OK;
    return bb_fail(BB_INVALID, "BVHBENCH_SCENES is '%s', which is no folder: correct or unset it",
                   folder);
}

bb_status bb_check_scene(const char *text)
{
    bb_spec spec;
    if (access(text, F_OK) == 0 || strcspn(text, "./") < strcspn(text, ":"))
        return BB_OK;
    BB_TRY(bb_spec_parse(text, &spec));
    bb_suggestion meant = {.word = spec.name};
    for (const char *const *name = bb_shipped_scenes; *name != NULL; name++) {
        if (strcmp(*name, spec.name) == 0)
            return check_scene_folder();
        bb_suggest(&meant, *name);
    }
    for (const bb_generator *const *g = bb_generators; *g != NULL; g++) {
        if (strcmp((*g)->name, spec.name) == 0)
            return BB_OK;
        bb_suggest(&meant, (*g)->name);
    }
    if (meant.nearest == NULL)
        return BB_OK;
    return bb_fail(BB_INVALID, "unknown scene '%s'%s: `bvhbench list scenes` shows them", spec.name,
                   bb_suggested(&meant));
}

bb_status bb_choose_scenes(bb_names *names, adder *add_all)
{
    const list scenes = {"scene", add_all, offsetof(spelt, cell.scene)};
    BB_TRY(choose(&scenes, add_all, names));
    for (size_t i = 0; i < names->count; i++)
        BB_TRY(bb_check_scene(names->items[i]));
    return BB_OK;
}

/* ---- builders ---- */

/* Adds a builder by its name, and a splitter or an optimiser beside a default builder. */
static bb_status add_builder(bb_names *names, const bb_builder *builder)
{
    char whole[sizeof((bb_pipeline *)NULL)->text];
    BB_TRY(bb_pipeline_complete(builder->name, whole, sizeof whole, NULL));
    return bb_names_add_item(names, whole);
}

static bb_status add_all_builders(bb_names *names)
{
    for (uint32_t i = 0; i < bb_builder_count(); i++)
        BB_TRY(add_builder(names, bb_builder_at(i)));
    return BB_OK;
}

static bb_status add_variants(bb_names *names, bool every)
{
    for (uint32_t i = 0; i < bb_builder_count(); i++) {
        const bb_builder *builder = bb_builder_at(i);
        const char *compared = bb_builder_variants(builder, BB_ROLE_COMPARED);
        if (bb_builder_is_compared(builder) || every)
            BB_TRY(compared != NULL ? bb_names_add(names, compared) : add_builder(names, builder));
    }
    return BB_OK;
}

static bb_status add_compared_variants(bb_names *names)
{
    return add_variants(names, false);
}

static bb_status add_every_variant(bb_names *names)
{
    return add_variants(names, true);
}

bb_status bb_choose_builders(bb_names *names, bool every)
{
    static const list builders = {"builder", add_all_builders, offsetof(spelt, cell.builder)};
    return choose(&builders, every ? add_every_variant : add_compared_variants, names);
}

bb_status bb_choose_entrants(bb_names *names, const bb_names *tracers)
{
    static const list entrants = {"tracer", add_all_builders, offsetof(spelt, cell.builder)};
    const bb_tracer *reference = bb_tracer_find(BB_REFERENCE_NAME);
    bool referenced = false;
    BB_TRY(bb_choose_builders(names, false));
    for (size_t i = 0; tracers != NULL && i < tracers->count; i++)
        BB_TRY(bb_names_add_item(names, tracers->items[i]));
    for (size_t i = 0; i < names->count; i++)
        referenced = referenced || bb_tracer_of(names->items[i]) == reference;
    if (!referenced)
        BB_TRY(bb_names_add(names, bb_tracer_compared(reference)));
    return refuse_twins(&entrants, names);
}

/* ---- what traces, and what is traced and measured ---- */

static bb_status add_all_kernels(bb_names *names)
{
    for (const bb_kernel *const *kernel = bb_kernels; *kernel != NULL; kernel++)
        BB_TRY(bb_names_add_item(names, (*kernel)->name));
    return BB_OK;
}

bb_status bb_add_kernels(bb_names *names, const char *role, uint32_t kind)
{
    for (const bb_kernel *const *k = bb_kernels; *k != NULL; k++)
        for (const bb_variants *v = (*k)->variants; (v = bb_variants_of(v, role, kind)) != NULL;
             v++)
            BB_TRY(bb_names_add(names, v->specs));
    return BB_OK;
}

bb_status bb_choose_kernels(bb_names *names, const char *device)
{
    static const list kernels = {"kernel", add_all_kernels, offsetof(spelt, cell.kernel)};
    return names->count > 0 ? choose(&kernels, NULL, names)
                            : bb_add_kernels(names, BB_ROLE_COMPARED, bb_device_find_kind(device));
}

static bb_status add_all_rays(bb_names *names)
{
    for (uint32_t i = 0; bb_workloads[i] != NULL; i++)
        BB_TRY(bb_names_add_item(names, bb_workloads[i]->name));
    return BB_OK;
}

bb_status bb_choose_rays(bb_names *names)
{
    static const list rays = {"rays", add_all_rays, offsetof(spelt, cell.rays)};
    return choose(&rays, NULL, names);
}

static bb_status add_all_intersectors(bb_names *names)
{
    for (const bb_intersector *i = bb_intersectors; i->name != NULL; i++)
        BB_TRY(bb_names_add_item(names, i->name));
    return BB_OK;
}

bb_status bb_choose_intersectors(bb_names *names)
{
    static const list intersectors = {"intersector", add_all_intersectors,
                                      offsetof(spelt, cell.intersector)};
    return choose(&intersectors, NULL, names);
}

static bb_status add_all_metrics(bb_names *names)
{
    for (uint32_t i = 0; i < bb_metric_count(); i++)
        if (bb_metrics[i]->on_request)
            BB_TRY(bb_names_add_item(names, bb_metrics[i]->name));
    return BB_OK;
}

bb_status bb_choose_metrics(bb_names *names)
{
    static const list metrics = {"metrics", add_all_metrics, offsetof(spelt, other)};
    return choose(&metrics, NULL, names);
}

bb_status bb_choose_simulations(const bb_names *names, bb_simt simts[BB_SIMT_MAX], uint32_t *count)
{
    for (size_t i = 0; i < names->count; i++)
        if (!bb_is_simt(names->items[i]))
            return bb_fail(BB_INVALID, "--metrics: there is no '%s' here, only " BB_SIMT,
                           names->items[i]);
    return bb_simts_parse(names->items, (uint32_t)names->count, simts, count);
}

static bb_status add_all_axes(bb_names *names)
{
    for (const bb_axis_source *s = bb_axis_sources; s->name != NULL; s++)
        BB_TRY(bb_names_add_item(names, s->name));
    return BB_OK;
}

bb_status bb_choose_axes(bb_names *names)
{
    static const list axes = {"axis", add_all_axes, offsetof(spelt, other)};
    return choose(&axes, NULL, names);
}
