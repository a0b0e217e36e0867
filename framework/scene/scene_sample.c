/* A scene made of some of another scene's primitives. */
#include "framework/scene/prim.h"
#include "framework/scene/scene_private.h"

#include <stdlib.h>
#include <string.h>

/* Returns the number of the k-th of `count` items taken from `of`: evenly spaced, starting with the
 * first. */
static size_t place(uint32_t k, uint32_t count, uint32_t of)
{
    return (size_t)((uint64_t)k * of / count);
}

static bb_prim_counts shares(const bb_scene *scene, uint32_t count)
{
    bb_prim_counts counts = {.of = {0}};
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++) {
        const uint64_t had = scene->prims[kind].count;
        const uint64_t share = had * count / scene->prim_count;
        counts.of[kind] = share > 0 || had == 0 ? share : 1;
    }
    return counts;
}

static const void *taken(const bb_scene *scene, uint32_t kind, uint32_t k, uint32_t count)
{
    return (const char *)scene->prims[kind].data +
           place(k, count, scene->prims[kind].count) * bb_prim_bytes(kind);
}

/* Numbers the vertices that are taken, in their order; the others get BB_NONE. Returns how many. */
static uint32_t number_vertices(const bb_scene *scene, const bb_prim_counts *counts,
                                uint32_t *numbers)
{
    uint32_t used = 0;
    memset(numbers, 0xFF, scene->vertex_count * sizeof *numbers);
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++)
        for (uint32_t k = 0; bb_prim_kinds[kind]->is_mesh && k < counts->of[kind]; k++) {
            const uint32_t *corners = taken(scene, kind, k, (uint32_t)counts->of[kind]);
            for (size_t c = 0; c < bb_prim_bytes(kind) / sizeof *corners; c++)
                numbers[corners[c]] = 0;
        }
    for (uint32_t v = 0; v < scene->vertex_count; v++)
        if (numbers[v] != BB_NONE)
            numbers[v] = used++;
    return used;
}

static void take_prims(const bb_scene *scene, const uint32_t *numbers, bb_scene *sample,
                       uint32_t kind)
{
    const size_t bytes = bb_prim_bytes(kind);
    const uint32_t count = sample->prims[kind].count;
    for (uint32_t k = 0; k < count; k++) {
        uint32_t *corners = (uint32_t *)((char *)sample->prims[kind].data + k * bytes);
        memcpy(corners, taken(scene, kind, k, count), bytes);
        for (size_t c = 0; bb_prim_kinds[kind]->is_mesh && c < bytes / sizeof *corners; c++)
            corners[c] = numbers[corners[c]];
    }
}

static bb_status fill(const bb_scene *scene, const uint32_t *numbers, bb_scene *sample)
{
    for (uint32_t v = 0; v < scene->vertex_count; v++)
        if (numbers[v] != BB_NONE)
            memcpy(sample->vertices + 3 * (size_t)numbers[v], scene->vertices + 3 * (size_t)v,
                   3 * sizeof *scene->vertices);
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++)
        take_prims(scene, numbers, sample, kind);
    return bb_scene_finish(sample);
}

bb_status bb_scene_sample(const bb_scene *scene, uint32_t count, bb_scene **out)
{
    const bb_prim_counts counts = shares(scene, count);
    bb_scene *sample = calloc(1, sizeof *sample);
    uint32_t *numbers = NULL;
    *out = NULL;
    if (sample == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    memcpy(sample->name, scene->name, sizeof sample->name);
    memcpy(sample->source, scene->source, sizeof sample->source);
    memcpy(sample->views, scene->views, sizeof sample->views);
    sample->view_count = scene->view_count;
    sample->profile = scene->profile;
    bb_status status = bb_host_alloc(NULL, scene->vertex_count * sizeof *numbers,
                                     "numbers of the sample's vertices", &numbers);
    if (status == BB_OK)
        status = bb_scene_reserve(sample, number_vertices(scene, &counts, numbers), &counts);
    if (status == BB_OK)
        status = fill(scene, numbers, sample);
    bb_host_free(numbers);
    if (status == BB_OK)
        *out = sample;
    else
        bb_scene_free(sample);
    return status;
}
