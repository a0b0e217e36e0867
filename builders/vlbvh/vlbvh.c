/* The LBVH of a sparse volume: of the bricks that a transfer function makes visible. Runs on the
 * device.
 *
 * Zellmann, Hellmann, Lang 2019 (A Linear Time BVH Construction Algorithm for Sparse Volumes),
 * section 3.2: vote, compact, Morton codes of 30 bits, sort, Karras' radix tree, boxes. What
 * differs, or is left open there:
 * - The paper votes on voxels: a brick is left out if none of its 8^3 voxels is visible. But values
 *   are interpolated between voxels, also of two bricks, and a transfer function may be visible
 *   between two values at which it is not. So the vote is on the range of values of all voxels of a
 *   brick's cells. vote=voxels reads them in each build, as the paper does; vote=ranges reads the
 *   range, which was computed when the volume was loaded. Both give the same tree.
 * - Boxes in the scene's units are made before the tree, not after it: nodes' boxes are unions of
 *   these, bit for bit the same either way.
 * - prune=P, which section 4 suggests but does not try: leaves are cubes of 2^P bricks a side in
 *   the codes' octree, or their visible part; the tree lacks P levels of the octree.
 * - The sort only uses the bits of the codes that the volume's bricks need.
 * - How many bricks are seen is known once they are compacted; memory is reserved before, outside
 *   of the build's time, for all of them. room=seen takes the number from the harness.
 */
#include "builders/common/compact.h"
#include "builders/common/radix_tree.h"
#include "framework/base/arithmetic.h"
#include "framework/builder/builder.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

BB_DEVICE_SOURCE(vlbvh);

enum { GROUP_SIZE = 64, CHUNK = 64, PRUNE_MAX = 5 };

static const bb_option options[] = {
    {"vote", "voxels", "voxels|ranges",
     "data read per brick: its voxels, or the range of their values, computed at loading"},
    {"prune", "0", "0|1|2|3|4|5", "leaves are the visible parts of cubes of 2^prune bricks a side"},
    {"room", "all", "all|seen",
     "memory for all bricks, or for as many as the harness knows to be seen; the tree is the same"},
    {"link", "karras", "apetrei|karras", "how nodes are linked; the tree is the same"},
    {.name = NULL},
};

typedef struct vlbvh {
    bb_device *device;
    bb_account *account;
    bool by_ranges, knows_seen;
    uint32_t prune;
    uint32_t bytes;        /* bytes per voxel that the kernels are compiled for; 0: not compiled */
    uint32_t bricks, seen; /* in the last build */
    bb_primitives *primitives;
    bb_compaction *compaction;
    bb_radix_tree *radix;
    cl_program program;
    cl_kernel vote, codes, boxes_of, heads, end;
    bb_buffer marks;  /* of bricks, then of the first ones of leaves */
    bb_buffer active; /* numbers of visible bricks */
    bb_buffer kept;   /* their number */
    bb_buffer keys;
    bb_buffer values;    /* numbers of primitives: places in `active` */
    bb_buffer boxes;     /* of primitives */
    bb_buffer leaf_keys; /* with prune */
    bb_radix_runs runs;
} vlbvh;

static void release_program(vlbvh *self)
{
    bb_kernel_release(self->vote);
    bb_kernel_release(self->codes);
    bb_kernel_release(self->boxes_of);
    bb_kernel_release(self->heads);
    bb_kernel_release(self->end);
    bb_program_release(self->program);
    self->vote = self->codes = self->boxes_of = self->heads = self->end = NULL;
    self->program = NULL;
    self->bytes = 0;
}

static void destroy(void *opaque)
{
    vlbvh *self = opaque;
    if (self == NULL)
        return;
    bb_buffer *buffers[] = {&self->marks,     &self->active,      &self->kept,
                            &self->keys,      &self->values,      &self->boxes,
                            &self->leaf_keys, &self->runs.starts, &self->runs.total};
    for (size_t i = 0; i < sizeof buffers / sizeof buffers[0]; i++)
        bb_buffer_release(buffers[i]);
    release_program(self);
    bb_radix_tree_destroy(self->radix);
    bb_compaction_destroy(self->compaction);
    bb_primitives_destroy(self->primitives);
    free(self);
}

static bb_status create(const bb_builder_context *context, void **out)
{
    vlbvh *self = calloc(1, sizeof *self);
    if (self == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    *out = self;
    self->device = context->device;
    self->account = context->account;
    self->by_ranges = bb_spec_is(context->spec, options, "vote", "ranges");
    self->knows_seen = bb_spec_is(context->spec, options, "room", "seen");
    uint64_t prune;
    BB_TRY(bb_spec_u64(context->spec, options, "prune", 0, PRUNE_MAX, &prune));
    self->prune = (uint32_t)prune;
    bool karras = bb_spec_is(context->spec, options, "link", "karras");
    bb_radix_kind kind = {
        .key_bytes = 4, .linking = karras ? BB_LINK_KARRAS : BB_LINK_APETREI, .runs = prune > 0};
    BB_TRY(bb_primitives_create(self->device, self->account, &self->primitives));
    BB_TRY(bb_compaction_create(self->device, self->account, self->primitives, &self->compaction));
    return bb_radix_tree_create(self->device, self->account, kind, &self->radix);
}

static bb_status compile(vlbvh *self, uint32_t bytes)
{
    if (self->bytes == bytes)
        return BB_OK;
    release_program(self);
    const char *vote = self->by_ranges             ? "vote_ranges"
                       : bb_cpu_form(self->device) ? "vote_voxels"
                                                   : "vote_voxels_group";
    char defines[64];
    snprintf(defines, sizeof defines, "-DBB_VOXEL=%s -DBB_GROUP=%d",
             bytes == 1 ? "uchar" : "ushort", GROUP_SIZE);
    BB_TRY(bb_program_build(self->device, &bb_source_vlbvh, defines, &self->program));
    BB_TRY(bb_kernel_get(self->program, vote, &self->vote));
    BB_TRY(bb_kernel_get(self->program, "brick_codes", &self->codes));
    BB_TRY(bb_kernel_get(self->program, "brick_boxes", &self->boxes_of));
    BB_TRY(bb_kernel_get(self->program, "brick_heads", &self->heads));
    BB_TRY(bb_kernel_get(self->program, "brick_end", &self->end));
    self->bytes = bytes;
    return BB_OK;
}

static bb_status prepare(void *opaque, const bb_scene *scene, bb_tree *tree)
{
    vlbvh *self = opaque;
    const bb_volume *volume = scene->volume;
    const size_t word = sizeof(uint32_t), bricks = volume->brick_count;
    const size_t room = self->knows_seen ? scene->prim_count : volume->brick_count;
    const size_t count = room > 0 ? room : 1;
    const size_t pruned = self->prune > 0 ? count : 1;
    const struct {
        size_t bytes;
        const char *what;
        bb_buffer *buffer;
    } needed[] = {
        {bricks * word, "vlbvh: marks", &self->marks},
        {count * word, "vlbvh: bricks that are seen", &self->active},
        {word, "vlbvh: their number", &self->kept},
        {count * word, "vlbvh: codes", &self->keys},
        {count * word, "vlbvh: indices", &self->values},
        {count * sizeof(bb_box), "vlbvh: boxes", &self->boxes},
        {pruned * word, "vlbvh: codes of leaves", &self->leaf_keys},
        {(pruned + 1) * word, "vlbvh: starts of leaves", &self->runs.starts},
        {word, "vlbvh: number of leaves", &self->runs.total},
    };
    BB_TRY(compile(self, volume->bytes));
    for (size_t i = 0; i < sizeof needed / sizeof needed[0]; i++)
        BB_TRY(bb_buffer_reserve(self->device, self->account, needed[i].bytes, needed[i].what,
                                 needed[i].buffer));
    BB_TRY(bb_compaction_reserve(self->compaction, volume->brick_count));
    BB_TRY(bb_primitives_reserve(self->primitives, (uint32_t)count, 4));
    return bb_radix_tree_reserve(self->radix, (uint32_t)count, tree);
}

static bb_status vote(vlbvh *self, const bb_scene *scene)
{
    const bb_scene_device *there = &scene->on_device;
    const bb_volume *volume = scene->volume;
    const uint32_t count = volume->brick_count, chunk = CHUNK;
    if (self->by_ranges)
        return bb_launch(self->device, self->vote, count, GROUP_SIZE, BB_MEM(there->ranges),
                         BB_VALUE(volume->grid), BB_VALUE(count), BB_MEM(there->seen),
                         BB_MEM(self->marks));
    size_t items =
        bb_cpu_form(self->device) ? bb_divide_up(count, CHUNK) : (size_t)count * GROUP_SIZE;
    return bb_launch(self->device, self->vote, items, bb_cpu_form(self->device) ? 1 : GROUP_SIZE,
                     BB_MEM(there->bricks), BB_VALUE(volume->grid), BB_VALUE(count),
                     BB_VALUE(chunk), BB_MEM(there->seen), BB_MEM(self->marks));
}

/* The harness has found the same bricks visible. */
static bb_status compact(vlbvh *self, const bb_scene *scene, uint32_t *count)
{
    BB_TRY(bb_compact_u32(self->compaction, &self->marks, NULL, scene->volume->brick_count,
                          &self->active, &self->kept));
    BB_TRY(bb_buffer_read(&self->kept, 0, sizeof *count, count));
    if (*count != scene->prim_count)
        return bb_fail(BB_FAILED, "vlbvh: sees %u bricks, the scene has %u", *count,
                       scene->prim_count);
    return BB_OK;
}

/* Returns the number of bits of the last brick's code: three per bit of its largest coordinate. */
static uint32_t code_bits(const bb_volume_grid *grid)
{
    uint32_t last = 0, bits = 0;
    for (int k = 0; k < 3; k++)
        last |= grid->bricks[k] - 1;
    while (last >> bits != 0)
        bits++;
    return 3 * bits;
}

/* Turns runs of equal codes into leaves. */
static bb_status merge(vlbvh *self, uint32_t count)
{
    BB_TRY(bb_launch(self->device, self->heads, count, GROUP_SIZE, BB_MEM(self->keys),
                     BB_VALUE(count), BB_MEM(self->marks)));
    BB_TRY(bb_compact_u32(self->compaction, &self->marks, &self->keys, count, &self->leaf_keys,
                          &self->runs.total));
    BB_TRY(bb_compact_u32(self->compaction, &self->marks, NULL, count, &self->runs.starts,
                          &self->runs.total));
    return bb_launch(self->device, self->end, 1, 1, BB_MEM(self->runs.total), BB_VALUE(count),
                     BB_MEM(self->runs.starts));
}

static bb_status leave_empty(bb_tree *tree)
{
    const bb_tree_info none = {.root = BB_NONE};
    return bb_buffer_write(&tree->d_info, 0, sizeof none, &none);
}

static bb_status build(void *opaque, const bb_scene *scene, const bb_tree *input, bb_tree *tree,
                       bb_phases *phases)
{
    (void)input;
    vlbvh *self = opaque;
    const bb_volume_grid *grid = &scene->volume->grid;
    const uint32_t bits = code_bits(grid), dropped = 3 * self->prune;
    uint32_t count;
    BB_TRY(bb_phase(phases, "vote"));
    BB_TRY(vote(self, scene));
    BB_TRY(bb_phase(phases, "compact"));
    BB_TRY(compact(self, scene, &count));
    self->bricks = scene->volume->brick_count;
    self->seen = count;
    if (count == 0)
        return leave_empty(tree);
    BB_TRY(bb_phase(phases, "codes"));
    BB_TRY(bb_launch(self->device, self->codes, count, GROUP_SIZE, BB_MEM(self->active),
                     BB_VALUE(*grid), BB_VALUE(count), BB_VALUE(dropped), BB_MEM(self->keys),
                     BB_MEM(self->values)));
    BB_TRY(bb_phase(phases, "boxes"));
    BB_TRY(bb_launch(self->device, self->boxes_of, count, GROUP_SIZE, BB_MEM(self->active),
                     BB_VALUE(*grid), BB_VALUE(count), BB_MEM(self->boxes)));
    BB_TRY(bb_phase(phases, "sort"));
    BB_TRY(bb_sort_keys(self->primitives, 4, &self->keys, &self->values, count,
                        bits > dropped ? bits - dropped : 0));
    BB_TRY(bb_phase(phases, "link"));
    if (self->prune > 0)
        BB_TRY(merge(self, count));
    BB_TRY(bb_radix_tree_link(self->radix, self->prune > 0 ? &self->leaf_keys : &self->keys,
                              self->prune > 0 ? &self->runs : NULL, &self->values, &self->boxes,
                              count, tree));
    return bb_phase(phases, NULL);
}

static bb_status describe(void *opaque, const bb_scene *scene, char *text, size_t capacity)
{
    (void)scene;
    const vlbvh *self = opaque;
    snprintf(text, capacity, "%u of %u bricks are seen, %.2f %%", self->seen, self->bricks,
             100.0 * self->seen / self->bricks);
    return BB_OK;
}

static const bb_variants variants[] = {
    {BB_FOR_ALL, BB_ROLE_VOLUMES, "vlbvh"},
    {0},
};

const bb_builder bb_builder_vlbvh = {
    .abi_version = BB_ABI_VERSION,
    .name = "vlbvh",
    .summary = "LBVH of a volume: finds the visible bricks, then Morton codes and radix tree",
    .paper = "Zellmann, Hellmann, Lang 2019, section 3.2",
    .kinds = BB_AABBS,
    .inputs = BB_INPUT_VOLUME,
    .place = BB_ON_DEVICE,
    .deterministic = true,
    .options = options,
    .variants = variants,
    .create = create,
    .prepare = prepare,
    .build = build,
    .describe = describe,
    .destroy = destroy,
};
