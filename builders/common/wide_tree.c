#include "builders/common/wide_tree.h"

#include "builders/common/wide_tree_shared.h"
#include "framework/base/arithmetic.h"

#include <stdio.h>
#include <stdlib.h>

enum {
    GROUP_SIZE = 64,
    ITEMS_MAX = 1024,     /* on CPUs: items among which cores share the work ... */
    ITEMS_PER_UNIT = 32,  /* ... none of them much of it, ... */
    SHARE_LEAST = 1024,   /* ... but so many keys, since it takes time to start an item */
    ITEMS_PER_SHARE = 16, /* room for the items of a share, and those above */
    TURNS = 32,
    LEVEL_ITEMS = 1 << 14, /* on GPUs: work-items that share a level */
    LEVELS_AT_ONCE = 8,    /* enqueued before asking whether there is a further level */
};

struct bb_wide_tree {
    bb_device *device;
    bb_account *account;
    uint32_t leaf;
    cl_program program;
    cl_kernel top, cut, below, roof; /* form for CPUs */
    cl_kernel root, level, join;     /* form for GPUs */
    bb_buffer items[2];              /* bb_wide_item; of levels in turns, or all of the top */
    bb_buffer levels;                /* bb_wide_level; or the number of items of the top */
    bb_buffer cuts, counts;          /* form for CPUs: u32, BB_WIDE_WORDS per key; u32 per item */
};

static bb_status get_kernels(bb_wide_tree *wide, uint32_t key_bytes)
{
    char defines[48];
    snprintf(defines, sizeof defines, "-DBB_WIDE_CPU=%d%s", bb_cpu_form(wide->device),
             key_bytes == 8 ? " -DBB_KEY64" : "");
    BB_TRY(bb_program_build(wide->device, bb_source_find("wide_tree.cl"), defines, &wide->program));
    if (bb_cpu_form(wide->device)) {
        BB_TRY(bb_kernel_get(wide->program, "wide_top", &wide->top));
        BB_TRY(bb_kernel_get(wide->program, "wide_cut", &wide->cut));
        BB_TRY(bb_kernel_get(wide->program, "wide_below", &wide->below));
        return bb_kernel_get(wide->program, "wide_roof", &wide->roof);
    }
    BB_TRY(bb_kernel_get(wide->program, "wide_root", &wide->root));
    BB_TRY(bb_kernel_get(wide->program, "wide_level", &wide->level));
    return bb_kernel_get(wide->program, "wide_join", &wide->join);
}

bb_status bb_wide_tree_create(bb_device *device, bb_account *account, uint32_t key_bytes,
                              uint32_t leaf, bb_wide_tree **out)
{
    bb_wide_tree *wide = calloc(1, sizeof *wide);
    if (wide == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    wide->device = device;
    wide->account = account;
    wide->leaf = leaf;
    bb_status status = get_kernels(wide, key_bytes);
    if (status != BB_OK) {
        bb_wide_tree_destroy(wide);
        return status;
    }
    *out = wide;
    return BB_OK;
}

void bb_wide_tree_destroy(bb_wide_tree *wide)
{
    if (wide == NULL)
        return;
    const cl_kernel kernels[] = {wide->top,  wide->cut,   wide->below, wide->roof,
                                 wide->root, wide->level, wide->join};
    for (size_t i = 0; i < sizeof kernels / sizeof kernels[0]; i++)
        bb_kernel_release(kernels[i]);
    bb_program_release(wide->program);
    bb_buffer_release(&wide->items[0]);
    bb_buffer_release(&wide->items[1]);
    bb_buffer_release(&wide->levels);
    bb_buffer_release(&wide->cuts);
    bb_buffer_release(&wide->counts);
    free(wide);
}

/* Returns the most inner nodes: those with 8 children are at most a seventh of the leaves; the
 * children of others are leaves, of more references than one leaf holds. */
static size_t most_inner(const bb_wide_tree *wide, uint32_t count)
{
    return (size_t)count / (BB_WIDE_ARITY - 1) + count / (wide->leaf + 1) + 1;
}

size_t bb_wide_tree_nodes(const bb_wide_tree *wide, uint32_t count)
{
    return count + most_inner(wide, count);
}

static bb_status reserve(bb_wide_tree *wide, size_t bytes, const char *what, bb_buffer *buffer)
{
    return bb_buffer_reserve(wide->device, wide->account, bytes, what, buffer);
}

bb_status bb_wide_tree_reserve(bb_wide_tree *wide, uint32_t count, bb_tree *tree)
{
    const bool cpu = bb_cpu_form(wide->device);
    const size_t items = cpu ? ITEMS_MAX : most_inner(wide, count);
    BB_TRY(
        bb_tree_reserve(tree, wide->device, BB_ON_DEVICE, bb_wide_tree_nodes(wide, count), count));
    for (uint32_t i = 0; i < (cpu ? 1 : 2); i++)
        BB_TRY(reserve(wide, items * sizeof(bb_wide_item), "wide tree: nodes to open",
                       &wide->items[i]));
    if (cpu) {
        BB_TRY(reserve(wide, BB_WIDE_WORDS * (size_t)count * sizeof(uint32_t), "wide tree: cuts",
                       &wide->cuts));
        BB_TRY(
            reserve(wide, ITEMS_MAX * sizeof(uint32_t), "wide tree: nodes below", &wide->counts));
    }
    return reserve(wide, (BB_WIDE_LEVELS + LEVELS_AT_ONCE + 1) * sizeof(bb_wide_level),
                   "wide tree: levels", &wide->levels);
}

static bb_status make_depth_first(bb_wide_tree *wide, const bb_buffer *keys,
                                  const bb_buffer *values, const bb_buffer *boxes, uint32_t count,
                                  bb_tree *tree)
{
    const uint32_t leaf = wide->leaf, turns = TURNS,
                   even = count / (wide->device->compute_units * ITEMS_PER_UNIT),
                   share = even > SHARE_LEAST ? even : SHARE_LEAST,
                   wanted = bb_divide_up(count / share * ITEMS_PER_SHARE + 1, TURNS) * TURNS,
                   most = wanted < ITEMS_MAX ? wanted : ITEMS_MAX;
    BB_TRY(bb_launch(wide->device, wide->top, 1, 1, BB_MEM(*keys), BB_MEM(*values), BB_MEM(*boxes),
                     BB_VALUE(count), BB_VALUE(leaf), BB_VALUE(share), BB_VALUE(most),
                     BB_MEM(tree->d_nodes), BB_MEM(tree->d_refs), BB_MEM(tree->d_info),
                     BB_MEM(wide->items[0]), BB_MEM(wide->levels), BB_MEM(wide->counts)));
    BB_TRY(bb_launch(wide->device, wide->cut, most, 1, BB_MEM(*keys), BB_VALUE(count),
                     BB_VALUE(leaf), BB_VALUE(turns), BB_MEM(wide->items[0]), BB_MEM(wide->levels),
                     BB_MEM(wide->cuts), BB_MEM(wide->counts)));
    BB_TRY(bb_launch(wide->device, wide->below, most, 1, BB_MEM(*values), BB_MEM(*boxes),
                     BB_VALUE(leaf), BB_VALUE(turns), BB_MEM(tree->d_nodes), BB_MEM(tree->d_refs),
                     BB_MEM(tree->d_info), BB_MEM(wide->items[0]), BB_MEM(wide->levels),
                     BB_MEM(wide->cuts), BB_MEM(wide->counts)));
    return bb_launch(wide->device, wide->roof, 1, 1, BB_MEM(tree->d_nodes), BB_MEM(tree->d_info),
                     BB_MEM(wide->items[0]), BB_MEM(wide->levels), BB_MEM(wide->counts));
}

static bb_status make_by_levels(bb_wide_tree *wide, const bb_buffer *keys, const bb_buffer *values,
                                const bb_buffer *boxes, uint32_t count, bb_tree *tree)
{
    const uint32_t leaf = wide->leaf;
    bb_wide_level last = {.items = 1};
    uint32_t number = 0;
    BB_TRY(bb_buffer_fill(&wide->levels, wide->levels.bytes, 0));
    BB_TRY(bb_launch(wide->device, wide->root, 1, 1, BB_MEM(*keys), BB_MEM(*values), BB_MEM(*boxes),
                     BB_VALUE(count), BB_VALUE(leaf), BB_MEM(tree->d_nodes), BB_MEM(tree->d_refs),
                     BB_MEM(tree->d_info), BB_MEM(wide->items[0]), BB_MEM(wide->levels)));
    while (last.items > 0) {
        if (number > BB_WIDE_LEVELS)
            return bb_fail(BB_FAILED, "wide tree: more than %d levels: keys are not sorted",
                           BB_WIDE_LEVELS);
        for (uint32_t i = 0; i < LEVELS_AT_ONCE; i++, number++)
            BB_TRY(bb_launch(wide->device, wide->level, LEVEL_ITEMS, GROUP_SIZE, BB_MEM(*keys),
                             BB_MEM(*values), BB_MEM(*boxes), BB_VALUE(count), BB_VALUE(leaf),
                             BB_VALUE(number), BB_MEM(tree->d_nodes), BB_MEM(tree->d_refs),
                             BB_MEM(tree->d_info), BB_MEM(wide->items[number % 2]),
                             BB_MEM(wide->items[(number + 1) % 2]), BB_MEM(wide->levels)));
        BB_TRY(bb_buffer_read(&wide->levels, number * sizeof last, sizeof last, &last));
    }
    while (number-- > 0)
        BB_TRY(bb_launch(wide->device, wide->join, LEVEL_ITEMS, GROUP_SIZE, BB_VALUE(number),
                         BB_MEM(tree->d_nodes), BB_MEM(wide->levels)));
    return BB_OK;
}

bb_status bb_wide_tree_make(bb_wide_tree *wide, const bb_buffer *keys, const bb_buffer *values,
                            const bb_buffer *boxes, uint32_t count, bb_tree *tree)
{
    BB_TRY(bb_wide_tree_reserve(wide, count, tree));
    tree->duplicated = false;
    tree->disjoint = false;
    tree->keep_nodes = true;
    return (bb_cpu_form(wide->device) ? make_depth_first : make_by_levels)(wide, keys, values,
                                                                           boxes, count, tree);
}
