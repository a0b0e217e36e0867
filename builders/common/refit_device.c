/* The host side of refit.cl. */
#include "builders/common/compact.h"
#include "builders/common/refit.h"
#include "framework/device/levels.h"

#include <stdlib.h>

enum {
    GROUP_SIZE = 64,
    SUBTREE_CPU = 256, /* most nodes of a subtree that one work-item does */
    SUBTREE_GPU = 15,
};

struct bb_refitter {
    bb_device *device;
    bb_account *account;
    cl_program program;
    cl_kernel parents_kernel;
    cl_kernel sizes_kernel, mark, subtrees; /* by a fence */
    cl_kernel leaves, level;                /* by levels */
    bb_buffer parents, missing; /* u32 per node: its parent; children that have not come yet */
    bb_buffer sizes, marks, roots, root_count;
    bb_primitives *primitives;
    bb_compaction *compaction;
    uint32_t found; /* subtrees */
    uint64_t links; /* of the tree that all this is of; each pass leaves it as it was */
    bb_levels levels;
};

static bool by_levels(const bb_refitter *refitter)
{
    return refitter->device->handover == BB_HANDOVER_LEVELS;
}

static bb_status get_kernels(bb_refitter *refitter)
{
    char defines[96];
    bb_handover_defines(refitter->device, defines, sizeof defines);
    BB_TRY(bb_program_build(refitter->device, bb_source_find("refit.cl"), defines,
                            &refitter->program));
    BB_TRY(bb_kernel_get(refitter->program, "refit_parents", &refitter->parents_kernel));
    if (!by_levels(refitter)) {
        BB_TRY(bb_kernel_get(refitter->program, "refit_sizes", &refitter->sizes_kernel));
        BB_TRY(bb_kernel_get(refitter->program, "refit_mark", &refitter->mark));
        BB_TRY(bb_kernel_get(refitter->program, "refit_subtrees", &refitter->subtrees));
        BB_TRY(bb_primitives_create(refitter->device, refitter->account, &refitter->primitives));
        return bb_compaction_create(refitter->device, refitter->account, refitter->primitives,
                                    &refitter->compaction);
    }
    BB_TRY(bb_kernel_get(refitter->program, "refit_leaves", &refitter->leaves));
    return bb_kernel_get(refitter->program, "refit_level", &refitter->level);
}

bb_status bb_refitter_create(bb_device *device, bb_account *account, bb_refitter **out)
{
    bb_refitter *refitter = calloc(1, sizeof *refitter);
    if (refitter == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    refitter->device = device;
    refitter->account = account;
    bb_status status = get_kernels(refitter);
    if (status != BB_OK) {
        bb_refitter_destroy(refitter);
        return status;
    }
    *out = refitter;
    return BB_OK;
}

void bb_refitter_destroy(bb_refitter *refitter)
{
    if (refitter == NULL)
        return;
    bb_buffer_release(&refitter->parents);
    bb_buffer_release(&refitter->missing);
    bb_buffer_release(&refitter->sizes);
    bb_buffer_release(&refitter->marks);
    bb_buffer_release(&refitter->roots);
    bb_buffer_release(&refitter->root_count);
    bb_compaction_destroy(refitter->compaction);
    bb_primitives_destroy(refitter->primitives);
    bb_levels_release(&refitter->levels);
    bb_kernel_release(refitter->parents_kernel);
    bb_kernel_release(refitter->sizes_kernel);
    bb_kernel_release(refitter->mark);
    bb_kernel_release(refitter->subtrees);
    bb_kernel_release(refitter->leaves);
    bb_kernel_release(refitter->level);
    bb_program_release(refitter->program);
    free(refitter);
}

bb_status bb_refitter_reserve(bb_refitter *refitter, size_t nodes)
{
    size_t bytes = nodes * sizeof(uint32_t);
    BB_TRY(bb_buffer_reserve(refitter->device, refitter->account, bytes, "refit: parents",
                             &refitter->parents));
    BB_TRY(bb_buffer_reserve(refitter->device, refitter->account, bytes, "refit: missing children",
                             &refitter->missing));
    if (!by_levels(refitter)) {
        BB_TRY(bb_buffer_reserve(refitter->device, refitter->account, bytes, "refit: sizes",
                                 &refitter->sizes));
        BB_TRY(bb_buffer_reserve(refitter->device, refitter->account, bytes, "refit: marks",
                                 &refitter->marks));
        BB_TRY(bb_buffer_reserve(refitter->device, refitter->account, bytes, "refit: subtrees",
                                 &refitter->roots));
        BB_TRY(bb_buffer_reserve(refitter->device, refitter->account, sizeof(uint32_t),
                                 "refit: number of subtrees", &refitter->root_count));
        return bb_compaction_reserve(refitter->compaction, (uint32_t)nodes);
    }
    return bb_levels_reserve(&refitter->levels, refitter->device, refitter->account,
                             (uint32_t)nodes, 0, "refit: levels");
}

typedef struct level_job {
    bb_refitter *refitter;
    bb_tree *tree;
} level_job;

static bb_status fit_level(void *context, const bb_levels *levels, uint32_t n)
{
    const level_job *job = context;
    bb_refitter *refitter = job->refitter;
    return bb_launch(refitter->device, refitter->level, bb_levels_items(levels), GROUP_SIZE,
                     BB_MEM(job->tree->d_nodes), BB_MEM(refitter->parents),
                     BB_MEM(refitter->missing), BB_MEM(levels->lists[n % 2]), BB_VALUE(n),
                     BB_MEM(levels->counts), BB_MEM(levels->lists[(n + 1) % 2]));
}

static bb_status fit_by_levels(bb_refitter *refitter, const bb_buffer *boxes, bb_tree *tree)
{
    bb_levels *levels = &refitter->levels;
    level_job job = {refitter, tree};
    uint32_t count = tree->info.node_count;
    BB_TRY(bb_levels_reserve(levels, refitter->device, refitter->account, count, tree->info.depth,
                             "refit: levels"));
    BB_TRY(bb_levels_start(levels));
    BB_TRY(bb_launch(refitter->device, refitter->leaves, count, GROUP_SIZE, BB_MEM(tree->d_nodes),
                     BB_MEM(tree->d_refs), BB_MEM(*boxes), BB_VALUE(count),
                     BB_MEM(refitter->parents), BB_MEM(refitter->missing), BB_MEM(levels->counts),
                     BB_MEM(levels->lists[1])));
    return bb_levels_run(levels, fit_level, &job);
}

bb_status bb_refit_plan(bb_refitter *refitter, const bb_tree *tree)
{
    bb_device *device = refitter->device;
    uint32_t count = tree->info.node_count, root = tree->info.root;
    uint32_t most = device->is_cpu ? SUBTREE_CPU : SUBTREE_GPU;
    refitter->links = 0; /* until it is done */
    BB_TRY(bb_refitter_reserve(refitter, count));
    BB_TRY(bb_launch(device, refitter->parents_kernel, count, GROUP_SIZE, BB_MEM(tree->d_nodes),
                     BB_VALUE(count), BB_VALUE(root), BB_MEM(refitter->parents),
                     BB_MEM(refitter->missing)));
    if (!by_levels(refitter)) {
        BB_TRY(bb_launch(device, refitter->sizes_kernel, count, GROUP_SIZE, BB_MEM(tree->d_nodes),
                         BB_VALUE(count), BB_MEM(refitter->parents), BB_MEM(refitter->missing),
                         BB_MEM(refitter->sizes)));
        BB_TRY(bb_launch(device, refitter->mark, count, GROUP_SIZE, BB_MEM(refitter->sizes),
                         BB_VALUE(count), BB_VALUE(root), BB_VALUE(most), BB_MEM(refitter->parents),
                         BB_MEM(refitter->marks)));
        BB_TRY(bb_compact_u32(refitter->compaction, &refitter->marks, NULL, count, &refitter->roots,
                              &refitter->root_count));
        BB_TRY(bb_buffer_read(&refitter->root_count, 0, sizeof refitter->found, &refitter->found));
    }
    refitter->links = tree->links;
    return BB_OK;
}

bb_status bb_refit_device(bb_refitter *refitter, const bb_buffer *boxes, bb_tree *tree)
{
    if (tree->duplicated)
        return bb_fail(BB_UNSUPPORTED,
                       "refit: the tree has duplicated references, whose boxes do not follow from "
                       "the primitives'");
    if (tree->links != refitter->links)
        BB_TRY(bb_refit_plan(refitter, tree));
    refitter->links = 0; /* until it is done */
    if (by_levels(refitter))
        BB_TRY(fit_by_levels(refitter, boxes, tree));
    else
        BB_TRY(bb_launch(refitter->device, refitter->subtrees, refitter->found, GROUP_SIZE,
                         BB_MEM(tree->d_nodes), BB_MEM(tree->d_refs), BB_MEM(*boxes),
                         BB_MEM(refitter->roots), BB_MEM(refitter->root_count),
                         BB_MEM(refitter->parents), BB_MEM(refitter->missing)));
    refitter->links = tree->links;
    tree->disjoint = false;
    bb_tree_boxes_changed(tree);
    return BB_OK;
}
