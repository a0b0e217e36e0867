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

static bb_status fill(const bb_scene *scene, bb_scene *sample)
{
    if (scene->vertex_count > 0)
        memcpy(sample->vertices, scene->vertices,
               (size_t)scene->vertex_count * 3 * sizeof *scene->vertices);
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++) {
        const size_t bytes = bb_prim_bytes(kind);
        const uint32_t count = sample->prims[kind].count;
        for (uint32_t k = 0; k < count; k++)
            memcpy((char *)sample->prims[kind].data + k * bytes,
                   (const char *)scene->prims[kind].data +
                       place(k, count, scene->prims[kind].count) * bytes,
                   bytes);
    }
    return bb_scene_finish(sample);
}

bb_status bb_scene_sample(const bb_scene *scene, uint32_t count, bb_scene **out)
{
    const bb_prim_counts counts = shares(scene, count);
    bb_scene *sample = calloc(1, sizeof *sample);
    *out = NULL;
    if (sample == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    memcpy(sample->name, scene->name, sizeof sample->name);
    memcpy(sample->source, scene->source, sizeof sample->source);
    memcpy(sample->views, scene->views, sizeof sample->views);
    sample->view_count = scene->view_count;
    sample->profile = scene->profile;
    bb_status status = bb_scene_reserve(sample, scene->vertex_count, &counts);
    if (status == BB_OK)
        status = fill(scene, sample);
    if (status == BB_OK)
        *out = sample;
    else
        bb_scene_free(sample);
    return status;
}
