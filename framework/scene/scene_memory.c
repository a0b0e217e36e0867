/* A scene's memory on the host. */
#include "framework/base/limits.h"
#include "framework/scene/prim.h"
#include "framework/scene/scene_private.h"
#include "framework/scene/tets.h"

#include <stdio.h>
#include <stdlib.h>

enum { PRIM_LIMIT = 0x7FFFFFFF };

/* Returns the bytes of a scene with these counts on the host, or on the device. At most about 2^38,
 * since the counts are bounded. */
static uint64_t scene_bytes(uint64_t vertices, const bb_prim_counts *counts)
{
    uint64_t bytes = vertices * 3 * sizeof(float);
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++)
        bytes += counts->of[kind] * (bb_prim_bytes(kind) + sizeof(bb_box));
    return bytes;
}

static bb_status check_counts(const bb_scene *scene, uint64_t vertex_count,
                              const bb_prim_counts *counts)
{
    uint64_t left = PRIM_LIMIT;
    bool fits = vertex_count <= UINT32_MAX;
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++) {
        fits = fits && counts->of[kind] <= left;
        left -= fits ? counts->of[kind] : 0;
    }
    if (fits)
        return BB_OK;
    char text[160] = "";
    for (uint32_t kind = 0, used = 0; kind < BB_KIND_COUNT; kind++)
        if (counts->of[kind] > 0)
            used += (uint32_t)snprintf(text + used, sizeof text - used, ", %llu %s",
                                       (unsigned long long)counts->of[kind],
                                       bb_prim_kinds[kind]->plural);
    return bb_fail(BB_REFUSED,
                   "%s: %llu vertices%s are more than 2^32 - 1 vertices or 2^31 - 1 primitives",
                   scene->name, (unsigned long long)vertex_count, text);
}

bb_status bb_scene_reserve(bb_scene *scene, uint64_t vertex_count, const bb_prim_counts *counts)
{
    BB_TRY(check_counts(scene, vertex_count, counts));
    uint64_t bytes = scene_bytes(vertex_count, counts);
    if (bytes > bb_host_limit())
        return bb_fail(BB_REFUSED,
                       "%s: the scene needs %llu bytes, three quarters of %s are %llu: take a "
                       "smaller scene",
                       scene->name, (unsigned long long)bytes, bb_memory_limit_by(),
                       (unsigned long long)bb_host_limit());
    BB_TRY(bb_host_alloc(NULL, (size_t)vertex_count * 3 * sizeof(float), "the scene's vertices",
                         &scene->vertices));
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++)
        BB_TRY(bb_host_alloc(NULL, (size_t)counts->of[kind] * bb_prim_bytes(kind),
                             "the scene's primitives", &scene->prims[kind].data));
    scene->vertex_count = scene->vertex_room = (uint32_t)vertex_count;
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++)
        scene->prims[kind].count = scene->prims[kind].room = (uint32_t)counts->of[kind];
    bb_scene_number_kinds(scene);
    return BB_OK;
}

bb_status bb_scene_reserve_mesh(bb_scene *scene, uint64_t vertex_count, uint64_t triangle_count)
{
    return bb_scene_reserve(scene, vertex_count,
                            &(bb_prim_counts){.of = {[BB_TRIANGLE] = triangle_count}});
}

bb_prim_ends bb_scene_ends(const bb_scene *scene)
{
    bb_prim_ends ends;
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++)
        ends.end[kind] = scene->prims[kind].first + scene->prims[kind].count;
    return ends;
}

bb_status bb_scene_reserve_objects(bb_scene *scene, uint32_t objects, uint32_t movers)
{
    BB_TRY(bb_host_alloc(NULL, ((size_t)objects + 1) * sizeof *scene->object_starts,
                         "objects of a scene", &scene->object_starts));
    BB_TRY(
        bb_host_alloc(NULL, movers * sizeof *scene->movers, "objects that move", &scene->movers));
    scene->object_count = objects;
    scene->mover_count = movers;
    return BB_OK;
}

void bb_scene_free(bb_scene *scene)
{
    if (scene == NULL)
        return;
    bb_buffer_release(&scene->on_device.boxes);
    bb_buffer_release(&scene->on_device.vertices);
    bb_buffer_release(&scene->on_device.prims);
    bb_buffer_release(&scene->on_device.bricks);
    bb_buffer_release(&scene->on_device.ranges);
    bb_buffer_release(&scene->on_device.seen);
    bb_buffer_release(&scene->on_device.tet_flags);
    bb_buffer_release(&scene->on_device.field);
    bb_host_free(scene->vertices);
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++)
        bb_host_free(scene->prims[kind].data);
    bb_host_free(scene->boxes);
    bb_scene_free_motion(scene);
    bb_host_free(scene->bricks);
    bb_host_free(scene->object_starts);
    bb_host_free(scene->movers);
    bb_volume_free(scene->volume);
    bb_tets_free(scene->tets);
    bb_host_free(scene->seal);
    free(scene);
}
