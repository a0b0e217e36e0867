/* Builds of an instance, stage after stage, each with its own clock, and the data passed between
 * them. */
#include "framework/builder/instance_private.h"

#include "framework/base/clock.h"
#include "framework/scene/prim.h"

enum { GROUP_SIZE = 64 };

static volatile uint64_t sink;

/* Reads one word per cache line. */
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

/* Reads the input once. Otherwise it would depend on the build before, or on restore(), whether the
 * stage's first access finds it cold or warm. Only memory that the host shares can be warmed.
 * Between this and the build, nothing else may read or write much memory. */
static bb_status warm_up(const bb_scene *part)
{
    const bb_scene_device *there = &part->on_device;
    read_memory(part->boxes, part->prim_count * sizeof *part->boxes);
    read_memory(part->vertices, part->vertex_count * 3 * sizeof *part->vertices);
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++)
        read_memory(part->prims[kind].data, part->prims[kind].count * bb_prim_bytes(kind));
    if (there->device == NULL || !there->device->is_cpu)
        return BB_OK;
    BB_TRY(read_buffer(&there->boxes));
    BB_TRY(read_buffer(&there->vertices));
    BB_TRY(read_buffer(&there->prims));
    BB_TRY(read_buffer(&there->bricks));
    BB_TRY(read_buffer(&there->ranges));
    BB_TRY(read_buffer(&there->seen));
    return read_buffer(&there->tet_flags);
}

/* Calls prepare() or restore(); *ms gets its time, which is not part of the build's. */
static bb_status get_ready(bb_instance *instance, uint32_t i, const bb_scene *scene,
                           const bb_scene *part, bool prepare, double *ms)
{
    bb_stage *stage = &instance->stages[i];
    const bb_builder *builder = stage->builder;
    bb_hook hook;
    bb_stage_begin(instance, i, prepare ? "prepare" : "restore", scene, &hook);
    const double start = bb_wall_ms();
    bb_status status =
        prepare ? builder->prepare(stage->self, part, bb_is_splitter(builder) ? NULL : stage->tree)
                : builder->restore(stage->self, part);
    if (status == BB_OK)
        status = bb_finish(instance->device);
    *ms = bb_wall_ms() - start;
    return bb_hook_end(&hook, status);
}

static bb_status prepare_and_restore(bb_instance *instance, uint32_t i, const bb_scene *scene,
                                     const bb_scene *part, double *restore_ms)
{
    bb_stage *stage = &instance->stages[i];
    const bool prepared = stage->prepared == scene && stage->prepared_count == part->prim_count;
    if (!prepared && stage->builder->prepare != NULL)
        BB_TRY(get_ready(instance, i, scene, part, true, &stage->prepare_ms));
    stage->prepared = scene;
    stage->prepared_count = part->prim_count;
    *restore_ms = 0;
    if (stage->builder->restore != NULL)
        return get_ready(instance, i, scene, part, false, restore_ms);
    return BB_OK;
}

/* ---- each stage's share of the common account ---- */

typedef struct meter {
    uint64_t bytes, peak; /* values of the account at the start */
} meter;

static meter start_meter(bb_instance *instance)
{
    bb_account *account = &instance->account;
    const meter before = {account->bytes, account->peak};
    bb_account_mark(account);
    return before;
}

/* Books the change of the account since `before` on the stage; returns the most that the stage
 * held. */
static uint64_t stop_meter(bb_instance *instance, bb_stage *stage, const meter *before)
{
    bb_account *account = &instance->account;
    const uint64_t most = stage->bytes + (account->peak - before->bytes);
    stage->bytes += account->bytes - before->bytes; /* modulo 2^64: it may have shrunk */
    if (account->peak < before->peak)
        account->peak = before->peak;
    return most;
}

/* Copies the output of the stage before to where stage `i` needs it; `ms` gets the time of the copy
 * that its declared inputs require. A builder on the host may also read boxes on the device, as it
 * may for a scene: the harness makes that copy, untimed. */
static bb_status hand_over(bb_instance *instance, uint32_t i, double *ms)
{
    bb_device *device = instance->device;
    bb_stage *stage = &instance->stages[i];
    bool on_host = stage->builder->place == BB_ON_HOST;
    *ms = 0;
    if (i == 0)
        return BB_OK;
    if (bb_stage_is_fed_with_references(instance, i)) {
        if (on_host)
            BB_TRY(bb_references_download(&instance->references, ms));
        return bb_references_upload(&instance->references, device, on_host ? NULL : ms);
    }
    bb_tree *input = instance->stages[i - 1].tree;
    return on_host ? bb_tree_download(input, ms) : bb_tree_upload(input, device, ms);
}

/* `changed` is 0 in a build. */
static bb_status run_hook(bb_instance *instance, uint32_t i, const bb_scene *part, uint32_t changed,
                          bb_phases *phases)
{
    bb_stage *stage = &instance->stages[i];
    const bb_builder *builder = stage->builder;
    const bb_tree *input = bb_is_optimiser(builder) ? instance->stages[i - 1].tree : NULL;
    if (changed != 0)
        BB_TRY(builder->update(stage->self, part, changed, stage->tree, phases));
    else if (bb_is_splitter(builder))
        BB_TRY(builder->split(stage->self, part, &instance->references, phases));
    else
        BB_TRY(builder->build(stage->self, part, input, stage->tree, phases));
    return bb_phase(phases, NULL);
}

/* The splitter's counts must be in range, since copies rely on them. */
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

/* Whether stage `i` makes the tree that is traced; after a splitter that is made of its tree. */
static bool is_final(const bb_instance *instance, uint32_t i)
{
    return i + 1 == instance->pipeline.count && instance->stages[i].tree != NULL &&
           !bb_stage_is_fed_with_references(instance, i);
}

/* Checks the tree before threads that the hook may have left behind have time to finish it. */
static bb_status check_now(bb_instance *instance, const bb_scene *scene)
{
    bb_tree *tree = &instance->tree;
    tree->copied = false;
    BB_TRY(bb_tree_fetch_info(tree));
    BB_TRY(bb_tree_download(tree, NULL));
    return bb_tree_check(tree, scene);
}

static bb_status run_stage(bb_instance *instance, uint32_t i, const bb_scene *scene,
                           uint32_t changed, bool exact)
{
    bb_stage *stage = &instance->stages[i];
    const bb_builder *builder = stage->builder;
    bb_build_step *step = &instance->steps[instance->step_count++];
    bb_scene part = bb_stage_part(instance, i, scene);
    *step = (bb_build_step){.label = instance->pipeline.stages[i].label, .stage = i};
    const meter before = start_meter(instance);
    BB_TRY(prepare_and_restore(instance, i, scene, &part, &step->timing.restore_ms));
    if (bb_stage_is_fed_with_references(instance, i)) /* else keep the result of map_refs() */
        stage->tree->duplicated = false;
    step->phases = (bb_phases){.device = builder->place == BB_ON_DEVICE ? instance->device : NULL,
                               .exact = exact,
                               .current = -1};
    if (stage->tree != NULL && changed == 0)
        bb_tree_changed(stage->tree); /* first: derivations from the build's new links stay valid */
    if (stage->tree != NULL)
        stage->tree->refitted = false;
    bb_stopwatch watch;
    bb_hook hook;
    const char *name = changed != 0 ? "update" : bb_is_splitter(builder) ? "split" : "build";
    bb_stage_begin(instance, i, name, scene, &hook);
    bb_status status = warm_up(&part);
    if (status == BB_OK)
        status = bb_stopwatch_start(instance->device, &watch);
    if (status == BB_OK) {
        status = run_hook(instance, i, &part, changed, &step->phases);
        status = bb_stopwatch_stop(&watch, status, &step->timing.timing);
    }
    if (status == BB_OK && instance->check_at_once && is_final(instance, i))
        status = check_now(instance, scene);
    BB_TRY(bb_hook_end(&hook, status));
    step->timing.outside_ms = step->phases.outside_ms;
    step->timing.timing.ms -= step->phases.outside_ms;
    step->peak = stop_meter(instance, stage, &before);
    if (bb_is_splitter(builder)) {
        instance->references.copied = false;
        step->bytes = (uint64_t)instance->references.count * (sizeof(bb_box) + sizeof(uint32_t));
        return check_references(instance, scene);
    }
    stage->tree->copied = false;
    if (changed != 0 && !stage->tree->refitted)
        bb_tree_changed(stage->tree);
    BB_TRY(bb_tree_fetch_info(stage->tree));
    step->bytes = bb_tree_bytes(stage->tree);
    return BB_OK;
}

/* Replaces references by primitives, at the tree's place. */
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
    *step = (bb_build_step){.label = "map", .stage = BB_NONE};
    step->phases.used_device = !on_host;
    bb_stopwatch watch;
    BB_TRY(bb_stopwatch_start(instance->device, &watch));
    bb_status status =
        on_host ? map_on_host(tree, references)
                : bb_launch(instance->device, instance->map, tree->info.ref_count, GROUP_SIZE,
                            BB_MEM(tree->d_refs), BB_VALUE(tree->info.ref_count),
                            BB_VALUE(references->count), BB_MEM(references->d_prims));
    BB_TRY(bb_stopwatch_stop(&watch, status, &step->timing.timing));
    tree->duplicated = tree->duplicated || references->count > scene->prim_count;
    bb_tree_changed(tree);
    return BB_OK;
}

static void add_timing(bb_build_timing *sum, const bb_build_timing *more)
{
    sum->timing.ms += more->timing.ms;
    sum->timing.cpu_ms += more->timing.cpu_ms;
    sum->timing.event_ms += more->timing.event_ms;
    sum->timing.launches += more->timing.launches;
    sum->timing.waits += more->timing.waits;
    sum->restore_ms += more->restore_ms;
    sum->outside_ms += more->outside_ms;
}

static void set_built(bb_instance *instance, const bb_scene *scene)
{
    instance->built = scene;
    instance->built_hash = scene->hash;
}

static void sum_timings(const bb_instance *instance, bb_build_timing *timing)
{
    if (timing == NULL)
        return;
    *timing = (bb_build_timing){0};
    for (uint32_t i = 0; i < instance->step_count; i++)
        add_timing(timing, &instance->steps[i].timing);
}

bb_status bb_instance_build(bb_instance *instance, const bb_scene *scene, bool exact_phases,
                            bb_build_timing *timing)
{
    instance->step_count = 0;
    instance->built = NULL;
    for (uint32_t i = 0; i < instance->pipeline.count; i++) {
        double unused;
        const meter before = start_meter(instance);
        BB_TRY(hand_over(instance, i, &unused));
        (void)stop_meter(instance, &instance->stages[i], &before);
        BB_TRY(run_stage(instance, i, scene, 0, exact_phases));
        if (bb_stage_is_fed_with_references(instance, i))
            BB_TRY(map_refs(instance, scene));
    }
    set_built(instance, scene);
    sum_timings(instance, timing);
    return BB_OK;
}

/* ---- updates ---- */

const char *bb_update_word(bb_update_way way)
{
    static const char *const words[] = {"kept", "updated", "rebuilt"};
    return words[way];
}

/* Only the last stage, which owns the tree, can update it. After a splitter its references would
 * need an update first, and no hook does that. */
static bool can_update(const bb_instance *instance, const bb_scene *scene)
{
    const bb_stage *last = &instance->stages[instance->pipeline.count - 1];
    return !bb_is_splitter(instance->stages[0].builder) && last->builder->update != NULL &&
           instance->built == scene && last->prepared_count == scene->prim_count;
}

/* The time of an update that was given up after work had begun is added to that of the rebuild. */
static bb_status rebuild(bb_instance *instance, const bb_scene *scene, bool exact_phases,
                         const bb_build_step *given_up, bb_build_timing *timing)
{
    BB_TRY(bb_instance_build(instance, scene, exact_phases, NULL));
    if (given_up->phases.count > 0) {
        instance->steps[instance->step_count] = *given_up;
        instance->steps[instance->step_count++].label = "update given up";
    }
    sum_timings(instance, timing);
    return BB_OK;
}

bb_status bb_instance_update(bb_instance *instance, const bb_scene *scene, uint32_t changed,
                             bool exact_phases, bb_update_way *way, bb_build_timing *timing)
{
    if (instance->built == scene && instance->built_hash != scene->hash)
        changed |= BB_CHANGED_POSITIONS;
    if (instance->built == scene && changed == 0) {
        *way = BB_KEPT;
        instance->step_count = 0;
        sum_timings(instance, timing);
        return BB_OK;
    }
    bb_build_step given_up = {0};
    if (can_update(instance, scene)) {
        *way = BB_UPDATED;
        instance->step_count = 0;
        instance->built = NULL;
        bb_status status =
            run_stage(instance, instance->pipeline.count - 1, scene, changed, exact_phases);
        if (status == BB_OK) {
            set_built(instance, scene);
            sum_timings(instance, timing);
        }
        if (status != BB_UNSUPPORTED)
            return status;
        given_up = instance->steps[0];
    }
    *way = BB_REBUILT;
    return rebuild(instance, scene, exact_phases, &given_up, timing);
}

/* ---- transfers ---- */

/* The inputs that stages on the host declare, each once however many stages read it. */
static uint32_t inputs_on_host(const bb_instance *instance)
{
    uint32_t inputs = 0;
    for (uint32_t i = 0; i < instance->pipeline.count; i++)
        if (instance->stages[i].builder->place == BB_ON_HOST &&
            !bb_stage_is_fed_with_references(instance, i))
            inputs |= instance->stages[i].builder->inputs;
    return inputs;
}

/* Reads the declared inputs once, into memory that is then freed. */
static bb_status read_inputs(uint32_t inputs, const bb_scene *scene, double *ms)
{
    const bb_scene_device *there = &scene->on_device;
    const struct {
        uint32_t input;
        const bb_buffer *buffer;
    } parts[] = {{BB_INPUT_BOXES, &there->boxes},
                 {BB_INPUT_GEOMETRY, &there->vertices},
                 {BB_INPUT_GEOMETRY, &there->prims},
                 {BB_INPUT_TETS, &there->tet_flags}};
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
        if (bb_stage_is_fed_with_references(instance, i)) /* else it is there already */
            instance->references.copied = false;
        else if (i > 0)
            bb_tree_changed(instance->stages[i - 1].tree);
        BB_TRY(last ? bb_tree_upload(&instance->tree, instance->device, &more)
                    : hand_over(instance, i, &more));
        *ms += more;
    }
    return BB_OK;
}
