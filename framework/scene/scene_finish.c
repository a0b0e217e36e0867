/* Completes a filled scene: checks, boxes and hash. */
#include "framework/scene/prim.h"
#include "framework/scene/scene_private.h"
#include "framework/scene/tets.h"

#include <math.h>
#include <string.h>
#include <xxhash.h>

enum { PRIM_LIMIT = 0x7FFFFFFF };

/* ---- boxes ---- */

/* -0 equals +0, so the minimum of both would depend on their order. */
static void drop_negative_zeros(float *values, size_t count)
{
    for (size_t i = 0; i < count; i++)
        values[i] += 0.0f;
}

static void grow(bb_box *bounds, const bb_box *box)
{
    for (int axis = 0; axis < 3; axis++) {
        if (box->lo[axis] < bounds->lo[axis])
            bounds->lo[axis] = box->lo[axis];
        if (box->hi[axis] > bounds->hi[axis])
            bounds->hi[axis] = box->hi[axis];
    }
}

static bb_status make_boxes_of(bb_scene *scene, uint32_t kind)
{
    const bb_prims *prims = &scene->prims[kind];
    for (uint32_t i = 0; i < prims->count; i++) {
        bb_box *box = &scene->boxes[prims->first + i];
        box->pad0 = box->pad1 = 0;
        BB_TRY(bb_prim_kinds[kind]->bounds(scene, i, box));
        if (prims->first + i == 0)
            scene->bounds = *box;
        else
            grow(&scene->bounds, box);
    }
    return BB_OK;
}

static bb_status make_boxes(bb_scene *scene)
{
    memset(&scene->bounds, 0, sizeof scene->bounds);
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++)
        BB_TRY(make_boxes_of(scene, kind));
    if (scene->volume != NULL)
        bb_scene_volume_bounds(scene, &scene->bounds);
    for (int axis = 0; axis < 3; axis++)
        if (!isfinite(scene->bounds.hi[axis] - scene->bounds.lo[axis]))
            return bb_fail(
                BB_INVALID,
                "%s: reaches from %g to %g on axis %c, too far for a float: scale it down",
                scene->name, (double)scene->bounds.lo[axis], (double)scene->bounds.hi[axis],
                "xyz"[axis]);
    return BB_OK;
}

/* ---- finishing ---- */

/* Hashes the counts and the arrays. Kinds after spheres are only hashed if present, so that a scene
 * keeps its hash when kinds are added. */
static bb_status hash_geometry(bb_scene *scene)
{
    XXH3_state_t *state = XXH3_createState();
    if (state == NULL)
        return bb_fail(BB_REFUSED, "%s: no memory for a hash", scene->name);
    XXH3_64bits_reset(state);
    XXH3_64bits_update(state, &scene->vertex_count, sizeof scene->vertex_count);
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++)
        if (kind <= BB_SPHERE || scene->prims[kind].count > 0)
            XXH3_64bits_update(state, &scene->prims[kind].count, sizeof scene->prims[kind].count);
    if (scene->vertex_count > 0)
        XXH3_64bits_update(state, scene->vertices, (size_t)scene->vertex_count * 3 * sizeof(float));
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++)
        if (scene->prims[kind].count > 0)
            XXH3_64bits_update(state, scene->prims[kind].data,
                               scene->prims[kind].count * bb_prim_bytes(kind));
    if (scene->volume != NULL)
        XXH3_64bits_update(state, &scene->volume->hash, sizeof scene->volume->hash);
    scene->hash = XXH3_64bits_digest(state);
    XXH3_freeState(state);
    return BB_OK;
}

bb_status bb_scene_finish_frame(bb_scene *scene)
{
    drop_negative_zeros(scene->vertices, 3 * (size_t)scene->vertex_count);
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++)
        if (!bb_prim_kinds[kind]->is_mesh)
            drop_negative_zeros(scene->prims[kind].data,
                                scene->prims[kind].count * bb_prim_bytes(kind) / sizeof(float));
    BB_TRY(make_boxes(scene));
    BB_TRY(bb_scene_choose_scale(scene));
    return hash_geometry(scene);
}

bb_status bb_scene_finish(bb_scene *scene)
{
    uint64_t prims = 0;
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++)
        prims += scene->prims[kind].count;
    if (prims == 0 && scene->volume == NULL)
        return bb_fail(BB_INVALID, "%s: has no primitive", scene->name);
    if (prims > PRIM_LIMIT)
        return bb_fail(BB_REFUSED, "%s: has %llu primitives, at most 2^31 - 1 can be handled",
                       scene->name, (unsigned long long)prims);
    bb_scene_number_kinds(scene);
    BB_TRY(bb_host_alloc(NULL, bb_scene_box_room(scene) * sizeof(bb_box), "the scene's boxes",
                         &scene->boxes));
    if (scene->frame_count == 0)
        scene->frame_count = 1;
    BB_TRY(bb_scene_finish_frame(scene));
    return bb_scene_finish_tets(scene);
}
