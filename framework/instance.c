#include "framework/instance.h"

#include "framework/clock.h"

#include <stdio.h>
#include <string.h>

static bb_status find_builder(const char *text, bb_spec *spec, const bb_builder **builder)
{
    BB_TRY(bb_spec_parse(text, spec));
    *builder = bb_builder_find(spec->name);
    if (*builder == NULL)
        return bb_fail(BB_INVALID, "unknown builder '%s': `bvhbench list builders` shows them",
                       spec->name);
    char what[96];
    snprintf(what, sizeof what, "builder %s", (*builder)->name);
    return bb_spec_validate(spec, (*builder)->options, what);
}

bb_status bb_instance_describe(bb_instance *instance, const bb_scene *scene, char *text,
                               size_t capacity)
{
    text[0] = '\0';
    if (instance->builder->describe == NULL)
        return BB_OK;
    return instance->builder->describe(instance->self, scene, text, capacity);
}

bb_status bb_instance_check(const char *text)
{
    bb_spec spec;
    const bb_builder *builder;
    return find_builder(text, &spec, &builder);
}

bb_status bb_instance_create(bb_device *device, const char *text, const bb_scene *scene,
                             uint64_t seed, bb_instance *instance)
{
    memset(instance, 0, sizeof *instance);
    BB_TRY(find_builder(text, &instance->spec, &instance->builder));
    const bb_builder *builder = instance->builder;
    if ((scene->kinds & ~builder->kinds) != 0)
        return bb_fail(BB_UNSUPPORTED, "builder %s does not take the primitives of scene %s",
                       builder->name, scene->name);
    if ((builder->inputs & BB_INPUT_TREE) != 0)
        return bb_fail(BB_UNSUPPORTED, "builder %s takes another builder's tree", builder->name);
    instance->context = (bb_builder_context){
        .device = device,
        .account = &instance->account,
        .spec = &instance->spec,
        .options = builder->options,
        .seed = seed,
        .threads = device->compute_units,
    };
    bb_tree_init(&instance->tree, &instance->account);
    bb_status status = builder->create(&instance->context, &instance->self);
    if (status != BB_OK)
        bb_instance_destroy(instance);
    return status;
}

void bb_instance_destroy(bb_instance *instance)
{
    if (instance->builder == NULL)
        return;
    if (instance->self != NULL)
        instance->builder->destroy(instance->self);
    bb_tree_release(&instance->tree);
    memset(instance, 0, sizeof *instance);
}

bb_status bb_instance_build(bb_instance *instance, const bb_scene *scene, bool exact_phases,
                            bb_phases *phases, double *ms)
{
    const bb_builder *builder = instance->builder;
    bb_device *device = instance->context.device;
    if (!instance->prepared && builder->prepare != NULL)
        BB_TRY(builder->prepare(instance->self, scene, &instance->tree));
    instance->prepared = true;
    if (builder->restore != NULL)
        BB_TRY(builder->restore(instance->self, scene));

    bb_phases local;
    if (phases == NULL)
        phases = &local;
    *phases = (bb_phases){.device = builder->place == BB_ON_DEVICE ? device : NULL,
                          .exact = exact_phases,
                          .current = -1};
    BB_TRY(bb_finish(device));
    double start = bb_wall_ms();
    BB_TRY(builder->build(instance->self, scene, NULL, &instance->tree, phases));
    BB_TRY(bb_phase(phases, NULL));
    BB_TRY(bb_finish(device));
    *ms = bb_wall_ms() - start - phases->outside_ms;
    bb_tree_changed(&instance->tree);
    if (builder->place == BB_ON_DEVICE)
        BB_TRY(bb_tree_fetch_info(&instance->tree));
    return BB_OK;
}
