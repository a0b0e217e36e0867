/* Wide layouts directly from binary trees: host side of kernels/layout_wide_direct.cl. */
#include "traversal/wide_direct.h"

#include "framework/base/arithmetic.h"
#include "kernels/wide_direct_shared.h"
#include "traversal/pairs.h"

enum {
    GROUP_SIZE = 64,
    PIECES_MAX = BB_DIRECT_PIECES,
    PIECES_PER_UNIT = 32,           /* fewest subtrees, so that none is much of the work */
    QUEUE_MAX = 4 * PIECES_MAX + 1, /* at most half of the pieces are opened, into up to 8 each */
    OPENERS_PER_UNIT = 32,          /* work-items that share the queue */
};

bb_status bb_wide_direct_create(bb_device *device, bb_account *account, bb_primitives *primitives,
                                const char *defines, bb_wide_direct *direct)
{
    *direct = (bb_wide_direct){
        .device = device, .account = account, .primitives = primitives, .defines = defines};
    BB_TRY(bb_program_build(device, bb_source_find("layout_wide_direct.cl"), defines,
                            &direct->program));
    BB_TRY(bb_program_build(device, bb_source_find("layout_wide_direct_write.cl"), defines,
                            &direct->write_program));
    BB_TRY(bb_kernel_get(direct->program, "direct_cut", &direct->cut));
    BB_TRY(bb_kernel_get(direct->program, "direct_plan", &direct->plan));
    BB_TRY(bb_kernel_get(direct->program, "direct_top", &direct->top));
    BB_TRY(bb_kernel_get(direct->program, "direct_open", &direct->open));
    BB_TRY(bb_kernel_get(direct->program, "direct_count", &direct->count));
    BB_TRY(bb_kernel_get(direct->write_program, "direct_blocks", &direct->blocks));
    return bb_kernel_get(direct->write_program, "direct_nodes", &direct->nodes);
}

void bb_wide_direct_release(bb_wide_direct *direct)
{
    bb_buffer *const buffers[] = {&direct->pieces, &direct->results, &direct->state,
                                  &direct->queue,  &direct->words,   &direct->marks,
                                  &direct->bits,   &direct->before,  &direct->blocks_before,
                                  &direct->firsts};
    for (size_t i = 0; i < sizeof buffers / sizeof buffers[0]; i++)
        bb_buffer_release(buffers[i]);
    const cl_kernel kernels[] = {direct->cut,   direct->plan,   direct->top,  direct->open,
                                 direct->count, direct->blocks, direct->nodes};
    for (size_t i = 0; i < sizeof kernels / sizeof kernels[0]; i++)
        bb_kernel_release(kernels[i]);
    bb_program_release(direct->program);
    bb_program_release(direct->write_program);
    *direct = (bb_wide_direct){.device = NULL};
}

bool bb_wide_direct_takes(const bb_device *device, const bb_tree *tree)
{
    const bb_tree_info *info = &tree->info;
    return bb_cpu_form(device) && !tree->duplicated && bb_pairs_keep_shape(info) &&
           info->leaf_count == info->ref_count && info->leaf_count > 1 &&
           info->depth <= BB_DIRECT_DEPTH;
}

static uint32_t words_of(const bb_tree *tree)
{
    return bb_divide_up(tree->info.node_count, BB_DIRECT_WORD);
}

static bb_status reserve(bb_wide_direct *d, const bb_layout_source *source)
{
    size_t nodes = source->tree->info.node_count, words = words_of(source->tree);
    const struct {
        size_t bytes;
        bb_buffer *buffer;
    } wanted[] = {
        {PIECES_MAX * sizeof(bb_direct_piece), &d->pieces},
        {PIECES_MAX * sizeof(bb_direct_done), &d->results},
        {sizeof(bb_direct_state), &d->state},
        {QUEUE_MAX * sizeof(cl_uint2), &d->queue},
        {nodes * sizeof(cl_uint2), &d->words},
        {words * BB_DIRECT_WORD, &d->marks},
        {(words + 1) * sizeof(cl_ulong), &d->bits},
        {(words + 1) * sizeof(uint32_t), &d->before},
        {(words + 1) * sizeof(uint32_t), &d->blocks_before},
        {(source->leaf > 1 ? nodes : 1) * sizeof(uint32_t), &d->firsts},
    };
    for (size_t i = 0; i < sizeof wanted / sizeof wanted[0]; i++)
        BB_TRY(bb_buffer_reserve(d->device, d->account, wanted[i].bytes, "wide: straight from tree",
                                 wanted[i].buffer));
    return BB_OK;
}

/* Cuts the tree, plans, and marks. */
static bb_status mark(bb_wide_direct *d, const bb_layout_source *source)
{
    const bb_tree *tree = source->tree;
    const bb_tree_info *info = &tree->info;
    const bb_scene *scene = source->scene;
    const bb_prim_ends ends = bb_scene_ends(scene);
    float scale = scene->scale, intersection = (float)BB_COST_INTERSECTION,
          traversal = source->traversal;
    uint32_t leaf = source->leaf, collapsed = leaf > 1, most = PIECES_MAX,
             share = info->ref_count / (d->device->compute_units * PIECES_PER_UNIT),
             one_kind = (scene->kinds & (scene->kinds - 1)) == 0,
             greedy = source->plan == BB_PLAN_GREEDY;
    BB_TRY(bb_buffer_fill(&d->marks, (size_t)words_of(tree) * BB_DIRECT_WORD, 0));
    BB_TRY(bb_launch(d->device, d->cut, 1, 1, BB_MEM(tree->d_nodes), BB_VALUE(info->root),
                     BB_VALUE(info->ref_count), BB_VALUE(share), BB_VALUE(most), BB_MEM(d->pieces),
                     BB_MEM(d->state)));
    BB_TRY(bb_launch(d->device, d->plan, most, 1, BB_MEM(tree->d_nodes), BB_VALUE(scale),
                     BB_VALUE(traversal), BB_VALUE(intersection), BB_VALUE(leaf), BB_VALUE(greedy),
                     BB_MEM(d->pieces), BB_MEM(d->state), BB_MEM(d->words), BB_MEM(d->results)));
    BB_TRY(bb_launch(d->device, d->top, 1, 1, BB_MEM(tree->d_nodes), BB_MEM(tree->d_refs),
                     BB_VALUE(ends), BB_VALUE(scale), BB_VALUE(traversal), BB_VALUE(intersection),
                     BB_VALUE(leaf), BB_VALUE(greedy), BB_VALUE(info->root), BB_MEM(d->pieces),
                     BB_MEM(d->words), BB_MEM(d->results), BB_MEM(d->marks), BB_VALUE(one_kind),
                     BB_MEM(d->queue), BB_MEM(d->state)));
    return bb_launch(d->device, d->open, (size_t)d->device->compute_units * OPENERS_PER_UNIT, 1,
                     BB_MEM(tree->d_nodes), BB_MEM(tree->d_refs), BB_VALUE(ends),
                     BB_VALUE(collapsed), BB_VALUE(one_kind), BB_VALUE(greedy), BB_MEM(d->words),
                     BB_MEM(d->marks), BB_MEM(d->queue), BB_MEM(d->state));
}

static bb_status read_u32(const bb_buffer *buffer, size_t at, uint32_t *value)
{
    return bb_buffer_read(buffer, at * sizeof *value, sizeof *value, value);
}

/* Finds the number of the root's wide node. */
static bb_status find_root(bb_wide_direct *d, uint32_t root)
{
    uint32_t word = root / BB_DIRECT_WORD;
    uint64_t bits;
    BB_TRY(read_u32(&d->before, word, &d->root));
    BB_TRY(bb_buffer_read(&d->bits, word * sizeof bits, sizeof bits, &bits));
    for (uint32_t n = 0; n < root % BB_DIRECT_WORD; n++)
        d->root += (uint32_t)(bits >> n & 1);
    return BB_OK;
}

bb_status bb_wide_direct_number(bb_wide_direct *d, const bb_layout_source *source)
{
    const bb_tree *tree = source->tree;
    uint32_t words = words_of(tree);
    bb_direct_state state;
    BB_TRY(reserve(d, source));
    BB_TRY(mark(d, source));
    BB_TRY(bb_launch(d->device, d->count, (size_t)words + 1, GROUP_SIZE, BB_MEM(d->marks),
                     BB_VALUE(words), BB_MEM(d->bits), BB_MEM(d->before),
                     BB_MEM(d->blocks_before)));
    BB_TRY(bb_scan_u32(d->primitives, &d->before, &d->before, words + 1, NULL));
    BB_TRY(bb_scan_u32(d->primitives, &d->blocks_before, &d->blocks_before, words + 1, NULL));
    BB_TRY(read_u32(&d->before, words, &d->node_count));
    BB_TRY(read_u32(&d->blocks_before, words, &d->block_count));
    BB_TRY(bb_buffer_read(&d->state, 0, sizeof state, &state));
    d->stack_need = state.stack_need;
    d->root = BB_LEAF_BIT; /* the only leaf */
    return state.root_is_leaf ? BB_OK : find_root(d, tree->info.root);
}

static uint32_t chunks_of(const bb_tree *tree)
{
    return bb_divide_up(tree->info.node_count, BB_DIRECT_CHUNK);
}

bb_status bb_wide_direct_blocks(bb_wide_direct *d, const bb_layout_source *source, uint32_t format,
                                bb_buffer *blocks, uint64_t *bytes)
{
    const bb_tree *tree = source->tree;
    const bb_scene *scene = source->scene;
    const bb_prim_ends ends = bb_scene_ends(scene);
    uint32_t words = bb_block_words(source->kinds, format), count = tree->info.node_count,
             fresh = !source->same_links;
    float scale = scene->scale;
    size_t size = ((size_t)d->block_count + 1) * words * sizeof(uint32_t);
    BB_TRY(bb_buffer_reserve(d->device, d->account, size, "wide: blocks of primitives", blocks));
    *bytes += size;
    return bb_launch(d->device, d->blocks, chunks_of(tree), 1, BB_MEM(tree->d_nodes),
                     BB_MEM(tree->d_refs), BB_MEM(d->words), BB_MEM(d->marks), BB_VALUE(count),
                     BB_VALUE(tree->info.ref_count), BB_MEM(d->blocks_before),
                     BB_MEM(scene->on_device.vertices), BB_MEM(scene->on_device.prims),
                     BB_VALUE(ends), BB_VALUE(scale), BB_VALUE(format), BB_VALUE(words),
                     BB_VALUE(fresh), BB_MEM(d->firsts), BB_MEM(*blocks));
}

bb_status bb_wide_direct_nodes(bb_wide_direct *d, const bb_layout_source *source,
                               const bb_buffer *nodes, const bb_buffer *sides)
{
    const bb_tree *tree = source->tree;
    uint32_t count = tree->info.node_count, collapsed = source->leaf > 1,
             none = collapsed ? d->block_count : tree->info.ref_count, octants = source->octants;
    float scale = source->scene->scale;
    return bb_launch(d->device, d->nodes, chunks_of(tree), 1, BB_MEM(tree->d_nodes),
                     BB_MEM(d->words), BB_VALUE(count), BB_MEM(d->bits), BB_MEM(d->before),
                     BB_MEM(d->firsts), BB_VALUE(scale), BB_VALUE(collapsed), BB_VALUE(none),
                     BB_VALUE(octants), BB_MEM(*nodes), BB_MEM(*sides));
}
