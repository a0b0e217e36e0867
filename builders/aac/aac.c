/* AAC: approximate agglomerative clustering, on the device, over any code.
 *
 * Gu, He, Fatahalian, Blelloch 2013, "Efficient BVH Construction via Approximate Agglomerative
 * Clustering". The paper's text was not at hand: this was made from its abstract, later papers and
 * published code, and derived again. variant=hq and variant=fast set delta and epsilon as published
 * code does for AAC-HQ and AAC-Fast. aac.cl and aac_combine.clh list the steps. Where this
 * knowingly departs from the method:
 *
 * - No matrices of distances are kept: distances are recomputed from boxes in the first-level
 *   cache, so memory grows with f(n), not with its square; it is reserved before a build.
 * - Equal codes are distinguished by their index, so that the recursion is at most 32 levels deeper
 *   than the code is long.
 * - Recursion is by subtrees of a given size, then upwards by levels of the radix tree.
 * - Large triangles are not split first; `presplit+aac` does that.
 */
#include "aac_goal.h"
#include "aac_shared.h"
#include "builders/common/refit.h"
#include "builders/common/scene_unit.h"
#include "builders/common/sorted_codes.h"
#include "framework/base/arithmetic.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>

BB_DEVICE_SOURCE(aac);

enum {
    GROUP_SIZE = 64,
    LANES_GPU = 64,   /* work-items that combine one list */
    LARGE_GPU = 512,  /* a node with more primitives is built by several work-groups */
    LARGE_CPU = 1024, /* lower bound; the number of cores may raise it */
    TASKS_PER_CORE = 8,
    GROUPS_GPU = 2048, /* most work-groups at once over small nodes, each with its scratch */
    GROUPS_LARGE_GPU = 256,
    LEVELS_MAX = 96, /* longest common prefix: 64 bits of keys and 32 of indices */
};

static const bb_option options[] = {
    BB_CODE_OPTIONS("mc32"),
    {"variant", "hq", "hq|fast", "AAC-HQ (delta 20, epsilon 0.1) or AAC-Fast (4, 0.2)"},
    {"delta", NULL, NULL, "nodes of fewer primitives are combined at once, 2 to 256"},
    {"epsilon", NULL, NULL,
     "a node of k primitives keeps about k^(0.5 - epsilon) clusters, 0 to 0.5"},
    BB_UPDATE_OPTION,
    {.name = NULL},
};

typedef struct aac {
    bb_device *device;
    bb_account *account;
    aac_law law;
    bb_sorted_codes sorted;
    bb_refitter *refitter; /* NULL: moved primitives cause a rebuild */
    uint32_t key_bytes;    /* size of the keys that the kernels are compiled for; 0: not compiled */
    cl_program program;
    cl_kernel split, subtree, join, finish, skips;
    uint32_t prepared;                   /* most primitives that the sizes below allow for */
    uint32_t large;                      /* nodes of more primitives are large */
    uint32_t goals;                      /* sizes in the table of f */
    uint32_t small_room, large_room;     /* slots in a work-group's scratch */
    uint32_t small_groups, large_groups; /* work-groups that have scratch */
    bb_buffer sizes, counts, nodes, tasks, clusters, heights, live, scratch;
} aac;

static void release_kernels(aac *self)
{
    cl_kernel *const kernels[] = {&self->split, &self->subtree, &self->join, &self->finish,
                                  &self->skips};
    for (size_t i = 0; i < sizeof kernels / sizeof kernels[0]; i++) {
        bb_kernel_release(*kernels[i]);
        *kernels[i] = NULL;
    }
    bb_program_release(self->program);
    self->program = NULL;
    self->key_bytes = 0;
}

static void destroy(void *opaque)
{
    aac *self = opaque;
    if (self == NULL)
        return;
    bb_buffer *const buffers[] = {&self->sizes,    &self->counts,  &self->nodes, &self->tasks,
                                  &self->clusters, &self->heights, &self->live,  &self->scratch};
    for (size_t i = 0; i < sizeof buffers / sizeof buffers[0]; i++)
        bb_buffer_release(buffers[i]);
    release_kernels(self);
    bb_sorted_codes_release(&self->sorted);
    bb_refitter_destroy(self->refitter);
    free(self);
}

static uint32_t lanes_of(const aac *self)
{
    return bb_cpu_form(self->device) ? 1 : LANES_GPU;
}

/* Compiles what depends on the size of keys, which is known once all options of the code are
 * settled. */
static bb_status compile(aac *self)
{
    if (!bb_codes_key_changed(self->sorted.codes, self->key_bytes))
        return BB_OK;
    release_kernels(self);
    uint32_t key_bytes = bb_codes_key_bytes(self->sorted.codes);
    char defines[64];
    snprintf(defines, sizeof defines, "-DAAC_LANES=%u%s", lanes_of(self),
             key_bytes == 8 ? " -DBB_KEY64" : "");
    BB_TRY(bb_program_build(self->device, &bb_source_aac, defines, &self->program));
    BB_TRY(bb_kernel_get(self->program, "aac_split", &self->split));
    BB_TRY(bb_kernel_get(self->program, "aac_subtree", &self->subtree));
    BB_TRY(bb_kernel_get(self->program, "aac_join", &self->join));
    BB_TRY(bb_kernel_get(self->program, "aac_finish", &self->finish));
    BB_TRY(bb_kernel_get(self->program, "aac_skips", &self->skips));
    self->key_bytes = key_bytes;
    return BB_OK;
}

static bb_status read_law(const bb_spec *spec, aac_law *law)
{
    const bool fast = bb_spec_is(spec, options, "variant", "fast");
    uint64_t delta = fast ? 4 : 20;
    law->epsilon = fast ? 0.2 : 0.1;
    if (bb_spec_value(spec, options, "delta") != NULL)
        BB_TRY(bb_spec_u64(spec, options, "delta", 2, 256, &delta));
    if (bb_spec_value(spec, options, "epsilon") != NULL)
        BB_TRY(bb_spec_double(spec, options, "epsilon", 0, 0.5, &law->epsilon));
    law->delta = (uint32_t)delta;
    return BB_OK;
}

static bb_status create(const bb_builder_context *context, void **out)
{
    aac_law law;
    BB_TRY(read_law(context->spec, &law));
    aac *self = calloc(1, sizeof *self);
    if (self == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    *out = self;
    self->device = context->device;
    self->account = context->account;
    self->law = law;
    BB_TRY(bb_sorted_codes_create(context, false, &self->sorted));
    BB_TRY(bb_refitter_choose(context, &self->refitter));
    return compile(self);
}

/* Scratch slots needed to combine the clusters of two children that have `size` primitives
 * together. */
static uint32_t room_for(const aac *self, uint32_t size)
{
    uint32_t slots = bb_max_u32(2 * aac_goal(&self->law, size), self->law.delta);
    return (slots + 7) / 8 * 8;
}

static void choose_sizes(aac *self, uint32_t count)
{
    uint32_t cores = self->device->compute_units;
    self->prepared = count;
    self->large = bb_cpu_form(self->device)
                      ? bb_max_u32(count / (TASKS_PER_CORE * cores), LARGE_CPU)
                      : LARGE_GPU;
    self->goals = aac_goal(&self->law, bb_max_u32(count, self->law.delta));
    self->small_room = room_for(self, self->large);
    self->large_room = room_for(self, count);
    self->small_groups = bb_cpu_form(self->device) ? TASKS_PER_CORE * cores : GROUPS_GPU;
    self->large_groups = bb_cpu_form(self->device) ? cores : GROUPS_LARGE_GPU;
}

/* Computes the table of f on the host, so that it is the same on all devices. */
static bb_status write_sizes(aac *self)
{
    uint32_t *sizes = NULL, most = bb_max_u32(self->prepared, self->law.delta);
    size_t bytes = self->goals * sizeof *sizes;
    BB_TRY(bb_buffer_reserve(self->device, self->account, bytes, "aac: sizes", &self->sizes));
    BB_TRY(bb_host_alloc(self->account, bytes, "aac: sizes", &sizes));
    for (uint32_t i = 0; i < self->goals; i++)
        sizes[i] = aac_goal_size(&self->law, i + 1, most);
    bb_status status = bb_buffer_write(&self->sizes, 0, bytes, sizes);
    bb_host_free(sizes);
    return status;
}

static bb_status reserve(aac *self, size_t count)
{
    bb_device *device = self->device;
    bb_account *account = self->account;
    size_t word = sizeof(uint32_t);
    /* The large nodes of one level share no primitives. A binary tree has one leaf, here a small
     * node, more than it has inner nodes. */
    size_t ranges = (count / self->large + 1) * LEVELS_MAX;
    size_t small = (size_t)self->small_groups * self->small_room;
    size_t large = (size_t)self->large_groups * self->large_room;
    BB_TRY(bb_buffer_reserve(device, account, 2 * word, "aac: counts", &self->counts));
    BB_TRY(bb_buffer_reserve(device, account, ranges * sizeof(aac_range), "aac: large nodes",
                             &self->nodes));
    BB_TRY(bb_buffer_reserve(device, account, (ranges + 1) * sizeof(aac_range), "aac: small nodes",
                             &self->tasks));
    BB_TRY(bb_buffer_reserve(device, account, count * sizeof(aac_cluster), "aac: clusters",
                             &self->clusters));
    BB_TRY(bb_buffer_reserve(device, account, count * word, "aac: heights", &self->heights));
    BB_TRY(bb_buffer_reserve(device, account, count * word, "aac: counts", &self->live));
    return bb_buffer_reserve(device, account, (small > large ? small : large) * AAC_SLOT_WORDS * 4,
                             "aac: lists to combine", &self->scratch);
}

static bb_status prepare(void *opaque, const bb_scene *scene, bb_tree *tree)
{
    aac *self = opaque;
    size_t count = scene->prim_count;
    BB_TRY(bb_sorted_codes_prepare(&self->sorted, scene, 1));
    BB_TRY(compile(self));
    choose_sizes(self, scene->prim_count);
    BB_TRY(reserve(self, count));
    BB_TRY(write_sizes(self));
    BB_TRY(bb_refitter_reserve(self->refitter, 2 * count - 1));
    return bb_tree_reserve(tree, self->device, BB_ON_DEVICE, 2 * count - 1, count);
}

/* ---- the build ---- */

/* Large nodes by level, from the root: those of level n are at[n] .. at[n + 1] - 1. */
typedef struct large_levels {
    uint32_t at[LEVELS_MAX + 2];
    uint32_t count;
    uint32_t tasks; /* small nodes */
} large_levels;

static bb_status split_nodes(aac *self, uint32_t count, large_levels *levels)
{
    const aac_range root = {0, count - 1, 0};
    const bool is_large = count > self->large;
    uint32_t counts[2] = {0, is_large ? 1 : 0};
    BB_TRY(bb_buffer_write(is_large ? &self->nodes : &self->tasks, 0, sizeof root, &root));
    levels->count = 0;
    levels->at[0] = 0;
    counts[0] = is_large ? 0 : 1;
    while (counts[1] > 0) {
        uint32_t at = levels->at[levels->count], nodes = counts[1];
        assert(levels->count < LEVELS_MAX);
        counts[1] = 0;
        BB_TRY(bb_buffer_write(&self->counts, 0, sizeof counts, counts));
        BB_TRY(bb_launch(self->device, self->split, nodes, GROUP_SIZE, BB_MEM(self->sorted.keys),
                         BB_VALUE(at), BB_VALUE(nodes), BB_VALUE(self->large), BB_MEM(self->counts),
                         BB_MEM(self->nodes), BB_MEM(self->tasks)));
        BB_TRY(bb_buffer_read(&self->counts, 0, sizeof counts, counts));
        levels->at[++levels->count] = at + nodes;
    }
    levels->tasks = counts[0];
    return BB_OK;
}

static size_t items_for(const aac *self, uint32_t lists, uint32_t groups)
{
    return (size_t)(lists < groups ? lists : groups) * lanes_of(self);
}

static bb_status combine_small(aac *self, const bb_scene *scene, const large_levels *levels,
                               float unit, bb_tree *tree)
{
    uint32_t count = scene->prim_count;
    return bb_launch(
        self->device, self->subtree, items_for(self, levels->tasks, self->small_groups),
        lanes_of(self), BB_MEM(self->sorted.keys), BB_VALUE(count), BB_MEM(self->tasks),
        BB_VALUE(levels->tasks), BB_MEM(self->sorted.values), BB_MEM(scene->on_device.boxes),
        BB_MEM(tree->d_refs), BB_MEM(self->clusters), BB_MEM(self->heights), BB_MEM(tree->d_nodes),
        BB_VALUE(unit), BB_MEM(self->sizes), BB_VALUE(self->goals), BB_VALUE(self->law.delta),
        BB_MEM(self->scratch), BB_VALUE(self->small_room), BB_MEM(self->live));
}

static bb_status combine_large(aac *self, const large_levels *levels, float unit, bb_tree *tree)
{
    for (uint32_t n = levels->count; n-- > 0;) {
        uint32_t at = levels->at[n], nodes = levels->at[n + 1] - at;
        BB_TRY(bb_launch(self->device, self->join, items_for(self, nodes, self->large_groups),
                         lanes_of(self), BB_MEM(self->nodes), BB_VALUE(at), BB_VALUE(nodes),
                         BB_MEM(self->clusters), BB_MEM(self->heights), BB_MEM(tree->d_nodes),
                         BB_VALUE(unit), BB_MEM(self->sizes), BB_VALUE(self->goals),
                         BB_VALUE(self->law.delta), BB_MEM(self->scratch),
                         BB_VALUE(self->large_room), BB_MEM(self->live)));
    }
    return BB_OK;
}

static bb_status build(void *opaque, const bb_scene *scene, const bb_tree *input, bb_tree *tree,
                       bb_phases *phases)
{
    (void)input;
    aac *self = opaque;
    uint32_t count = scene->prim_count;
    large_levels levels;
    BB_TRY(bb_tree_reserve(tree, self->device, BB_ON_DEVICE, 2 * (size_t)count - 1, count));
    tree->duplicated = tree->disjoint = false;
    BB_TRY(bb_sorted_codes_make(&self->sorted, scene, phases));
    BB_TRY(bb_phase(phases, "split"));
    BB_TRY(split_nodes(self, count, &levels));
    const float unit = bb_scene_unit(&bb_codes_bounds(self->sorted.codes)[0]);
    BB_TRY(bb_phase(phases, "combine small"));
    BB_TRY(combine_small(self, scene, &levels, unit, tree));
    BB_TRY(bb_phase(phases, "combine large"));
    BB_TRY(combine_large(self, &levels, unit, tree));
    BB_TRY(bb_launch(self->device, self->finish, lanes_of(self), lanes_of(self), BB_VALUE(count),
                     BB_MEM(self->clusters), BB_MEM(self->heights), BB_MEM(tree->d_nodes),
                     BB_VALUE(unit), BB_MEM(self->sizes), BB_VALUE(self->goals),
                     BB_VALUE(self->law.delta), BB_MEM(self->scratch), BB_VALUE(self->large_room),
                     BB_MEM(self->live), BB_MEM(tree->d_info)));
    BB_TRY(bb_phase(phases, "skips"));
    BB_TRY(bb_launch(self->device, self->skips, count, GROUP_SIZE, BB_VALUE(count),
                     BB_MEM(tree->d_nodes)));
    BB_TRY(bb_event(phases, "subtrees", levels.tasks));
    return bb_phase(phases, NULL);
}

static bb_status update(void *opaque, const bb_scene *scene, uint32_t changed, bb_tree *tree,
                        bb_phases *phases)
{
    return bb_refit_update(((aac *)opaque)->refitter, scene, changed, tree, phases);
}

static bb_status describe(void *opaque, const bb_scene *scene, char *text, size_t capacity)
{
    const aac *self = opaque;
    char code[BB_CODE_TEXT];
    bb_codes_describe(self->sorted.codes, code, sizeof code);
    snprintf(text, capacity, "delta %u, epsilon %g, f(%u) = %u; %s", self->law.delta,
             self->law.epsilon, scene->prim_count, aac_goal(&self->law, scene->prim_count), code);
    return BB_OK;
}

static void decide(void *opaque, const bb_scene *scene, bb_decisions *decisions)
{
    const aac *self = opaque;
    bb_codes_decide(self->sorted.codes, scene, decisions);
}

static const bb_variants variants[] = {
    {BB_FOR_ALL, BB_ROLE_COMPARED, "aac"},
    {0},
};

const bb_builder bb_builder_aac = {
    .abi_version = BB_ABI_VERSION,
    .name = "aac",
    .summary = "agglomerative: nearest clusters first, within the nodes of a radix tree",
    .paper = "Gu, He, Fatahalian, Blelloch 2013",
    .kinds = BB_ALL_KINDS,
    .inputs = BB_INPUT_BOXES | BB_INPUT_PROFILE,
    .place = BB_ON_DEVICE,
    .deterministic = true,
    .options = options,
    .variants = variants,
    .decide = decide,
    .create = create,
    .prepare = prepare,
    .build = build,
    .update = update,
    .describe = describe,
    .destroy = destroy,
};
