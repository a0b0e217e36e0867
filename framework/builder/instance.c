/* The life of an instance, and the part of the scene that each stage sees. */
#include "framework/builder/instance_private.h"

#include "framework/builder/guard.h"
#include "framework/device/device_private.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

bb_status bb_instance_check(const char *text)
{
    bb_pipeline pipeline;
    return bb_pipeline_parse(text, &pipeline);
}

static bb_status check_kinds(const bb_pipeline *pipeline, const bb_scene *scene)
{
    for (uint32_t i = 0; i < pipeline->count; i++) {
        const bb_builder *builder = pipeline->stages[i].builder;
        if ((scene->kinds & ~builder->kinds) != 0)
            return bb_fail(BB_UNSUPPORTED, "builder %s does not take the primitives of scene %s",
                           builder->name, scene->name);
        if ((builder->inputs & BB_INPUT_VOLUME) != 0 && scene->volume == NULL)
            return bb_fail(BB_UNSUPPORTED, "builder %s is for volumes, and scene %s is none",
                           builder->name, scene->name);
    }
    return BB_OK;
}

static bb_status create_stage(bb_instance *instance, uint32_t i, uint64_t seed)
{
    bb_stage *stage = &instance->stages[i];
    const bb_pipeline_stage *parsed = &instance->pipeline.stages[i];
    stage->builder = parsed->builder;
    stage->context = (bb_builder_context){
        .device = instance->device,
        .account = &instance->account,
        .spec = &parsed->spec,
        .options = parsed->builder->options,
        .seed = seed,
        .threads = bb_host_threads(instance->device),
    };
    stage->tree = i + 1 < instance->pipeline.count ? &stage->own : &instance->tree;
    bb_tree_init(&stage->own, &instance->account);
    /* copies between stages are booked on the pipeline, not on the harness */
    stage->own.copy_account = &instance->account;
    const uint64_t before = instance->account.bytes;
    bb_hook hook;
    bb_stage_begin(instance, i, "create", NULL, &hook);
    const bb_status status =
        bb_hook_end(&hook, stage->builder->create(&stage->context, &stage->self));
    stage->bytes = instance->account.bytes - before;
    return status;
}

static bb_status create_map(bb_instance *instance)
{
    BB_TRY(bb_program_build(instance->device, bb_source_find("references.cl"), "",
                            &instance->program));
    return bb_kernel_get(instance->program, "map_references", &instance->map);
}

bb_status bb_instance_create(bb_device *device, const char *text, const bb_scene *scene,
                             uint64_t seed, bb_instance *instance)
{
    memset(instance, 0, sizeof *instance);
    bb_status status = bb_pipeline_parse(text, &instance->pipeline);
    snprintf(instance->scene, sizeof instance->scene, "%s", scene != NULL ? scene->name : "");
    const char *death = bb_guard_death((bb_guarded){instance->scene, instance->pipeline.text});
    if (status == BB_OK && death != NULL)
        status = bb_fail(BB_FAILED, "%s", death);
    if (status == BB_OK && scene != NULL)
        status = check_kinds(&instance->pipeline, scene);
    if (status != BB_OK) {
        memset(instance, 0, sizeof *instance);
        return status;
    }
    instance->device = device;
    bb_tree_init(&instance->tree, &instance->account);
    bb_references_init(&instance->references, &instance->account);
    for (uint32_t i = 0; i < instance->pipeline.count && status == BB_OK; i++)
        status = create_stage(instance, i, seed);
    if (status == BB_OK && bb_is_splitter(instance->stages[0].builder))
        status = create_map(instance);
    if (status != BB_OK)
        bb_instance_destroy(instance);
    return status;
}

bb_status bb_instance_try(bb_device *device, const char *text, uint64_t seed)
{
    bb_instance instance;
    bb_status status = bb_instance_create(device, text, NULL, seed, &instance);
    bb_instance_destroy(&instance);
    return status == BB_INVALID ? BB_INVALID : BB_OK;
}

void bb_instance_destroy(bb_instance *instance)
{
    for (uint32_t i = 0; i < instance->pipeline.count; i++) {
        bb_stage *stage = &instance->stages[i];
        bb_hook hook;
        bb_stage_begin(instance, i, "destroy", NULL, &hook);
        if (stage->self != NULL)
            stage->builder->destroy(stage->self);
        bb_hook_put_back(&hook); /* no row is left to fail */
        bb_tree_release(&stage->own);
    }
    bb_references_release(&instance->references);
    bb_tree_release(&instance->tree);
    bb_kernel_release(instance->map);
    bb_program_release(instance->program);
    memset(instance, 0, sizeof *instance);
}

/* ---- declarations of the stages ---- */

uint32_t bb_instance_inputs(const bb_instance *instance)
{
    uint32_t inputs = 0;
    for (uint32_t i = 0; i < instance->pipeline.count; i++)
        inputs |= instance->stages[i].builder->inputs;
    return inputs & ~(uint32_t)BB_INPUT_TREE;
}

double bb_instance_prepare_ms(const bb_instance *instance)
{
    double ms = 0;
    for (uint32_t i = 0; i < instance->pipeline.count; i++)
        ms += instance->stages[i].prepare_ms;
    return ms;
}

bool bb_instance_is_deterministic(const bb_instance *instance)
{
    bool deterministic = true;
    for (uint32_t i = 0; i < instance->pipeline.count; i++)
        deterministic = deterministic && instance->stages[i].builder->deterministic;
    return deterministic;
}

bool bb_stage_is_fed_with_references(const bb_instance *instance, uint32_t i)
{
    return i == 1 && bb_is_splitter(instance->stages[0].builder);
}

static bool may_see_views(const bb_stage *stage)
{
    return bb_spec_value(stage->context.spec, NULL, "view") != NULL;
}

/* The scene without the inputs that the builder did not declare. */
static bb_scene declared_part(const bb_stage *stage, const bb_scene *scene)
{
    uint32_t inputs = stage->builder->inputs;
    bool on_host = stage->builder->place == BB_ON_HOST;
    bb_scene part = {.kinds = scene->kinds,
                     .prim_count = scene->prim_count,
                     .vertex_count = scene->vertex_count,
                     .on_device.device = scene->on_device.device};
    memcpy(part.prims, scene->prims, sizeof part.prims);
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++)
        if ((inputs & BB_INPUT_GEOMETRY) == 0 || !on_host)
            part.prims[kind].data = NULL;
    memcpy(part.name, scene->name, sizeof part.name);
    memcpy(part.source, scene->source, sizeof part.source);
    if ((inputs & BB_INPUT_BOXES) != 0) {
        part.boxes = on_host ? scene->boxes : NULL;
        part.on_device.boxes = scene->on_device.boxes;
    }
    if ((inputs & BB_INPUT_GEOMETRY) != 0) {
        part.vertices = on_host ? scene->vertices : NULL;
        part.on_device.vertices = scene->on_device.vertices;
        part.on_device.prims = scene->on_device.prims;
    }
    if ((inputs & BB_INPUT_VOLUME) != 0) {
        part.volume = scene->volume;
        part.on_device.bricks = scene->on_device.bricks;
        part.on_device.ranges = scene->on_device.ranges;
        part.on_device.seen = scene->on_device.seen;
    }
    if ((inputs & BB_INPUT_TETS) != 0) {
        part.tets = scene->tets;
        part.on_device.tet_flags = scene->on_device.tet_flags;
    }
    if ((inputs & BB_INPUT_PROFILE) != 0) {
        part.bounds = scene->bounds;
        part.profile = scene->profile;
    }
    if ((inputs & BB_INPUT_OBJECTS) != 0) {
        part.object_count = scene->object_count;
        part.object_starts = scene->object_starts;
        part.mover_count = scene->mover_count;
        part.movers = scene->movers;
    }
    if (may_see_views(stage)) {
        part.view_count = scene->view_count;
        memcpy(part.views, scene->views, sizeof part.views);
    }
    return part;
}

bb_scene bb_stage_part(const bb_instance *instance, uint32_t i, const bb_scene *scene)
{
    const bb_references *references = &instance->references;
    const bb_stage *stage = &instance->stages[i];
    bb_scene part = declared_part(stage, scene);
    if (!bb_stage_is_fed_with_references(instance, i))
        return part;
    part.prim_count = references->count;
    part.object_count = part.mover_count = 0;
    part.object_starts = part.movers = NULL;
    if ((stage->builder->inputs & BB_INPUT_BOXES) != 0) {
        part.boxes = stage->builder->place == BB_ON_HOST ? references->boxes : NULL;
        part.on_device.boxes = references->d_boxes;
    }
    return part;
}

bb_status bb_instance_stage_sah(bb_instance *instance, uint32_t i, double *sah)
{
    bb_tree *tree = instance->stages[i].tree;
    *sah = NAN;
    if (bb_is_splitter(instance->stages[i].builder))
        return BB_OK;
    const bool there = tree->place == BB_ON_HOST || tree->copied;
    BB_TRY(bb_tree_download(tree, NULL));
    *sah = bb_tree_sah(tree);
    if (!there)
        bb_tree_drop_copy(tree);
    return BB_OK;
}

bb_status bb_instance_describe(bb_instance *instance, const bb_scene *scene, char *text,
                               size_t capacity)
{
    size_t used = 0;
    text[0] = '\0';
    for (uint32_t i = 0; i < instance->pipeline.count; i++) {
        bb_stage *stage = &instance->stages[i];
        char words[512] = "";
        if (stage->builder->describe == NULL)
            continue;
        bb_scene part = bb_stage_part(instance, i, scene);
        bb_hook hook;
        bb_stage_begin(instance, i, "describe", scene, &hook);
        BB_TRY(
            bb_hook_end(&hook, stage->builder->describe(stage->self, &part, words, sizeof words)));
        bool alone = instance->pipeline.count == 1;
        if (words[0] != '\0' && used < capacity)
            used += (size_t)snprintf(text + used, capacity - used, "%s%s%s%s", used > 0 ? "; " : "",
                                     alone ? "" : instance->pipeline.stages[i].label,
                                     alone ? "" : ": ", words);
    }
    return BB_OK;
}

bb_status bb_instance_decisions(bb_instance *instance, const bb_scene *scene,
                                bb_decisions *decisions)
{
    decisions->count = 0;
    for (uint32_t i = 0; i < instance->pipeline.count; i++) {
        bb_stage *stage = &instance->stages[i];
        if (stage->builder->decide == NULL)
            continue;
        bb_scene part = bb_stage_part(instance, i, scene);
        bb_hook hook;
        bb_stage_begin(instance, i, "decide", scene, &hook);
        stage->builder->decide(stage->self, &part, decisions);
        BB_TRY(bb_hook_end(&hook, BB_OK));
    }
    return BB_OK;
}
