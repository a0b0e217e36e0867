/* OLBVH: an octree over the cells of a grid, each of which lists all primitives whose boxes meet
 * it. Runs on the device.
 *
 * Stroeter, Mueller-Roemer, Stork, Fellner 2020 (OLBVH: octree linear bounding volume hierarchy for
 * volumetric meshes), section 3: depth by the primitives' sizes, Morton codes of all cells of each
 * primitive's quantised box, sort, splits by level, six arrays; here also the links of the common
 * tree. Departures and corrections:
 * - Equations 3 and 4 round to the nearest of 2^l grid points, and algorithm 1 takes cells from one
 *   point to the next, so primitives stick out of their cells by up to half a cell, and l = 0
 *   divides by 0. Here cells are between 2^l + 1 planes (kernels/cell_grid.clh).
 * - Equation 9 needs >= where a level has a single node.
 * - Algorithm 2 finds children level by level, by the positions where they end. Here nodes that end
 *   at one position have adjacent slots before they are sorted by level, so the last child of a
 *   node is in the slot after its own, and one pass links them all.
 * - BF is whether the tree's side array `cells` counts references to boundary primitives below a
 *   node; those of a leaf come first. CO and PO are its side arrays `co` and `po`, PO
 *   without its last entry, the number of references.
 * - A node's flag comes from a prefix sum over the references' flags, not from a loop over them.
 * - Cells list primitives by their boxes, so a cell without boundary primitives can still be
 *   outside the mesh: to infer "inside", also test a point (kernels/locate.clh).
 *
 * Memory for references is allocated once their number is known; more than fit are refused.
 */
#include "olbvh.h"

#include "framework/base/arithmetic.h"
#include "framework/builder/builder.h"
#include "kernels/cell_grid_shared.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

BB_DEVICE_SOURCE(olbvh);

enum {
    GROUP_SIZE = 64,
    CHUNK = 256,
    LEVEL_BITS = 4,
    REFS_MAX = 0x7FFFFFFF,
    LEVELS_MAX = BB_CELL_BITS_MAX + 1
};

static const bb_option options[] = {
    {"alpha", "0", NULL, "levels by which cells are coarser than primitives, 0 to 10"},
    {"bits", "auto", NULL, "2^bits cells along an axis, 0 to 10; auto: by the primitives' sizes"},
    {.name = NULL},
};

enum { SIZES, COUNTS, CODES, SPLITS, ENDS, OFFSETS, NODES, UNIONS, INFO, KERNELS };

static const char *const kernel_names[KERNELS] = {"olbvh_sizes",  "olbvh_counts", "olbvh_codes",
                                                  "olbvh_splits", "olbvh_ends",   "olbvh_offsets",
                                                  "olbvh_nodes",  "olbvh_unions", "olbvh_info"};

typedef struct olbvh {
    bb_device *device;
    bb_account *account;
    double alpha;
    uint32_t bits; /* as given; BB_NONE: auto */
    bb_primitives *primitives;
    cl_program program;
    cl_kernel kernels[KERNELS];
    bb_buffer bounds;           /* two bb_box */
    bb_buffer sums;             /* per chunk of primitives */
    bb_buffer counts;           /* cells of each primitive of the boundary, of each other; then
                                             * its first reference */
    bb_buffer codes, refs;      /* MC, P */
    bb_buffer splits, boundary; /* per reference, then exclusive prefix sums */
    bb_buffer total, marked;    /* totals of these */
    bb_buffer levels, slots, ends, node_of; /* per node */
    bb_buffer no;
    bb_buffer arity;
    /* for the last build */
    bb_cell_grid grid;
    double average; /* of equation 11, over all primitives */
    uint32_t primitive_count, reference_count, node_count;
    uint32_t level_ends[LEVELS_MAX]; /* NO */
} olbvh;

static void destroy(void *opaque)
{
    olbvh *self = opaque;
    if (self == NULL)
        return;
    bb_buffer *buffers[] = {&self->bounds,  &self->sums,   &self->counts,   &self->codes,
                            &self->refs,    &self->splits, &self->boundary, &self->total,
                            &self->marked,  &self->levels, &self->slots,    &self->ends,
                            &self->node_of, &self->no,     &self->arity};
    for (size_t i = 0; i < sizeof buffers / sizeof buffers[0]; i++)
        bb_buffer_release(buffers[i]);
    for (int i = 0; i < KERNELS; i++)
        bb_kernel_release(self->kernels[i]);
    bb_program_release(self->program);
    bb_primitives_destroy(self->primitives);
    free(self);
}

static bb_status create(const bb_builder_context *context, void **out)
{
    olbvh *self = calloc(1, sizeof *self);
    if (self == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    *out = self;
    self->device = context->device;
    self->account = context->account;
    self->bits = BB_NONE;
    BB_TRY(bb_spec_double(context->spec, options, "alpha", 0, BB_CELL_BITS_MAX, &self->alpha));
    if (!bb_spec_is(context->spec, options, "bits", "auto")) {
        uint64_t bits;
        BB_TRY(bb_spec_u64(context->spec, options, "bits", 0, BB_CELL_BITS_MAX, &bits));
        self->bits = (uint32_t)bits;
    }
    BB_TRY(bb_primitives_create(self->device, self->account, &self->primitives));
    BB_TRY(bb_program_build(self->device, &bb_source_olbvh, "", &self->program));
    for (int i = 0; i < KERNELS; i++)
        BB_TRY(bb_kernel_get(self->program, kernel_names[i], &self->kernels[i]));
    return BB_OK;
}

/* ---- how deep, how many ---- */

/* Sets the same steps and planes as on the device, for 2^bits cells along an axis. */
static void set_grid(olbvh *self, const bb_box *bounds, uint32_t bits)
{
    bb_cell_grid *grid = &self->grid;
    grid->bits = bits;
    grid->cells = 1u << bits;
    grid->pad = 0;
    for (int k = 0; k < 3; k++) {
        grid->lo[k] = bounds->lo[k];
        grid->hi[k] = bounds->hi[k];
        grid->step[k] = ldexpf(bounds->hi[k] - bounds->lo[k], -(int)bits);
        if (!isnormal(grid->step[k]))
            grid->step[k] = 0; /* flat, or nearly so */
    }
}

static uint32_t chunks_of(uint32_t count)
{
    return bb_divide_up(count, CHUNK);
}

/* Chooses the depth by equations 11 and 12. */
static bb_status choose_bits(olbvh *self, const bb_scene *scene, uint32_t *bits)
{
    const uint32_t count = scene->prim_count, chunks = chunks_of(count), chunk = CHUNK;
    uint32_t *sums = NULL;
    uint64_t sum = 0;
    BB_TRY(bb_launch(self->device, self->kernels[SIZES], chunks, GROUP_SIZE,
                     BB_MEM(scene->on_device.boxes), BB_VALUE(count), BB_VALUE(self->grid),
                     BB_VALUE(chunk), BB_MEM(self->sums)));
    void *mapped;
    BB_TRY(bb_buffer_map(&self->sums, false, &mapped));
    sums = mapped;
    for (uint32_t i = 0; i < chunks; i++)
        sum += sums[i];
    BB_TRY(bb_buffer_unmap(&self->sums, mapped));
    self->average = (double)sum / count;
    *bits = (uint32_t)fmin(fmax(floor(10.5 - (self->average + self->alpha)), 0), BB_CELL_BITS_MAX);
    return BB_OK;
}

/* Returns the most bytes needed during a build; a level has at most as many nodes as cells, and as
 * references. */
static uint64_t bytes_for(uint64_t references, uint32_t bits)
{
    uint64_t nodes = 0;
    for (uint32_t level = 0; level <= bits; level++)
        nodes += (uint64_t)1 << 3 * level < references ? (uint64_t)1 << 3 * level : references;
    return references * (2 + 2 + 1 + 2) * sizeof(uint32_t) /* including those of the sort */ +
           nodes * (9 * sizeof(uint32_t) + sizeof(bb_node));
}

static bb_status check_room(const olbvh *self, const bb_scene *scene, uint64_t references)
{
    const bb_device *device = self->device;
    /* memory of an earlier build is reused */
    const uint64_t own = self->account->bytes;
    const uint64_t others = device->bytes > own ? device->bytes - own : 0;
    const uint64_t left = device->global_bytes > others ? device->global_bytes - others : 0;
    uint64_t bytes = bytes_for(references, self->grid.bits);
    if (references <= REFS_MAX && bytes <= left)
        return BB_OK;
    return bb_fail(BB_REFUSED,
                   "olbvh: %u cells along an axis make %llu references of %u primitives, and about "
                   "%llu bytes; %s has %llu left: take fewer (alpha=%g, or bits=%u)",
                   self->grid.cells, (unsigned long long)references, scene->prim_count,
                   (unsigned long long)bytes, device->name, (unsigned long long)left,
                   fmin(self->alpha + 2, BB_CELL_BITS_MAX),
                   self->grid.bits > 2 ? self->grid.bits - 2 : 0);
}

/* Which primitives are of the boundary: arguments of kernels. */
typedef struct marks {
    const bb_buffer *flags; /* of tetrahedra; any buffer if there are none */
    uint32_t first, has;
} marks;

static marks marks_of(const olbvh *self, const bb_scene *scene)
{
    const bb_prims *tets = &scene->prims[BB_TETRAHEDRON];
    const bool has = tets->count > 0;
    return (marks){has ? &scene->on_device.tet_flags : &self->total, tets->first, has};
}

static bb_status count_references(olbvh *self, const bb_scene *scene)
{
    const marks m = marks_of(self, scene);
    const uint32_t count = scene->prim_count, chunks = chunks_of(count), chunk = CHUNK;
    uint64_t references = 0;
    void *mapped;
    BB_TRY(bb_launch(self->device, self->kernels[COUNTS], chunks, GROUP_SIZE,
                     BB_MEM(scene->on_device.boxes), BB_VALUE(count), BB_VALUE(self->grid),
                     BB_VALUE(chunk), BB_MEM(*m.flags), BB_VALUE(m.first), BB_VALUE(m.has),
                     BB_MEM(self->counts), BB_MEM(self->sums)));
    BB_TRY(bb_buffer_map(&self->sums, false, &mapped));
    for (uint32_t i = 0; i < chunks; i++)
        references += ((const uint64_t *)mapped)[i];
    BB_TRY(bb_buffer_unmap(&self->sums, mapped));
    BB_TRY(check_room(self, scene, references));
    self->primitive_count = count;
    self->reference_count = (uint32_t)references;
    return BB_OK;
}

typedef struct part {
    const char *what;
    bb_buffer *buffer;
} part;

/* Reserves `count` words for each part. */
static bb_status reserve_all(olbvh *self, size_t count, const part *parts, size_t part_count)
{
    for (size_t i = 0; i < part_count; i++)
        BB_TRY(bb_buffer_reserve(self->device, self->account, count * sizeof(uint32_t),
                                 parts[i].what, parts[i].buffer));
    return BB_OK;
}

#define RESERVE(self, count, ...)                                                                  \
    reserve_all((self), (count), (const part[]){__VA_ARGS__},                                      \
                sizeof((const part[]){__VA_ARGS__}) / sizeof(part))

static bb_status choose_grid(olbvh *self, const bb_scene *scene)
{
    bb_box bounds[2];
    uint32_t bits = self->bits;
    BB_TRY(bb_reduce_boxes(self->primitives, &scene->on_device.boxes, scene->prim_count,
                           &self->bounds));
    BB_TRY(bb_buffer_read(&self->bounds, 0, sizeof bounds, bounds));
    set_grid(self, &bounds[0], BB_CELL_BITS_MAX);
    self->average = NAN;
    if (bits == BB_NONE)
        BB_TRY(choose_bits(self, scene, &bits));
    set_grid(self, &bounds[0], bits);
    return BB_OK;
}

/* ---- references ---- */

static bb_status make_references(olbvh *self, const bb_scene *scene, bb_phases *phases)
{
    const uint32_t count = scene->prim_count, references = self->reference_count;
    const marks m = marks_of(self, scene);
    BB_TRY(RESERVE(self, references, {"olbvh: codes", &self->codes},
                   {"olbvh: references", &self->refs}, {"olbvh: splits", &self->splits},
                   {"olbvh: boundary references", &self->boundary}));
    BB_TRY(bb_scan_u32(self->primitives, &self->counts, &self->counts, 2 * count, NULL));
    BB_TRY(bb_launch(self->device, self->kernels[CODES], count, GROUP_SIZE,
                     BB_MEM(scene->on_device.boxes), BB_VALUE(count), BB_VALUE(self->grid),
                     BB_MEM(*m.flags), BB_VALUE(m.first), BB_VALUE(m.has), BB_MEM(self->counts),
                     BB_MEM(self->codes), BB_MEM(self->refs)));
    BB_TRY(bb_phase(phases, "sort"));
    return bb_sort_keys(self->primitives, 4, &self->codes, &self->refs, references,
                        3 * self->grid.bits);
}

/* ---- nodes ---- */

static bb_status count_nodes(olbvh *self, const bb_scene *scene)
{
    const uint32_t references = self->reference_count;
    const marks m = marks_of(self, scene);
    BB_TRY(bb_launch(self->device, self->kernels[SPLITS], references, GROUP_SIZE,
                     BB_MEM(self->codes), BB_MEM(self->refs), BB_VALUE(references),
                     BB_VALUE(self->grid.bits), BB_MEM(*m.flags), BB_VALUE(m.first),
                     BB_VALUE(m.has), BB_MEM(self->splits), BB_MEM(self->boundary)));
    BB_TRY(bb_scan_u32(self->primitives, &self->splits, &self->splits, references, &self->total));
    BB_TRY(
        bb_scan_u32(self->primitives, &self->boundary, &self->boundary, references, &self->marked));
    return bb_buffer_read(&self->total, 0, sizeof self->node_count, &self->node_count);
}

/* The tree's side arrays. */
typedef struct side_arrays {
    bb_tree_array *cells, *co, *po;
} side_arrays;

static bb_status reserve_tree(olbvh *self, bb_tree *tree, side_arrays *arrays)
{
    const uint32_t word = sizeof(uint32_t);
    BB_TRY(
        bb_tree_reserve(tree, self->device, BB_ON_DEVICE, self->node_count, self->reference_count));
    BB_TRY(bb_tree_reserve_array(tree, self->device, "cells", false, word, &arrays->cells));
    BB_TRY(bb_tree_reserve_array(tree, self->device, "co", false, word, &arrays->co));
    BB_TRY(bb_tree_reserve_array(tree, self->device, "po", false, word, &arrays->po));
    tree->duplicated = true;
    tree->disjoint = true;
    return BB_OK;
}

static bb_status sort_nodes(olbvh *self, const side_arrays *arrays)
{
    const uint32_t references = self->reference_count, nodes = self->node_count;
    BB_TRY(RESERVE(self, nodes, {"olbvh: levels", &self->levels}, {"olbvh: slots", &self->slots},
                   {"olbvh: ends", &self->ends}, {"olbvh: nodes of slots", &self->node_of}));
    BB_TRY(bb_launch(self->device, self->kernels[ENDS], references, GROUP_SIZE, BB_MEM(self->codes),
                     BB_VALUE(references), BB_VALUE(self->grid.bits), BB_MEM(self->splits),
                     BB_MEM(self->levels), BB_MEM(self->slots), BB_MEM(self->ends)));
    BB_TRY(bb_sort_keys(self->primitives, 4, &self->levels, &self->slots, nodes, LEVEL_BITS));
    BB_TRY(bb_launch(self->device, self->kernels[OFFSETS], nodes, GROUP_SIZE, BB_MEM(self->levels),
                     BB_MEM(self->slots), BB_VALUE(nodes), BB_VALUE(self->grid.bits),
                     BB_MEM(self->ends), BB_MEM(self->node_of), BB_MEM(arrays->po->buffer),
                     BB_MEM(self->no)));
    return bb_buffer_read(&self->no, 0, (self->grid.bits + 1) * sizeof(uint32_t), self->level_ends);
}

static bb_status make_nodes(olbvh *self, bb_tree *tree, const side_arrays *arrays)
{
    const uint32_t references = self->reference_count, nodes = self->node_count;
    const uint32_t bits = self->grid.bits, *ends = self->level_ends;
    const uint32_t leaves = nodes - (bits > 0 ? ends[bits - 1] : 0);
    BB_TRY(bb_buffer_fill(&self->arity, sizeof(uint32_t), 0));
    BB_TRY(bb_buffer_copy(&self->refs, &tree->d_refs, references * sizeof(uint32_t)));
    BB_TRY(bb_launch(self->device, self->kernels[NODES], nodes, GROUP_SIZE, BB_MEM(self->levels),
                     BB_MEM(self->slots), BB_VALUE(nodes), BB_VALUE(self->grid),
                     BB_VALUE(references), BB_MEM(self->codes), BB_MEM(self->splits),
                     BB_MEM(self->node_of), BB_MEM(arrays->po->buffer), BB_MEM(self->boundary),
                     BB_MEM(self->marked), BB_MEM(tree->d_refs), BB_MEM(arrays->co->buffer),
                     BB_MEM(tree->d_nodes), BB_MEM(arrays->cells->buffer), BB_MEM(self->arity)));
    for (uint32_t level = bits; level-- > 0;) {
        const uint32_t first = level > 0 ? ends[level - 1] : 0, count = ends[level] - first;
        BB_TRY(bb_launch(self->device, self->kernels[UNIONS], count, GROUP_SIZE,
                         BB_MEM(tree->d_nodes), BB_VALUE(first), BB_VALUE(count),
                         BB_MEM(arrays->co->buffer)));
    }
    return bb_launch(self->device, self->kernels[INFO], 1, 1, BB_MEM(tree->d_info), BB_VALUE(nodes),
                     BB_VALUE(leaves), BB_VALUE(references), BB_VALUE(bits), BB_MEM(self->arity));
}

static bb_status build(void *opaque, const bb_scene *scene, const bb_tree *input, bb_tree *tree,
                       bb_phases *phases)
{
    (void)input;
    olbvh *self = opaque;
    side_arrays arrays;
    BB_TRY(bb_phase(phases, "depth"));
    BB_TRY(choose_grid(self, scene));
    BB_TRY(bb_phase(phases, "codes"));
    BB_TRY(count_references(self, scene));
    BB_TRY(make_references(self, scene, phases));
    BB_TRY(bb_phase(phases, "splits"));
    BB_TRY(count_nodes(self, scene));
    BB_TRY(reserve_tree(self, tree, &arrays));
    BB_TRY(sort_nodes(self, &arrays));
    BB_TRY(bb_phase(phases, "nodes"));
    BB_TRY(make_nodes(self, tree, &arrays));
    return bb_phase(phases, NULL);
}

/* Reserves what is known beforehand; the rest depends on the number of references. */
static bb_status prepare(void *opaque, const bb_scene *scene, bb_tree *tree)
{
    olbvh *self = opaque;
    const size_t count = scene->prim_count;
    BB_TRY(RESERVE(self, 2 * count, {"olbvh: cells of primitives", &self->counts}));
    BB_TRY(RESERVE(self, 2 * (size_t)chunks_of(scene->prim_count), {"olbvh: sums", &self->sums}));
    BB_TRY(RESERVE(self, 1, {"olbvh: arity", &self->arity}, {"olbvh: nodes", &self->total},
                   {"olbvh: boundary references", &self->marked}));
    BB_TRY(RESERVE(self, LEVELS_MAX, {"olbvh: NO", &self->no}));
    BB_TRY(RESERVE(self, 2 * sizeof(bb_box) / sizeof(uint32_t), {"olbvh: bounds", &self->bounds}));
    return build(self, scene, NULL, tree, NULL);
}

static bb_status describe(void *opaque, const bb_scene *scene, char *text, size_t capacity)
{
    (void)scene;
    const olbvh *self = opaque;
    snprintf(text, capacity, "%u cells along an axis, %.2f references per primitive",
             self->grid.cells, (double)self->reference_count / self->primitive_count);
    return BB_OK;
}

static void decide(void *opaque, const bb_scene *scene, bb_decisions *decisions)
{
    (void)scene;
    const olbvh *self = opaque;
    if (self->bits == BB_NONE)
        bb_decide_number(decisions, BB_DECIDED_LEVELS, self->grid.bits, BB_BY_SCENE,
                         "primitives are 2^%.2f of the finest cells wide on average, alpha is %g",
                         self->average, self->alpha);
    else
        bb_decide_number(decisions, BB_DECIDED_LEVELS, self->grid.bits, BB_GIVEN, "bits=%u",
                         self->bits);
}

void olbvh_arrays_of(const void *opaque, olbvh_arrays *arrays)
{
    const olbvh *self = opaque;
    *arrays = (olbvh_arrays){self->node_count, self->reference_count, self->grid.bits + 1,
                             &self->codes, &self->no};
}

static const bb_variants variants[] = {
    {BB_FOR_ALL, BB_ROLE_MESHES, "olbvh,olbvh:alpha=1"},
    {BB_FOR_ALL, BB_ROLE_MESHES_LONG, "olbvh:alpha=2"},
    {0},
};

const bb_builder bb_builder_olbvh = {
    .abi_version = BB_ABI_VERSION,
    .name = "olbvh",
    .summary = "octree of cells that list all primitives meeting them, with boundary flags",
    .paper = "Stroeter, Mueller-Roemer, Stork, Fellner 2020, section 3",
    .kinds = BB_TRIANGLES | BB_AABBS | BB_TETRAHEDRONS,
    .inputs = BB_INPUT_BOXES | BB_INPUT_TETS,
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
