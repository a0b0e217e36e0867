#include "traversal/wide_native.h"

#include "framework/base/arithmetic.h"

enum { GROUP_SIZE = 64, CPU_CHUNK = 1024, GPU_CHUNK = 16 };

void bb_wide_native_release(bb_wide_native *native)
{
    bb_buffer_release(&native->inner);
    bb_buffer_release(&native->first_blocks);
    bb_buffer_release(&native->links);
    bb_kernel_release(native->count);
    bb_kernel_release(native->number);
    bb_kernel_release(native->nodes);
    bb_program_release(native->program);
    *native = (bb_wide_native){.device = NULL};
}

static bb_status compile(bb_wide_native *native)
{
    if (native->program == NULL)
        BB_TRY(bb_program_build(native->device, bb_source_find("layout_wide_native.cl"),
                                native->defines, &native->program));
    if (native->count == NULL)
        BB_TRY(bb_kernel_get(native->program, "native_count", &native->count));
    if (native->number == NULL)
        BB_TRY(bb_kernel_get(native->program, "native_number", &native->number));
    if (native->nodes == NULL)
        BB_TRY(bb_kernel_get(native->program, "native_nodes", &native->nodes));
    return BB_OK;
}

/* Nodes that a work-item numbers and writes. */
static uint32_t chunk_of(const bb_wide_native *native)
{
    return bb_cpu_form(native->device) ? CPU_CHUNK : GPU_CHUNK;
}

static uint32_t group_of(const bb_wide_native *native)
{
    return bb_cpu_form(native->device) ? 1 : GROUP_SIZE;
}

static bb_status reserve(bb_wide_native *native, size_t bytes, const char *what, bb_buffer *buffer)
{
    return bb_buffer_reserve(native->device, native->account, bytes, what, buffer);
}

/* Counts the nodes and blocks of all chunks, and adds them up. */
static bb_status count(bb_wide_native *native, const bb_layout_source *source, bool single)
{
    const bb_tree *tree = source->tree;
    const bb_prim_ends ends = bb_scene_ends(source->scene);
    const uint32_t nodes = tree->info.node_count, chunk = chunk_of(native),
                   chunks = bb_divide_up(nodes, chunk), records = single;
    const size_t bytes = ((size_t)chunks + 1) * sizeof(uint32_t), total = chunks * sizeof(uint32_t);
    BB_TRY(reserve(native, bytes, "wide: nodes before chunks", &native->inner));
    BB_TRY(reserve(native, bytes, "wide: blocks before chunks", &native->first_blocks));
    BB_TRY(reserve(native, nodes * sizeof(uint32_t), "wide: links to nodes", &native->links));
    BB_TRY(bb_launch(native->device, native->count, (size_t)chunks + 1, group_of(native),
                     BB_MEM(tree->d_nodes), BB_VALUE(nodes), BB_MEM(tree->d_refs), BB_VALUE(ends),
                     BB_VALUE(records), BB_VALUE(chunk), BB_VALUE(chunks), BB_MEM(native->inner),
                     BB_MEM(native->first_blocks)));
    BB_TRY(bb_scan_u32(native->primitives, &native->inner, &native->inner, chunks + 1, NULL));
    BB_TRY(bb_scan_u32(native->primitives, &native->first_blocks, &native->first_blocks, chunks + 1,
                       NULL));
    native->node_count = nodes - tree->info.leaf_count;
    return bb_buffer_read(&native->first_blocks, total, sizeof(uint32_t), &native->block_count);
}

bb_status bb_wide_native_number(bb_wide_native *native, const bb_layout_source *source,
                                uint32_t width, bool single, uint32_t format, bb_buffer *blocks,
                                uint64_t *bytes)
{
    const bb_scene *scene = source->scene;
    const bb_tree_info *info = &source->tree->info;
    if (info->arity > width)
        return bb_fail(BB_UNSUPPORTED,
                       "plan=native: the tree has nodes of %u children, the layout's have %u "
                       "places: leave out plan=native",
                       info->arity, width);
    BB_TRY(compile(native));
    if (!source->same_links)
        BB_TRY(count(native, source, single));
    const bb_prim_ends ends = bb_scene_ends(scene);
    const uint32_t words = bb_block_words(source->kinds, format), chunk = chunk_of(native),
                   fresh = !source->same_links, records = single;
    const float scale = scene->scale;
    if (!single) {
        const size_t size = ((size_t)native->block_count + 1) * words * sizeof(uint32_t);
        BB_TRY(reserve(native, size, "wide: blocks of primitives", blocks));
        *bytes += size;
    }
    BB_TRY(bb_launch(native->device, native->number, bb_divide_up(info->node_count, chunk),
                     group_of(native), BB_MEM(source->tree->d_nodes), BB_VALUE(info->node_count),
                     BB_MEM(source->tree->d_refs), BB_VALUE(info->ref_count),
                     BB_MEM(scene->on_device.vertices), BB_MEM(scene->on_device.prims),
                     BB_VALUE(ends), BB_VALUE(scale), BB_VALUE(format), BB_VALUE(words),
                     BB_VALUE(fresh), BB_VALUE(records), BB_VALUE(chunk), BB_MEM(native->inner),
                     BB_MEM(native->first_blocks), BB_MEM(native->links), BB_MEM(*blocks)));
    if (source->same_links)
        return BB_OK;
    native->root = 0; /* of inner nodes, the first in memory; reading a link would wait for it */
    return info->root == 0 && native->node_count > 0
               ? BB_OK
               : bb_buffer_read(&native->links, info->root * sizeof(uint32_t), sizeof(uint32_t),
                                &native->root);
}

bb_status bb_wide_native_nodes(bb_wide_native *native, const bb_layout_source *source, bool single,
                               const bb_buffer *nodes, const bb_buffer *sides)
{
    const bb_tree *tree = source->tree;
    const uint32_t chunk = chunk_of(native), octants = source->octants,
                   none = single ? tree->info.ref_count : native->block_count;
    const float scale = source->scene->scale;
    return bb_launch(native->device, native->nodes, bb_divide_up(tree->info.node_count, chunk),
                     group_of(native), BB_MEM(tree->d_nodes), BB_VALUE(tree->info.node_count),
                     BB_VALUE(chunk), BB_MEM(native->inner), BB_MEM(native->links), BB_VALUE(scale),
                     BB_VALUE(none), BB_VALUE(octants), BB_MEM(*nodes), BB_MEM(*sides));
}
