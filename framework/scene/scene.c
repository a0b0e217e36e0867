/* A scene's memory, its checks, its boxes and its hash, and its copy on the device. */
#include "framework/scene/prim.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <xxhash.h>

enum { PRIM_LIMIT = 0x7FFFFFFF, GROUP_SIZE = 64 };

/* ---- memory ---- */

/* Bytes that a scene of these counts takes on the host, or on the device. At most 2^38 or so: the
 * counts are bounded. */
static uint64_t scene_bytes(uint64_t vertices, const bb_prim_counts *counts)
{
    uint64_t bytes = vertices * 3 * sizeof(float);
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++)
        bytes += counts->of[kind] * (bb_prim_bytes(kind) + sizeof(bb_box));
    return bytes;
}

/* Numbers the primitives through. */
static void number_kinds(bb_scene *scene)
{
    scene->kinds = scene->prim_count = 0;
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++) {
        bb_prims *prims = &scene->prims[kind];
        prims->first = scene->prim_count;
        scene->prim_count += prims->count;
        scene->kinds |= prims->count > 0 ? 1u << kind : 0;
    }
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
        return bb_fail(
            BB_REFUSED,
            "%s: the scene needs %llu bytes, three quarters of the host's memory are %llu",
            scene->name, (unsigned long long)bytes, (unsigned long long)bb_host_limit());
    BB_TRY(bb_host_alloc(NULL, (size_t)vertex_count * 3 * sizeof(float), "the scene's vertices",
                         &scene->vertices));
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++)
        BB_TRY(bb_host_alloc(NULL, (size_t)counts->of[kind] * bb_prim_bytes(kind),
                             "the scene's primitives", &scene->prims[kind].data));
    scene->vertex_count = (uint32_t)vertex_count;
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++)
        scene->prims[kind].count = (uint32_t)counts->of[kind];
    number_kinds(scene);
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

void bb_scene_free(bb_scene *scene)
{
    if (scene == NULL)
        return;
    bb_buffer_release(&scene->on_device.boxes);
    bb_buffer_release(&scene->on_device.vertices);
    bb_buffer_release(&scene->on_device.prims);
    bb_host_free(scene->vertices);
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++)
        bb_host_free(scene->prims[kind].data);
    bb_host_free(scene->boxes);
    free(scene);
}

/* ---- boxes ---- */

/* -0 equals +0, so which of them is the minimum would depend on who comes first. */
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
    BB_TRY(bb_host_alloc(NULL, (size_t)scene->prim_count * sizeof(bb_box), "the scene's boxes",
                         &scene->boxes));
    memset(&scene->bounds, 0, sizeof scene->bounds);
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++)
        BB_TRY(make_boxes_of(scene, kind));
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

/* Of the counts and the arrays. Kinds that came after spheres are left out where there are none, so that
 * a scene keeps its hash as kinds are added. */
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
    scene->hash = XXH3_64bits_digest(state);
    XXH3_freeState(state);
    return BB_OK;
}

bb_status bb_scene_finish(bb_scene *scene)
{
    uint64_t prims = 0;
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++)
        prims += scene->prims[kind].count;
    if (prims == 0)
        return bb_fail(BB_INVALID, "%s: has no primitive", scene->name);
    if (prims > PRIM_LIMIT)
        return bb_fail(BB_REFUSED, "%s: has %llu primitives, at most 2^31 - 1 can be handled",
                       scene->name, (unsigned long long)prims);
    number_kinds(scene);
    drop_negative_zeros(scene->vertices, 3 * (size_t)scene->vertex_count);
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++)
        if (!bb_prim_kinds[kind]->is_mesh)
            drop_negative_zeros(scene->prims[kind].data,
                                scene->prims[kind].count * bb_prim_bytes(kind) / sizeof(float));
    BB_TRY(make_boxes(scene));
    BB_TRY(bb_scene_choose_scale(scene));
    return hash_geometry(scene);
}

/* ---- the device ---- */

typedef struct part {
    const char *what;
    bb_buffer *buffer;
    const void *source;
    uint64_t bytes;
} part;

/* Asks for all of it before any of it, so that a refusal names the whole and leaves nothing behind.
 */
static bb_status check_room(const bb_scene *scene, const bb_device *device, const part *parts,
                            size_t count)
{
    uint64_t total = 0;
    for (size_t i = 0; i < count; i++) {
        total += parts[i].bytes;
        if (parts[i].bytes > device->largest_allocation)
            return bb_fail(BB_REFUSED,
                           "%s: %s needs %llu bytes, the largest allocation of %s is %llu: take a "
                           "smaller scene or another device",
                           scene->name, parts[i].what, (unsigned long long)parts[i].bytes,
                           device->name, (unsigned long long)device->largest_allocation);
    }
    uint64_t left = device->global_bytes > device->bytes ? device->global_bytes - device->bytes : 0;
    if (total > left)
        return bb_fail(BB_REFUSED,
                       "%s: needs %llu bytes, %s has %llu left: take a smaller scene or another "
                       "device",
                       scene->name, (unsigned long long)total, device->name,
                       (unsigned long long)left);
    return BB_OK;
}

static uint64_t prim_bytes(const bb_scene *scene)
{
    uint64_t bytes = 0;
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++)
        bytes += (uint64_t)scene->prims[kind].count * bb_prim_bytes(kind);
    return bytes;
}

/* The data of all kinds, one after the other. */
static bb_status write_prims(bb_scene *scene)
{
    size_t at = 0;
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++) {
        size_t bytes = scene->prims[kind].count * bb_prim_bytes(kind);
        if (bytes > 0)
            BB_TRY(bb_buffer_write(&scene->on_device.prims, at, bytes, scene->prims[kind].data));
        at += bytes;
    }
    return BB_OK;
}

bb_status bb_scene_upload(bb_scene *scene, bb_device *device)
{
    bb_scene_device *there = &scene->on_device;
    if (there->device == device)
        return BB_OK;
    const part parts[] = {
        {"the scene's boxes", &there->boxes, NULL, (uint64_t)scene->prim_count * sizeof(bb_box)},
        {"the scene's vertices", &there->vertices, scene->vertices,
         (uint64_t)scene->vertex_count * 3 * sizeof(float)},
        {"the scene's primitives", &there->prims, NULL, prim_bytes(scene)},
    };
    enum { PARTS = sizeof parts / sizeof parts[0] };
    for (size_t i = 0; i < PARTS; i++)
        bb_buffer_release(parts[i].buffer); /* of another device */
    there->device = NULL;
    BB_TRY(check_room(scene, device, parts, PARTS));
    for (size_t i = 0; i < PARTS; i++) {
        /* Kernels take a buffer for each part, so none of them stays without one. */
        size_t bytes = parts[i].bytes > 0 ? (size_t)parts[i].bytes : sizeof(bb_box);
        BB_TRY(bb_buffer_reserve(device, &there->account, bytes, parts[i].what, parts[i].buffer));
        if (parts[i].bytes > 0 && parts[i].source != NULL)
            BB_TRY(bb_buffer_write(parts[i].buffer, 0, (size_t)parts[i].bytes, parts[i].source));
    }
    there->device = device;
    bb_status status = write_prims(scene);
    if (status == BB_OK)
        status = bb_scene_make_boxes(scene);
    if (status == BB_OK)
        status = bb_finish(device);
    if (status != BB_OK)
        there->device = NULL;
    return status;
}

bb_status bb_scene_make_boxes(bb_scene *scene)
{
    const bb_scene_device *there = &scene->on_device;
    const bb_prim_ends ends = bb_scene_ends(scene);
    cl_program program = NULL;
    cl_kernel kernel = NULL;
    bb_status status = bb_program_build(there->device, bb_source_find("boxes.cl"), "", &program);
    if (status == BB_OK)
        status = bb_kernel_get(program, "make_boxes", &kernel);
    if (status == BB_OK)
        status = bb_launch(there->device, kernel, scene->prim_count, GROUP_SIZE,
                           BB_MEM(there->vertices), BB_MEM(there->prims), BB_VALUE(ends),
                           BB_VALUE(scene->prim_count), BB_MEM(there->boxes));
    bb_kernel_release(kernel);
    bb_program_release(program);
    return status;
}
