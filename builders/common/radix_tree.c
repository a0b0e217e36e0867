#include "builders/common/radix_tree.h"

#include "framework/base/arithmetic.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>

struct bb_radix_tree {
    bb_device *device;
    bb_account *account;
    bb_radix_kind kind;
    cl_program program;
    cl_kernel link;    /* link_chunks, link_climb or link_boxes */
    cl_kernel ranges;  /* before link_boxes */
    cl_kernel pieces;  /* after link_chunks */
    bb_buffer ends;    /* u32 per split: far end of the first sibling to come; chunks: lists */
    bb_buffer heights; /* u8 per node */
    bb_buffer places;  /* Karras: u32 per split, its inner node */
    bb_buffer lengths; /* u32 per list: its length; first of chunks, then of runs of them ... */
    uint32_t count;    /* references of the last tree */
};

enum { GROUP_SIZE = 64 };

/* How leaves are divided among work-items without a fence. */
typedef struct cut {
    uint32_t chunk; /* leaves that a work-item does first */
    uint32_t some;  /* lists that a work-item combines */
    uint32_t group;
} cut;

static cut cut_of(const bb_radix_tree *radix)
{
    /* CPUs: a chunk's nodes fit the second-level cache */
    return bb_cpu_form(radix->device) ? (cut){2048, 32, 1} : (cut){16, 16, GROUP_SIZE};
}

/* Without a fence; on CPUs that takes no longer. */
static bool by_chunks(const bb_radix_tree *radix)
{
    return radix->device->handover == BB_HANDOVER_LEVELS ||
           (bb_cpu_form(radix->device) && radix->kind.linking == BB_LINK_APETREI);
}

static bool by_ranges(const bb_radix_tree *radix)
{
    return !by_chunks(radix) && radix->kind.linking == BB_LINK_KARRAS;
}

static bb_status get_kernels(bb_radix_tree *radix)
{
    const bb_radix_kind *kind = &radix->kind;
    const char *link = by_chunks(radix)   ? "link_chunks"
                       : by_ranges(radix) ? "link_boxes"
                                          : "link_climb";
    char handover[96], defines[192];
    bb_handover_defines(radix->device, handover, sizeof handover);
    snprintf(defines, sizeof defines, "%s -DBB_KEEP_WAITING=%d %s%s%s", handover,
             bb_cpu_form(radix->device), kind->key_bytes == 8 ? "-DBB_KEY64 " : "",
             kind->nodes ? "-DBB_KEY_NODES " : "", kind->runs ? "-DBB_LEAF_RUNS" : "");
    BB_TRY(
        bb_program_build(radix->device, bb_source_find("radix_tree.cl"), defines, &radix->program));
    BB_TRY(bb_kernel_get(radix->program, link, &radix->link));
    BB_TRY(bb_kernel_get(radix->program, "link_ranges", &radix->ranges));
    return bb_kernel_get(radix->program, "link_pieces", &radix->pieces);
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
    bb_buffer_release(&radix->lengths);
    bb_kernel_release(radix->link);
    bb_kernel_release(radix->ranges);
    bb_kernel_release(radix->pieces);
    bb_program_release(radix->program);
    free(radix);
}

/* Number of lists of all runs over `count` leaves. */
static size_t count_lists(const bb_radix_tree *radix, uint32_t count)
{
    const cut c = cut_of(radix);
    size_t lists = bb_divide_up(count, c.chunk), sum = lists;
    while (lists > 1)
        sum += lists = (lists + c.some - 1) / c.some;
    return sum;
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
    if (by_ranges(radix))
        BB_TRY(bb_buffer_reserve(device, radix->account, splits * sizeof(uint32_t),
                                 "radix tree: places", &radix->places));
    if (by_chunks(radix))
        BB_TRY(bb_buffer_reserve(device, radix->account,
                                 count_lists(radix, count) * sizeof(uint32_t), "radix tree: lists",
                                 &radix->lengths));
    return BB_OK;
}

const bb_buffer *bb_radix_tree_heights(const bb_radix_tree *radix)
{
    return &radix->heights;
}

static bb_status link_by_chunks(bb_radix_tree *radix, const bb_buffer *keys,
                                const bb_radix_runs *runs, const bb_buffer *values,
                                const bb_buffer *boxes, uint32_t count, bb_tree *tree)
{
    const cut c = cut_of(radix);
    uint32_t lists = bb_divide_up(count, c.chunk), span = c.chunk, from = 0;
    BB_TRY(bb_launch(radix->device, radix->link, lists, c.group, BB_MEM(*keys),
                     BB_MEM(runs->starts), BB_MEM(runs->total), BB_MEM(*values), BB_MEM(*boxes),
                     BB_VALUE(count), BB_MEM(radix->ends), BB_MEM(radix->heights),
                     BB_MEM(tree->d_nodes), BB_MEM(tree->d_refs), BB_MEM(tree->d_info),
                     BB_VALUE(c.chunk), BB_MEM(radix->lengths)));
    while (lists > 1) {
        uint32_t to = from + lists;
        lists = bb_divide_up(lists, c.some);
        BB_TRY(bb_launch(radix->device, radix->pieces, lists, c.group, BB_MEM(*keys),
                         BB_MEM(runs->total), BB_VALUE(count), BB_MEM(radix->ends),
                         BB_MEM(radix->heights), BB_MEM(tree->d_nodes), BB_MEM(tree->d_info),
                         BB_VALUE(span), BB_VALUE(c.some), BB_VALUE(from), BB_VALUE(to),
                         BB_MEM(radix->lengths)));
        span *= c.some;
        from = to;
    }
    return BB_OK;
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
    radix->count = count;
    if (by_chunks(radix))
        return link_by_chunks(radix, keys, r, values, boxes, count, tree);
    BB_TRY(bb_buffer_fill(&radix->ends, count * sizeof(uint32_t), BB_NONE));
    if (!by_ranges(radix))
        return bb_launch(device, radix->link, count, GROUP_SIZE, BB_MEM(*keys), BB_MEM(r->starts),
                         BB_MEM(r->total), BB_MEM(*values), BB_MEM(*boxes), BB_VALUE(count),
                         BB_MEM(radix->ends), BB_MEM(radix->heights), BB_MEM(tree->d_nodes),
                         BB_MEM(tree->d_refs), BB_MEM(tree->d_info));
    BB_TRY(bb_launch(device, radix->ranges, count, GROUP_SIZE, BB_MEM(*keys), BB_MEM(r->total),
                     BB_VALUE(count), BB_MEM(tree->d_nodes), BB_MEM(radix->places)));
    return bb_launch(device, radix->link, count, GROUP_SIZE, BB_MEM(*keys), BB_MEM(r->starts),
                     BB_MEM(r->total), BB_MEM(*values), BB_MEM(*boxes), BB_VALUE(count),
                     BB_MEM(radix->ends), BB_MEM(radix->heights), BB_MEM(tree->d_nodes),
                     BB_MEM(tree->d_refs), BB_MEM(tree->d_info), BB_MEM(radix->places));
}

bb_status bb_radix_tree_longest(const bb_radix_tree *radix, uint32_t *met, uint32_t *most)
{
    const cut c = cut_of(radix);
    const size_t lists = count_lists(radix, radix->count);
    /* right and left children of each level, by keys and by indices */
    const uint32_t bits = 8 * radix->kind.key_bytes * (radix->kind.nodes ? 2 : 1);
    const uint32_t subtrees = c.some * 2 * (bits + 32);
    *met = *most = 0;
    if (radix->count == 0 || radix->kind.runs || radix->device->handover != BB_HANDOVER_LEVELS)
        return BB_OK;
    uint32_t *lengths = malloc(lists * sizeof *lengths);
    if (lengths == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    bb_status status = bb_buffer_read(&radix->lengths, 0, lists * sizeof *lengths, lengths);
    *met = radix->count < c.chunk ? radix->count : c.chunk;
    *most = c.chunk > subtrees ? c.chunk : subtrees;
    uint32_t from = 0, level = bb_divide_up(radix->count, c.chunk);
    for (; level > 1; from += level, level = bb_divide_up(level, c.some))
        for (uint32_t i = 0, sum = 0; i < level; i++) {
            sum = i % c.some == 0 ? lengths[from + i] : sum + lengths[from + i];
            *met = sum > *met ? sum : *met;
        }
    free(lengths);
    return status;
}
