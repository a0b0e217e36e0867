/* LOBVH: inserts primitives into a dense loose octree by centroid and size, and compacts it into an
 * 8-ary tree.
 *
 * Gu, Jendersie, Grosch 2018 (Fast and Dynamic Construction of Bounding Volume Hierarchies based on
 * Loose Octrees), sections 3.1, 3.2 and 3.4. lobvh.cl has the algorithm and its arrays. What the
 * paper leaves open, and where this departs from it:
 *
 * - The root cell is a cube at the low corner of the scene's box, as long as its longest side.
 *   Cells in the proportions of the box gave trees of 27 to 39 % higher cost in flat scenes, and up
 *   to 10 % lower cost in others.
 * - A measure of 0 would give an infinite level: it is clamped to the deepest. If all of a scene is
 *   at one point, everything is on level 0.
 * - A node with children and primitives gets a leaf with its primitives as its first child; a node
 *   without children is a leaf.
 * - A node without primitives and with a single child is replaced by that child; `chains=keep`
 *   keeps it, as the paper does. Its box equals its child's, so a ray that tests both gains nothing
 *   (without such nodes the SAH cost of real scenes is up to 17 % lower).
 * - The dense octree is kept in bits, so 8 to 10 levels are affordable; the paper reaches 8.
 *   `octree=arrays` keeps it in the paper's four arrays (lobvh_dense.h): the same tree.
 * - Spheres are measured by their box, whose sides are the diameter, rounded outwards.
 */
#include "builders/common/view_order.h"
#include "framework/builder/builder.h"
#include "lobvh_dense.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

BB_DEVICE_SOURCE(lobvh);

enum {
    LEVELS_MAX = 10, /* so that keys have 32 bits */
    GROUP_SIZE = 64,
    CHUNK_PRIMS = 2048, /* per work-item on CPUs */
    CHUNK_WORDS = 256,  /* the same, in words of eight octree nodes */
    BINARY_TREE_BYTES = 2 * sizeof(bb_node) + sizeof(uint32_t), /* per primitive */
};

static const bb_option options[] = {
    {"levels", "auto", "auto|1|2|3|4|5|6|7|8|9|10",
     "depth of the octree; auto: by the number of primitives"},
    {"side", "smallest", "smallest|largest|mean|volume",
     "measure of a box's size, which decides its level; volume: its cube root"},
    {"loose", "2", NULL, "size of an enlarged cell, in cells, above 1, up to 16"},
    {"fit", "yes", "yes|no", "put a box one level deeper if it fits into the enlarged cell there"},
    {"chains", "skip", "skip|keep", "nodes with a single child and nothing else"},
    {"octree", "bits", "bits|arrays",
     "how it is kept: in bits, or in the paper's four arrays, with chains=keep"},
    {"view", "none", NULL, BB_VIEW_ORDER_HELP},
    {.name = NULL},
};

typedef struct lobvh {
    bb_device *device;
    bb_account *account;
    uint32_t levels_given; /* 0: auto */
    float looseness;       /* a - 1 */
    bool chains;           /* keep nodes with one child */
    bool by_arrays;        /* by `dense`; no kernel but keys_kernel is needed */
    bb_lobvh_dense dense;
    const char *view;
    bb_primitives *primitives;
    cl_program program;
    cl_kernel keys_kernel, mark, vacancy, sizes, leaves, inner;
    bb_buffer bounds; /* two bb_box: bounds of the boxes; of the centroids */
    bb_buffer keys;
    bb_buffer values;
    bb_buffer occupied; /* the dense octree: see lobvh.cl */
    bb_buffer own;
    bb_buffer offsets;
    bb_buffer total;   /* u32: nodes below the root */
    bb_buffer heights; /* u8 per node of the tree */
    /* for the prepared scene */
    uint32_t levels;
    bb_axis_order order;
} lobvh;

static void destroy(void *opaque)
{
    lobvh *self = opaque;
    if (self == NULL)
        return;
    bb_buffer *const buffers[] = {&self->bounds, &self->keys,    &self->values, &self->occupied,
                                  &self->own,    &self->offsets, &self->total,  &self->heights};
    for (size_t i = 0; i < sizeof buffers / sizeof buffers[0]; i++)
        bb_buffer_release(buffers[i]);
    cl_kernel const kernels[] = {self->keys_kernel, self->mark,   self->vacancy,
                                 self->sizes,       self->leaves, self->inner};
    for (size_t i = 0; i < sizeof kernels / sizeof kernels[0]; i++)
        bb_kernel_release(kernels[i]);
    bb_program_release(self->program);
    bb_lobvh_dense_release(&self->dense);
    bb_primitives_destroy(self->primitives);
    free(self);
}

static bb_status compile(lobvh *self, const bb_spec *spec)
{
    static const char *const sides[] = {"smallest", "largest", "mean", "volume"};
    char defines[128];
    int side = 0;
    while (!bb_spec_is(spec, options, "side", sides[side]))
        side++;
    snprintf(defines, sizeof defines, "-DBB_SIDE=%d%s%s", side,
             bb_spec_is(spec, options, "fit", "yes") ? " -DBB_FIT" : "",
             self->chains ? " -DBB_CHAINS" : "");
    BB_TRY(bb_program_build(self->device, &bb_source_lobvh, defines, &self->program));
    BB_TRY(bb_kernel_get(self->program, "lobvh_keys", &self->keys_kernel));
    BB_TRY(bb_kernel_get(self->program, "lobvh_mark", &self->mark));
    BB_TRY(bb_kernel_get(self->program, "lobvh_vacancy", &self->vacancy));
    BB_TRY(bb_kernel_get(self->program, "lobvh_sizes", &self->sizes));
    BB_TRY(bb_kernel_get(self->program, "lobvh_leaves", &self->leaves));
    return bb_kernel_get(self->program, "lobvh_inner", &self->inner);
}

static bb_status create(const bb_builder_context *context, void **out)
{
    lobvh *self = calloc(1, sizeof *self);
    if (self == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    *out = self;
    self->device = context->device;
    self->account = context->account;
    self->chains = bb_spec_is(context->spec, options, "chains", "keep");
    self->by_arrays = bb_spec_is(context->spec, options, "octree", "arrays");
    if (self->by_arrays && !self->chains)
        return bb_fail(BB_INVALID, "builder lobvh: octree=arrays keeps chains, as published: take "
                                   "chains=keep with it");
    self->view = bb_spec_value(context->spec, options, "view");
    double loose;
    BB_TRY(bb_spec_double(context->spec, options, "loose", 1.001, 16, &loose));
    self->looseness = (float)(loose - 1);
    if (!bb_spec_is(context->spec, options, "levels", "auto")) {
        uint64_t levels;
        BB_TRY(bb_spec_u64(context->spec, options, "levels", 1, LEVELS_MAX, &levels));
        self->levels_given = (uint32_t)levels;
    }
    BB_TRY(bb_primitives_create(self->device, self->account, &self->primitives));
    if (self->by_arrays)
        BB_TRY(bb_lobvh_dense_create(self->device, self->account, &self->dense));
    return compile(self, context->spec);
}

/* ---- sizes ---- */

/* Returns the number of octree nodes above `level`. */
static uint32_t nodes_above(uint32_t level)
{
    return (uint32_t)((((uint64_t)1 << 3 * level) - 1) / 7);
}

/* Returns the number of words, each of eight siblings. */
static uint32_t words_of(uint32_t levels)
{
    return (nodes_above(levels) + 7) / 8;
}

static uint64_t own_bytes(uint32_t levels)
{
    return ((uint64_t)words_of(levels) + 3) / 4 * 4;
}

/* Returns the bytes of the octree in bits, and as it is kept: they grow with its depth, not with
 * the scene. */
static uint64_t bits_bytes(uint32_t levels)
{
    return (uint64_t)words_of(levels) * (8 + 4) + own_bytes(levels);
}

static uint64_t dense_bytes(const lobvh *self, uint32_t levels)
{
    return self->by_arrays ? bb_lobvh_dense_bytes(levels) : bits_bytes(levels);
}

static bool has_room(const lobvh *self, uint32_t levels)
{
    const bb_device *device = self->device;
    const uint64_t held = self->occupied.bytes + self->own.bytes + self->offsets.bytes +
                          bb_lobvh_dense_held(&self->dense);
    const uint64_t largest =
        self->by_arrays ? bb_lobvh_dense_largest(levels) : (uint64_t)words_of(levels) * 8;
    return largest <= device->largest_allocation &&
           dense_bytes(self, levels) <= device->global_bytes - device->bytes + held;
}

/* Returns the level of the median primitive by equation 1, as if it were a cube: deeper levels only
 * separate few and small primitives. A median of 0 gives the deepest level. */
static uint32_t level_of_median(const lobvh *self, const bb_scene *scene)
{
    double longest = 0;
    for (int k = 0; k < 3; k++)
        longest = fmax(longest, (double)scene->bounds.hi[k] - (double)scene->bounds.lo[k]);
    double limit = longest * (double)self->looseness, side = scene->profile.size_median / sqrt(3);
    uint32_t level = 0;
    while (level < LEVELS_MAX && side <= ldexp(limit, -(int)level - 1))
        level++;
    return level;
}

/* levels=auto: deep enough for the median primitive's size and for a cell per primitive, but not
 * deeper than needed to separate the centroids, and with arrays no larger than a binary tree over
 * the primitives. */
static uint32_t choose_levels(const lobvh *self, const bb_scene *scene)
{
    const uint64_t count = scene->prim_count;
    uint32_t levels = level_of_median(self, scene);
    while (levels < LEVELS_MAX && (uint64_t)1 << 3 * levels < count)
        levels++;
    if (scene->profile.octree_depth > 0 && scene->profile.octree_depth < levels)
        levels = scene->profile.octree_depth;
    while (levels > 1 && bits_bytes(levels) > count * BINARY_TREE_BYTES)
        levels--;
    return levels > 1 ? levels : 1;
}

static bb_status refuse(const lobvh *self)
{
    const bb_device *device = self->device;
    uint32_t fitting = self->levels;
    while (fitting > 0 && !has_room(self, fitting))
        fitting--;
    char advice[64] = "";
    if (fitting > 0)
        snprintf(advice, sizeof advice, ": take levels=%u or less", fitting);
    return bb_fail(BB_REFUSED,
                   "builder lobvh: levels=%u is a dense octree of %u nodes in %llu bytes, "
                   "%s has %llu left and allows %llu in a buffer%s",
                   self->levels, nodes_above(self->levels + 1),
                   (unsigned long long)dense_bytes(self, self->levels), device->name,
                   (unsigned long long)(device->global_bytes - device->bytes),
                   (unsigned long long)device->largest_allocation, advice);
}

static uint64_t least(uint64_t a, uint64_t b)
{
    return a < b ? a : b;
}

/* Returns the most nodes that the tree can have: a leaf per octree node with primitives, and the
 * nodes above them. */
static uint64_t tree_nodes_max(const lobvh *self, uint64_t count)
{
    uint64_t leaves = least(count, nodes_above(self->levels + 1)), inner = 0;
    for (uint32_t level = 0; level < self->levels; level++)
        inner += least(leaves, (uint64_t)1 << 3 * level);
    if (!self->chains) /* each inner node has at least two children */
        inner = least(inner, leaves - 1);
    return leaves + inner;
}

static bb_status reserve(lobvh *self, size_t bytes, const char *what, bb_buffer *buffer)
{
    return bb_buffer_reserve(self->device, self->account, bytes, what, buffer);
}

/* The octree in bits. */
static bb_status reserve_bits(lobvh *self, size_t nodes)
{
    const size_t words = words_of(self->levels);
    BB_TRY(reserve(self, words * 8, "lobvh: occupied nodes", &self->occupied));
    BB_TRY(reserve(self, own_bytes(self->levels), "lobvh: nodes with primitives", &self->own));
    BB_TRY(reserve(self, words * sizeof(uint32_t), "lobvh: offsets", &self->offsets));
    BB_TRY(reserve(self, sizeof(uint32_t), "lobvh: total", &self->total));
    return reserve(self, nodes, "lobvh: heights", &self->heights);
}

static bb_status prepare(void *opaque, const bb_scene *scene, bb_tree *tree)
{
    lobvh *self = opaque;
    size_t count = scene->prim_count;
    double direction[3];
    BB_TRY(bb_view_order(scene, self->view, "builder lobvh", direction));
    self->order = bb_axis_order_of(direction);
    self->levels = self->levels_given > 0 ? self->levels_given : choose_levels(self, scene);
    if (!has_room(self, self->levels))
        return refuse(self);
    const size_t nodes = tree_nodes_max(self, count);
    BB_TRY(self->by_arrays ? bb_lobvh_dense_reserve(&self->dense, self->levels)
                           : reserve_bits(self, nodes));
    BB_TRY(reserve(self, 2 * sizeof(bb_box), "lobvh: bounds", &self->bounds));
    BB_TRY(reserve(self, count * sizeof(uint32_t), "lobvh: keys", &self->keys));
    BB_TRY(reserve(self, count * sizeof(uint32_t), "lobvh: indices", &self->values));
    BB_TRY(bb_primitives_reserve(self->primitives, scene->prim_count, sizeof(uint32_t)));
    return bb_tree_reserve(tree, self->device, BB_ON_DEVICE, nodes, count);
}

/* ---- build ---- */

/* A work-item handles `chunk` of `count` elements on CPUs, one element on GPUs. */
typedef struct division {
    uint32_t chunk;
    size_t items;
    size_t group;
} division;

static division divide(const lobvh *self, uint32_t count, uint32_t chunk)
{
    if (self->device->form == BB_FORM_GPU)
        return (division){1, count, GROUP_SIZE};
    return (division){chunk, count / chunk + (count % chunk != 0), 1};
}

static bb_status make_keys(lobvh *self, const bb_buffer *boxes, uint32_t count)
{
    const bb_axis_order *order = &self->order;
    BB_TRY(bb_reduce_boxes(self->primitives, boxes, count, &self->bounds));
    return bb_launch(self->device, self->keys_kernel, count, GROUP_SIZE, BB_MEM(*boxes),
                     BB_MEM(self->bounds), BB_VALUE(count), BB_VALUE(self->levels),
                     BB_VALUE(self->looseness), BB_VALUE(order->axis[0]), BB_VALUE(order->axis[1]),
                     BB_VALUE(order->axis[2]), BB_VALUE(order->flips), BB_MEM(self->keys),
                     BB_MEM(self->values));
}

static bb_status sort(lobvh *self, uint32_t count)
{
    uint32_t bits = 32 - (uint32_t)__builtin_clz(nodes_above(self->levels + 1) - 1);
    return bb_sort_u32(self->primitives, &self->keys, &self->values, count, bits);
}

static bb_status set_pointers(lobvh *self, uint32_t count, bb_tree *tree)
{
    uint32_t inner = nodes_above(self->levels);
    division by = divide(self, count, CHUNK_PRIMS);
    BB_TRY(bb_buffer_fill(&self->occupied, (size_t)words_of(self->levels) * 8, 0));
    BB_TRY(bb_buffer_fill(&self->own, own_bytes(self->levels), 0));
    return bb_launch(self->device, self->mark, by.items, by.group, BB_MEM(self->keys),
                     BB_MEM(self->values), BB_VALUE(count), BB_VALUE(inner), BB_VALUE(by.chunk),
                     BB_MEM(self->occupied), BB_MEM(self->own), BB_MEM(tree->d_refs));
}

static bb_status find_vacancy(lobvh *self)
{
    for (uint32_t level = self->levels - 1; level-- > 0;) {
        uint32_t first = nodes_above(level), nodes = nodes_above(level + 1) - first;
        BB_TRY(bb_launch(self->device, self->vacancy, nodes, GROUP_SIZE, BB_MEM(self->occupied),
                         BB_MEM(self->occupied), BB_VALUE(first), BB_VALUE(nodes)));
    }
    return BB_OK;
}

static bb_status compact(lobvh *self)
{
    uint32_t words = words_of(self->levels);
    BB_TRY(bb_launch(self->device, self->sizes, words, GROUP_SIZE, BB_MEM(self->occupied),
                     BB_MEM(self->own), BB_VALUE(words), BB_MEM(self->offsets)));
    return bb_scan_u32(self->primitives, &self->offsets, &self->offsets, words, &self->total);
}

static bb_status link_leaves(lobvh *self, const bb_buffer *boxes, uint32_t count, bb_tree *tree)
{
    uint32_t inner = nodes_above(self->levels);
    division by = divide(self, count, CHUNK_PRIMS);
    BB_TRY(bb_buffer_fill(&tree->d_info, sizeof(bb_tree_info), 0));
    return bb_launch(self->device, self->leaves, by.items, by.group, BB_MEM(self->keys),
                     BB_MEM(self->values), BB_MEM(*boxes), BB_VALUE(count), BB_VALUE(inner),
                     BB_VALUE(by.chunk), BB_MEM(self->occupied), BB_MEM(self->own),
                     BB_MEM(self->offsets), BB_MEM(tree->d_nodes), BB_MEM(self->heights),
                     BB_MEM(tree->d_info));
}

static bb_status link_inner(lobvh *self, uint32_t count, bb_tree *tree)
{
    for (uint32_t level = self->levels; level-- > 0;) {
        uint32_t first = words_of(level), words = words_of(level + 1) - first;
        division by = divide(self, words, CHUNK_WORDS);
        BB_TRY(bb_launch(self->device, self->inner, by.items, by.group, BB_MEM(self->occupied),
                         BB_MEM(self->own), BB_MEM(self->offsets), BB_MEM(self->total),
                         BB_VALUE(count), BB_VALUE(first), BB_VALUE(words), BB_VALUE(by.chunk),
                         BB_MEM(tree->d_nodes), BB_MEM(self->heights), BB_MEM(tree->d_info)));
    }
    return BB_OK;
}

static bb_status build(void *opaque, const bb_scene *scene, const bb_tree *input, bb_tree *tree,
                       bb_phases *phases)
{
    (void)input;
    lobvh *self = opaque;
    const bb_buffer *boxes = &scene->on_device.boxes;
    uint32_t count = scene->prim_count;

    tree->duplicated = false;
    tree->disjoint = false;
    bb_tree_changed(tree);
    BB_TRY(bb_phase(phases, "initialization"));
    BB_TRY(make_keys(self, boxes, count));
    BB_TRY(bb_phase(phases, "sort"));
    BB_TRY(sort(self, count));
    if (self->by_arrays) {
        BB_TRY(bb_lobvh_dense_link(&self->dense, self->primitives, &self->keys, &self->values,
                                   boxes, count, self->levels, tree, phases));
        return bb_phase(phases, NULL);
    }
    BB_TRY(bb_phase(phases, "pointer setup"));
    BB_TRY(set_pointers(self, count, tree));
    BB_TRY(bb_phase(phases, "vacancy"));
    BB_TRY(find_vacancy(self));
    BB_TRY(bb_phase(phases, "compaction"));
    BB_TRY(compact(self));
    BB_TRY(bb_phase(phases, "link leaves"));
    BB_TRY(link_leaves(self, boxes, count, tree));
    BB_TRY(bb_phase(phases, "link inner"));
    BB_TRY(link_inner(self, count, tree));
    return bb_phase(phases, NULL);
}

static bb_status describe(void *opaque, const bb_scene *scene, char *text, size_t capacity)
{
    (void)scene;
    const lobvh *self = opaque;
    const bb_axis_order *order = &self->order;
    int used = snprintf(text, capacity, "octree of %u levels%s, %u dense nodes in %llu bytes",
                        self->levels, self->levels_given > 0 ? "" : " (auto)",
                        nodes_above(self->levels + 1),
                        (unsigned long long)dense_bytes(self, self->levels));
    if (strcmp(self->view, "none") != 0 && used > 0 && (size_t)used < capacity) {
        char axes[8] = "";
        for (int i = 0; i < 3; i++) {
            axes[2 * i] = (order->flips >> order->axis[i] & 1) != 0 ? '-' : '+';
            axes[2 * i + 1] = "xyz"[order->axis[i]];
        }
        snprintf(text + used, capacity - (size_t)used, ", ordered along %s", axes);
    }
    return BB_OK;
}

static void decide(void *opaque, const bb_scene *scene, bb_decisions *decisions)
{
    const lobvh *self = opaque;
    bb_decide_number(decisions, BB_DECIDED_LEVELS, self->levels,
                     self->levels_given > 0 ? BB_GIVEN : BB_BY_SCENE,
                     "the median primitive's is level %u, %u tell the centroids apart; arrays of "
                     "%llu bytes",
                     level_of_median(self, scene), scene->profile.octree_depth,
                     (unsigned long long)dense_bytes(self, self->levels));
}

static const bb_variants variants[] = {
    {BB_FOR_ALL, BB_ROLE_COMPARED, "lobvh"},
    {BB_FOR_ALL, BB_ROLE_GENEROUS, "lobvh:levels=9"},
    {0},
};

const bb_builder bb_builder_lobvh = {
    .abi_version = BB_ABI_VERSION,
    .name = "lobvh",
    .summary = "8-ary tree by a dense loose octree",
    .paper = "Gu, Jendersie, Grosch 2018, sections 3.1, 3.2, 3.4",
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
