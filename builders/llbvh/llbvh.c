/* LLBVH: a binary tree over the non-empty nodes of a loose octree, which keeps large primitives
 * near the root. Runs on the device.
 *
 * Gu, Jendersie, Grosch 2018 (Fast and Dynamic Construction of Bounding Volume Hierarchies based on
 * Loose Octrees), sections 3.1 and 3.3. Choices where the paper leaves something open:
 * - s0 for a scene whose box is no cube: the longest side, so that cells are cubes. Where
 *   scenes are wide and low, cubes make the better tree (SAH relative to cells of the box's
 *   proportions: city 0.75, terrain 0.76, scorpion 0.97); elsewhere not always (mountain 1.02,
 *   coffee and interior 1.04, corridor 1.26). With box=scene and box=centroids cells have those
 *   proportions, and sizes are compared per axis (loose_octree.clh).
 * - The fit test of section 3.1 is made for all measures. Spheres profit (SAH 0.91 and 0.95 in
 *   their two states); with the smallest side of triangles hardly any box passes it.
 * - "size information every two levels (6 bits) up to a specific level" (end of section 2):
 *   sizes=yes lowers levels to even ones, so that the code has a size after every 6 bits instead of
 *   every 3; upto=L is the level.
 * - Primitives of one octree node share a leaf, as in the paper, but no more than about `merge` of
 *   them, so that many duplicates do not become one long list; merge=0 is the paper's rule.
 *
 * The tree is not linked by algorithm 1, but as a radix tree over the nodes, with the same result;
 * radix_tree.cl explains why.
 */
#include "builders/common/radix_tree.h"
#include "builders/common/sorted_codes.h"
#include "framework/base/arithmetic.h"

#include <float.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

BB_DEVICE_SOURCE(llbvh);

enum {
    GROUP_SIZE = 64,
    LEVELS_MAX = 21,
    CHUNK_CPU = 4096, /* primitives per work-item when searching for leaves */
    CHUNK_GPU = 8,
};

static const bb_option options[] = {
    {"side", "smallest", "smallest|largest|mean|volume",
     "size of a box: a side, their mean, or the cube root of the volume"},
    {"loose", "2", NULL, "size of an enlarged cell, in cells, above 1"},
    {"fit", "yes", "yes|no", "put a box one level deeper if it fits there"},
    {"sizes", "no", "no|yes", "boxes on even levels only: size encoded every 6 bits"},
    {"upto", "21", NULL, "deepest level chosen by size, 0 to 21; anything smaller goes there too"},
    {"merge", "64", NULL,
     "approximate number of a node's primitives per leaf: a power of two; 0: no limit"},
    {"code", "mc32", BB_CODE_NAMES, "code; it sets the defaults of the options below"},
    {"bits", NULL, NULL,
     "bits of the code: three for each level of the octree; auto: as many as lower the cost"},
    {"axes", NULL, "xyz|extent|view", "order of the axes; view: by the view's direction"},
    {"box", "cube", "cube|scene|centroids", BB_CODE_BOX_HELP},
    {"expand", "shifts", "shifts|tables", "how bits are spread; the code is the same"},
    {"view", "none", NULL, BB_VIEW_ORDER_HELP},
    {"link", "apetrei", "apetrei|search", "how nodes are linked; the tree is the same"},
    {.name = NULL},
};

typedef struct llbvh {
    bb_device *device;
    bb_account *account;
    uint32_t upto, merge;
    const bb_builder_context *context;
    uint32_t key_bytes; /* size of the keys that the kernels are compiled for; 0: not compiled */
    double loose;
    bb_sorted_codes sorted; /* keys: codes, then preorder indices of nodes */
    bb_radix_tree *radix;
    cl_program program;
    cl_kernel place, heads, leaves;
    bb_buffer nodes;      /* node of each primitive, in the form that radix_tree.cl takes */
    bb_buffer places;     /* number of leaves before each chunk */
    bb_buffer leaf_nodes; /* node of each leaf */
    bb_radix_runs runs;
} llbvh;

static void release_program(llbvh *self)
{
    bb_kernel_release(self->place);
    bb_kernel_release(self->heads);
    bb_kernel_release(self->leaves);
    bb_program_release(self->program);
    bb_radix_tree_destroy(self->radix);
    self->place = self->heads = self->leaves = NULL;
    self->program = NULL;
    self->radix = NULL;
    self->key_bytes = 0;
}

static void destroy(void *opaque)
{
    llbvh *self = opaque;
    if (self == NULL)
        return;
    bb_buffer_release(&self->nodes);
    bb_buffer_release(&self->places);
    bb_buffer_release(&self->leaf_nodes);
    bb_buffer_release(&self->runs.starts);
    bb_buffer_release(&self->runs.total);
    release_program(self);
    bb_sorted_codes_release(&self->sorted);
    free(self);
}

/* Refuses codes in which a group of three bits does not halve all three axes, or a bit encodes a
 * size: here levels encode sizes. This depends only on the code, not on the scene, so any box of
 * three different sides shows it. */
static bb_status require_octree(const bb_builder_context *context)
{
    static const bb_box bounds[2] = {{.hi = {4, 2, 1}}, {.hi = {4, 2, 1}}};
    static const double direction[3] = {1, 2, 3};
    bb_code_choice choice;
    bb_code_pattern layout;
    BB_TRY(bb_code_choose(context->spec, context->options, &choice));
    bb_code_lay_out(&choice, bounds, direction, &layout);
    bool octree = layout.bits % 3 == 0 && layout.bits <= 3 * LEVELS_MAX;
    for (uint32_t i = 0; i + 2 < layout.bits; i += 3) {
        const uint8_t *axes = layout.axes + i;
        octree = octree && (1u << axes[0] | 1u << axes[1] | 1u << axes[2]) == 7;
    }
    if (!octree)
        return bb_fail(
            BB_INVALID,
            "%s: this code has no octree: it must have three bits for each of 1 to %d levels, one "
            "per axis, and none for sizes, as mc32 and mc64 have",
            context->spec->text, LEVELS_MAX);
    return BB_OK;
}

static bb_status read_options(llbvh *self, const bb_builder_context *context)
{
    uint64_t upto, merge;
    BB_TRY(require_octree(context));
    BB_TRY(bb_spec_u64(context->spec, options, "upto", 0, LEVELS_MAX, &upto));
    BB_TRY(bb_spec_u64(context->spec, options, "merge", 0, 1u << 30, &merge));
    BB_TRY(bb_spec_double(context->spec, options, "loose", 1.001, 1000, &self->loose));
    self->upto = (uint32_t)upto;
    while (merge > self->merge)
        self->merge = self->merge == 0 ? 1 : 2 * self->merge;
    return BB_OK;
}

static bb_status build_program(llbvh *self, const bb_builder_context *context)
{
    static const char *sides[][2] = {{"smallest", "-DBB_SIDE_SMALLEST"},
                                     {"largest", "-DBB_SIDE_LARGEST"},
                                     {"mean", "-DBB_SIDE_MEAN"},
                                     {"volume", "-DBB_SIDE_VOLUME"}};
    const char *side = NULL;
    for (size_t i = 0; i < sizeof sides / sizeof sides[0]; i++)
        if (bb_spec_is(context->spec, options, "side", sides[i][0]))
            side = sides[i][1];
    char defines[96];
    snprintf(defines, sizeof defines, "%s %s%s%s",
             bb_codes_key_bytes(self->sorted.codes) == 8 ? "-DBB_KEY64" : "", side,
             bb_spec_is(context->spec, options, "fit", "yes") ? " -DBB_FIT" : "",
             bb_spec_is(context->spec, options, "sizes", "yes") ? " -DBB_EVERY_OTHER" : "");
    BB_TRY(bb_program_build(self->device, &bb_source_llbvh, defines, &self->program));
    BB_TRY(bb_kernel_get(self->program, "llbvh_nodes", &self->place));
    BB_TRY(bb_kernel_get(self->program, "llbvh_heads", &self->heads));
    return bb_kernel_get(self->program, "llbvh_leaves", &self->leaves);
}

/* Compiles what depends on the size of keys, once that is known. */
static bb_status compile(llbvh *self)
{
    if (!bb_codes_key_changed(self->sorted.codes, self->key_bytes))
        return BB_OK;
    const uint32_t key_bytes = bb_codes_key_bytes(self->sorted.codes);
    release_program(self);
    BB_TRY(build_program(self, self->context));
    bool search = bb_spec_is(self->context->spec, options, "link", "search");
    bb_radix_kind kind = {.key_bytes = key_bytes,
                          .linking = search ? BB_LINK_KARRAS : BB_LINK_APETREI,
                          .nodes = true,
                          .runs = true};
    BB_TRY(bb_radix_tree_create(self->device, self->account, kind, &self->radix));
    self->key_bytes = key_bytes;
    return BB_OK;
}

static bb_status create(const bb_builder_context *context, void **out)
{
    llbvh *self = calloc(1, sizeof *self);
    if (self == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    *out = self;
    self->device = context->device;
    self->account = context->account;
    self->context = context;
    BB_TRY(read_options(self, context));
    BB_TRY(bb_sorted_codes_create(context, false, &self->sorted));
    return compile(self);
}

static uint32_t chunk_size(const llbvh *self)
{
    return bb_cpu_form(self->device) ? CHUNK_CPU : CHUNK_GPU;
}

static uint32_t chunk_count(const llbvh *self, uint32_t count)
{
    return bb_divide_up(count, chunk_size(self));
}

static bb_status prepare(void *opaque, const bb_scene *scene, bb_tree *tree)
{
    llbvh *self = opaque;
    size_t count = scene->prim_count, word = sizeof(uint32_t);
    BB_TRY(bb_sorted_codes_prepare(&self->sorted, scene, 3));
    BB_TRY(compile(self));
    uint32_t key_bytes = bb_codes_key_bytes(self->sorted.codes);
    const struct {
        size_t bytes;
        const char *what;
        bb_buffer *buffer;
    } needed[] = {
        {count * key_bytes, "llbvh: nodes", &self->nodes},
        {chunk_count(self, scene->prim_count) * word, "llbvh: places of leaves", &self->places},
        {count * key_bytes, "llbvh: nodes of leaves", &self->leaf_nodes},
        {(count + 1) * word, "llbvh: starts of leaves", &self->runs.starts},
        {word, "llbvh: number of leaves", &self->runs.total},
    };
    for (size_t i = 0; i < sizeof needed / sizeof needed[0]; i++)
        BB_TRY(bb_buffer_reserve(self->device, self->account, needed[i].bytes, needed[i].what,
                                 needed[i].buffer));
    return bb_radix_tree_reserve(self->radix, scene->prim_count, tree);
}

/* Computes key and node of each primitive from its code. */
static bb_status place_primitives(llbvh *self, const bb_scene *scene)
{
    const bb_code_pattern *layout = bb_codes_pattern(self->sorted.codes);
    cl_float4 reach = {{0}}, low = {{0}}, scale = {{0}};
    for (int k = 0; k < 3; k++) {
        low.s[k] = layout->plan.low[k];
        scale.s[k] = layout->plan.scale[k];
        if (scale.s[k] > 0) /* sides[2]: sides of the root's children */
            reach.s[k] = (float)((self->loose - 1) * 2 * layout->sides[2][k]);
    }
    cl_float loose = (float)self->loose;
    uint32_t count = scene->prim_count, deepest = layout->bits / 3;
    return bb_launch(self->device, self->place, count, GROUP_SIZE, BB_MEM(scene->on_device.boxes),
                     BB_VALUE(count), BB_VALUE(reach), BB_VALUE(low), BB_VALUE(scale),
                     BB_VALUE(loose), BB_VALUE(deepest), BB_VALUE(self->upto),
                     BB_MEM(self->sorted.keys), BB_MEM(self->nodes));
}

/* Turns runs of equal keys into leaves. */
static bb_status merge_equal(llbvh *self, uint32_t count)
{
    uint32_t chunk = chunk_size(self), chunks = chunk_count(self, count);
    size_t group = bb_cpu_form(self->device) ? 1 : GROUP_SIZE;
    BB_TRY(bb_launch(self->device, self->heads, chunks, group, BB_MEM(self->sorted.keys),
                     BB_VALUE(count), BB_VALUE(self->merge), BB_VALUE(chunk),
                     BB_MEM(self->places)));
    BB_TRY(bb_scan_u32(self->sorted.primitives, &self->places, &self->places, chunks,
                       &self->runs.total));
    return bb_launch(self->device, self->leaves, chunks, group, BB_MEM(self->sorted.keys),
                     BB_VALUE(count), BB_VALUE(self->merge), BB_VALUE(chunk), BB_MEM(self->places),
                     BB_MEM(self->sorted.values), BB_MEM(self->nodes), BB_MEM(self->leaf_nodes),
                     BB_MEM(self->runs.starts));
}

static bb_status build(void *opaque, const bb_scene *scene, const bb_tree *input, bb_tree *tree,
                       bb_phases *phases)
{
    (void)input;
    llbvh *self = opaque;
    uint32_t count = scene->prim_count;
    bb_sorted_codes *sorted = &self->sorted;
    BB_TRY(bb_codes_make(sorted->codes, sorted->primitives, scene, &sorted->keys, &sorted->values,
                         phases));
    BB_TRY(bb_phase(phases, "levels"));
    BB_TRY(place_primitives(self, scene));
    BB_TRY(bb_sorted_codes_sort(sorted, count, bb_codes_bits(sorted->codes) + 1, phases));
    BB_TRY(bb_phase(phases, "merge"));
    BB_TRY(merge_equal(self, count));
    BB_TRY(bb_phase(phases, "link"));
    BB_TRY(bb_radix_tree_link(self->radix, &self->leaf_nodes, &self->runs, &sorted->values,
                              &scene->on_device.boxes, count, tree));
    return bb_phase(phases, NULL);
}

/* Describes the levels of the octree with primitives, the leaves, and the most primitives in
 * one. */
static void describe_leaves(const llbvh *self, const bb_scene *scene, const void *nodes,
                            const uint32_t *starts, uint32_t leaves, char *text, size_t capacity)
{
    bool wide = bb_codes_key_bytes(self->sorted.codes) == 8;
    uint32_t deepest = bb_codes_bits(self->sorted.codes) / 3;
    uint32_t first = deepest, last = 0, most = 0, at_deepest = 0;
    for (uint32_t i = 0; i < leaves; i++) {
        /* a path: steps from the top bit on, a 1, zeros */
        uint32_t steps = wide ? 63u - (uint32_t)__builtin_ctzll(((const uint64_t *)nodes)[i])
                              : 31u - (uint32_t)__builtin_ctz(((const uint32_t *)nodes)[i]);
        uint32_t level = steps / 3, size = starts[i + 1] - starts[i];
        first = level < first ? level : first;
        last = level > last ? level : last;
        most = size > most ? size : most;
        at_deepest += level == deepest ? size : 0;
    }
    snprintf(
        text, capacity,
        "octree levels %u to %u of %u, %.1f %% of the primitives on the last; %u leaves for %u, "
        "at most %u in one",
        first, last, deepest, 100.0 * at_deepest / scene->prim_count, leaves, scene->prim_count,
        most);
}

static bb_status describe(void *opaque, const bb_scene *scene, char *text, size_t capacity)
{
    llbvh *self = opaque;
    uint32_t leaves;
    BB_TRY(bb_buffer_read(&self->runs.total, 0, sizeof leaves, &leaves));
    size_t node_bytes = (size_t)leaves * bb_codes_key_bytes(self->sorted.codes);
    size_t start_bytes = ((size_t)leaves + 1) * sizeof(uint32_t);
    void *nodes = malloc(node_bytes), *starts = malloc(start_bytes);
    bb_status status =
        nodes == NULL || starts == NULL ? bb_fail(BB_FAILED, "out of memory") : BB_OK;
    if (status == BB_OK)
        status = bb_buffer_read(&self->leaf_nodes, 0, node_bytes, nodes);
    if (status == BB_OK)
        status = bb_buffer_read(&self->runs.starts, 0, start_bytes, starts);
    if (status == BB_OK)
        describe_leaves(self, scene, nodes, starts, leaves, text, capacity);
    free(nodes);
    free(starts);
    return status;
}

static void decide(void *opaque, const bb_scene *scene, bb_decisions *decisions)
{
    const llbvh *self = opaque;
    bb_codes_decide(self->sorted.codes, scene, decisions);
}

static const bb_variants variants[] = {
    {BB_FOR_ALL, BB_ROLE_COMPARED, "llbvh"},
    {BB_FOR_ALL, BB_ROLE_LEAST, "llbvh:bits=auto"},
    {BB_FOR_ALL, BB_ROLE_GENEROUS, "llbvh:bits=63"},
    {0},
};

const bb_builder bb_builder_llbvh = {
    .abi_version = BB_ABI_VERSION,
    .name = "llbvh",
    .summary = "binary tree over the nodes of a loose octree: large primitives near the root",
    .paper = "Gu, Jendersie, Grosch 2018, sections 3.1 and 3.3",
    .kinds = BB_ALL_KINDS,
    .inputs = BB_INPUT_BOXES | BB_INPUT_PROFILE,
    .place = BB_ON_DEVICE,
    .deterministic = true,
    .options = options,
    .variants = variants,
    .create = create,
    .prepare = prepare,
    .build = build,
    .describe = describe,
    .decide = decide,
    .destroy = destroy,
};
