/* PLOC: agglomerative clustering in which clusters look for partners only near them along a
 * space-filling curve. Runs on the device.
 *
 * Meister and Bittner 2018, "Parallel Locally-Ordered Clustering for Bounding Volume Hierarchy
 * Construction". Fused steps as in Benthin, Drabinski, Tessari, Dittebrandt 2022, "PLOC++: Parallel
 * Locally-Ordered Clustering for Bounding Volume Hierarchy Construction Revisited". The papers'
 * texts were not at hand: this was made from their abstracts and published code, and derived again.
 * ploc.cl lists the rounds; the merge step, shared with H-PLOC, is in
 * builders/common/ploc_cluster.clh.
 *
 * Where this knowingly departs from the authors' code:
 *
 * - Among equally near clusters theirs takes the lowest index, so a row of equal boxes merges one
 *   pair per round. Here a key that both ends of a pair share decides (ploc_cluster.clh), a rule of
 *   ours. Embree and HIPRT have another rule, by the parity of indices.
 * - After a round that makes few pairs the next one compares areas by their exponents alone, a rule
 *   of Embree's against chains of nested boxes.
 * - The default radius is 8, as in Embree's and HIPRT's builders of this kind; theirs is 100. In
 *   the scenes measured a larger one hardly lowers the cost, and takes longer.
 * - Nodes have the same numbers in each run, on all devices.
 */
#include "builders/common/ploc.h"
#include "builders/common/ploc_shared.h"
#include "framework/base/arithmetic.h"

#include <stdio.h>
#include <stdlib.h>

BB_DEVICE_SOURCE(ploc);
BB_DEVICE_SOURCE(ploc_gpu);

enum {
    GROUP_SIZE = 64,
    REST_GROUP = 256, /* GPUs: most clusters that one work-group finishes */
    TILE = 512,
    CHUNK = 2048,
    LISTS = 2,
};

static const bb_option options[] = {
    BB_CODE_OPTIONS("mc64"),
    {"radius", "8", NULL, "clusters on either side that a cluster is compared with, 1 to 127"},
    {.name = NULL},
};

typedef struct ploc {
    bb_ploc base;
    cl_program program;
    cl_kernel leaves, search, places, merge, rest; /* GPUs: places marks which clusters stay */
    uint32_t rest_most;                            /* most clusters that are finished in one
                                                    * launch */
    bb_buffer actions;                             /* char per cluster */
    bb_buffer kept;                                /* u32 per chunk; GPUs: per cluster */
    bb_buffer number;                              /* u32 */
    uint32_t rounds;                               /* of the last build */
} ploc;

static void destroy(void *opaque)
{
    ploc *self = opaque;
    if (self == NULL)
        return;
    bb_buffer_release(&self->actions);
    bb_buffer_release(&self->kept);
    bb_buffer_release(&self->number);
    bb_kernel_release(self->leaves);
    bb_kernel_release(self->search);
    bb_kernel_release(self->places);
    bb_kernel_release(self->merge);
    bb_kernel_release(self->rest);
    bb_program_release(self->program);
    bb_ploc_release(&self->base);
    free(self);
}

static bb_status get_kernels(ploc *self)
{
    static const char *const names[2][5] = {
        {"ploc_leaves_each", "ploc_find", "ploc_mark", "ploc_merge_each", "ploc_rest_group"},
        {"ploc_leaves", "ploc_search", "ploc_places", "ploc_merge", "ploc_rest"},
    };
    const bool cpu = bb_cpu_form(self->base.device);
    cl_kernel *const kernels[] = {&self->leaves, &self->search, &self->places, &self->merge,
                                  &self->rest};
    char defines[128];
    snprintf(defines, sizeof defines, "-DBB_RADIUS=%u -DBB_TILE=%d -DBB_CHUNK=%d -DBB_GROUP=%u",
             self->base.radius, TILE, CHUNK, self->rest_most);
    BB_TRY(bb_program_build(self->base.device, cpu ? &bb_source_ploc : &bb_source_ploc_gpu, defines,
                            &self->program));
    for (int i = 0; i < 5; i++)
        BB_TRY(bb_kernel_get(self->program, names[cpu][i], kernels[i]));
    return BB_OK;
}

static bb_status create(const bb_builder_context *context, void **out)
{
    ploc *self = calloc(1, sizeof *self);
    if (self == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    *out = self;
    BB_TRY(bb_ploc_create(context, &self->base));
    const size_t group = context->device->max_group_size;
    self->rest_most = bb_cpu_form(self->base.device) ? TILE
                      : group < REST_GROUP           ? (uint32_t)group
                                                     : REST_GROUP;
    return get_kernels(self);
}

static bb_status prepare(void *opaque, const bb_scene *scene, bb_tree *tree)
{
    ploc *self = opaque;
    bb_device *device = self->base.device;
    bb_account *account = self->base.account;
    const uint32_t count = scene->prim_count;
    const size_t kept = bb_cpu_form(self->base.device) ? bb_divide_up(count, CHUNK) : count;
    BB_TRY(bb_ploc_prepare(&self->base, scene, LISTS, tree));
    BB_TRY(bb_buffer_reserve(device, account, count, "ploc: actions", &self->actions));
    BB_TRY(
        bb_buffer_reserve(device, account, kept * sizeof(uint32_t), "ploc: places", &self->kept));
    return bb_buffer_reserve(device, account, sizeof(uint32_t), "ploc: number", &self->number);
}

/* Returns the number of work-items for a launch over `count` clusters. */
static uint32_t items_of(const ploc *self, uint32_t count)
{
    return bb_cpu_form(self->base.device) ? bb_divide_up(count, CHUNK) : count;
}

static uint32_t group_of(const ploc *self)
{
    return bb_cpu_form(self->base.device) ? 1 : GROUP_SIZE;
}

/* Computes the places of the clusters that stay, from actions[] or kept[]; *left: their number. */
static bb_status find_places(ploc *self, uint32_t count, uint32_t *left)
{
    bb_device *device = self->base.device;
    uint32_t items = items_of(self, count);
    if (bb_cpu_form(self->base.device)) {
        BB_TRY(bb_launch(device, self->places, 1, 1, BB_MEM(self->kept), BB_VALUE(items),
                         BB_MEM(self->number)));
    } else {
        BB_TRY(bb_launch(device, self->places, items, GROUP_SIZE, BB_MEM(self->actions),
                         BB_VALUE(count), BB_MEM(self->kept)));
        BB_TRY(bb_scan_u32(self->base.sorted.primitives, &self->kept, &self->kept, count,
                           &self->number));
    }
    return bb_buffer_read(&self->number, 0, sizeof *left, left);
}

/* Runs one round over the `count` clusters of lists[from], into the other list. */
static bb_status round_of(ploc *self, uint32_t from, uint32_t count, int32_t mask, uint32_t *left)
{
    bb_ploc *base = &self->base;
    const bb_ploc_list *list = &base->lists[from], *next = &base->lists[1 - from];
    const bb_buffer *pairs = bb_pair_tree_pairs(base->pairs);
    const uint32_t items = items_of(self, count), group = group_of(self);
    if (bb_cpu_form(self->base.device))
        BB_TRY(bb_launch(base->device, self->search, items, group, BB_MEM(list->planes),
                         BB_MEM(list->tags), BB_VALUE(base->stride), BB_VALUE(count),
                         BB_VALUE(mask), BB_MEM(self->actions), BB_MEM(self->kept)));
    else
        BB_TRY(bb_launch(base->device, self->search, items, group, BB_MEM(list->planes),
                         BB_MEM(list->tags), BB_VALUE(base->stride), BB_VALUE(count),
                         BB_VALUE(mask), BB_MEM(self->actions)));
    BB_TRY(find_places(self, count, left));
    return bb_launch(base->device, self->merge, items, group, BB_MEM(list->planes),
                     BB_MEM(list->tags), BB_VALUE(base->stride), BB_VALUE(count),
                     BB_MEM(self->actions), BB_MEM(self->kept), BB_MEM(next->planes),
                     BB_MEM(next->tags), BB_MEM(*pairs));
}

/* Runs rounds until one cluster is left, and counts them. */
static bb_status cluster(ploc *self, const bb_scene *scene, bb_phases *phases)
{
    bb_ploc *base = &self->base;
    const bb_buffer *pairs = bb_pair_tree_pairs(base->pairs);
    const bb_buffer *root = bb_pair_tree_root(base->pairs);
    int32_t mask = BB_PLOC_EXACT;
    uint32_t count = scene->prim_count, from = 0, rounds = 0, rest;
    BB_TRY(bb_launch(base->device, self->leaves, items_of(self, count), group_of(self),
                     BB_MEM(scene->on_device.boxes), BB_MEM(base->sorted.values), BB_VALUE(count),
                     BB_MEM(base->lists[0].planes), BB_MEM(base->lists[0].tags),
                     BB_VALUE(base->stride)));
    for (uint32_t left; count > self->rest_most; rounds++) {
        BB_TRY(round_of(self, from, count, mask, &left));
        mask = count - left < BB_PLOC_FEW(count) ? BB_PLOC_FORCED : BB_PLOC_EXACT;
        count = left;
        from = 1 - from;
    }
    const uint32_t items = bb_cpu_form(self->base.device) ? 1 : self->rest_most;
    BB_TRY(bb_launch(base->device, self->rest, items, items, BB_MEM(base->lists[from].planes),
                     BB_MEM(base->lists[from].tags), BB_VALUE(base->stride), BB_VALUE(count),
                     BB_VALUE(mask), BB_MEM(*pairs), BB_MEM(*root), BB_MEM(self->number)));
    BB_TRY(bb_buffer_read(&self->number, 0, sizeof rest, &rest));
    self->rounds = rounds + rest;
    return bb_event(phases, "rounds", self->rounds);
}

static bb_status build(void *opaque, const bb_scene *scene, const bb_tree *input, bb_tree *tree,
                       bb_phases *phases)
{
    (void)input;
    ploc *self = opaque;
    BB_TRY(bb_sorted_codes_make(&self->base.sorted, scene, phases));
    BB_TRY(bb_phase(phases, "cluster"));
    BB_TRY(cluster(self, scene, phases));
    return bb_ploc_finish(&self->base, scene, tree, phases);
}

static void decide(void *opaque, const bb_scene *scene, bb_decisions *decisions)
{
    const ploc *self = opaque;
    bb_codes_decide(self->base.sorted.codes, scene, decisions);
}

static bb_status describe(void *opaque, const bb_scene *scene, char *text, size_t capacity)
{
    (void)scene;
    const ploc *self = opaque;
    char code[BB_CODE_TEXT];
    bb_codes_describe(self->base.sorted.codes, code, sizeof code);
    snprintf(text, capacity, "%u rounds; %s", self->rounds, code);
    return BB_OK;
}

const bb_builder bb_builder_ploc = {
    .abi_version = BB_ABI_VERSION,
    .name = "ploc",
    .summary = "clusters merge with their nearest along a curve, in rounds",
    .paper = "Meister, Bittner 2018; Benthin et al. 2022",
    .kinds = BB_ALL_KINDS,
    .inputs = BB_INPUT_BOXES | BB_INPUT_PROFILE,
    .place = BB_ON_DEVICE,
    .deterministic = true,
    .options = options,
    .create = create,
    .prepare = prepare,
    .build = build,
    .describe = describe,
    .decide = decide,
    .destroy = destroy,
};
