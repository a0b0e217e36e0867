/* Host side of pair_tree.cl. */
#include "builders/common/pair_tree.h"

#include "framework/device/levels.h"

#include <stdlib.h>

enum {
    GROUP_SIZE = 64,
    TASKS_MAX = 4096,
    TASKS_WANTED = 1024, /* CPUs: enough to spread over all cores, however long each takes */
};

struct bb_pair_tree {
    bb_device *device;
    bb_account *account;
    cl_program program;
    cl_kernel first;  /* pair_tree_top, or _start */
    cl_kernel second; /* pair_tree_walk, or _level */
    bb_buffer pairs;
    bb_buffer root;
    bb_buffer tasks; /* CPUs */
    bb_buffer total;
    bb_buffer spans; /* GPUs: uint4 per pair */
    bb_levels levels;
};

static bb_status get_kernels(bb_pair_tree *pairs)
{
    const bool cpu = bb_cpu_form(pairs->device);
    BB_TRY(bb_program_build(pairs->device, bb_source_find("pair_tree.cl"), "", &pairs->program));
    BB_TRY(bb_kernel_get(pairs->program, cpu ? "pair_tree_top" : "pair_tree_start", &pairs->first));
    return bb_kernel_get(pairs->program, cpu ? "pair_tree_walk" : "pair_tree_level",
                         &pairs->second);
}

bb_status bb_pair_tree_create(bb_device *device, bb_account *account, bb_pair_tree **out)
{
    bb_pair_tree *pairs = calloc(1, sizeof *pairs);
    if (pairs == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    pairs->device = device;
    pairs->account = account;
    bb_status status = get_kernels(pairs);
    if (status != BB_OK) {
        bb_pair_tree_destroy(pairs);
        return status;
    }
    *out = pairs;
    return BB_OK;
}

void bb_pair_tree_destroy(bb_pair_tree *pairs)
{
    if (pairs == NULL)
        return;
    bb_buffer_release(&pairs->pairs);
    bb_buffer_release(&pairs->root);
    bb_buffer_release(&pairs->tasks);
    bb_buffer_release(&pairs->total);
    bb_buffer_release(&pairs->spans);
    bb_levels_release(&pairs->levels);
    bb_kernel_release(pairs->first);
    bb_kernel_release(pairs->second);
    bb_program_release(pairs->program);
    free(pairs);
}

bb_status bb_pair_tree_reserve(bb_pair_tree *pairs, uint32_t count, bb_tree *tree)
{
    bb_device *device = pairs->device;
    bb_account *account = pairs->account;
    size_t n = count;
    BB_TRY(bb_tree_reserve(tree, device, BB_ON_DEVICE, 2 * n - 1, n));
    BB_TRY(bb_buffer_reserve(device, account, n * sizeof(bb_cluster_pair), "pairs of clusters",
                             &pairs->pairs));
    BB_TRY(bb_buffer_reserve(device, account, sizeof(bb_pair_side), "pairs: root", &pairs->root));
    if (device->form == BB_FORM_GPU) {
        BB_TRY(bb_buffer_reserve(device, account, n * 4 * sizeof(uint32_t), "pairs: spans",
                                 &pairs->spans));
        return bb_levels_reserve(&pairs->levels, device, account, count, count, "pairs: levels");
    }
    BB_TRY(bb_buffer_reserve(device, account, TASKS_MAX * sizeof(bb_pair_task), "pairs: tasks",
                             &pairs->tasks));
    return bb_buffer_reserve(device, account, sizeof(uint32_t), "pairs: tasks", &pairs->total);
}

const bb_buffer *bb_pair_tree_pairs(const bb_pair_tree *pairs)
{
    return &pairs->pairs;
}

const bb_buffer *bb_pair_tree_root(const bb_pair_tree *pairs)
{
    return &pairs->root;
}

/* Arguments of a launch over one level. */
typedef struct level_job {
    bb_pair_tree *pairs;
    bb_tree *tree;
    uint32_t count;
} level_job;

static bb_status open_level(void *context, const bb_levels *levels, uint32_t n)
{
    const level_job *job = context;
    bb_pair_tree *pairs = job->pairs;
    return bb_launch(pairs->device, pairs->second, bb_levels_items(levels), GROUP_SIZE,
                     BB_MEM(pairs->pairs), BB_VALUE(job->count), BB_MEM(job->tree->d_nodes),
                     BB_MEM(job->tree->d_refs), BB_MEM(job->tree->d_info), BB_MEM(pairs->spans),
                     BB_VALUE(n), BB_MEM(levels->counts), BB_MEM(levels->lists[n % 2]),
                     BB_MEM(levels->lists[(n + 1) % 2]));
}

static bb_status finish_by_levels(bb_pair_tree *pairs, uint32_t count, bb_tree *tree)
{
    level_job job = {pairs, tree, count};
    BB_TRY(bb_levels_start(&pairs->levels));
    BB_TRY(bb_launch(pairs->device, pairs->first, 1, 1, BB_MEM(pairs->root), BB_VALUE(count),
                     BB_MEM(tree->d_nodes), BB_MEM(tree->d_refs), BB_MEM(tree->d_info),
                     BB_MEM(pairs->spans), BB_MEM(pairs->levels.counts),
                     BB_MEM(pairs->levels.lists[1])));
    return bb_levels_run(&pairs->levels, open_level, &job);
}

bb_status bb_pair_tree_finish(bb_pair_tree *pairs, uint32_t count, bb_tree *tree)
{
    bb_device *device = pairs->device;
    const uint32_t share = count / TASKS_WANTED, most = TASKS_MAX;
    BB_TRY(bb_pair_tree_reserve(pairs, count, tree));
    tree->duplicated = false;
    tree->disjoint = false;
    if (device->form == BB_FORM_GPU)
        return finish_by_levels(pairs, count, tree);
    BB_TRY(bb_launch(device, pairs->first, 1, 1, BB_MEM(pairs->root), BB_MEM(pairs->pairs),
                     BB_VALUE(count), BB_MEM(tree->d_nodes), BB_MEM(tree->d_refs),
                     BB_MEM(tree->d_info), BB_VALUE(share), BB_VALUE(most), BB_MEM(pairs->tasks),
                     BB_MEM(pairs->total)));
    return bb_launch(device, pairs->second, TASKS_MAX / BB_PAIR_WALKS, 1, BB_MEM(pairs->pairs),
                     BB_VALUE(count), BB_MEM(tree->d_nodes), BB_MEM(tree->d_refs),
                     BB_MEM(tree->d_info), BB_MEM(pairs->tasks), BB_MEM(pairs->total));
}
