/* A hash of the request, which the shards of one run share. */
#include "framework/bench/bench.h"

#include <string.h>
#include <xxhash.h>

static uint64_t of_text(uint64_t hash, const char *text)
{
    return XXH3_64bits_withSeed(text, strlen(text) + 1, hash);
}

static uint64_t of_number(uint64_t hash, double value)
{
    return XXH3_64bits_withSeed(&value, sizeof value, hash);
}

static uint64_t of_texts(uint64_t hash, char *const *texts, uint32_t count)
{
    hash = of_number(hash, count);
    for (uint32_t i = 0; i < count; i++)
        hash = of_text(hash, texts[i]);
    return hash;
}

uint64_t bb_bench_request_hash(const bb_bench_request *r, uint64_t hash)
{
    const double numbers[] = {r->native,    r->width,   r->height,        r->max_rays,
                              r->max_views, r->repeats, r->max_wrong_ppm, r->lean};
    hash = of_texts(hash, r->scenes, r->scene_count);
    hash = of_texts(hash, r->builders, r->builder_count);
    hash = of_texts(hash, r->kernels, r->kernel_count);
    hash = of_texts(hash, r->intersectors, r->intersector_count);
    hash = of_texts(hash, r->workloads, r->workload_count);
    hash = of_texts(hash, r->metrics, r->metric_count);
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++)
        hash = of_number(hash, numbers[i]);
    hash = XXH3_64bits_withSeed(&r->seed, sizeof r->seed, hash);
    for (uint32_t i = 0; i < r->cell_count; i++) {
        char key[BB_CELL_KEY];
        if (bb_cell_key_format(&r->cells[i], key) == BB_OK)
            hash = of_text(hash, key);
    }
    return hash;
}
