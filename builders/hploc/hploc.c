/* H-PLOC: PLOC along the radix tree of the codes, in which each node passes a few clusters up to
 * its parent. Runs on the device.
 *
 * Benthin, Meister, Barczak, Mehalwal, Tsakok, Kensler 2024, "H-PLOC: Hierarchical Parallel
 * Locally-Ordered Clustering for Bounding Volume Hierarchy Construction". The paper's text was not
 * at hand: this was made from its abstract and published code, whose radius of 8 and window of 32
 * are the defaults, and derived again. hploc.cl lists the steps; the merge step, shared with PLOC,
 * is in builders/common/ploc_cluster.clh.
 *
 * What was added: PLOC's rules for ties and against chains (builders/ploc/ploc.c), and hand-over
 * between launches instead of by fences, so that nothing depends on how work-groups are scheduled.
 */
#include "builders/common/ploc.h"
#include "framework/base/arithmetic.h"
#include "framework/device/levels.h"
#include "hploc_shared.h"

#include <stdio.h>
#include <stdlib.h>

BB_DEVICE_SOURCE(hploc);
BB_DEVICE_SOURCE(hploc_gpu);

enum {
    GROUP_SIZE = 64,
    WINDOW_MIN = 4,
    WINDOW_MAX = 256,
    CHUNK_MIN = 1024,
    CHUNKS_PER_UNIT = 16, /* CPUs: so that cores share the work evenly */
    HEIGHT_MAX = 96,      /* of a radix tree: 64 bits of keys and 32 of indices */
    PIECES_MAX = HPLOC_PIECES_MAX(64),
};

static const bb_option options[] = {
    BB_CODE_OPTIONS("mc64"),
    {"radius", "8", NULL, "clusters on either side that a cluster is compared with, 1 to 127"},
    {"window", "32", NULL, "most clusters at a node, 4 to 256 and even; it passes half of them up"},
    {.name = NULL},
};

typedef struct hploc {
    bb_ploc base;
    uint32_t window;
    uint32_t key_bytes; /* size of the keys that the program is compiled for; 0: not compiled */
    cl_program program;
    cl_kernel first;  /* hploc_chunks or hploc_leaves */
    cl_kernel ranges; /* GPUs only */
    cl_kernel last;   /* hploc_top or hploc_level */
    uint32_t chunk;   /* CPUs: keys per work-item */
    bb_buffer pieces, piece_counts, stack;
    bb_buffer clusters, heads, live, splits, missing; /* GPUs only */
    bb_levels levels;
} hploc;

static void release_program(hploc *self)
{
    bb_kernel_release(self->first);
    bb_kernel_release(self->ranges);
    bb_kernel_release(self->last);
    bb_program_release(self->program);
    self->first = self->ranges = self->last = NULL;
    self->program = NULL;
    self->key_bytes = 0;
}

static void destroy(void *opaque)
{
    hploc *self = opaque;
    if (self == NULL)
        return;
    bb_buffer *const buffers[] = {&self->pieces,   &self->piece_counts, &self->stack,
                                  &self->clusters, &self->heads,        &self->live,
                                  &self->splits,   &self->missing};
    for (size_t i = 0; i < sizeof buffers / sizeof *buffers; i++)
        bb_buffer_release(buffers[i]);
    bb_levels_release(&self->levels);
    release_program(self);
    bb_ploc_release(&self->base);
    free(self);
}

/* Work-items per group on GPUs: one per cluster of a node. */
static uint32_t group_of(const hploc *self)
{
    return self->window <= 32 ? 32 : self->window;
}

/* Gets the kernels for the size of keys, which is known once all options of the code are
 * settled. */
static bb_status get_kernels(hploc *self)
{
    if (!bb_codes_key_changed(self->base.sorted.codes, self->key_bytes))
        return BB_OK;
    const uint32_t key_bytes = bb_codes_key_bytes(self->base.sorted.codes);
    const bool cpu = bb_cpu_form(self->base.device);
    release_program(self);
    char defines[128];
    snprintf(defines, sizeof defines, "-DBB_RADIUS=%u -DBB_GOAL=%u -DBB_GROUP=%u%s",
             self->base.radius, self->window / 2, group_of(self),
             key_bytes == 8 ? " -DBB_KEY64" : "");
    BB_TRY(bb_program_build(self->base.device, cpu ? &bb_source_hploc : &bb_source_hploc_gpu,
                            defines, &self->program));
    BB_TRY(bb_kernel_get(self->program, cpu ? "hploc_chunks" : "hploc_leaves", &self->first));
    BB_TRY(bb_kernel_get(self->program, cpu ? "hploc_top" : "hploc_level", &self->last));
    if (!cpu)
        BB_TRY(bb_kernel_get(self->program, "hploc_ranges", &self->ranges));
    self->key_bytes = key_bytes;
    return BB_OK;
}

static bb_status create(const bb_builder_context *context, void **out)
{
    const bb_spec *spec = context->spec;
    uint64_t window;
    hploc *self = calloc(1, sizeof *self);
    if (self == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    *out = self;
    BB_TRY(bb_spec_u64(spec, options, "window", WINDOW_MIN, WINDOW_MAX, &window));
    if (window % 2 != 0)
        return bb_fail(BB_INVALID, "builder %s: window=%u is odd: half of the clusters are left",
                       spec->name, (uint32_t)window);
    self->window = (uint32_t)window;
    BB_TRY(bb_ploc_create(context, &self->base));
    if (!bb_cpu_form(self->base.device) && group_of(self) > context->device->max_group_size)
        return bb_fail(BB_UNSUPPORTED,
                       "builder %s: window=%u: the device's work-groups have %zu items at most",
                       spec->name, self->window, context->device->max_group_size);
    return get_kernels(self);
}

static bb_status reserve_for_gpu(hploc *self, uint32_t count)
{
    bb_device *device = self->base.device;
    bb_account *account = self->base.account;
    const size_t n = count;
    BB_TRY(bb_buffer_reserve(device, account, n * sizeof(bb_pair_side), "hploc: clusters",
                             &self->clusters));
    BB_TRY(bb_buffer_reserve(device, account, n * sizeof(uint32_t), "hploc: heads", &self->heads));
    BB_TRY(bb_buffer_reserve(device, account, n * sizeof(uint32_t), "hploc: counts", &self->live));
    BB_TRY(bb_buffer_reserve(device, account, n * 2 * sizeof(uint32_t), "hploc: ranges",
                             &self->splits));
    BB_TRY(bb_buffer_reserve(device, account, n * sizeof(uint32_t), "hploc: missing children",
                             &self->missing));
    self->levels.by_groups = true;
    return bb_levels_reserve(&self->levels, device, account, count, HEIGHT_MAX, "hploc: levels");
}

static bb_status prepare(void *opaque, const bb_scene *scene, bb_tree *tree)
{
    hploc *self = opaque;
    bb_device *device = self->base.device;
    bb_account *account = self->base.account;
    const uint32_t count = scene->prim_count;
    BB_TRY(bb_ploc_prepare(&self->base, scene, bb_cpu_form(self->base.device) ? 1 : 0, tree));
    BB_TRY(get_kernels(self));
    if (!bb_cpu_form(self->base.device))
        return reserve_for_gpu(self, count);
    const uint32_t units = device->compute_units * CHUNKS_PER_UNIT;
    self->chunk = bb_max_u32(count / units + 1, CHUNK_MIN);
    const size_t chunks = (count - 1) / self->chunk + 1;
    BB_TRY(bb_buffer_reserve(device, account, chunks * PIECES_MAX * sizeof(hploc_piece),
                             "hploc: subtrees", &self->pieces));
    BB_TRY(bb_buffer_reserve(device, account, chunks * sizeof(uint32_t), "hploc: subtrees",
                             &self->piece_counts));
    return bb_buffer_reserve(device, account, PIECES_MAX * sizeof(hploc_piece), "hploc: subtrees",
                             &self->stack);
}

static bb_status cluster_on_cpu(hploc *self, const bb_scene *scene)
{
    const bb_ploc *base = &self->base;
    const bb_ploc_list *list = &base->lists[0];
    const bb_buffer *pairs = bb_pair_tree_pairs(base->pairs);
    const bb_buffer *root = bb_pair_tree_root(base->pairs);
    const uint32_t count = scene->prim_count;
    BB_TRY(bb_launch(base->device, self->first, (count - 1) / self->chunk + 1, 1,
                     BB_MEM(base->sorted.keys), BB_MEM(base->sorted.values),
                     BB_MEM(scene->on_device.boxes), BB_VALUE(count), BB_VALUE(self->chunk),
                     BB_MEM(list->planes), BB_MEM(list->tags), BB_VALUE(base->stride),
                     BB_MEM(*pairs), BB_MEM(self->pieces), BB_MEM(self->piece_counts)));
    return bb_launch(base->device, self->last, 1, 1, BB_MEM(base->sorted.keys), BB_VALUE(count),
                     BB_VALUE(self->chunk), BB_MEM(list->planes), BB_MEM(list->tags),
                     BB_VALUE(base->stride), BB_MEM(*pairs), BB_MEM(self->pieces),
                     BB_MEM(self->piece_counts), BB_MEM(self->stack), BB_MEM(*root));
}

/* Arguments of a launch over one level. */
typedef struct level_job {
    hploc *self;
    uint32_t count;
} level_job;

static bb_status reduce_level(void *context, const bb_levels *levels, uint32_t n)
{
    const level_job *job = context;
    hploc *self = job->self;
    const bb_buffer *pairs = bb_pair_tree_pairs(self->base.pairs);
    const bb_buffer *root = bb_pair_tree_root(self->base.pairs);
    return bb_launch(self->base.device, self->last, bb_levels_items(levels), group_of(self),
                     BB_MEM(self->base.sorted.keys), BB_VALUE(job->count), BB_MEM(self->clusters),
                     BB_MEM(self->heads), BB_MEM(self->live), BB_MEM(self->splits),
                     BB_MEM(self->missing), BB_MEM(*pairs), BB_MEM(*root), BB_VALUE(n),
                     BB_MEM(levels->counts), BB_MEM(levels->lists[n % 2]),
                     BB_MEM(levels->lists[(n + 1) % 2]));
}

static bb_status cluster_on_gpu(hploc *self, const bb_scene *scene)
{
    const bb_ploc *base = &self->base;
    const bb_buffer *root = bb_pair_tree_root(base->pairs);
    const uint32_t count = scene->prim_count;
    level_job job = {self, count};
    BB_TRY(bb_launch(base->device, self->first, count, GROUP_SIZE, BB_MEM(scene->on_device.boxes),
                     BB_MEM(base->sorted.values), BB_VALUE(count), BB_MEM(self->clusters),
                     BB_MEM(self->heads), BB_MEM(*root)));
    BB_TRY(bb_levels_start(&self->levels));
    BB_TRY(bb_launch(base->device, self->ranges, count, GROUP_SIZE, BB_MEM(base->sorted.keys),
                     BB_VALUE(count), BB_MEM(self->splits), BB_MEM(self->missing),
                     BB_MEM(self->levels.counts), BB_MEM(self->levels.lists[1])));
    return bb_levels_run(&self->levels, reduce_level, &job);
}

static bb_status build(void *opaque, const bb_scene *scene, const bb_tree *input, bb_tree *tree,
                       bb_phases *phases)
{
    (void)input;
    hploc *self = opaque;
    BB_TRY(bb_sorted_codes_make(&self->base.sorted, scene, phases));
    BB_TRY(bb_phase(phases, "cluster"));
    BB_TRY(bb_cpu_form(self->base.device) ? cluster_on_cpu(self, scene)
                                          : cluster_on_gpu(self, scene));
    return bb_ploc_finish(&self->base, scene, tree, phases);
}

static void decide(void *opaque, const bb_scene *scene, bb_decisions *decisions)
{
    const hploc *self = opaque;
    bb_codes_decide(self->base.sorted.codes, scene, decisions);
}

static bb_status describe(void *opaque, const bb_scene *scene, char *text, size_t capacity)
{
    (void)scene;
    const hploc *self = opaque;
    bb_codes_describe(self->base.sorted.codes, text, capacity);
    return BB_OK;
}

const bb_builder bb_builder_hploc = {
    .abi_version = BB_ABI_VERSION,
    .name = "hploc",
    .summary = "PLOC among the few clusters that the children of a radix tree's node pass up",
    .paper = "Benthin et al. 2024",
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
