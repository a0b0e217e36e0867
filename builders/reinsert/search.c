/* Host side of reinsert_search.cl. */
#include "search.h"

#include <stdio.h>
#include <stdlib.h>

BB_DEVICE_SOURCE(reinsert_search);

enum {
    GROUP_SIZE = 64,
    SAMPLES_MAX = 8192, /* families; at a share of 1 %, 164 subtrees set the threshold */
};

bb_status bb_reinsert_search_create(bb_device *device, bb_account *account,
                                    bb_primitives *primitives, uint32_t most,
                                    bb_reinsert_search *search)
{
    char defines[64];
    search->device = device;
    search->account = account;
    search->primitives = primitives;
    snprintf(defines, sizeof defines, "-DBB_SEARCH_MOST=%uu", most);
    BB_TRY(bb_program_build(device, &bb_source_reinsert_search, defines, &search->program));
    BB_TRY(bb_kernel_get(search->program, "search_sample", &search->sample));
    BB_TRY(bb_kernel_get(search->program, "search_mark", &search->mark));
    BB_TRY(bb_kernel_get(search->program, "search_find", &search->find));
    return bb_compaction_create(device, account, primitives, &search->compaction);
}

void bb_reinsert_search_release(bb_reinsert_search *search)
{
    bb_buffer_release(&search->samples);
    bb_host_free(search->samples_here);
    bb_buffer_release(&search->marks);
    bb_buffer_release(&search->list);
    bb_buffer_release(&search->listed);
    bb_buffer_release(&search->moves);
    bb_compaction_destroy(search->compaction);
    bb_kernel_release(search->sample);
    bb_kernel_release(search->mark);
    bb_kernel_release(search->find);
    bb_program_release(search->program);
    *search = (bb_reinsert_search){0};
}

static bb_status reserve(bb_reinsert_search *search, size_t bytes, const char *what, bb_buffer *out)
{
    return bb_buffer_reserve(search->device, search->account, bytes, what, out);
}

bb_status bb_reinsert_search_reserve(bb_reinsert_search *search, uint32_t count)
{
    const size_t places = 2 * (size_t)count, samples = 2 * (size_t)SAMPLES_MAX * sizeof(float);
    BB_TRY(reserve(search, samples, "reinsert: samples", &search->samples));
    BB_TRY(reserve(search, places * sizeof(uint32_t), "reinsert: marks", &search->marks));
    BB_TRY(reserve(search, places * sizeof(uint32_t), "reinsert: list", &search->list));
    BB_TRY(reserve(search, sizeof(uint32_t), "reinsert: length of the list", &search->listed));
    BB_TRY(reserve(search, places * sizeof(bb_move), "reinsert: moves", &search->moves));
    BB_TRY(bb_compaction_reserve(search->compaction, (uint32_t)places));
    if (search->samples_here != NULL)
        return BB_OK;
    return bb_host_alloc(search->account, samples, "reinsert: samples", &search->samples_here);
}

static int falling(const void *a, const void *b)
{
    float x = *(const float *)a, y = *(const float *)b;
    return x < y ? 1 : x > y ? -1 : 0;
}

/* Finds the area that about `share` of the subtrees reach. */
static bb_status find_threshold(bb_reinsert_search *search, const bb_family_tree *tree,
                                double share, float *least)
{
    const uint32_t step = tree->count / SAMPLES_MAX + 1, count = (tree->count - 1) / step + 1;
    *least = 0;
    if (share >= 1)
        return BB_OK;
    BB_TRY(bb_launch(search->device, search->sample, count, GROUP_SIZE, BB_MEM(tree->families),
                     BB_VALUE(step), BB_VALUE(count), BB_VALUE(tree->unit),
                     BB_MEM(search->samples)));
    BB_TRY(bb_buffer_read(&search->samples, 0, 2ul * count * sizeof(float), search->samples_here));
    qsort(search->samples_here, 2ul * count, sizeof(float), falling);
    *least = search->samples_here[(size_t)(share * (2 * count - 1))];
    return BB_OK;
}

bb_status bb_reinsert_choose(bb_reinsert_search *search, const bb_family_tree *tree, double share)
{
    float least;
    BB_TRY(find_threshold(search, tree, share, &least));
    BB_TRY(bb_launch(search->device, search->mark, tree->count, GROUP_SIZE, BB_MEM(tree->families),
                     BB_VALUE(tree->count), BB_VALUE(tree->unit), BB_VALUE(least),
                     BB_MEM(search->marks)));
    BB_TRY(bb_compact_u32(search->compaction, &search->marks, NULL, 2 * tree->count, &search->list,
                          &search->listed));
    return bb_buffer_read(&search->listed, 0, sizeof search->count, &search->count);
}

bb_status bb_reinsert_find(bb_reinsert_search *search, const bb_family_tree *tree, uint32_t part,
                           uint32_t parts, uint32_t begin, uint32_t *end)
{
    const uint32_t count = search->count > part ? (search->count - part - 1) / parts + 1 : 0;
    *end = begin + count;
    if (count == 0)
        return BB_OK;
    return bb_launch(search->device, search->find, count, GROUP_SIZE, BB_MEM(tree->families),
                     BB_VALUE(tree->count), BB_VALUE(tree->unit), BB_MEM(search->list),
                     BB_VALUE(part), BB_VALUE(parts), BB_VALUE(begin), BB_VALUE(count),
                     BB_MEM(search->moves));
}
