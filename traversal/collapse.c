/* Leaf collapse by SAH: host side of kernels/collapse.cl. */
#include "traversal/collapse.h"

#include "framework/device/levels.h"
#include "framework/device/primitives.h"

#include <assert.h>
#include <stdlib.h>

enum { GROUP_SIZE = 64 };

struct bb_collapse {
    bb_device *device;
    bb_account *account;
    cl_program program;
    cl_kernel parents_kernel, mark, write;
    cl_kernel decide;        /* hand-over by a fence */
    cl_kernel leaves, level; /* hand-over by levels */
    bb_levels levels;
    bb_primitives *primitives;
    bb_buffer parents, missing; /* u32 per node: its parent; children that are not finished */
    bb_buffer subtrees;         /* bb_subtree per node */
    bb_buffer places,
        firsts;    /* u32 per node, and the total: places of nodes, and of first references */
    uint32_t most; /* most references per leaf in the last result */
    bb_tree tree;
};

double bb_collapse_node_cost(uint32_t width)
{
    return BB_COST_TRAVERSAL * 0.5 * width;
}

float bb_collapse_traversal(double node, uint32_t width)
{
    return (float)(node / (width - 1));
}

static bb_status get_kernels(bb_collapse *self)
{
    char defines[96];
    bb_handover_defines(self->device, defines, sizeof defines);
    BB_TRY(bb_program_build(self->device, bb_source_find("collapse.cl"), defines, &self->program));
    BB_TRY(bb_kernel_get(self->program, "collapse_parents", &self->parents_kernel));
    BB_TRY(bb_kernel_get(self->program, "collapse_mark", &self->mark));
    BB_TRY(bb_kernel_get(self->program, "collapse_write", &self->write));
    if (self->device->handover != BB_HANDOVER_LEVELS)
        return bb_kernel_get(self->program, "collapse_decide", &self->decide);
    BB_TRY(bb_kernel_get(self->program, "collapse_leaves", &self->leaves));
    return bb_kernel_get(self->program, "collapse_level", &self->level);
}

bb_status bb_collapse_create(bb_device *device, bb_account *account, bb_collapse **out)
{
    bb_collapse *self = calloc(1, sizeof *self);
    if (self == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    self->device = device;
    self->account = account;
    bb_tree_init(&self->tree, account);
    bb_status status = get_kernels(self);
    if (status == BB_OK)
        status = bb_primitives_create(device, account, &self->primitives);
    if (status != BB_OK) {
        bb_collapse_destroy(self);
        return status;
    }
    *out = self;
    return BB_OK;
}

void bb_collapse_destroy(bb_collapse *self)
{
    if (self == NULL)
        return;
    bb_buffer *const buffers[] = {&self->parents, &self->missing, &self->subtrees, &self->places,
                                  &self->firsts};
    for (size_t i = 0; i < sizeof buffers / sizeof buffers[0]; i++)
        bb_buffer_release(buffers[i]);
    bb_levels_release(&self->levels);
    bb_tree_release(&self->tree);
    bb_primitives_destroy(self->primitives);
    bb_kernel_release(self->parents_kernel);
    bb_kernel_release(self->decide);
    bb_kernel_release(self->leaves);
    bb_kernel_release(self->level);
    bb_kernel_release(self->mark);
    bb_kernel_release(self->write);
    bb_program_release(self->program);
    free(self);
}

static bb_status reserve(bb_collapse *self, size_t count)
{
    const struct {
        size_t bytes;
        bb_buffer *buffer;
    } wanted[] = {
        {count * sizeof(uint32_t), &self->parents},
        {count * sizeof(uint32_t), &self->missing},
        {count * sizeof(bb_subtree), &self->subtrees},
        {(count + 1) * sizeof(uint32_t), &self->places},
        {(count + 1) * sizeof(uint32_t), &self->firsts},
    };
    for (size_t i = 0; i < sizeof wanted / sizeof wanted[0]; i++)
        BB_TRY(bb_buffer_reserve(self->device, self->account, wanted[i].bytes, "leaf collapse",
                                 wanted[i].buffer));
    return BB_OK;
}

/* Parameters of the decisions: the kernels' cost_model. */
typedef struct decision {
    bb_collapse *self;
    const bb_tree *tree;
    float scale, traversal, intersection;
    uint32_t block, max_leaf;
} decision;

static bb_status decide_level(void *context, const bb_levels *levels, uint32_t n)
{
    const decision *d = context;
    bb_collapse *self = d->self;
    return bb_launch(self->device, self->level, bb_levels_items(levels), GROUP_SIZE,
                     BB_MEM(d->tree->d_nodes), BB_VALUE(d->scale), BB_VALUE(d->traversal),
                     BB_VALUE(d->intersection), BB_VALUE(d->block), BB_VALUE(d->max_leaf),
                     BB_MEM(self->parents), BB_MEM(self->missing), BB_MEM(self->subtrees),
                     BB_MEM(levels->lists[n % 2]), BB_VALUE(n), BB_MEM(levels->counts),
                     BB_MEM(levels->lists[(n + 1) % 2]));
}

static bb_status decide(decision *d)
{
    bb_collapse *self = d->self;
    const bb_tree *tree = d->tree;
    uint32_t count = tree->info.node_count;
    BB_TRY(bb_launch(self->device, self->parents_kernel, count, GROUP_SIZE, BB_MEM(tree->d_nodes),
                     BB_VALUE(count), BB_VALUE(tree->info.root), BB_MEM(self->parents),
                     BB_MEM(self->missing)));
    if (self->device->handover == BB_HANDOVER_FENCE)
        return bb_launch(self->device, self->decide, count, GROUP_SIZE, BB_MEM(tree->d_nodes),
                         BB_MEM(tree->d_refs), BB_VALUE(count), BB_VALUE(d->scale),
                         BB_VALUE(d->traversal), BB_VALUE(d->intersection), BB_VALUE(d->block),
                         BB_VALUE(d->max_leaf), BB_VALUE(self->most), BB_MEM(self->parents),
                         BB_MEM(self->missing), BB_MEM(self->subtrees));
    BB_TRY(bb_levels_reserve(&self->levels, self->device, self->account, count, tree->info.depth,
                             "leaf collapse: levels"));
    BB_TRY(bb_levels_start(&self->levels));
    BB_TRY(bb_launch(self->device, self->leaves, count, GROUP_SIZE, BB_MEM(tree->d_nodes),
                     BB_MEM(tree->d_refs), BB_VALUE(count), BB_VALUE(d->scale),
                     BB_VALUE(d->traversal), BB_VALUE(d->intersection), BB_VALUE(d->block),
                     BB_VALUE(d->max_leaf), BB_VALUE(self->most), BB_MEM(self->parents),
                     BB_MEM(self->missing), BB_MEM(self->subtrees), BB_MEM(self->levels.counts),
                     BB_MEM(self->levels.lists[1])));
    return bb_levels_run(&self->levels, decide_level, d);
}

static bb_status write_tree(bb_collapse *self, const bb_tree *tree, bb_tree **out)
{
    bb_tree *result = &self->tree;
    uint32_t count = tree->info.node_count, duplicated = tree->duplicated ? 1 : 0;
    BB_TRY(bb_launch(self->device, self->write, count, GROUP_SIZE, BB_MEM(tree->d_nodes),
                     BB_MEM(tree->d_refs), BB_VALUE(count), BB_VALUE(tree->info.root),
                     BB_VALUE(duplicated), BB_VALUE(self->most), BB_MEM(self->subtrees),
                     BB_MEM(self->places), BB_MEM(self->firsts), BB_MEM(result->d_nodes),
                     BB_MEM(result->d_refs), BB_MEM(result->d_info)));
    result->duplicated = tree->duplicated;
    result->disjoint = tree->disjoint;
    *out = result;
    return BB_OK;
}

bb_status bb_collapse_make(bb_collapse *self, const bb_tree *tree, float scale, uint32_t max_leaf,
                           float traversal, uint32_t block, uint32_t most, bb_tree **out)
{
    assert(max_leaf >= 1 && max_leaf <= BB_LEAF_MAX && traversal > 0.0f && block >= 1);
    uint32_t count = tree->info.node_count, duplicated = tree->duplicated ? 1 : 0, totals[2];
    BB_TRY(reserve(self, count));
    self->most = most > 0 ? most : UINT32_MAX;
    decision d = {.self = self,
                  .tree = tree,
                  .scale = scale,
                  .traversal = traversal,
                  .intersection = (float)BB_COST_INTERSECTION,
                  .block = block,
                  .max_leaf = max_leaf};
    BB_TRY(decide(&d));
    BB_TRY(bb_launch(self->device, self->mark, (size_t)count + 1, GROUP_SIZE, BB_MEM(tree->d_nodes),
                     BB_MEM(tree->d_refs), BB_VALUE(count), BB_VALUE(max_leaf),
                     BB_VALUE(duplicated), BB_VALUE(self->most), BB_MEM(self->parents),
                     BB_MEM(self->subtrees), BB_MEM(self->places), BB_MEM(self->firsts)));
    BB_TRY(bb_scan_u32(self->primitives, &self->places, &self->places, count + 1, NULL));
    BB_TRY(bb_scan_u32(self->primitives, &self->firsts, &self->firsts, count + 1, NULL));
    size_t last = count * sizeof(uint32_t);
    BB_TRY(bb_buffer_read(&self->places, last, sizeof totals[0], &totals[0]));
    BB_TRY(bb_buffer_read(&self->firsts, last, sizeof totals[1], &totals[1]));
    BB_TRY(bb_tree_reserve(&self->tree, self->device, BB_ON_DEVICE, totals[0], totals[1]));
    BB_TRY(write_tree(self, tree, out));
    return bb_tree_fetch_info(&self->tree);
}

bb_status bb_collapse_again(bb_collapse *self, const bb_tree *tree, bb_tree **out)
{
    bb_tree_boxes_changed(&self->tree);
    return write_tree(self, tree, out);
}
