#include "framework/builder/instance.h"

#include "framework/base/clock.h"
#include "framework/builder/registry.h"
#include "framework/device/device_private.h"

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
        .threads = bb_host_threads(device),
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

/* ---- building ---- */

static bool may_see_views(const bb_instance *instance)
{
    return bb_spec_value(&instance->spec, NULL, "view") != NULL;
}

/* The scene with all taken out that the builder did not declare. */
static bb_scene declared_part(const bb_instance *instance, const bb_scene *scene)
{
    uint32_t inputs = instance->builder->inputs;
    bool on_host = instance->builder->place == BB_ON_HOST;
    bb_scene part = {.kinds = scene->kinds,
                     .prim_count = scene->prim_count,
                     .triangle_count = scene->triangle_count,
                     .sphere_count = scene->sphere_count,
                     .vertex_count = scene->vertex_count,
                     .on_device.device = scene->on_device.device};
    memcpy(part.name, scene->name, sizeof part.name);
    memcpy(part.source, scene->source, sizeof part.source);
    if ((inputs & BB_INPUT_BOXES) != 0) {
        part.boxes = on_host ? scene->boxes : NULL;
        part.on_device.boxes = scene->on_device.boxes;
    }
    if ((inputs & BB_INPUT_GEOMETRY) != 0) {
        part.vertices = on_host ? scene->vertices : NULL;
        part.indices = on_host ? scene->indices : NULL;
        part.spheres = on_host ? scene->spheres : NULL;
        part.on_device.vertices = scene->on_device.vertices;
        part.on_device.indices = scene->on_device.indices;
        part.on_device.spheres = scene->on_device.spheres;
    }
    if ((inputs & BB_INPUT_PROFILE) != 0) {
        part.bounds = scene->bounds;
        part.profile = scene->profile;
    }
    if (may_see_views(instance)) {
        part.view_count = scene->view_count;
        memcpy(part.views, scene->views, sizeof part.views);
    }
    return part;
}

static volatile uint64_t sink;

/* One word per cache line. */
static void read_memory(const void *memory, size_t bytes)
{
    const unsigned char *at = memory;
    uint64_t sum = 0;
    for (size_t i = 0; at != NULL && i < bytes; i += 64)
        sum += at[i];
    sink += sum;
}

static bb_status read_buffer(const bb_buffer *buffer)
{
    void *mapped;
    if (buffer->mem == NULL)
        return BB_OK;
    BB_TRY(bb_buffer_map(buffer, false, &mapped));
    read_memory(mapped, buffer->bytes);
    return bb_buffer_unmap(buffer, mapped);
}

/* Reads the input once. Else its first reader after somebody else's build, or after its own restore(),
 * would find it cold, or warm, by accident. A device with memory of its own keeps that to itself. */
static bb_status warm_up(const bb_scene *part)
{
    const bb_scene_device *there = &part->on_device;
    read_memory(part->boxes, part->prim_count * sizeof *part->boxes);
    read_memory(part->vertices, part->vertex_count * 3 * sizeof *part->vertices);
    read_memory(part->indices, part->triangle_count * 3 * sizeof *part->indices);
    read_memory(part->spheres, part->sphere_count * 4 * sizeof *part->spheres);
    if (there->device == NULL || !there->device->is_cpu)
        return BB_OK;
    BB_TRY(read_buffer(&there->boxes));
    BB_TRY(read_buffer(&there->vertices));
    BB_TRY(read_buffer(&there->indices));
    return read_buffer(&there->spheres);
}

/* Untimed, and recorded. */
static bb_status get_ready(bb_instance *instance, const bb_scene *scene, const bb_scene *part,
                           double *restore_ms)
{
    const bb_builder *builder = instance->builder;
    if (instance->prepared != scene && builder->prepare != NULL) {
        double start = bb_wall_ms();
        BB_TRY(builder->prepare(instance->self, part, &instance->tree));
        BB_TRY(bb_finish(instance->context.device));
        instance->prepare_ms = bb_wall_ms() - start;
    }
    instance->prepared = scene;
    *restore_ms = 0;
    if (builder->restore != NULL) {
        double start = bb_wall_ms();
        BB_TRY(builder->restore(instance->self, part));
        BB_TRY(bb_finish(instance->context.device));
        *restore_ms = bb_wall_ms() - start;
    }
    return warm_up(part);
}

bb_status bb_instance_build(bb_instance *instance, const bb_scene *scene, bool exact_phases,
                            bb_phases *phases, bb_build_timing *timing)
{
    const bb_builder *builder = instance->builder;
    bb_device *device = instance->context.device;
    bb_scene part = declared_part(instance, scene);
    bb_phases local;
    bb_build_timing unused;
    phases = phases != NULL ? phases : &local;
    timing = timing != NULL ? timing : &unused;
    BB_TRY(get_ready(instance, scene, &part, &timing->restore_ms));
    *phases = (bb_phases){.device = builder->place == BB_ON_DEVICE ? device : NULL,
                          .exact = exact_phases,
                          .current = -1};
    bb_stopwatch watch;
    BB_TRY(bb_stopwatch_start(device, &watch));
    bb_status status = builder->build(instance->self, &part, NULL, &instance->tree, phases);
    if (status == BB_OK)
        status = bb_phase(phases, NULL);
    bb_status stopped = bb_stopwatch_stop(&watch, &timing->timing);
    BB_TRY(status);
    BB_TRY(stopped);
    timing->outside_ms = phases->outside_ms;
    timing->timing.ms -= phases->outside_ms;
    bb_tree_changed(&instance->tree);
    if (builder->place == BB_ON_DEVICE)
        BB_TRY(bb_tree_fetch_info(&instance->tree));
    return BB_OK;
}

bb_status bb_instance_describe(bb_instance *instance, const bb_scene *scene, char *text,
                               size_t capacity)
{
    text[0] = '\0';
    if (instance->builder->describe == NULL)
        return BB_OK;
    bb_scene part = declared_part(instance, scene);
    return instance->builder->describe(instance->self, &part, text, capacity);
}
