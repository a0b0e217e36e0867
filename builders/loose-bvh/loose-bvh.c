/* Loose BVH: a complete binary tree of 3N levels that is fixed before the scene is known. A
 * primitive goes to the level of its size and the node of its centre, regardless of other
 * primitives: nothing is searched, split or compared, so a frame in which everything moves costs as
 * much as any other.
 *
 * Eisemann, Grosch, Mueller, Magnor 2007 (Automatic Creation of Object Hierarchies for Ray Tracing
 * of Dynamic Scenes), section 3.2, algorithm 2. loose-bvh.cl has the algorithm. The tree is the
 * paper's without the nodes that its skip indices pass over. What the paper leaves open, and where
 * this departs from it:
 *
 * - The root cell is a cube at the low corner of the scene's box, as long as its longest side;
 *   root=box is the paper's. In a nearly flat box S / O is about 1 on the short axis for all
 *   primitives, and all go to the root. In an exactly flat box it is 0 / 0: such an axis is
 *   ignored, and so is one on which the primitive has no extent. If all axes are ignored the level
 *   is the deepest.
 * - Primitives are one level deeper than equation 3 says, in cells that may be half as large as the
 *   primitive; deeper=0 is the paper's. By the paper's rule two to eight triangles of a mesh share
 *   a cell, and many more where all are large relative to the scene. SAH relative to a binned build
 *   of the same frame, at worst over all frames: twist 1.12 (deeper=0: 1.58), a crowd that has just
 *   left the origin 1.30 (2.65), fourteen sequences at most 1.30.
 * - A centre at the far end of the scene would be in a cell beyond the last; it is put in the last.
 * - A node with primitives and children gets a leaf with its primitives as its first child, so
 *   nodes have up to three children; a node without children is a leaf. A leaf has all primitives
 *   of its node, however many.
 * - The paper allocates, clears and refits all 2^(3N + 1) - 1 nodes in each frame: 1 GB at N = 8.
 *   Here only nodes that exist take memory and time, at most two per primitive, and N goes up to
 *   10.
 * - Keys are in-order, not breadth-first, so that neighbours in the sorted order show which nodes
 *   stay.
 * - The paper's update inserts all primitives again, which equals another build, so there is no
 *   update. One that refits while no primitive changes its cell would never get to refit: cells are
 *   relative to the scene's box, which moves, too, so where all primitives move, most change their
 *   cells in each frame, and where 2 % move, 2 % do.
 * - Far outliers make cells large: with N = 10, primitives that are together and smaller than a
 *   thousandth of the scene become one list. This is a limit of the method.
 */
#include "framework/base/arithmetic.h"
#include "framework/builder/builder.h"
#include "loose_bvh_shared.h"

#include <stdio.h>
#include <stdlib.h>

BB_DEVICE_SOURCE(loose_bvh);

enum {
    LEVELS_MAX = 10, /* so that keys have 31 bits */
    GROUP_SIZE = 64,
    CHUNK_CPU = 2048, /* primitives per work-item when finding cells and making leaves */
    CHUNK_GPU = 8,
    CHUNK_CELLS = 1024, /* CPUs: cells per work-item when linking */
    LANES = 8,          /* CPUs: keys that a work-item computes at once */
};

static const bb_option options[] = {
    {"levels", "auto", "auto|1|2|3|4|5|6|7|8|9|10",
     "N: the deepest cells are 2^N per axis; auto: by the number of primitives"},
    {"deeper", "1", NULL,
     "levels by which primitives are below the cells of their size, 0 to 10; 0: as in the paper"},
    {"root", "cube", "cube|box", "root cell: a cube as long as the scene, or the scene's box"},
    {.name = NULL},
};

typedef struct loose_bvh {
    bb_device *device;
    bb_account *account;
    uint32_t levels_given; /* 0: auto */
    uint32_t deeper;
    bb_primitives *primitives;
    cl_program program;
    cl_kernel keys_kernel, heads_kernel, cells_kernel, leaves, spans_kernel;
    cl_kernel level;                  /* GPUs */
    cl_kernel chunks, rest_of_chunks; /* CPUs */
    bb_buffer bounds;                 /* two bb_box: bounds of the boxes; of the centroids */
    bb_buffer keys, values;
    bb_buffer heads, spans;         /* per chunk of primitives: see loose-bvh.cl */
    bb_buffer totals;               /* u32: number of cells; of third children */
    bb_buffer cells, starts, bases; /* per cell */
    bb_buffer splits;               /* u8 per cell, plus one */
    bb_buffer firsts, lasts;        /* per cell */
    bb_buffer heights;              /* u8 per node */
    bb_buffer rest, rest_counts;    /* per chunk of cells */
    uint32_t levels;                /* for the prepared scene */
} loose_bvh;

static void destroy(void *opaque)
{
    loose_bvh *self = opaque;
    if (self == NULL)
        return;
    bb_buffer *const buffers[] = {
        &self->bounds, &self->keys,  &self->values,  &self->heads, &self->spans,
        &self->totals, &self->cells, &self->starts,  &self->bases, &self->splits,
        &self->firsts, &self->lasts, &self->heights, &self->rest,  &self->rest_counts,
    };
    for (size_t i = 0; i < sizeof buffers / sizeof buffers[0]; i++)
        bb_buffer_release(buffers[i]);
    cl_kernel const kernels[] = {self->keys_kernel, self->heads_kernel,  self->cells_kernel,
                                 self->leaves,      self->spans_kernel,  self->level,
                                 self->chunks,      self->rest_of_chunks};
    for (size_t i = 0; i < sizeof kernels / sizeof kernels[0]; i++)
        bb_kernel_release(kernels[i]);
    bb_program_release(self->program);
    bb_primitives_destroy(self->primitives);
    free(self);
}

static bb_status compile(loose_bvh *self, const bb_spec *spec)
{
    char defines[64];
    snprintf(defines, sizeof defines, "-DBB_LANES=%d%s", bb_cpu_form(self->device) ? LANES : 1,
             bb_spec_is(spec, options, "root", "cube") ? " -DBB_CUBE" : "");
    BB_TRY(bb_program_build(self->device, &bb_source_loose_bvh, defines, &self->program));
    BB_TRY(bb_kernel_get(self->program, "loose_keys", &self->keys_kernel));
    BB_TRY(bb_kernel_get(self->program, "loose_heads", &self->heads_kernel));
    BB_TRY(bb_kernel_get(self->program, "loose_cells", &self->cells_kernel));
    BB_TRY(bb_kernel_get(self->program, "loose_leaves", &self->leaves));
    BB_TRY(bb_kernel_get(self->program, "loose_spans", &self->spans_kernel));
    BB_TRY(bb_kernel_get(self->program, "loose_level", &self->level));
    BB_TRY(bb_kernel_get(self->program, "loose_chunks", &self->chunks));
    return bb_kernel_get(self->program, "loose_rest", &self->rest_of_chunks);
}

static bb_status create(const bb_builder_context *context, void **out)
{
    loose_bvh *self = calloc(1, sizeof *self);
    if (self == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    *out = self;
    self->device = context->device;
    self->account = context->account;
    if (!bb_spec_is(context->spec, options, "levels", "auto")) {
        uint64_t levels;
        BB_TRY(bb_spec_u64(context->spec, options, "levels", 1, LEVELS_MAX, &levels));
        self->levels_given = (uint32_t)levels;
    }
    uint64_t deeper;
    BB_TRY(bb_spec_u64(context->spec, options, "deeper", 0, LEVELS_MAX, &deeper));
    self->deeper = (uint32_t)deeper;
    BB_TRY(bb_primitives_create(self->device, self->account, &self->primitives));
    return compile(self, context->spec);
}

/* ---- sizes ---- */

/* levels=auto: a surface of 4^N primitives of equal size meets about as many cells of level N; one
 * more level separates primitives that share one. */
static uint32_t choose_levels(uint64_t count)
{
    uint32_t levels = 1;
    while (levels < LEVELS_MAX && (uint64_t)1 << 2 * (levels - 1) < count)
        levels++;
    return levels;
}

static uint32_t chunk_size(const loose_bvh *self)
{
    return bb_cpu_form(self->device) ? CHUNK_CPU : CHUNK_GPU;
}

/* Returns the most cells that there can be, on all levels. */
static uint32_t cells_max(const loose_bvh *self, uint32_t count)
{
    uint64_t all = (((uint64_t)1 << 3 * (self->levels + 1)) - 1) / 7;
    return all < count ? (uint32_t)all : count;
}

typedef struct need {
    size_t bytes;
    const char *what;
    bb_buffer *buffer;
} need;

enum { NEEDS = 15 };

static void list_needs(loose_bvh *self, uint32_t count, need needs[NEEDS])
{
    const size_t word = sizeof(uint32_t), prims = count, cells = cells_max(self, count);
    const size_t chunks = bb_divide_up(count, chunk_size(self));
    const size_t parts = bb_cpu_form(self->device) ? bb_divide_up((uint32_t)cells, CHUNK_CELLS) : 0;
    const need list[NEEDS] = {
        {2 * sizeof(bb_box), "loose-bvh: bounds", &self->bounds},
        {prims * word, "loose-bvh: keys", &self->keys},
        {prims * word, "loose-bvh: indices", &self->values},
        {2 * chunks * word, "loose-bvh: cells of chunks", &self->heads},
        {chunks * BB_LOOSE_SPAN_WORDS * word, "loose-bvh: boxes across chunks", &self->spans},
        {2 * word, "loose-bvh: number of cells", &self->totals},
        {cells * word, "loose-bvh: cells", &self->cells},
        {(cells + 1) * word, "loose-bvh: starts of cells", &self->starts},
        {cells * word, "loose-bvh: places of children", &self->bases},
        {cells + 1, "loose-bvh: splits", &self->splits},
        {cells * word, "loose-bvh: first cells", &self->firsts},
        {cells * word, "loose-bvh: last cells", &self->lasts},
        {2 * cells - 1, "loose-bvh: heights", &self->heights},
        {parts * BB_LOOSE_REST_MAX * word, "loose-bvh: splits between chunks", &self->rest},
        {parts * word, "loose-bvh: numbers of splits between chunks", &self->rest_counts},
    };
    for (size_t i = 0; i < NEEDS; i++)
        needs[i] = list[i];
}

static uint64_t most(uint64_t a, uint64_t b)
{
    return a > b ? a : b;
}

/* Asks for all memory at once, so that a refusal comes before anything is allocated. The sort keeps
 * a copy of keys and indices. */
static bb_status require_room(const loose_bvh *self, const need needs[NEEDS], uint32_t count,
                              const bb_tree *tree)
{
    const bb_device *device = self->device;
    const uint64_t nodes = (2 * (uint64_t)cells_max(self, count) - 1) * sizeof(bb_node);
    const uint64_t refs = (uint64_t)count * sizeof(uint32_t);
    uint64_t total = most(nodes, tree->d_nodes.bytes) + most(refs, tree->d_refs.bytes) + 2 * refs;
    uint64_t held = tree->d_nodes.bytes + tree->d_refs.bytes, largest = nodes;
    for (size_t i = 0; i < NEEDS; i++) {
        total += most(needs[i].bytes, needs[i].buffer->bytes);
        held += needs[i].buffer->bytes;
        largest = most(largest, needs[i].bytes);
    }
    const uint64_t left = device->global_bytes - device->bytes + held;
    if (total <= left && largest <= device->largest_allocation)
        return BB_OK;
    return bb_fail(
        BB_REFUSED,
        "builder loose-bvh: levels=%u over %u primitives takes up to %llu bytes, %llu of "
        "them in one buffer; %s has %llu left and allows %llu in a buffer",
        self->levels, count, (unsigned long long)total, (unsigned long long)largest, device->name,
        (unsigned long long)left, (unsigned long long)device->largest_allocation);
}

static bb_status prepare(void *opaque, const bb_scene *scene, bb_tree *tree)
{
    loose_bvh *self = opaque;
    const uint32_t count = scene->prim_count;
    need needs[NEEDS];
    self->levels = self->levels_given > 0 ? self->levels_given : choose_levels(count);
    list_needs(self, count, needs);
    BB_TRY(require_room(self, needs, count, tree));
    for (size_t i = 0; i < NEEDS; i++)
        if (needs[i].bytes > 0)
            BB_TRY(bb_buffer_reserve(self->device, self->account, needs[i].bytes, needs[i].what,
                                     needs[i].buffer));
    BB_TRY(bb_primitives_reserve(self->primitives, count, sizeof(uint32_t)));
    return bb_tree_reserve(tree, self->device, BB_ON_DEVICE, 2 * (size_t)cells_max(self, count) - 1,
                           count);
}

/* ---- build ---- */

static bb_status make_keys(loose_bvh *self, const bb_buffer *boxes, uint32_t count)
{
    BB_TRY(bb_reduce_boxes(self->primitives, boxes, count, &self->bounds));
    return bb_launch(self->device, self->keys_kernel,
                     bb_divide_up(count, bb_cpu_form(self->device) ? LANES : 1), GROUP_SIZE,
                     BB_MEM(*boxes), BB_MEM(self->bounds), BB_VALUE(count), BB_VALUE(self->levels),
                     BB_VALUE(self->deeper), BB_MEM(self->keys), BB_MEM(self->values));
}

static size_t group_size(const loose_bvh *self)
{
    return bb_cpu_form(self->device) ? 1 : GROUP_SIZE;
}

static bb_status find_cells(loose_bvh *self, uint32_t count)
{
    const uint32_t chunk = chunk_size(self), chunks = bb_divide_up(count, chunk);
    const uint32_t bits = 3 * self->levels;
    BB_TRY(bb_launch(self->device, self->heads_kernel, chunks, group_size(self), BB_MEM(self->keys),
                     BB_VALUE(count), BB_VALUE(chunk), BB_VALUE(chunks), BB_MEM(self->heads)));
    BB_TRY(bb_scan_u32(self->primitives, &self->heads, &self->heads, 2 * chunks, NULL));
    return bb_launch(self->device, self->cells_kernel, chunks, group_size(self), BB_MEM(self->keys),
                     BB_VALUE(count), BB_VALUE(chunk), BB_VALUE(chunks), BB_VALUE(bits),
                     BB_MEM(self->heads), BB_MEM(self->totals), BB_MEM(self->cells),
                     BB_MEM(self->starts), BB_MEM(self->bases), BB_MEM(self->splits),
                     BB_MEM(self->firsts), BB_MEM(self->lasts), BB_MEM(self->spans));
}

static bb_status make_leaves(loose_bvh *self, const bb_buffer *boxes, uint32_t count, bb_tree *tree)
{
    const uint32_t chunk = chunk_size(self), chunks = bb_divide_up(count, chunk);
    BB_TRY(bb_launch(self->device, self->leaves, chunks, group_size(self), BB_MEM(self->values),
                     BB_MEM(*boxes), BB_VALUE(count), BB_VALUE(chunk), BB_MEM(self->heads),
                     BB_MEM(self->starts), BB_MEM(self->bases), BB_MEM(self->splits),
                     BB_MEM(self->totals), BB_MEM(self->spans), BB_MEM(tree->d_refs),
                     BB_MEM(tree->d_nodes), BB_MEM(self->heights), BB_MEM(tree->d_info)));
    return bb_launch(self->device, self->spans_kernel, chunks, GROUP_SIZE, BB_VALUE(count),
                     BB_VALUE(chunk), BB_VALUE(chunks), BB_MEM(self->heads), BB_MEM(self->starts),
                     BB_MEM(self->bases), BB_MEM(self->splits), BB_MEM(self->totals),
                     BB_MEM(self->spans), BB_MEM(tree->d_nodes), BB_MEM(self->heights),
                     BB_MEM(tree->d_info));
}

/* Launches for as many cells as possible, since only the device knows their number. */
static bb_status link_chunks(loose_bvh *self, uint32_t count, bb_tree *tree)
{
    const uint32_t chunk = CHUNK_CELLS, chunks = bb_divide_up(cells_max(self, count), chunk);
    BB_TRY(bb_launch(self->device, self->chunks, chunks, 1, BB_MEM(self->bases),
                     BB_MEM(self->splits), BB_MEM(self->totals), BB_VALUE(count), BB_VALUE(chunk),
                     BB_MEM(self->firsts), BB_MEM(self->lasts), BB_MEM(tree->d_nodes),
                     BB_MEM(self->heights), BB_MEM(tree->d_info), BB_MEM(self->rest),
                     BB_MEM(self->rest_counts)));
    return bb_launch(self->device, self->rest_of_chunks, 1, 1, BB_MEM(self->bases),
                     BB_MEM(self->splits), BB_MEM(self->totals), BB_VALUE(count), BB_VALUE(chunks),
                     BB_MEM(self->firsts), BB_MEM(self->lasts), BB_MEM(tree->d_nodes),
                     BB_MEM(self->heights), BB_MEM(tree->d_info), BB_MEM(self->rest),
                     BB_MEM(self->rest_counts));
}

static bb_status link_levels(loose_bvh *self, uint32_t count, bb_tree *tree)
{
    for (uint32_t depth = 3 * self->levels; depth > 0; depth--)
        BB_TRY(bb_launch(self->device, self->level, cells_max(self, count), GROUP_SIZE,
                         BB_MEM(self->bases), BB_MEM(self->splits), BB_MEM(self->totals),
                         BB_VALUE(count), BB_VALUE(depth), BB_MEM(self->firsts),
                         BB_MEM(self->lasts), BB_MEM(tree->d_nodes), BB_MEM(self->heights),
                         BB_MEM(tree->d_info)));
    return BB_OK;
}

static bb_status build(void *opaque, const bb_scene *scene, const bb_tree *input, bb_tree *tree,
                       bb_phases *phases)
{
    (void)input;
    loose_bvh *self = opaque;
    const bb_buffer *boxes = &scene->on_device.boxes;
    const uint32_t count = scene->prim_count;

    tree->duplicated = false;
    tree->disjoint = false;
    bb_tree_changed(tree);
    BB_TRY(bb_phase(phases, "keys"));
    BB_TRY(make_keys(self, boxes, count));
    BB_TRY(bb_phase(phases, "sort"));
    BB_TRY(bb_sort_u32(self->primitives, &self->keys, &self->values, count, 3 * self->levels + 1));
    BB_TRY(bb_phase(phases, "cells"));
    BB_TRY(find_cells(self, count));
    BB_TRY(bb_phase(phases, "leaves"));
    BB_TRY(make_leaves(self, boxes, count, tree));
    BB_TRY(bb_phase(phases, "link"));
    BB_TRY(bb_cpu_form(self->device) ? link_chunks(self, count, tree)
                                     : link_levels(self, count, tree));
    return bb_phase(phases, NULL);
}

/* Describes the cells per level, and the most primitives in one. */
static void describe_cells(const loose_bvh *self, const uint32_t *cells, const uint32_t *starts,
                           uint32_t count, char *text, size_t capacity)
{
    uint32_t shallowest = self->levels, longest = 0, above = 0;
    for (uint32_t c = 0; c < count; c++) {
        uint32_t level = self->levels - (uint32_t)__builtin_ctz(cells[c]) / 3;
        uint32_t size = starts[c + 1] - starts[c];
        shallowest = level < shallowest ? level : shallowest;
        longest = size > longest ? size : longest;
        above += level < self->levels ? size : 0;
    }
    snprintf(text, capacity,
             "N = %u%s: primitives on levels %u to %u, %.1f %% of them above the last; %u cells, "
             "at most %u primitives in one",
             self->levels, self->levels_given > 0 ? "" : " (auto)", shallowest, self->levels,
             100.0 * above / starts[count], count, longest);
}

static bb_status describe(void *opaque, const bb_scene *scene, char *text, size_t capacity)
{
    (void)scene;
    loose_bvh *self = opaque;
    uint32_t count;
    BB_TRY(bb_buffer_read(&self->totals, 0, sizeof count, &count));
    const size_t bytes = count * sizeof(uint32_t);
    uint32_t *cells = malloc(bytes), *starts = malloc(bytes + sizeof *starts);
    bb_status status =
        cells == NULL || starts == NULL ? bb_fail(BB_FAILED, "out of memory") : BB_OK;
    if (status == BB_OK)
        status = bb_buffer_read(&self->cells, 0, bytes, cells);
    if (status == BB_OK)
        status = bb_buffer_read(&self->starts, 0, bytes + sizeof *starts, starts);
    if (status == BB_OK)
        describe_cells(self, cells, starts, count, text, capacity);
    free(cells);
    free(starts);
    return status;
}

static void decide(void *opaque, const bb_scene *scene, bb_decisions *decisions)
{
    const loose_bvh *self = opaque;
    bb_decide_number(decisions, BB_DECIDED_LEVELS, self->levels,
                     self->levels_given > 0 ? BB_GIVEN : BB_BY_SCENE, "%u primitives ask for %u",
                     scene->prim_count, choose_levels(scene->prim_count));
}

static const bb_variants variants[] = {
    {BB_FOR_ALL, BB_ROLE_MOVING, "loose-bvh"},
    {BB_FOR_ALL, BB_ROLE_STRESSED, "loose-bvh:root=box"},
    {0},
};

const bb_builder bb_builder_loose_bvh = {
    .abi_version = BB_ABI_VERSION,
    .name = "loose-bvh",
    .summary = "binary tree over given cells: primitives by their middle, on the level of their "
               "size",
    .paper = "Eisemann, Grosch, Mueller, Magnor 2007, section 3.2",
    .kinds = BB_ALL_KINDS,
    .inputs = BB_INPUT_BOXES,
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
