/* HLBVH: a binned SAH tree over clusters, with an LBVH inside each cluster. A cluster is a run of
 * primitives whose codes share their top bits. Runs on the device, over any code.
 *
 * Garanzha, Pantaleoni, McAllister 2011, "Simpler and Faster HLBVH with Work Queues". The paper's
 * text was not at hand: this was made from later papers and published code, and derived again.
 * hlbvh.cl and hlbvh_top.cl list the steps. Where this knowingly departs from the method, and what
 * was added:
 *
 * - Clusters are binned by the centroids of their boxes, within the bounds of the task's centroids,
 *   not by the code's grid: a code with sizes or uneven axes has no such grid.
 * - By default 15 bits are used for all scenes, as in published code. This gives between 400 and
 *   10,000 clusters; with many primitives the top tree takes little of the build's time.
 *   top-bits=auto uses as many bits as leave `each` primitives per cluster: it counts in which bit
 *   neighbours in the sorted order differ. A larger top tree gives a better tree and a slower
 *   build.
 * - Work queues are replaced by one launch per level and one for all small tasks, so no work-item
 *   waits for another.
 * - The whole radix tree is made first; the top tree replaces the nodes above the clusters, in
 *   place.
 *
 * top-bits=0 is the LBVH; top-bits=all is binned SAH over runs of equal codes.
 */
#include "builders/common/radix_tree.h"
#include "builders/common/refit.h"
#include "builders/common/sorted_codes.h"
#include "hlbvh_top.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

BB_DEVICE_SOURCE(hlbvh);

enum {
    GROUP_SIZE = 64,
    CHUNK_CPU = 2048, /* keys per work-item */
    CHUNK_GPU = 64,
    ALL_BITS = 64,
    AUTO_BITS = 65,
    EACH = 8, /* primitives per cluster with top-bits=auto */
};

static const bb_option options[] = {
    BB_CODE_OPTIONS("mc32"),
    {"top-bits", "15", NULL,
     "primitives whose codes agree in this many top bits form a cluster: 0 to 64, or all; "
     "auto: see `each`"},
    {"each", NULL, NULL,
     "top-bits=auto: fewest primitives per cluster on average, 1 to 1000000; default: 8"},
    {"bins", "32", NULL, "bins per axis of the top tree, 2 to 64"},
    {"weight", "clusters", "clusters|prims", "what the cost of the top tree counts"},
    BB_UPDATE_OPTION,
    {.name = NULL},
};

typedef struct hlbvh {
    bb_device *device;
    bb_account *account;
    uint32_t top_bits; /* as given: 0 to 64, or AUTO_BITS */
    bb_decider top_bits_by;
    uint32_t each;
    bool by_prims;
    bb_sorted_codes sorted;
    uint32_t key_bytes; /* size of the keys that the kernels are compiled for; 0: not compiled */
    bb_radix_tree *radix;
    hl_top *top;
    bb_refitter *refitter; /* NULL: moved primitives cause a rebuild */
    cl_program program;
    cl_kernel levels_kernel, counts_kernel, starts_kernel, gather;
    bb_buffer levels;        /* u32[HL_LEVELS] per chunk of keys */
    bb_buffer totals;        /* u32[HL_LEVELS] */
    bb_buffer counts;        /* u32 per chunk */
    bb_buffer starts;        /* u32 per cluster, and one more */
    bb_buffer items, roots;  /* per cluster */
    bb_buffer bounds;        /* two bb_box */
    uint32_t clusters, bits; /* of the last build */
} hlbvh;

static void release_kernels(hlbvh *self)
{
    bb_kernel_release(self->levels_kernel);
    bb_kernel_release(self->counts_kernel);
    bb_kernel_release(self->starts_kernel);
    bb_kernel_release(self->gather);
    bb_program_release(self->program);
    self->levels_kernel = self->counts_kernel = self->starts_kernel = self->gather = NULL;
    self->program = NULL;
    bb_radix_tree_destroy(self->radix);
    self->radix = NULL;
    self->key_bytes = 0;
}

static void destroy(void *opaque)
{
    hlbvh *self = opaque;
    if (self == NULL)
        return;
    bb_buffer *const buffers[] = {&self->levels, &self->totals, &self->counts, &self->starts,
                                  &self->items,  &self->roots,  &self->bounds};
    for (size_t i = 0; i < sizeof buffers / sizeof buffers[0]; i++)
        bb_buffer_release(buffers[i]);
    release_kernels(self);
    hl_top_destroy(self->top);
    bb_sorted_codes_release(&self->sorted);
    bb_refitter_destroy(self->refitter);
    free(self);
}

/* Compiles what depends on the size of keys, which is known once all options of the code are
 * settled. */
static bb_status compile(hlbvh *self)
{
    if (!bb_codes_key_changed(self->sorted.codes, self->key_bytes))
        return BB_OK;
    release_kernels(self);
    uint32_t key_bytes = bb_codes_key_bytes(self->sorted.codes);
    bb_radix_kind kind = {.key_bytes = key_bytes, .linking = BB_LINK_APETREI};
    char defines[64];
    snprintf(defines, sizeof defines, "%s%s", key_bytes == 8 ? "-DBB_KEY64 " : "",
             self->by_prims ? "-DHL_BY_PRIMS" : "");
    BB_TRY(bb_radix_tree_create(self->device, self->account, kind, &self->radix));
    BB_TRY(bb_program_build(self->device, &bb_source_hlbvh, defines, &self->program));
    BB_TRY(bb_kernel_get(self->program, "hl_levels", &self->levels_kernel));
    BB_TRY(bb_kernel_get(self->program, "hl_counts", &self->counts_kernel));
    BB_TRY(bb_kernel_get(self->program, "hl_starts", &self->starts_kernel));
    BB_TRY(bb_kernel_get(self->program, "hl_gather", &self->gather));
    self->key_bytes = key_bytes;
    return BB_OK;
}

static bb_status read_top_bits(const bb_spec *spec, uint32_t *bits)
{
    uint64_t number;
    *bits = AUTO_BITS;
    if (bb_spec_is(spec, options, "top-bits", "auto"))
        return BB_OK;
    *bits = ALL_BITS;
    if (bb_spec_is(spec, options, "top-bits", "all"))
        return BB_OK;
    BB_TRY(bb_spec_u64(spec, options, "top-bits", 0, ALL_BITS, &number));
    *bits = (uint32_t)number;
    return BB_OK;
}

static bb_status read_each(const bb_spec *spec, uint32_t top_bits, uint32_t *each)
{
    uint64_t number;
    *each = EACH;
    if (bb_spec_value(spec, options, "each") == NULL)
        return BB_OK;
    BB_TRY(bb_spec_u64(spec, options, "each", 1, 1000000, &number));
    if (top_bits != AUTO_BITS)
        return bb_fail(BB_INVALID, "builder hlbvh: option 'each' needs top-bits=auto");
    *each = (uint32_t)number;
    return BB_OK;
}

static bb_status create(const bb_builder_context *context, void **out)
{
    const bb_spec *spec = context->spec;
    uint64_t bins;
    uint32_t top_bits, each;
    BB_TRY(bb_spec_u64(spec, options, "bins", 2, 64, &bins));
    BB_TRY(read_top_bits(spec, &top_bits));
    BB_TRY(read_each(spec, top_bits, &each));
    hlbvh *self = calloc(1, sizeof *self);
    if (self == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    *out = self;
    self->device = context->device;
    self->account = context->account;
    self->top_bits = top_bits;
    self->top_bits_by = top_bits == AUTO_BITS             ? BB_BY_SCENE
                        : bb_spec_gives(spec, "top-bits") ? BB_GIVEN
                                                          : BB_BY_DEFAULT;
    self->each = each;
    self->by_prims = bb_spec_is(spec, options, "weight", "prims");
    BB_TRY(bb_sorted_codes_create(context, true, &self->sorted));
    BB_TRY(hl_top_create(self->device, self->account, (uint32_t)bins, self->by_prims, &self->top));
    BB_TRY(bb_refitter_choose(context, &self->refitter));
    return compile(self);
}

static uint32_t chunk_of(const hlbvh *self)
{
    return bb_cpu_form(self->device) ? CHUNK_CPU : CHUNK_GPU;
}

/* Returns the most clusters that `count` primitives can make. */
static uint32_t most_clusters(const hlbvh *self, uint32_t count)
{
    if (self->top_bits == AUTO_BITS)
        return count / self->each > 1 ? count / self->each : 1;
    return self->top_bits < 32 && UINT32_C(1) << self->top_bits < count
               ? UINT32_C(1) << self->top_bits
               : count;
}

static bb_status reserve_clusters(hlbvh *self, uint32_t count)
{
    bb_device *device = self->device;
    bb_account *account = self->account;
    size_t chunks = count / chunk_of(self) + 1, clusters = most_clusters(self, count);
    BB_TRY(bb_buffer_reserve(device, account, chunks * HL_LEVELS * sizeof(uint32_t),
                             "hlbvh: differing bits", &self->levels));
    BB_TRY(bb_buffer_reserve(device, account, HL_LEVELS * sizeof(uint32_t), "hlbvh: differing bits",
                             &self->totals));
    BB_TRY(bb_buffer_reserve(device, account, chunks * sizeof(uint32_t), "hlbvh: borders",
                             &self->counts));
    BB_TRY(bb_buffer_reserve(device, account, (clusters + 1) * sizeof(uint32_t), "hlbvh: starts",
                             &self->starts));
    BB_TRY(bb_buffer_reserve(device, account, clusters * sizeof(hl_item), "hlbvh: clusters",
                             &self->items));
    BB_TRY(bb_buffer_reserve(device, account, clusters * sizeof(hl_root), "hlbvh: roots",
                             &self->roots));
    BB_TRY(bb_buffer_reserve(device, account, 2 * sizeof(bb_box), "hlbvh: bounds", &self->bounds));
    return hl_top_reserve(self->top, (uint32_t)clusters);
}

static bb_status prepare(void *opaque, const bb_scene *scene, bb_tree *tree)
{
    hlbvh *self = opaque;
    size_t count = scene->prim_count;
    BB_TRY(bb_sorted_codes_prepare(&self->sorted, scene, 1));
    BB_TRY(compile(self));
    BB_TRY(bb_refitter_reserve(self->refitter, 2 * count - 1));
    BB_TRY(reserve_clusters(self, scene->prim_count));
    return bb_radix_tree_reserve(self->radix, scene->prim_count, tree);
}

/* Chooses the number of top bits, and of clusters, from how many neighbours first differ in each
 * bit. */
static void choose_bits(hlbvh *self, const uint32_t totals[HL_LEVELS], uint32_t count)
{
    uint32_t bits = bb_codes_pattern(self->sorted.codes)->bits, most = most_clusters(self, count);
    self->bits = 0;
    self->clusters = 1;
    while (self->bits < bits && self->bits < self->top_bits &&
           self->clusters + totals[self->bits] <= most)
        self->clusters += totals[self->bits++];
}

static bb_status find_clusters(hlbvh *self, uint32_t count)
{
    bb_device *device = self->device;
    uint32_t chunk = chunk_of(self), chunks = count / chunk + 1;
    size_t group = bb_cpu_form(device) ? 1 : GROUP_SIZE;
    uint32_t bits = bb_codes_pattern(self->sorted.codes)->bits, totals[HL_LEVELS];
    BB_TRY(bb_buffer_fill(&self->totals, sizeof totals, 0));
    BB_TRY(bb_buffer_fill(&self->levels, chunks * sizeof totals, 0));
    BB_TRY(bb_launch(device, self->levels_kernel, chunks, group, BB_MEM(self->sorted.keys),
                     BB_VALUE(count), BB_VALUE(bits), BB_VALUE(chunk), BB_MEM(self->levels),
                     BB_MEM(self->totals)));
    BB_TRY(bb_buffer_read(&self->totals, 0, sizeof totals, totals));
    choose_bits(self, totals, count);
    BB_TRY(bb_launch(device, self->counts_kernel, chunks, GROUP_SIZE, BB_MEM(self->levels),
                     BB_VALUE(chunks), BB_VALUE(self->bits), BB_MEM(self->counts)));
    BB_TRY(bb_scan_u32(self->sorted.primitives, &self->counts, &self->counts, chunks, NULL));
    return bb_launch(device, self->starts_kernel, chunks, group, BB_MEM(self->sorted.keys),
                     BB_VALUE(count), BB_VALUE(bits), BB_VALUE(self->bits), BB_VALUE(chunk),
                     BB_MEM(self->counts), BB_VALUE(self->clusters), BB_MEM(self->starts));
}

/* Replaces the nodes above the clusters by the top tree. */
static bb_status make_top(hlbvh *self, uint32_t count, bb_tree *tree, bb_phases *phases)
{
    hl_clusters clusters = {.count = self->clusters,
                            .starts = &self->starts,
                            .items = &self->items,
                            .roots = &self->roots};
    uint32_t levels;
    BB_TRY(bb_launch(self->device, self->gather, clusters.count, GROUP_SIZE,
                     BB_MEM(self->sorted.keys), BB_VALUE(count), BB_MEM(self->starts),
                     BB_VALUE(clusters.count), BB_MEM(tree->d_nodes),
                     BB_MEM(*bb_radix_tree_heights(self->radix)), BB_MEM(self->items),
                     BB_MEM(self->roots), BB_MEM(tree->d_info)));
    BB_TRY(bb_reduce_boxes(self->sorted.primitives, &self->items, clusters.count, &self->bounds));
    BB_TRY(bb_buffer_read(&self->bounds, 0, sizeof clusters.bounds, clusters.bounds));
    BB_TRY(bb_phase(phases, "top"));
    BB_TRY(hl_top_make(self->top, &clusters, tree, &levels));
    return bb_event(phases, "levels", levels);
}

static bb_status build(void *opaque, const bb_scene *scene, const bb_tree *input, bb_tree *tree,
                       bb_phases *phases)
{
    (void)input;
    hlbvh *self = opaque;
    uint32_t count = scene->prim_count;
    BB_TRY(bb_sorted_codes_make(&self->sorted, scene, phases));
    BB_TRY(bb_phase(phases, "link"));
    BB_TRY(bb_radix_tree_link(self->radix, &self->sorted.keys, NULL, &self->sorted.values,
                              &scene->on_device.boxes, count, tree));
    BB_TRY(bb_phase(phases, "clusters"));
    BB_TRY(find_clusters(self, count));
    BB_TRY(bb_event(phases, "clusters", self->clusters));
    if (self->clusters > 1)
        BB_TRY(make_top(self, count, tree, phases));
    return bb_phase(phases, NULL);
}

static bb_status update(void *opaque, const bb_scene *scene, uint32_t changed, bb_tree *tree,
                        bb_phases *phases)
{
    return bb_refit_update(((hlbvh *)opaque)->refitter, scene, changed, tree, phases);
}

static bb_status describe(void *opaque, const bb_scene *scene, char *text, size_t capacity)
{
    const hlbvh *self = opaque;
    char code[BB_CODE_TEXT];
    bb_codes_describe(self->sorted.codes, code, sizeof code);
    snprintf(text, capacity, "%u clusters of %u primitives, by %u bits; %s%s", self->clusters,
             scene->prim_count, self->bits, code,
             self->clusters == 1 ? "; one cluster: this is the LBVH" : "");
    return BB_OK;
}

static void decide(void *opaque, const bb_scene *scene, bb_decisions *decisions)
{
    const hlbvh *self = opaque;
    bb_codes_decide(self->sorted.codes, scene, decisions);
    bb_decide_number(decisions, "top bits", self->bits, self->top_bits_by,
                     "%u clusters of %u primitives", self->clusters, scene->prim_count);
}

static const bb_variants variants[] = {
    {BB_FOR_ALL, BB_ROLE_COMPARED, "hlbvh"},
    {0},
};

const bb_builder bb_builder_hlbvh = {
    .abi_version = BB_ABI_VERSION,
    .name = "hlbvh",
    .summary = "binned SAH over clusters of equal top bits, an LBVH in each",
    .paper = "Garanzha, Pantaleoni, McAllister 2011",
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
