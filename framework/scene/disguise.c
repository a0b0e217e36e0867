#include "framework/scene/disguise.h"

#include "framework/scene/prim.h"
#include "framework/scene/scene_private.h"
#include "framework/scene/seal.h"

#include <math.h>
#include <string.h>

/* ---- the copy ---- */

static size_t vertex_bytes(const bb_scene *scene)
{
    return (size_t)scene->vertex_count * 3 * sizeof(float);
}

static size_t data_bytes(const bb_scene *scene, uint32_t kind)
{
    return scene->prims[kind].count * bb_prim_bytes(kind);
}

/* Copies into `to`, which has room. */
static bb_status copy_of(const void *from, size_t bytes, void *to)
{
    void **target = to;
    if (bytes == 0)
        return BB_OK;
    BB_TRY(bb_host_alloc(NULL, bytes, "a copy of the scene", target));
    memcpy(*target, from, bytes);
    return BB_OK;
}

static bb_status copy_scene(bb_disguise *disguise, bb_random *random, const bb_scene *scene)
{
    disguise->hash = scene->hash;
    disguise->first = bb_random_below(random, 7);
    BB_TRY(copy_of(scene->vertices, vertex_bytes(scene), &disguise->vertices));
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++)
        BB_TRY(copy_of(scene->prims[kind].data, data_bytes(scene, kind), &disguise->data[kind]));
    return BB_OK;
}

static void copy_back(const bb_disguise *disguise, bb_scene *scene)
{
    if (vertex_bytes(scene) > 0)
        memcpy(scene->vertices, disguise->vertices, vertex_bytes(scene));
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++)
        if (data_bytes(scene, kind) > 0)
            memcpy(scene->prims[kind].data, disguise->data[kind], data_bytes(scene, kind));
}

/* ---- the disguise ---- */

/* Whether the axis is worth mirroring, and primitives keep their sizes: what floats near the ends
 * of the box cannot tell apart must be small beside them. */
static bool can_mirror(const bb_scene *scene, int axis)
{
    const float lo = scene->bounds.lo[axis], hi = scene->bounds.hi[axis];
    const float far = fmaxf(fabsf(lo), fabsf(hi));
    const double step = (double)(nextafterf(far, INFINITY) - far);
    const bb_profile *profile = &scene->profile;
    const double size = profile->size_low > 0 ? profile->size_low : profile->size_median;
    return lo < hi && isfinite(step) && 16 * step <= size;
}

static uint32_t choose_axes(const bb_disguise *disguise, const bb_scene *scene)
{
    uint32_t axes = 1 + (disguise->first + disguise->count) % 7;
    for (int axis = 0; axis < 3; axis++)
        if (!can_mirror(scene, axis))
            axes &= ~(1u << axis);
    return axes;
}

static void mirror(bb_scene *scene, int axis, const bb_box *box)
{
    const float lo = box->lo[axis], hi = box->hi[axis];
    for (uint32_t i = 0; i < scene->vertex_count; i++) {
        float *at = &scene->vertices[3 * (size_t)i + (size_t)axis];
        *at = bb_mirrored(*at, lo, hi);
    }
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++)
        for (uint32_t i = 0; i < scene->prims[kind].count && !bb_prim_kinds[kind]->is_mesh; i++)
            bb_prim_kinds[kind]->mirror(scene, i, axis, lo, hi);
}

/* Writes the primitives from number `shift` on, then those before it. */
static void renumber(const bb_disguise *disguise, bb_scene *scene, uint32_t kind)
{
    const size_t bytes = data_bytes(scene, kind);
    const size_t before = disguise->shift[kind] * bb_prim_bytes(kind);
    const char *from = disguise->data[kind];
    char *to = scene->prims[kind].data;
    if (bytes == 0)
        return;
    memcpy(to, from + before, bytes - before);
    memcpy(to + (bytes - before), from, before);
}

static bb_status wear(bb_disguise *disguise, bb_random *random, bb_scene *scene)
{
    BB_TRY(bb_disguise_take_off(disguise, scene));
    const bb_box box = scene->bounds;
    disguise->worn = true;
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++) {
        const uint32_t count = scene->prims[kind].count;
        disguise->shift[kind] =
            count > 1 && scene->object_count == 0 ? 1 + bb_random_below(random, count - 1) : 0;
        renumber(disguise, scene, kind);
    }
    disguise->mirrored = choose_axes(disguise, scene);
    for (int axis = 0; axis < 3; axis++)
        if ((disguise->mirrored >> axis & 1) != 0)
            mirror(scene, axis, &box);
    disguise->count++;
    BB_TRY(bb_scene_finish_frame(scene));
    return bb_scene_upload_again(scene);
}

bb_status bb_disguise_put_on(bb_disguise *disguise, bb_random *random, bb_scene *scene)
{
    const int tries = 7; /* all axes that can be mirrored */
    if (scene->volume != NULL || scene->tets != NULL)
        return bb_fail(BB_UNSUPPORTED, "%s: has a volume or tetrahedra, and is not disguised",
                       scene->name);
    if (disguise->count == 0)
        BB_TRY(copy_scene(disguise, random, scene));
    for (int i = 0; i < tries; i++) {
        BB_TRY(wear(disguise, random, scene));
        if (scene->hash != disguise->hash)
            return BB_OK;
    }
    return bb_fail(BB_UNSUPPORTED, "%s: looks like itself in every disguise", scene->name);
}

bb_status bb_disguise_take_off(bb_disguise *disguise, bb_scene *scene)
{
    if (!disguise->worn)
        return BB_OK;
    copy_back(disguise, scene);
    BB_TRY(bb_scene_finish_frame(scene));
    BB_TRY(bb_scene_upload_again(scene));
    disguise->worn = false;
    bb_scene_is_whole(scene); /* whoever wrote into the disguise */
    return BB_OK;
}

void bb_disguise_end(bb_disguise *disguise)
{
    bb_host_free(disguise->vertices);
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++)
        bb_host_free(disguise->data[kind]);
    *disguise = (bb_disguise){0};
}
