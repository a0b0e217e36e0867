/* Host side of hlbvh_top.cl: lists the tasks of each level and cuts large ones into chunks. */
#include "hlbvh_top.h"

#include "builders/common/scene_unit.h"
#include "framework/base/arithmetic.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

BB_DEVICE_SOURCE(hlbvh_top);
BB_DEVICE_SOURCE(hlbvh_divide);
BB_DEVICE_SOURCE(hlbvh_divide_gpu);

/* On GPUs as many work-items as possible are used, on CPUs as many as keep all cores busy. */
enum {
    SMALL_GPU = 64,    /* largest task, in clusters, for one work-item */
    CHUNK_GPU = 128,   /* two groups' worth of clusters: few scenes need larger chunks */
    CHUNKS_GPU = 2048, /* most chunks of a list that is cut evenly */
    SMALL_CPU = 256,   /* lower bound; the number of cores may raise it */
    CHUNK_CPU = 2048,
    TASKS_PER_CORE = 8,
    GROUP_GPU = 32,
};

struct hl_top {
    bb_device *device;
    bb_account *account;
    size_t bin_bytes; /* of one chunk's bins */
    cl_program program, dividing;
    cl_kernel bin, divide, move, children, subtree;
    uint32_t small, chunk;            /* clusters of a small task; clusters per chunk */
    uint32_t tasks_most, chunks_most; /* most per level */
    bb_buffer tasks, waiting, splits, chunks, found, next, spare;
    hl_task *large;  /* tasks of the level; the root at first */
    hl_task *ready;  /* small tasks of any level, launched together */
    hl_task *halves; /* of the level's tasks */
    hl_chunk *cut;   /* the level's chunks */
    uint32_t large_count, ready_count, cut_count;
};

void hl_top_destroy(hl_top *top)
{
    if (top == NULL)
        return;
    bb_buffer *const buffers[] = {&top->tasks, &top->waiting, &top->splits, &top->chunks,
                                  &top->found, &top->next,    &top->spare};
    for (size_t i = 0; i < sizeof buffers / sizeof buffers[0]; i++)
        bb_buffer_release(buffers[i]);
    cl_kernel const kernels[] = {top->bin, top->divide, top->move, top->children, top->subtree};
    for (size_t i = 0; i < sizeof kernels / sizeof kernels[0]; i++)
        bb_kernel_release(kernels[i]);
    bb_program_release(top->program);
    bb_program_release(top->dividing);
    bb_host_free(top->large);
    bb_host_free(top->ready);
    bb_host_free(top->halves);
    bb_host_free(top->cut);
    free(top);
}

static bb_status compile(hl_top *top, uint32_t bins, bool by_prims)
{
    char defines[64];
    snprintf(defines, sizeof defines, "-DHL_BINS=%u%s", bins, by_prims ? " -DHL_BY_PRIMS" : "");
    BB_TRY(bb_program_build(top->device, &bb_source_hlbvh_top, defines, &top->program));
    BB_TRY(bb_program_build(top->device,
                            bb_cpu_form(top->device) ? &bb_source_hlbvh_divide
                                                     : &bb_source_hlbvh_divide_gpu,
                            defines, &top->dividing));
    BB_TRY(bb_kernel_get(top->dividing, "hl_bin", &top->bin));
    BB_TRY(bb_kernel_get(top->dividing, "hl_divide", &top->divide));
    BB_TRY(bb_kernel_get(top->program, "hl_move", &top->move));
    BB_TRY(bb_kernel_get(top->program, "hl_children", &top->children));
    return bb_kernel_get(top->program, "hl_subtree", &top->subtree);
}

bb_status hl_top_create(bb_device *device, bb_account *account, uint32_t bins, bool by_prims,
                        hl_top **out)
{
    hl_top *top = calloc(1, sizeof *top);
    if (top == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    top->device = device;
    top->account = account;
    top->bin_bytes = HL_BINS_BYTES((size_t)bins, by_prims ? 2 : 1);
    bb_status status = compile(top, bins, by_prims);
    if (status != BB_OK) {
        hl_top_destroy(top);
        return status;
    }
    *out = top;
    return BB_OK;
}

/* The sizes never decrease with the number of clusters, so memory for some number is enough for
 * fewer. */
static void choose_sizes(hl_top *top, uint32_t clusters)
{
    if (bb_cpu_form(top->device)) {
        uint32_t parts = TASKS_PER_CORE * top->device->compute_units;
        top->small = bb_max_u32(bb_divide_up(clusters, parts), SMALL_CPU);
        top->chunk = CHUNK_CPU;
        top->tasks_most = bb_min_u32(clusters / SMALL_CPU, parts) + 1;
        top->chunks_most = clusters / CHUNK_CPU + top->tasks_most;
    } else {
        top->small = SMALL_GPU;
        top->chunk = bb_max_u32(bb_divide_up(clusters, CHUNKS_GPU), CHUNK_GPU);
        top->tasks_most = clusters / SMALL_GPU + 1;
        top->chunks_most = bb_min_u32(clusters / CHUNK_GPU, CHUNKS_GPU) + top->tasks_most;
    }
}

bb_status hl_top_reserve(hl_top *top, uint32_t clusters)
{
    bb_device *device = top->device;
    bb_account *account = top->account;
    choose_sizes(top, clusters);
    size_t tasks = top->tasks_most, chunks = top->chunks_most;
    BB_TRY(
        bb_buffer_reserve(device, account, tasks * sizeof(hl_task), "hlbvh: tasks", &top->tasks));
    BB_TRY(bb_buffer_reserve(device, account, 2 * tasks * sizeof(hl_task), "hlbvh: small tasks",
                             &top->waiting));
    BB_TRY(bb_buffer_reserve(device, account, 2 * tasks * sizeof(hl_task), "hlbvh: halves",
                             &top->next));
    BB_TRY(bb_buffer_reserve(device, account, tasks * sizeof(hl_split), "hlbvh: splits",
                             &top->splits));
    BB_TRY(bb_buffer_reserve(device, account, chunks * sizeof(hl_chunk), "hlbvh: chunks",
                             &top->chunks));
    BB_TRY(bb_buffer_reserve(device, account, chunks * top->bin_bytes, "hlbvh: bins", &top->found));
    BB_TRY(bb_buffer_reserve(device, account, clusters * sizeof(hl_item), "hlbvh: clusters",
                             &top->spare));
    BB_TRY(bb_host_alloc(account, tasks * sizeof(hl_task), "hlbvh: tasks", &top->large));
    BB_TRY(bb_host_alloc(account, 2 * tasks * sizeof(hl_task), "hlbvh: tasks", &top->ready));
    BB_TRY(bb_host_alloc(account, 2 * tasks * sizeof(hl_task), "hlbvh: tasks", &top->halves));
    return bb_host_alloc(account, chunks * sizeof(hl_chunk), "hlbvh: chunks", &top->cut);
}

/* Arguments shared by all launches of a build. */
typedef struct job {
    hl_top *top;
    const hl_clusters *clusters;
    bb_tree *tree;
    float unit;
    uint32_t side; /* which of the two lists has the level's clusters */
} job;

static size_t group(const hl_top *top)
{
    return bb_cpu_form(top->device) ? 1 : GROUP_GPU;
}

static bb_status make_subtrees(job *j)
{
    hl_top *top = j->top;
    uint32_t count = top->ready_count;
    if (count == 0)
        return BB_OK;
    BB_TRY(bb_buffer_write(&top->waiting, 0, count * sizeof(hl_task), top->ready));
    top->ready_count = 0;
    return bb_launch(top->device, top->subtree, count, group(top), BB_MEM(top->waiting),
                     BB_VALUE(count), BB_MEM(*j->clusters->items), BB_MEM(top->spare),
                     BB_VALUE(j->unit), BB_MEM(*j->clusters->starts), BB_VALUE(j->clusters->count),
                     BB_MEM(*j->clusters->roots), BB_MEM(j->tree->d_nodes),
                     BB_MEM(j->tree->d_info));
}

/* Puts a task on the list for its size. */
static bb_status sort_in(job *j, const hl_task *task)
{
    hl_top *top = j->top;
    if (task->end - task->begin > top->small) {
        top->large[top->large_count++] = *task;
        return BB_OK;
    }
    if (top->ready_count == 2 * top->tasks_most)
        BB_TRY(make_subtrees(j));
    top->ready[top->ready_count++] = *task;
    return BB_OK;
}

static void cut_into_chunks(hl_top *top)
{
    top->cut_count = 0;
    for (uint32_t t = 0; t < top->large_count; t++) {
        hl_task *task = &top->large[t];
        task->first_chunk = top->cut_count;
        for (uint32_t at = task->begin; at < task->end; at += top->chunk) {
            uint32_t rest = task->end - at;
            top->cut[top->cut_count++] = (hl_chunk){
                .task = t, .begin = at, .end = at + (rest < top->chunk ? rest : top->chunk)};
        }
        task->chunk_count = top->cut_count - task->first_chunk;
    }
}

static bb_status split_level(job *j)
{
    hl_top *top = j->top;
    bb_device *device = top->device;
    cut_into_chunks(top);
    uint32_t tasks = top->large_count, chunks = top->cut_count;
    const size_t together = bb_cpu_form(device) ? 1 : HL_GROUP;
    const bb_buffer *from = j->side == 0 ? j->clusters->items : &top->spare;
    const bb_buffer *to = j->side == 0 ? &top->spare : j->clusters->items;
    BB_TRY(bb_buffer_write(&top->tasks, 0, tasks * sizeof(hl_task), top->large));
    BB_TRY(bb_buffer_write(&top->chunks, 0, chunks * sizeof(hl_chunk), top->cut));
    BB_TRY(bb_launch(device, top->bin, chunks * together, together, BB_MEM(top->tasks),
                     BB_MEM(top->chunks), BB_VALUE(chunks), BB_MEM(*from), BB_VALUE(j->unit),
                     BB_MEM(top->found)));
    BB_TRY(bb_launch(device, top->divide, tasks * together, together, BB_MEM(top->tasks),
                     BB_VALUE(tasks), BB_MEM(top->found), BB_VALUE(j->unit),
                     BB_MEM(*j->clusters->starts), BB_VALUE(j->clusters->count),
                     BB_MEM(j->tree->d_nodes), BB_MEM(top->splits), BB_MEM(top->chunks)));
    BB_TRY(bb_launch(device, top->move, chunks, group(top), BB_MEM(top->tasks), BB_MEM(top->splits),
                     BB_MEM(top->chunks), BB_VALUE(chunks), BB_MEM(*from), BB_MEM(*to),
                     BB_VALUE(j->unit)));
    BB_TRY(bb_launch(device, top->children, tasks, group(top), BB_MEM(top->tasks),
                     BB_MEM(top->splits), BB_VALUE(tasks), BB_MEM(top->chunks),
                     BB_MEM(*j->clusters->starts), BB_MEM(top->next)));
    BB_TRY(bb_buffer_read(&top->next, 0, 2 * tasks * sizeof(hl_task), top->halves));
    j->side = 1 - j->side;
    top->large_count = 0;
    for (uint32_t i = 0; i < 2 * tasks; i++)
        BB_TRY(sort_in(j, &top->halves[i]));
    return BB_OK;
}

bb_status hl_top_make(hl_top *top, const hl_clusters *clusters, bb_tree *tree, uint32_t *levels)
{
    job j = {.top = top,
             .clusters = clusters,
             .tree = tree,
             .unit = bb_scene_unit(&clusters->bounds[0])};
    hl_task root = {.end = clusters->count};
    for (int axis = 0; axis < 3; axis++) {
        root.lo[axis] = clusters->bounds[1].lo[axis] * j.unit;
        root.hi[axis] = clusters->bounds[1].hi[axis] * j.unit;
    }
    choose_sizes(top, clusters->count);
    top->large_count = top->ready_count = 0;
    BB_TRY(sort_in(&j, &root));
    for (*levels = 0; top->large_count > 0; ++*levels)
        BB_TRY(split_level(&j));
    return make_subtrees(&j);
}
