/* Host side of refit.cl. */
#include "builders/common/refit.h"
#include "builders/common/subtrees.h"
#include "framework/device/levels.h"

#include <stdlib.h>

enum { GROUP_SIZE = 64 };

struct bb_refitter {
    bb_device *device;
    bb_account *account;
    bb_subtrees subtrees;
    uint64_t links; /* links (bb_tree) that `subtrees` is for; each pass restores missing[] */
    cl_program program;
    cl_kernel fit;           /* with a fence */
    cl_kernel leaves, level; /* by levels */
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
    BB_TRY(bb_subtrees_create(refitter->device, refitter->account, &refitter->subtrees));
    BB_TRY(bb_program_build(refitter->device, bb_source_find("refit.cl"), defines,
                            &refitter->program));
    if (!by_levels(refitter))
        return bb_kernel_get(refitter->program, "refit_subtrees", &refitter->fit);
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
    bb_subtrees_release(&refitter->subtrees);
    bb_levels_release(&refitter->levels);
    bb_kernel_release(refitter->fit);
    bb_kernel_release(refitter->leaves);
    bb_kernel_release(refitter->level);
    bb_program_release(refitter->program);
    free(refitter);
}

bb_status bb_refitter_choose(const bb_builder_context *context, bb_refitter **out)
{
    *out = NULL;
    if (!bb_spec_is(context->spec, context->options, "update", "refit"))
        return BB_OK;
    return bb_refitter_create(context->device, context->account, out);
}

bb_status bb_refitter_reserve(bb_refitter *refitter, size_t nodes)
{
    if (refitter == NULL)
        return BB_OK;
    BB_TRY(bb_subtrees_reserve(&refitter->subtrees, nodes));
    if (!by_levels(refitter))
        return BB_OK;
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
                     BB_MEM(job->tree->d_nodes), BB_MEM(refitter->subtrees.parents),
                     BB_MEM(refitter->subtrees.missing), BB_MEM(levels->lists[n % 2]), BB_VALUE(n),
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
                     BB_MEM(refitter->subtrees.parents), BB_MEM(refitter->subtrees.missing),
                     BB_MEM(levels->counts), BB_MEM(levels->lists[1])));
    return bb_levels_run(levels, fit_level, &job);
}

bb_status bb_refit_plan(bb_refitter *refitter, const bb_tree *tree)
{
    refitter->links = 0; /* until it is done */
    BB_TRY(bb_refitter_reserve(refitter, tree->info.node_count));
    BB_TRY(bb_subtrees_plan(&refitter->subtrees, tree));
    refitter->links = tree->links;
    return BB_OK;
}

bb_status bb_refit_device(bb_refitter *refitter, const bb_buffer *boxes, bb_tree *tree)
{
    const bb_subtrees *subtrees = &refitter->subtrees;
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
        BB_TRY(bb_launch(refitter->device, refitter->fit, subtrees->found, GROUP_SIZE,
                         BB_MEM(tree->d_nodes), BB_MEM(tree->d_refs), BB_MEM(*boxes),
                         BB_MEM(subtrees->roots), BB_MEM(subtrees->root_count),
                         BB_MEM(subtrees->parents), BB_MEM(subtrees->missing)));
    refitter->links = tree->links;
    tree->disjoint = false;
    bb_tree_boxes_changed(tree);
    return BB_OK;
}

bb_status bb_refit_update(bb_refitter *refitter, const bb_scene *scene, uint32_t changed,
                          bb_tree *tree, bb_phases *phases)
{
    if (refitter == NULL || changed != BB_CHANGED_POSITIONS)
        return bb_fail(BB_UNSUPPORTED, "the tree is built again");
    BB_TRY(bb_phase(phases, "refit"));
    BB_TRY(bb_refit_device(refitter, &scene->on_device.boxes, tree));
    return bb_phase(phases, NULL);
}
