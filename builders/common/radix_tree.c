#include "builders/common/radix_tree.h"

#include "framework/base/arithmetic.h"
#include "framework/device/levels.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>

struct bb_radix_tree {
    bb_device *device;
    bb_account *account;
    bb_radix_kind kind;
    cl_program program;
    cl_kernel ranges;
    cl_kernel link;    /* link_chunks, link_climb, link_boxes; by levels: link_leaves */
    cl_kernel level;   /* link_level */
    bb_buffer ends;    /* u32 per split: the far end of the first sibling to come */
    bb_buffer heights; /* u8 per node */
    bb_buffer places;  /* u32 per split: its inner node; Karras, and by levels */
    bb_levels levels;
};

enum {
    GROUP_SIZE = 64,
    CHUNK = 2048, /* leaves per work-item of the CPU form: its nodes fit the second-level cache */
    HEIGHT_MAX = 160, /* the longest prefix of keys, 128, and that of indices */
};

static bool by_levels(const bb_radix_tree *radix)
{
    return radix->device->handover == BB_HANDOVER_LEVELS;
}

/* Inner nodes by their ranges, all at once, before boxes. */
static bool ranges_first(const bb_radix_tree *radix)
{
    return by_levels(radix) || radix->kind.linking == BB_LINK_KARRAS;
}

static bb_status get_kernels(bb_radix_tree *radix)
{
    const bb_device *device = radix->device;
    const bb_radix_kind *kind = &radix->kind;
    const char *link = by_levels(radix)                  ? "link_leaves"
                       : kind->linking == BB_LINK_KARRAS ? "link_boxes"
                       : bb_cpu_form(device)             ? "link_chunks"
                                                         : "link_climb";
    char handover[96], defines[192];
    bb_handover_defines(device, handover, sizeof handover);
    snprintf(defines, sizeof defines, "%s %s%s%s%s", handover,
             kind->key_bytes == 8 ? "-DBB_KEY64 " : "", kind->nodes ? "-DBB_KEY_NODES " : "",
             kind->runs ? "-DBB_LEAF_RUNS " : "", kind->heights ? "-DBB_ALL_HEIGHTS" : "");
    BB_TRY(
        bb_program_build(radix->device, bb_source_find("radix_tree.cl"), defines, &radix->program));
    BB_TRY(bb_kernel_get(radix->program, link, &radix->link));
    BB_TRY(bb_kernel_get(radix->program, "link_ranges", &radix->ranges));
    return bb_kernel_get(radix->program, "link_level", &radix->level);
}

bb_status bb_radix_tree_create(bb_device *device, bb_account *account, bb_radix_kind kind,
                               bb_radix_tree **out)
{
    bb_radix_tree *radix = calloc(1, sizeof *radix);
    if (radix == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    radix->device = device;
    radix->account = account;
    radix->kind = kind;
    bb_status status = get_kernels(radix);
    if (status != BB_OK) {
        bb_radix_tree_destroy(radix);
        return status;
    }
    *out = radix;
    return BB_OK;
}

void bb_radix_tree_destroy(bb_radix_tree *radix)
{
    if (radix == NULL)
        return;
    bb_buffer_release(&radix->ends);
    bb_buffer_release(&radix->heights);
    bb_buffer_release(&radix->places);
    bb_levels_release(&radix->levels);
    bb_kernel_release(radix->link);
    bb_kernel_release(radix->level);
    bb_kernel_release(radix->ranges);
    bb_program_release(radix->program);
    free(radix);
}

bb_status bb_radix_tree_reserve(bb_radix_tree *radix, uint32_t count, bb_tree *tree)
{
    bb_device *device = radix->device;
    size_t splits = count, nodes = 2 * (size_t)count - 1;
    BB_TRY(bb_tree_reserve(tree, device, BB_ON_DEVICE, nodes, count));
    BB_TRY(bb_buffer_reserve(device, radix->account, splits * sizeof(uint32_t),
                             "radix tree: range ends", &radix->ends));
    BB_TRY(
        bb_buffer_reserve(device, radix->account, nodes, "radix tree: heights", &radix->heights));
    if (ranges_first(radix))
        BB_TRY(bb_buffer_reserve(device, radix->account, splits * sizeof(uint32_t),
                                 "radix tree: places", &radix->places));
    if (by_levels(radix))
        BB_TRY(bb_levels_reserve(&radix->levels, device, radix->account, count, HEIGHT_MAX,
                                 "radix tree: levels"));
    return BB_OK;
}

const bb_buffer *bb_radix_tree_heights(const bb_radix_tree *radix)
{
    assert(radix->kind.heights);
    return &radix->heights;
}

/* What a launch over one level needs. */
typedef struct level_job {
    bb_radix_tree *radix;
    bb_tree *tree;
    const bb_buffer *total;
    uint32_t count;
} level_job;

static bb_status link_level(void *context, const bb_levels *levels, uint32_t n)
{
    const level_job *job = context;
    bb_radix_tree *radix = job->radix;
    return bb_launch(radix->device, radix->level, bb_levels_items(levels), GROUP_SIZE,
                     BB_MEM(*job->total), BB_VALUE(job->count), BB_MEM(radix->ends),
                     BB_MEM(radix->heights), BB_MEM(job->tree->d_nodes), BB_MEM(job->tree->d_info),
                     BB_MEM(radix->places), BB_MEM(levels->lists[n % 2]), BB_VALUE(n),
                     BB_MEM(levels->counts), BB_MEM(levels->lists[(n + 1) % 2]));
}

bb_status bb_radix_tree_link(bb_radix_tree *radix, const bb_buffer *keys, const bb_radix_runs *runs,
                             const bb_buffer *values, const bb_buffer *boxes, uint32_t count,
                             bb_tree *tree)
{
    assert((runs != NULL) == radix->kind.runs);
    bb_device *device = radix->device;
    const bb_radix_runs none = {0};
    const bb_radix_runs *r = runs != NULL ? runs : &none;
    BB_TRY(bb_radix_tree_reserve(radix, count, tree));
    tree->duplicated = false;
    tree->disjoint = false;
    BB_TRY(bb_buffer_fill(&radix->ends, count * sizeof(uint32_t), BB_NONE));
    if (ranges_first(radix))
        BB_TRY(bb_launch(device, radix->ranges, count, GROUP_SIZE, BB_MEM(*keys), BB_MEM(r->total),
                         BB_VALUE(count), BB_MEM(tree->d_nodes), BB_MEM(radix->places)));
    if (by_levels(radix)) {
        level_job job = {radix, tree, &r->total, count};
        BB_TRY(bb_levels_start(&radix->levels));
        BB_TRY(bb_launch(device, radix->link, count, GROUP_SIZE, BB_MEM(*keys), BB_MEM(r->starts),
                         BB_MEM(r->total), BB_MEM(*values), BB_MEM(*boxes), BB_VALUE(count),
                         BB_MEM(radix->ends), BB_MEM(radix->heights), BB_MEM(tree->d_nodes),
                         BB_MEM(tree->d_refs), BB_MEM(tree->d_info), BB_MEM(radix->places),
                         BB_MEM(radix->levels.counts), BB_MEM(radix->levels.lists[1])));
        return bb_levels_run(&radix->levels, link_level, &job);
    }
    if (radix->kind.linking == BB_LINK_KARRAS)
        return bb_launch(device, radix->link, count, GROUP_SIZE, BB_MEM(*keys), BB_MEM(r->starts),
                         BB_MEM(r->total), BB_MEM(*values), BB_MEM(*boxes), BB_VALUE(count),
                         BB_MEM(radix->ends), BB_MEM(radix->heights), BB_MEM(tree->d_nodes),
                         BB_MEM(tree->d_refs), BB_MEM(tree->d_info), BB_MEM(radix->places));
    if (device->form == BB_FORM_GPU)
        return bb_launch(device, radix->link, count, GROUP_SIZE, BB_MEM(*keys), BB_MEM(r->starts),
                         BB_MEM(r->total), BB_MEM(*values), BB_MEM(*boxes), BB_VALUE(count),
                         BB_MEM(radix->ends), BB_MEM(radix->heights), BB_MEM(tree->d_nodes),
                         BB_MEM(tree->d_refs), BB_MEM(tree->d_info));
    uint32_t chunk = CHUNK;
    return bb_launch(device, radix->link, bb_divide_up(count, CHUNK), 1, BB_MEM(*keys),
                     BB_MEM(r->starts), BB_MEM(r->total), BB_MEM(*values), BB_MEM(*boxes),
                     BB_VALUE(count), BB_MEM(radix->ends), BB_MEM(radix->heights),
                     BB_MEM(tree->d_nodes), BB_MEM(tree->d_refs), BB_MEM(tree->d_info),
                     BB_VALUE(chunk));
}
