#include "framework/builder/instance.h"

#include "framework/base/clock.h"

#include <stdio.h>
#include <string.h>

enum { GROUP_SIZE = 64 };

bb_status bb_instance_check(const char *text)
{
    bb_pipeline pipeline;
    return bb_pipeline_parse(text, &pipeline);
}

static bb_status check_kinds(const bb_pipeline *pipeline, const bb_scene *scene)
{
    for (uint32_t i = 0; i < pipeline->count; i++)
        if ((scene->kinds & ~pipeline->stages[i].builder->kinds) != 0)
            return bb_fail(BB_UNSUPPORTED, "builder %s does not take the primitives of scene %s",
                           pipeline->stages[i].builder->name, scene->name);
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
    /* what one stage needs of another is the pipeline's, not the harness's */
    stage->own.copy_account = &instance->account;
    return stage->builder->create(&stage->context, &stage->self);
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
    if (status == BB_OK)
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

void bb_instance_destroy(bb_instance *instance)
{
    for (uint32_t i = 0; i < instance->pipeline.count; i++) {
        bb_stage *stage = &instance->stages[i];
        if (stage->self != NULL)
            stage->builder->destroy(stage->self);
        bb_tree_release(&stage->own);
    }
    bb_references_release(&instance->references);
    bb_tree_release(&instance->tree);
    bb_kernel_release(instance->map);
    bb_program_release(instance->program);
    memset(instance, 0, sizeof *instance);
}

/* ---- what stages declare ---- */

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

static bool is_fed_with_references(const bb_instance *instance, uint32_t i)
{
    return i == 1 && bb_is_splitter(instance->stages[0].builder);
}

static bool may_see_views(const bb_stage *stage)
{
    return bb_spec_value(stage->context.spec, NULL, "view") != NULL;
}

/* The scene with all taken out that the builder did not declare. */
static bb_scene declared_part(const bb_stage *stage, const bb_scene *scene)
{
    uint32_t inputs = stage->builder->inputs;
    bool on_host = stage->builder->place == BB_ON_HOST;
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
    if (may_see_views(stage)) {
        part.view_count = scene->view_count;
        memcpy(part.views, scene->views, sizeof part.views);
    }
    return part;
}

/* The same with references in the primitives' place. */
static bb_scene stage_part(const bb_instance *instance, uint32_t i, const bb_scene *scene)
{
    const bb_references *references = &instance->references;
    const bb_stage *stage = &instance->stages[i];
    bb_scene part = declared_part(stage, scene);
    if (!is_fed_with_references(instance, i))
        return part;
    part.prim_count = references->count;
    if ((stage->builder->inputs & BB_INPUT_BOXES) != 0) {
        part.boxes = stage->builder->place == BB_ON_HOST ? references->boxes : NULL;
        part.on_device.boxes = references->d_boxes;
    }
    return part;
}

/* ---- building ---- */

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

/* Reads the input once. Else its first reader after somebody else's build, or after its own
 * restore(), would find it cold, or warm, by accident. A device with memory of its own keeps that
 * to itself. */
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
static bb_status get_ready(bb_instance *instance, bb_stage *stage, const bb_scene *scene,
                           const bb_scene *part, double *restore_ms)
{
    const bb_builder *builder = stage->builder;
    bool prepared = stage->prepared == scene && stage->prepared_count == part->prim_count;
    if (!prepared && builder->prepare != NULL) {
        double start = bb_wall_ms();
        BB_TRY(builder->prepare(stage->self, part, bb_is_splitter(builder) ? NULL : stage->tree));
        BB_TRY(bb_finish(instance->device));
        stage->prepare_ms = bb_wall_ms() - start;
    }
    stage->prepared = scene;
    stage->prepared_count = part->prim_count;
    *restore_ms = 0;
    if (builder->restore != NULL) {
        double start = bb_wall_ms();
        BB_TRY(builder->restore(stage->self, part));
        BB_TRY(bb_finish(instance->device));
        *restore_ms = bb_wall_ms() - start;
    }
    return warm_up(part);
}

/* Brings what stage `i` takes of the one before to where it wants it; `ms` gets the time of the
 * copy that its inputs ask for. A builder on the host may read boxes on the device too, as of a
 * scene: that copy is the harness's, and not timed. */
static bb_status hand_over(bb_instance *instance, uint32_t i, double *ms)
{
    bb_device *device = instance->device;
    bb_stage *stage = &instance->stages[i];
    bool on_host = stage->builder->place == BB_ON_HOST;
    *ms = 0;
    if (i == 0)
        return BB_OK;
    if (is_fed_with_references(instance, i)) {
        if (on_host)
            BB_TRY(bb_references_download(&instance->references, ms));
        return bb_references_upload(&instance->references, device, on_host ? NULL : ms);
    }
    bb_tree *input = instance->stages[i - 1].tree;
    return on_host ? bb_tree_download(input, ms) : bb_tree_upload(input, device, ms);
}

static bb_status run_hook(bb_instance *instance, uint32_t i, const bb_scene *part,
                          bb_phases *phases)
{
    bb_stage *stage = &instance->stages[i];
    const bb_builder *builder = stage->builder;
    const bb_tree *input = bb_is_optimiser(builder) ? instance->stages[i - 1].tree : NULL;
    if (bb_is_splitter(builder))
        BB_TRY(builder->split(stage->self, part, &instance->references, phases));
    else
        BB_TRY(builder->build(stage->self, part, input, stage->tree, phases));
    return bb_phase(phases, NULL);
}

/* What a splitter claims is copied by these counts. */
static bb_status check_references(const bb_instance *instance, const bb_scene *scene)
{
    const bb_references *references = &instance->references;
    size_t room = references->place == BB_ON_HOST ? references->capacity
                                                  : references->d_prims.bytes / sizeof(uint32_t);
    if (references->count >= scene->prim_count && references->count <= room)
        return BB_OK;
    return bb_fail(BB_FAILED, "%s gives %u references of %u primitives, with room for %zu",
                   instance->stages[0].builder->name, references->count, scene->prim_count, room);
}

static bb_status run_stage(bb_instance *instance, uint32_t i, const bb_scene *scene, bool exact)
{
    bb_stage *stage = &instance->stages[i];
    const bb_builder *builder = stage->builder;
    bb_build_step *step = &instance->steps[instance->step_count++];
    bb_scene part = stage_part(instance, i, scene);
    *step = (bb_build_step){.label = instance->pipeline.stages[i].label};
    BB_TRY(get_ready(instance, stage, scene, &part, &step->timing.restore_ms));
    if (is_fed_with_references(instance, i)) /* else what map_refs() found the last time */
        stage->tree->duplicated = false;
    step->phases = (bb_phases){.device = builder->place == BB_ON_DEVICE ? instance->device : NULL,
                               .exact = exact,
                               .current = -1};
    bb_stopwatch watch;
    BB_TRY(bb_stopwatch_start(instance->device, &watch));
    bb_status status = run_hook(instance, i, &part, &step->phases);
    bb_status stopped = bb_stopwatch_stop(&watch, &step->timing.timing);
    BB_TRY(status);
    BB_TRY(stopped);
    step->timing.outside_ms = step->phases.outside_ms;
    step->timing.timing.ms -= step->phases.outside_ms;
    if (bb_is_splitter(builder)) {
        instance->references.copied = false;
        return check_references(instance, scene);
    }
    bb_tree_changed(stage->tree);
    return bb_tree_fetch_info(stage->tree);
}

/* Puts primitives in the place of references, where the tree is. */
static bb_status map_on_host(bb_tree *tree, const bb_references *references)
{
    if (tree->info.ref_count > tree->ref_capacity)
        return bb_fail(BB_FAILED, "the tree claims %u references, it has room for %zu",
                       tree->info.ref_count, tree->ref_capacity);
    for (uint32_t i = 0; i < tree->info.ref_count; i++) {
        uint32_t ref = tree->refs[i];
        if ((ref & BB_INDEX_MASK) >= references->count)
            return bb_fail(BB_FAILED, "the tree names reference %u, there are %u",
                           ref & BB_INDEX_MASK, references->count);
        tree->refs[i] = references->prims[ref & BB_INDEX_MASK] | (ref & BB_LAST_BIT);
    }
    return BB_OK;
}

static bb_status map_refs(bb_instance *instance, const bb_scene *scene)
{
    bb_tree *tree = instance->stages[1].tree;
    const bb_references *references = &instance->references;
    bb_build_step *step = &instance->steps[instance->step_count++];
    bool on_host = tree->place == BB_ON_HOST;
    *step = (bb_build_step){.label = "map"};
    step->phases.used_device = !on_host;
    bb_stopwatch watch;
    BB_TRY(bb_stopwatch_start(instance->device, &watch));
    bb_status status =
        on_host ? map_on_host(tree, references)
                : bb_launch(instance->device, instance->map, tree->info.ref_count, GROUP_SIZE,
                            BB_MEM(tree->d_refs), BB_VALUE(tree->info.ref_count),
                            BB_VALUE(references->count), BB_MEM(references->d_prims));
    bb_status stopped = bb_stopwatch_stop(&watch, &step->timing.timing);
    BB_TRY(status);
    BB_TRY(stopped);
    tree->duplicated = tree->duplicated || references->count > scene->prim_count;
    bb_tree_changed(tree);
    return BB_OK;
}

static void add_timing(bb_build_timing *sum, const bb_build_timing *more)
{
    sum->timing.ms += more->timing.ms;
    sum->timing.cpu_ms += more->timing.cpu_ms;
    sum->timing.event_ms += more->timing.event_ms;
    sum->restore_ms += more->restore_ms;
    sum->outside_ms += more->outside_ms;
}

bb_status bb_instance_build(bb_instance *instance, const bb_scene *scene, bool exact_phases,
                            bb_build_timing *timing)
{
    instance->step_count = 0;
    for (uint32_t i = 0; i < instance->pipeline.count; i++) {
        double unused;
        BB_TRY(hand_over(instance, i, &unused));
        BB_TRY(run_stage(instance, i, scene, exact_phases));
        if (is_fed_with_references(instance, i))
            BB_TRY(map_refs(instance, scene));
    }
    if (timing == NULL)
        return BB_OK;
    *timing = (bb_build_timing){0};
    for (uint32_t i = 0; i < instance->step_count; i++)
        add_timing(timing, &instance->steps[i].timing);
    return BB_OK;
}

/* ---- afterwards ---- */

/* What the stages on the host declare of the scene: once each, whoever reads it. */
static uint32_t inputs_on_host(const bb_instance *instance)
{
    uint32_t inputs = 0;
    for (uint32_t i = 0; i < instance->pipeline.count; i++)
        if (instance->stages[i].builder->place == BB_ON_HOST &&
            !is_fed_with_references(instance, i))
            inputs |= instance->stages[i].builder->inputs;
    return inputs;
}

/* Reads what is declared of the scene once, into memory that is thrown away. */
static bb_status read_inputs(uint32_t inputs, const bb_scene *scene, double *ms)
{
    const bb_scene_device *there = &scene->on_device;
    const struct {
        uint32_t input;
        const bb_buffer *buffer;
    } parts[] = {{BB_INPUT_BOXES, &there->boxes},
                 {BB_INPUT_GEOMETRY, &there->vertices},
                 {BB_INPUT_GEOMETRY, &there->indices},
                 {BB_INPUT_GEOMETRY, &there->spheres}};
    size_t most = 0;
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++)
        if ((inputs & parts[i].input) != 0 && parts[i].buffer->bytes > most)
            most = parts[i].buffer->bytes;
    void *target = NULL;
    BB_TRY(bb_host_alloc(NULL, most, "the builder's input on the host", &target));
    bb_status status = BB_OK;
    double start = bb_wall_ms();
    for (size_t i = 0; i < sizeof parts / sizeof parts[0] && status == BB_OK; i++)
        if ((inputs & parts[i].input) != 0)
            status = bb_buffer_read(parts[i].buffer, 0, parts[i].buffer->bytes, target);
    *ms = bb_wall_ms() - start;
    bb_host_free(target);
    return status;
}

bb_status bb_instance_transfer(bb_instance *instance, const bb_scene *scene, double *ms)
{
    BB_TRY(read_inputs(inputs_on_host(instance), scene, ms));
    for (uint32_t i = 0; i <= instance->pipeline.count; i++) {
        bool last = i == instance->pipeline.count;
        double more = 0;
        if (is_fed_with_references(instance, i)) /* else it is there already */
            instance->references.copied = false;
        else if (i > 0)
            bb_tree_changed(instance->stages[i - 1].tree);
        BB_TRY(last ? bb_tree_upload(&instance->tree, instance->device, &more)
                    : hand_over(instance, i, &more));
        *ms += more;
    }
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
        bb_scene part = stage_part(instance, i, scene);
        BB_TRY(stage->builder->describe(stage->self, &part, words, sizeof words));
        bool alone = instance->pipeline.count == 1;
        if (words[0] != '\0' && used < capacity)
            used += (size_t)snprintf(text + used, capacity - used, "%s%s%s%s", used > 0 ? "; " : "",
                                     alone ? "" : instance->pipeline.stages[i].label,
                                     alone ? "" : ": ", words);
    }
    return BB_OK;
}
