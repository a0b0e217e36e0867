/* The wide layouts: host side of kernels/layout_wide.cl. */
#include "traversal/wide.h"

#include "framework/device/levels.h"
#include "traversal/cwbvh.h"
#include "traversal/leaf_prims.h"
#include "traversal/wide_direct.h"
#include "traversal/wide_native.h"

#include <stdio.h>
#include <stdlib.h>

enum {
    GROUP_SIZE = 64,
    LEVEL_ITEMS =
        4096, /* work-items per level, which share its nodes; their number is not known here */
    LEVELS_MAX = 1 << 20,
    LEVELS_AT_ONCE = 32, /* launches enqueued before asking whether there is a further level */
    DEEPER = 4,          /* level from which on a work-item opens everything below */
};

typedef struct wide_layout {
    const char *name;
    size_t node_bytes;
    bool compressed;
    bb_device *device;
    bb_account *account;
    bb_pairs pairs;
    cl_program program;
    cl_kernel parents_kernel, open, nodes, count, blocks;
    cl_kernel plan;               /* hand-over by a fence */
    cl_kernel plan_leaves, level; /* hand-over by levels */
    bb_levels plan_levels;
    bb_buffer pair_nodes;
    bb_buffer parents, missing; /* u32 per pair: the pair above; sides that are not finished */
    bb_buffer plans;            /* bb_wide_plan per pair */
    bb_buffer levels[2];        /* uint2 per pair: nodes of the current level, and of the next */
    bb_buffer state;            /* largest stack need; then number of nodes per level */
    bb_buffer index;            /* u32 per pair, and the total: its wide node */
    bb_buffer first;            /* u32 per reference, and the total: its leaf's first block */
    bb_wide_follow follow;
    bb_wide_native native;     /* for plan=native; zeroed for compressed nodes */
    bb_wide_direct direct;     /* for trees that it accepts; zeroed in the form for GPUs */
    bb_cwbvh_maker cwbvh;      /* for compressed nodes; otherwise zeroed */
    bb_leaf_prims *leaf_prims; /* for leaves of one primitive each */
    char defines[160];         /* for the programs */
    /* of the last layout */
    uint32_t block_count, node_count, root, stack_need;
} wide_layout;

void bb_wide_destroy(void *opaque)
{
    wide_layout *self = opaque;
    if (self == NULL)
        return;
    bb_buffer *const buffers[] = {&self->pair_nodes, &self->parents,   &self->missing,
                                  &self->plans,      &self->levels[0], &self->levels[1],
                                  &self->state,      &self->index,     &self->first};
    for (size_t i = 0; i < sizeof buffers / sizeof buffers[0]; i++)
        bb_buffer_release(buffers[i]);
    bb_pairs_destroy(&self->pairs);
    bb_wide_follow_release(&self->follow);
    bb_wide_native_release(&self->native);
    bb_wide_direct_release(&self->direct);
    bb_cwbvh_release(&self->cwbvh);
    bb_leaf_prims_destroy(self->leaf_prims);
    bb_kernel_release(self->parents_kernel);
    bb_kernel_release(self->plan);
    bb_kernel_release(self->plan_leaves);
    bb_kernel_release(self->level);
    bb_levels_release(&self->plan_levels);
    bb_kernel_release(self->open);
    bb_kernel_release(self->nodes);
    bb_kernel_release(self->count);
    bb_kernel_release(self->blocks);
    bb_program_release(self->program);
    free(self);
}

bb_status bb_wide_create(bb_device *device, bb_account *account, const char *name, uint32_t width,
                         bb_wide_form form, void **out)
{
    wide_layout *self = calloc(1, sizeof *self);
    if (self == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    *out = self;
    self->name = name;
    self->compressed = form == BB_WIDE_COMPRESSED;
    self->node_bytes = bb_layout_find(name)->node_bytes;
    self->device = device;
    self->account = account;
    self->follow = (bb_wide_follow){.device = device, .account = account, .width = width};
    char handover[96];
    bb_handover_defines(device, handover, sizeof handover);
    snprintf(self->defines, sizeof self->defines, "%s -DBB_WIDTH=%u -DBB_QUANTISED=%d%s", handover,
             width, form == BB_WIDE_QUANTISED, self->compressed ? " -DBB_COMPRESSED=1" : "");
    BB_TRY(bb_pairs_create(device, account, &self->pairs));
    BB_TRY(bb_leaf_prims_create(device, account, &self->leaf_prims));
    if (!self->compressed)
        self->native = (bb_wide_native){.device = device,
                                        .account = account,
                                        .primitives = self->pairs.primitives,
                                        .defines = self->defines};
    if (self->compressed)
        BB_TRY(
            bb_cwbvh_create(device, account, self->pairs.primitives, self->defines, &self->cwbvh));
    else if (bb_cpu_form(device))
        BB_TRY(bb_wide_direct_create(device, account, self->pairs.primitives, self->defines,
                                     &self->direct));
    BB_TRY(
        bb_program_build(device, bb_source_find("layout_wide.cl"), self->defines, &self->program));
    BB_TRY(bb_kernel_get(self->program, "wide_parents", &self->parents_kernel));
    if (device->handover == BB_HANDOVER_FENCE)
        BB_TRY(bb_kernel_get(self->program, "wide_plan", &self->plan));
    BB_TRY(bb_kernel_get(self->program, "plan_leaves", &self->plan_leaves));
    BB_TRY(bb_kernel_get(self->program, "plan_level", &self->level));
    BB_TRY(bb_kernel_get(self->program, "wide_open", &self->open));
    if (self->compressed)
        return BB_OK;
    BB_TRY(bb_kernel_get(self->program, "wide_nodes", &self->nodes));
    BB_TRY(bb_kernel_get(self->program, "wide_count", &self->count));
    BB_TRY(bb_kernel_get(self->program, "wide_blocks", &self->blocks));
    return BB_OK;
}

static bb_status reserve(wide_layout *self, size_t bytes, const char *what, bb_buffer *buffer)
{
    return bb_buffer_reserve(self->device, self->account, bytes, what, buffer);
}

/* Reads the last element of a scan over `count` elements. */
static bb_status read_total(const bb_buffer *scan, uint32_t count, uint32_t *total)
{
    return bb_buffer_read(scan, count * sizeof *total, sizeof *total, total);
}

/* Arguments of a launch over one level of pairs. */
typedef struct plan_job {
    wide_layout *self;
    uint32_t root;
} plan_job;

static bb_status plan_level(void *context, const bb_levels *levels, uint32_t n)
{
    const plan_job *job = context;
    wide_layout *self = job->self;
    return bb_launch(self->device, self->level, bb_levels_items(levels), GROUP_SIZE,
                     BB_MEM(self->pair_nodes), BB_VALUE(job->root), BB_MEM(self->parents),
                     BB_MEM(self->missing), BB_MEM(self->plans), BB_MEM(levels->lists[n % 2]),
                     BB_VALUE(n), BB_MEM(levels->counts), BB_MEM(levels->lists[(n + 1) % 2]));
}

static bb_status plan_by_levels(wide_layout *self, uint32_t count, uint32_t root, uint32_t most)
{
    plan_job job = {self, root};
    BB_TRY(bb_levels_reserve(&self->plan_levels, self->device, self->account, count, most,
                             "wide: levels of the plan"));
    BB_TRY(bb_levels_start(&self->plan_levels));
    BB_TRY(bb_launch(self->device, self->plan_leaves, count, GROUP_SIZE, BB_MEM(self->pair_nodes),
                     BB_VALUE(count), BB_VALUE(root), BB_MEM(self->parents), BB_MEM(self->missing),
                     BB_MEM(self->plans), BB_MEM(self->plan_levels.counts),
                     BB_MEM(self->plan_levels.lists[1])));
    return bb_levels_run(&self->plan_levels, plan_level, &job);
}

/* Computes how best to collapse each pair: self->plans. Clears the marks. `most`: levels of
 * pairs. */
static bb_status make_plans(wide_layout *self, uint32_t count, uint32_t root, uint32_t most)
{
    BB_TRY(reserve(self, count * sizeof(uint32_t), "wide: parents", &self->parents));
    BB_TRY(reserve(self, count * sizeof(uint32_t), "wide: sides to come", &self->missing));
    BB_TRY(bb_launch(self->device, self->parents_kernel, (size_t)count + 1, GROUP_SIZE,
                     BB_MEM(self->pair_nodes), BB_VALUE(count), BB_MEM(self->parents),
                     BB_MEM(self->missing), BB_MEM(self->index)));
    if (self->device->handover == BB_HANDOVER_LEVELS)
        return plan_by_levels(self, count, root, most);
    return bb_launch(self->device, self->plan, count, GROUP_SIZE, BB_MEM(self->pair_nodes),
                     BB_VALUE(count), BB_VALUE(root), BB_MEM(self->parents), BB_MEM(self->missing),
                     BB_MEM(self->plans));
}

/* Marks the pairs that become nodes in self->index, level by level from the root. */
static bb_status open_levels(wide_layout *self, const bb_layout_source *source, uint32_t pair_count,
                             uint32_t root)
{
    const bb_tree *tree = source->tree;
    uint64_t most = bb_pairs_levels(&tree->info) + 1;
    if (most > LEVELS_MAX)
        return bb_fail(BB_UNSUPPORTED, "layout %s takes trees of up to %d levels, not %llu",
                       self->name, LEVELS_MAX, (unsigned long long)most);
    size_t state_bytes = (most + 2) * sizeof(uint32_t);
    for (uint32_t i = 0; i < 2; i++)
        BB_TRY(reserve(self, pair_count * sizeof(cl_uint2), "wide: level", &self->levels[i]));
    BB_TRY(reserve(self, state_bytes, "wide: levels", &self->state));
    BB_TRY(bb_buffer_fill(&self->state, state_bytes, 0));
    const uint32_t start[2] = {root, 0}, one = 1, deeper = DEEPER,
                   greedy = source->plan == BB_PLAN_GREEDY;
    BB_TRY(bb_buffer_write(&self->levels[0], 0, sizeof start, start));
    BB_TRY(bb_buffer_write(&self->state, sizeof one, sizeof one, &one));
    uint32_t items = pair_count < LEVEL_ITEMS ? pair_count : LEVEL_ITEMS;
    for (uint32_t level = 0, left = 1; level < most && left > 0; level++) {
        BB_TRY(bb_launch(self->device, self->open, items, GROUP_SIZE, BB_MEM(self->pair_nodes),
                         BB_MEM(self->plans), BB_VALUE(greedy), BB_MEM(self->levels[level % 2]),
                         BB_VALUE(level), BB_VALUE(deeper), BB_MEM(self->state),
                         BB_MEM(self->index), BB_MEM(self->plans),
                         BB_MEM(self->levels[(level + 1) % 2])));
        if (level % LEVELS_AT_ONCE == LEVELS_AT_ONCE - 1)
            BB_TRY(bb_buffer_read(&self->state, (level + 2) * sizeof left, sizeof left, &left));
    }
    return bb_buffer_read(&self->state, 0, sizeof self->stack_need, &self->stack_need);
}

/* Leaves of one primitive each are records of one lane: a block of four would be three quarters
 * empty. */
static bool has_records(const bb_layout_source *source)
{
    const bb_tree_info *info = &source->tree->info;
    return source->leaf == 1 && info->leaf_count == info->ref_count;
}

/* Computes the first block of each leaf: self->first. */
static bb_status number_blocks(wide_layout *self, const bb_layout_source *source)
{
    const bb_tree *tree = source->tree;
    const bb_prim_ends ends = bb_scene_ends(source->scene);
    uint32_t count = tree->info.ref_count;
    size_t scan = (size_t)count + 1;
    BB_TRY(reserve(self, scan * sizeof(uint32_t), "wide: blocks of leaves", &self->first));
    BB_TRY(bb_launch(self->device, self->count, scan, GROUP_SIZE, BB_MEM(tree->d_refs),
                     BB_VALUE(count), BB_VALUE(ends), BB_MEM(self->first)));
    BB_TRY(bb_scan_u32(self->pairs.primitives, &self->first, &self->first, count + 1, NULL));
    return read_total(&self->first, count, &self->block_count);
}

/* Makes blocks from references: data->buffers[1]. */
static bb_status make_blocks(wide_layout *self, const bb_layout_source *source,
                             bb_layout_data *data)
{
    const bb_scene *scene = source->scene;
    const bb_tree *tree = source->tree;
    const bb_scene_device *geometry = &scene->on_device;
    const bb_prim_ends ends = bb_scene_ends(scene);
    uint32_t count = tree->info.ref_count;
    uint32_t words = bb_block_words(source->kinds, data->format);
    uint32_t fresh = !source->same_links;
    if (has_records(source)) {
        data->lanes = 1;
        return bb_leaf_prims_make(self->leaf_prims, source, &source->tree->d_refs, data->format,
                                  true, &data->buffers[1], &data->prims_bytes);
    }
    if (fresh)
        BB_TRY(number_blocks(self, source));
    size_t scan = (size_t)count + 1;
    size_t bytes = ((size_t)self->block_count + 1) * words * sizeof(uint32_t);
    BB_TRY(reserve(self, bytes, "wide: blocks of primitives", &data->buffers[1]));
    data->prims_bytes += bytes;
    return bb_launch(self->device, self->blocks, scan, GROUP_SIZE, BB_MEM(tree->d_refs),
                     BB_VALUE(count), BB_MEM(geometry->vertices), BB_MEM(geometry->prims),
                     BB_VALUE(ends), BB_VALUE(data->scale), BB_VALUE(data->format), BB_VALUE(words),
                     BB_MEM(self->first), BB_VALUE(fresh), BB_MEM(data->buffers[1]));
}

/* The opened pairs, for compressed nodes, in which siblings are adjacent: the root is number 0. */
static bb_opened opened_of(const wide_layout *self, uint32_t pair_count, uint32_t root)
{
    return (bb_opened){&self->pair_nodes, &self->index, &self->plans, pair_count, root};
}

/* Finds the pairs that become nodes, and their numbers: self->plans, self->index. */
static bb_status number_nodes(wide_layout *self, const bb_layout_source *source,
                              uint32_t pair_count, uint32_t root)
{
    size_t marks = ((size_t)pair_count + 1) * sizeof(uint32_t);
    BB_TRY(reserve(self, marks, "wide: numbering", &self->index));
    BB_TRY(reserve(self, pair_count * sizeof(bb_wide_plan), "wide: plans", &self->plans));
    BB_TRY(source->plan == BB_PLAN_GREEDY
               ? bb_buffer_fill(&self->index, marks, 0)
               : make_plans(self, pair_count, root, bb_pairs_stack_need(&source->tree->info)));
    BB_TRY(open_levels(self, source, pair_count, root));
    if (self->compressed) {
        const bb_opened opened = opened_of(self, pair_count, root);
        BB_TRY(bb_cwbvh_number(&self->cwbvh, source->tree, &opened));
        self->node_count = self->cwbvh.node_count;
        self->root = 0;
        return BB_OK;
    }
    BB_TRY(bb_scan_u32(self->pairs.primitives, &self->index, &self->index, pair_count + 1, NULL));
    BB_TRY(read_total(&self->index, pair_count, &self->node_count));
    return read_total(&self->index, root, &self->root);
}

/* Writes nodes from pairs, and their sides for layouts that follow. */
static bb_status write_nodes(wide_layout *self, const bb_layout_source *source, uint32_t pair_count,
                             uint32_t root, const bb_buffer *nodes)
{
    uint32_t ref_count = source->tree->info.ref_count, octants = source->octants;
    uint32_t single = has_records(source);
    /* not read if single: any buffer will do */
    const bb_buffer *first = single ? &self->index : &self->first;
    BB_TRY(bb_wide_follow_reserve(&self->follow, self->node_count));
    if (self->compressed) {
        const bb_opened opened = opened_of(self, pair_count, root);
        return bb_cwbvh_nodes(&self->cwbvh, source->tree, &opened, nodes, &self->follow.sides);
    }
    return bb_launch(self->device, self->nodes, pair_count, GROUP_SIZE, BB_MEM(self->pair_nodes),
                     BB_VALUE(pair_count), BB_MEM(self->plans), BB_MEM(self->index), BB_MEM(*first),
                     BB_VALUE(ref_count), BB_VALUE(single), BB_VALUE(octants), BB_MEM(*nodes),
                     BB_MEM(self->follow.sides));
}

/* Makes a layout without nodes: the root is the tree's only leaf, which starts at reference
 * `ref`. */
static bb_status make_root_leaf(wide_layout *self, const bb_layout_source *source, uint32_t ref,
                                bb_layout_data *data)
{
    data->stack_need = 0;
    BB_TRY(reserve(self, self->node_bytes, "wide: nodes", &data->buffers[0]));
    if (self->compressed) { /* its kernel needs the number of primitives */
        data->root = BB_LEAF_BIT | source->tree->info.ref_count;
        return bb_cwbvh_order_leaf(&self->cwbvh, source->tree);
    }
    data->root = ref;
    if (!has_records(source))
        BB_TRY(bb_buffer_read(&self->first, ref * sizeof ref, sizeof ref, &data->root));
    data->root |= BB_LEAF_BIT;
    return BB_OK;
}

/* Makes data->buffers[0], root and stack need. Called after the blocks, but for compressed nodes
 * before the primitives. */
static bb_status make_nodes(wide_layout *self, const bb_layout_source *source, bb_layout_data *data)
{
    const bb_tree *tree = source->tree;
    uint32_t pair_count = 0, root = self->pairs.made[0];
    data->levels = bb_pairs_stack_need(&tree->info); /* of the pairs: no wide node is deeper */
    if (!source->same_links)
        BB_TRY(bb_pairs_make(&self->pairs, source, &self->pair_nodes, &pair_count, &root));
    if ((root & BB_LEAF_BIT) != 0)
        return make_root_leaf(self, source, root & BB_INDEX_MASK, data);
    if (!source->same_links)
        BB_TRY(number_nodes(self, source, pair_count, root));
    data->root = self->root;
    data->stack_need = self->stack_need;
    BB_TRY(reserve(self, self->node_count * self->node_bytes, "wide: nodes", &data->buffers[0]));
    data->bytes += self->node_count * self->node_bytes;
    return source->same_links ? bb_wide_follow_boxes(&self->follow, &self->pairs, self->defines,
                                                     source, self->node_count, &data->buffers[0])
                              : write_nodes(self, source, pair_count, root, &data->buffers[0]);
}

bool bb_wide_collapses(const void *opaque, const bb_tree *tree)
{
    const wide_layout *self = opaque;
    return bb_wide_direct_takes(self->device, tree);
}

/* Makes the layout without pairs: layout_wide_direct.cl. */
static bb_status make_direct(wide_layout *self, const bb_layout_source *source,
                             bb_layout_data *data)
{
    bb_wide_direct *direct = &self->direct;
    if (!source->same_links)
        BB_TRY(bb_wide_direct_number(direct, source));
    BB_TRY(source->leaf == 1 ? make_blocks(self, source, data)
                             : bb_wide_direct_blocks(direct, source, data->format,
                                                     &data->buffers[1], &data->prims_bytes));
    data->levels = bb_pairs_stack_need(&source->tree->info);
    data->root = direct->root;
    data->stack_need = direct->stack_need;
    size_t bytes = direct->node_count * self->node_bytes;
    BB_TRY(reserve(self, bytes > 0 ? bytes : self->node_bytes, "wide: nodes", &data->buffers[0]));
    data->bytes += bytes;
    if (direct->node_count == 0) /* the root is a leaf */
        return BB_OK;
    if (source->same_links)
        return bb_wide_follow_boxes(&self->follow, NULL, self->defines, source, direct->node_count,
                                    &data->buffers[0]);
    BB_TRY(bb_wide_follow_reserve(&self->follow, direct->node_count));
    return bb_wide_direct_nodes(direct, source, &data->buffers[0], &self->follow.sides);
}

/* Makes the layout of the tree's own nodes: layout_wide_native.cl. */
static bb_status make_native(wide_layout *self, const bb_layout_source *source,
                             bb_layout_data *data)
{
    bb_wide_native *native = &self->native;
    const bb_tree_info *info = &source->tree->info;
    const bool single = has_records(source);
    if (single)
        BB_TRY(make_blocks(self, source, data));
    BB_TRY(bb_wide_native_number(native, source, self->follow.width, single, data->format,
                                 &data->buffers[1], &data->prims_bytes));
    data->root = native->root;
    data->levels = info->depth;
    data->stack_need = info->depth * (info->arity - (info->arity > 0)); /* at most */
    data->keeps_shape = true;
    const size_t bytes = native->node_count * self->node_bytes;
    BB_TRY(reserve(self, bytes > 0 ? bytes : self->node_bytes, "wide: nodes", &data->buffers[0]));
    data->bytes += bytes;
    if (native->node_count == 0) /* the root is a leaf */
        return BB_OK;
    if (!source->same_links) {
        BB_TRY(bb_wide_follow_reserve(&self->follow, native->node_count));
        BB_TRY(
            bb_wide_native_nodes(native, source, single, &data->buffers[0], &self->follow.sides));
        if (source->reach == NULL)
            return BB_OK;
    }
    return bb_wide_follow_boxes(&self->follow, NULL, self->defines, source, native->node_count,
                                &data->buffers[0]);
}

bb_status bb_wide_make(void *opaque, const bb_layout_source *source, bb_layout_data *data)
{
    wide_layout *self = opaque;
    data->buffer_count = 2;
    data->keeps_shape = false;
    if (source->plan == BB_PLAN_NATIVE)
        return make_native(self, source, data);
    if (!self->compressed && source->leaf > 0 && bb_wide_direct_takes(self->device, source->tree))
        return make_direct(self, source, data);
    if (self->compressed) {
        BB_TRY(make_nodes(self, source, data));
        return bb_leaf_prims_make(self->leaf_prims, source, &self->cwbvh.order, data->format, false,
                                  &data->buffers[1], &data->prims_bytes);
    }
    BB_TRY(make_blocks(self, source, data));
    return make_nodes(self, source, data);
}
