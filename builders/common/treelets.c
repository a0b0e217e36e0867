/* Host side of treelets.cl and treelet_rounds.clh. */
#include "builders/common/treelets.h"

#include "builders/common/pair_tree.h"
#include "builders/common/scene_unit.h"
#include "framework/base/arithmetic.h"
#include "framework/device/levels.h"

#include <stdio.h>
#include <stdlib.h>

enum {
    GROUP_SIZE = 64,
    LANES_CPU = 8,
    CHUNK_CPU = 1024,    /* nodes or pairs per work-item */
    PUSHES_CPU = 64,     /* pairs that a work-item puts on a list at once */
    SUBTREE_MOST = 4096, /* leaves of a subtree that one CPU work-item does: its pairs, 256 KiB */
    SUBTREE_LEAST = 256,
    SUBTREES_PER_CORE = 16,
    REST_CPU = 16,       /* most pairs of a level that one work-item does */
    ITEMS_PER_CORE = 32, /* CPUs: work-items that share a level */
    ROUNDS_MAX = 30,     /* since gamma doubles */
    GAMMA_MAX = 1 << 30,
};

typedef struct optimiser {
    bb_device *device;
    bb_account *account;
    uint32_t rounds;  /* most rounds */
    uint32_t treelet; /* leaves of a treelet */
    uint32_t gamma;   /* fewest leaves below a treelet's root in the first round */
    cl_program program, rounds_program;
    cl_kernel marks, make, count, start, leaves, level;
    cl_kernel subtrees; /* CPUs */
    bb_primitives *primitives;
    bb_pair_tree *pairs;
    bb_levels levels;
    bb_buffer places;           /* u32 per node: its pair if it is inner */
    bb_buffer parents, missing; /* u32 per pair: the pair above; pairs below still to come */
    bb_buffer held;             /* u32 per pair: leaves below */
    bb_buffer tasks;            /* CPUs: u32, roots of subtrees */
    bb_buffer totals;           /* u32: treelets examined, and rebuilt */
    /* of the last build */
    uint32_t rounds_made;
    uint32_t seen, rebuilt;
} optimiser;

/* ---- an object ---- */

static bb_status read_options(const bb_builder_context *context, uint32_t treelet_most,
                              optimiser *self)
{
    uint64_t rounds, treelet, gamma;
    BB_TRY(bb_spec_u64(context->spec, context->options, "rounds", 1, ROUNDS_MAX, &rounds));
    BB_TRY(bb_spec_u64(context->spec, context->options, "treelet", 3, treelet_most, &treelet));
    gamma = treelet;
    if (bb_spec_value(context->spec, context->options, "gamma") != NULL)
        BB_TRY(bb_spec_u64(context->spec, context->options, "gamma", 3, GAMMA_MAX, &gamma));
    if (gamma < treelet)
        return bb_fail(BB_INVALID,
                       "builder %s: gamma %u is less than the %u leaves of a treelet: a subtree "
                       "that has no more has no such treelet",
                       context->spec->name, (unsigned)gamma, (unsigned)treelet);
    self->rounds = (uint32_t)rounds;
    self->treelet = (uint32_t)treelet;
    self->gamma = (uint32_t)gamma;
    return BB_OK;
}

static bb_status compile(optimiser *self, const bb_source *source)
{
    const bool cpu = bb_cpu_form(self->device);
    char shared[128], own[256];
    snprintf(shared, sizeof shared, "-DBB_CHUNK=%du -DBB_PUSHES=%d -DBB_REST=%du",
             cpu ? CHUNK_CPU : 1, cpu ? PUSHES_CPU : 1, cpu ? REST_CPU : 0);
    if (cpu)
        snprintf(own, sizeof own, "%s -DBB_TREELET=%u -DBB_LANES=%d -DBB_SUBTREE=%d", shared,
                 self->treelet, LANES_CPU, SUBTREE_MOST);
    else
        snprintf(own, sizeof own, "%s -DBB_TREELET=%u -DBB_LANES=1", shared, self->treelet);
    BB_TRY(bb_program_build(self->device, bb_source_find("treelets.cl"), shared, &self->program));
    BB_TRY(bb_kernel_get(self->program, "treelets_marks", &self->marks));
    BB_TRY(bb_kernel_get(self->program, "treelets_pairs", &self->make));
    BB_TRY(bb_kernel_get(self->program, "treelets_count", &self->count));
    BB_TRY(bb_kernel_get(self->program, "treelets_start", &self->start));
    BB_TRY(bb_kernel_get(self->program, "treelets_leaves", &self->leaves));
    BB_TRY(bb_program_build(self->device, source, own, &self->rounds_program));
    if (cpu)
        BB_TRY(bb_kernel_get(self->rounds_program, "treelets_subtrees", &self->subtrees));
    return bb_kernel_get(self->rounds_program, "treelets_level", &self->level);
}

bb_status bb_treelets_create(const bb_builder_context *context, const bb_source *source,
                             uint32_t treelet_most, void **out)
{
    optimiser *self = calloc(1, sizeof *self);
    if (self == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    *out = self;
    self->device = context->device;
    self->account = context->account;
    BB_TRY(read_options(context, treelet_most, self));
    BB_TRY(compile(self, source));
    BB_TRY(bb_primitives_create(self->device, self->account, &self->primitives));
    return bb_pair_tree_create(self->device, self->account, &self->pairs);
}

void bb_treelets_destroy(void *opaque)
{
    optimiser *self = opaque;
    if (self == NULL)
        return;
    cl_kernel const kernels[] = {self->marks,  self->make,  self->count,   self->start,
                                 self->leaves, self->level, self->subtrees};
    for (size_t i = 0; i < sizeof kernels / sizeof kernels[0]; i++)
        bb_kernel_release(kernels[i]);
    bb_program_release(self->program);
    bb_program_release(self->rounds_program);
    bb_levels_release(&self->levels);
    bb_buffer_release(&self->places);
    bb_buffer_release(&self->parents);
    bb_buffer_release(&self->missing);
    bb_buffer_release(&self->held);
    bb_buffer_release(&self->tasks);
    bb_buffer_release(&self->totals);
    bb_pair_tree_destroy(self->pairs);
    bb_primitives_destroy(self->primitives);
    free(self);
}

/* ---- room ---- */

static bb_status reserve_u32(optimiser *self, size_t count, const char *what, bb_buffer *out)
{
    return bb_buffer_reserve(self->device, self->account, count * sizeof(uint32_t), what, out);
}

static bb_status reserve(optimiser *self, uint32_t leaves, uint32_t references, bb_tree *tree)
{
    const size_t nodes = 2 * (size_t)leaves - 1;
    BB_TRY(bb_tree_reserve(tree, self->device, BB_ON_DEVICE, nodes, references));
    if (leaves < self->gamma)
        return BB_OK;
    BB_TRY(bb_pair_tree_reserve(self->pairs, leaves, tree));
    BB_TRY(reserve_u32(self, nodes, "treelets: places of pairs", &self->places));
    BB_TRY(reserve_u32(self, leaves, "treelets: parents", &self->parents));
    BB_TRY(reserve_u32(self, leaves, "treelets: pairs to come", &self->missing));
    BB_TRY(reserve_u32(self, leaves, "treelets: leaves below", &self->held));
    /* subtrees share no leaf, and each has 3 or more */
    BB_TRY(reserve_u32(self, bb_cpu_form(self->device) ? leaves / 3 + 1 : 1, "treelets: subtrees",
                       &self->tasks));
    BB_TRY(reserve_u32(self, 2, "treelets: totals", &self->totals));
    /* pairs of a level share no leaf; no pair is higher than the tree has leaves */
    return bb_levels_reserve(&self->levels, self->device, self->account, leaves / 2 + 1, leaves,
                             "treelets: levels");
}

bb_status bb_treelets_prepare(void *opaque, const bb_scene *scene, bb_tree *tree)
{
    return reserve(opaque, scene->prim_count, scene->prim_count, tree);
}

/* ---- a build ---- */

typedef struct pass {
    optimiser *self;
    float unit;
} pass;

static uint32_t group_of(const optimiser *self)
{
    return bb_cpu_form(self->device) ? 1 : GROUP_SIZE;
}

/* Work-items of a launch over `count` nodes or pairs. */
static uint32_t chunks_of(const optimiser *self, uint32_t count)
{
    return bb_cpu_form(self->device) ? bb_divide_up(count, CHUNK_CPU) : count;
}

static uint32_t items_of(const optimiser *self, const bb_levels *levels)
{
    return bb_cpu_form(self->device) && !levels->last ? self->device->compute_units * ITEMS_PER_CORE
                                                      : bb_levels_items(levels);
}

static bb_status count_level(void *context, const bb_levels *levels, uint32_t n)
{
    optimiser *self = ((const pass *)context)->self;
    const bb_buffer *pairs = bb_pair_tree_pairs(self->pairs);
    return bb_launch(self->device, self->count, items_of(self, levels), group_of(self),
                     BB_MEM(*pairs), BB_MEM(self->parents), BB_MEM(self->missing),
                     BB_MEM(self->held), BB_VALUE(n), BB_MEM(levels->counts),
                     BB_MEM(levels->lists[n % 2]), BB_MEM(levels->lists[(n + 1) % 2]));
}

static bb_status treelet_level(void *context, const bb_levels *levels, uint32_t n)
{
    const pass *p = context;
    optimiser *self = p->self;
    const bb_buffer *pairs = bb_pair_tree_pairs(self->pairs);
    return bb_launch(self->device, self->level, items_of(self, levels), group_of(self),
                     BB_MEM(*pairs), BB_MEM(self->parents), BB_MEM(self->missing),
                     BB_MEM(self->held), BB_VALUE(n), BB_MEM(levels->counts),
                     BB_MEM(levels->lists[n % 2]), BB_MEM(levels->lists[(n + 1) % 2]),
                     BB_VALUE(p->unit), BB_MEM(self->totals));
}

/* Makes the tree's pairs and the first level to be counted. */
static bb_status make_pairs(optimiser *self, const bb_tree *input)
{
    const bb_tree_info *info = &input->info;
    const bb_buffer *pairs = bb_pair_tree_pairs(self->pairs);
    const bb_buffer *root = bb_pair_tree_root(self->pairs);
    const uint32_t single = info->ref_count == info->leaf_count;
    BB_TRY(bb_launch(self->device, self->marks, info->node_count, GROUP_SIZE,
                     BB_MEM(input->d_nodes), BB_VALUE(info->node_count), BB_MEM(self->places)));
    BB_TRY(bb_scan_u32(self->primitives, &self->places, &self->places, info->node_count, NULL));
    BB_TRY(bb_levels_start(&self->levels));
    return bb_launch(self->device, self->make, chunks_of(self, info->node_count), group_of(self),
                     BB_MEM(input->d_nodes), BB_VALUE(info->node_count), BB_VALUE(info->root),
                     BB_MEM(input->d_refs), BB_VALUE(single), BB_MEM(self->places), BB_MEM(*pairs),
                     BB_MEM(*root), BB_MEM(self->parents), BB_MEM(self->missing),
                     BB_MEM(self->levels.counts), BB_MEM(self->levels.lists[1]));
}

/* Most leaves of a subtree that one work-item does, so that there are enough for all cores. */
static uint32_t subtree_of(const optimiser *self, uint32_t leaves)
{
    const uint32_t share = leaves / (self->device->compute_units * SUBTREES_PER_CORE);
    if (!bb_cpu_form(self->device))
        return 0;
    return share < SUBTREE_LEAST ? SUBTREE_LEAST : share > SUBTREE_MOST ? SUBTREE_MOST : share;
}

/* Does one round over pairs of at least `least` leaves. */
static bb_status make_round(optimiser *self, uint32_t leaves, uint32_t least, float unit)
{
    const bb_buffer *pairs = bb_pair_tree_pairs(self->pairs);
    const uint32_t count = leaves - 1, above = subtree_of(self, leaves) + 1;
    const uint32_t lowest = least < above ? above : least;
    pass p = {self, unit};
    BB_TRY(bb_levels_start(&self->levels));
    BB_TRY(bb_launch(self->device, self->start, chunks_of(self, count), group_of(self),
                     BB_MEM(*pairs), BB_VALUE(count), BB_MEM(self->held), BB_VALUE(lowest),
                     BB_VALUE(least), BB_MEM(self->parents), BB_MEM(self->missing),
                     BB_MEM(self->levels.counts), BB_MEM(self->levels.lists[1]),
                     BB_MEM(self->tasks)));
    if (bb_cpu_form(self->device))
        BB_TRY(bb_launch(self->device, self->subtrees, items_of(self, &self->levels),
                         group_of(self), BB_MEM(*pairs), BB_MEM(self->held), BB_MEM(self->tasks),
                         BB_MEM(self->levels.counts), BB_VALUE(least), BB_VALUE(unit),
                         BB_MEM(self->totals)));
    return bb_levels_run(&self->levels, treelet_level, &p);
}

static bb_status make_rounds(optimiser *self, uint32_t leaves, float unit)
{
    uint32_t totals[2];
    BB_TRY(bb_buffer_fill(&self->totals, sizeof totals, 0));
    for (self->rounds_made = 0; self->rounds_made < self->rounds; self->rounds_made++) {
        const uint64_t gamma = (uint64_t)self->gamma << self->rounds_made;
        if (gamma > leaves)
            break;
        BB_TRY(make_round(self, leaves, (uint32_t)gamma, unit));
    }
    BB_TRY(bb_buffer_read(&self->totals, 0, sizeof totals, totals));
    self->seen = totals[0];
    self->rebuilt = totals[1];
    return BB_OK;
}

static bb_status make_tree(optimiser *self, const bb_tree *input, bb_tree *tree)
{
    const bb_tree_info *info = &input->info;
    BB_TRY(bb_pair_tree_finish(self->pairs, info->leaf_count, tree));
    tree->duplicated = input->duplicated;
    if (info->ref_count == info->leaf_count)
        return BB_OK;
    BB_TRY(bb_launch(self->device, self->leaves, info->node_count, GROUP_SIZE,
                     BB_MEM(tree->d_nodes), BB_VALUE(info->node_count), BB_MEM(tree->d_refs),
                     BB_VALUE(info->ref_count), BB_MEM(tree->d_info)));
    return bb_buffer_copy(&input->d_refs, &tree->d_refs, info->ref_count * sizeof(uint32_t));
}

static bb_status optimise(optimiser *self, const bb_tree *input, bb_tree *tree, bb_phases *phases)
{
    const bb_tree_info *info = &input->info;
    bb_node root;
    bb_box box;
    pass p = {self, 0};
    BB_TRY(bb_phase(phases, "pairs"));
    BB_TRY(bb_buffer_read(&input->d_nodes, info->root * sizeof root, sizeof root, &root));
    for (int axis = 0; axis < 3; axis++) {
        box.lo[axis] = root.lo[axis];
        box.hi[axis] = root.hi[axis];
    }
    BB_TRY(make_pairs(self, input));
    BB_TRY(bb_phase(phases, "count"));
    BB_TRY(bb_levels_run(&self->levels, count_level, &p));
    BB_TRY(bb_phase(phases, "treelets"));
    BB_TRY(make_rounds(self, info->leaf_count, bb_scene_unit(&box)));
    BB_TRY(bb_phase(phases, "order"));
    return make_tree(self, input, tree);
}

bb_status bb_treelets_build(void *opaque, const bb_scene *scene, const bb_tree *input,
                            bb_tree *tree, bb_phases *phases)
{
    (void)scene;
    optimiser *self = opaque;
    const bb_tree_info *info = &input->info;
    if (info->arity > 2 || info->node_count != 2 * info->leaf_count - 1)
        return bb_fail(BB_UNSUPPORTED,
                       "optimisers of treelets take binary trees, and this one has nodes of "
                       "another number of children than two");
    self->rounds_made = self->seen = self->rebuilt = 0;
    BB_TRY(reserve(self, info->leaf_count, info->ref_count, tree));
    if (info->leaf_count < self->gamma) {
        BB_TRY(bb_phase(phases, "copy"));
        BB_TRY(bb_tree_copy(input, tree));
    } else {
        BB_TRY(optimise(self, input, tree, phases));
    }
    BB_TRY(bb_event(phases, "treelets", self->seen));
    BB_TRY(bb_event(phases, "improved", self->rebuilt));
    return bb_phase(phases, NULL);
}

bb_status bb_treelets_describe(void *opaque, const bb_scene *scene, char *text, size_t capacity)
{
    (void)scene;
    const optimiser *self = opaque;
    snprintf(text, capacity, "%u of %u treelets of %u leaves rebuilt in %u rounds", self->rebuilt,
             self->seen, self->treelet, self->rounds_made);
    return BB_OK;
}
