/* A scene's copy on the device. */
#include "framework/scene/prim.h"
#include "framework/scene/scene_private.h"
#include "framework/scene/seal.h"
#include "framework/scene/tets.h"

#include <string.h>

enum {
    GROUP_SIZE = 64,
    PARTS = 8,
};

typedef struct part {
    const char *what;
    bb_buffer *buffer;
    uint64_t bytes;
} part;

/* Checks the room for all parts before allocating any, so that a refusal names the total and leaves
 * nothing behind.
 */
static bb_status check_room(const bb_scene *scene, const bb_device *device, const part parts[PARTS])
{
    uint64_t total = 0;
    for (size_t i = 0; i < PARTS; i++) {
        total += parts[i].bytes;
        if (parts[i].bytes > device->largest_allocation)
            return bb_fail(BB_REFUSED,
                           "%s: %s needs %llu bytes, the largest allocation of %s is %llu: take a "
                           "smaller scene or another device",
                           scene->name, parts[i].what, (unsigned long long)parts[i].bytes,
                           device->name, (unsigned long long)device->largest_allocation);
    }
    return bb_device_has_room(device, total, scene->name);
}

static uint64_t vertex_bytes(const bb_scene *scene)
{
    uint64_t room =
        scene->vertex_room > scene->vertex_count ? scene->vertex_room : scene->vertex_count;
    return room * 3 * sizeof(float);
}

static uint64_t prim_bytes(const bb_scene *scene)
{
    uint64_t bytes = 0;
    if (scene->volume != NULL)
        return bb_scene_box_room(scene) * bb_prim_bytes(BB_AABB);
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++) {
        const bb_prims *prims = &scene->prims[kind];
        uint64_t room = prims->room > prims->count ? prims->room : prims->count;
        bytes += room * bb_prim_bytes(kind);
    }
    return bytes;
}

/* Writes the data of all kinds, one after the other. */
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

/* Writes the parts of a volume that never change. */
static bb_status write_bricks(bb_scene *scene)
{
    bb_scene_device *there = &scene->on_device;
    const bb_volume *volume = scene->volume;
    BB_TRY(bb_buffer_write(&there->ranges, 0, volume->brick_count * sizeof *volume->ranges,
                           volume->ranges));
    return bb_buffer_write(&there->bricks, 0, (size_t)bb_volume_bytes(volume), volume->bricks);
}

static bb_status write_tets(bb_scene *scene)
{
    bb_scene_device *there = &scene->on_device;
    const bb_tets *tets = scene->tets;
    BB_TRY(bb_buffer_write(&there->tet_flags, 0,
                           scene->prims[BB_TETRAHEDRON].count * sizeof *tets->flags, tets->flags));
    return bb_buffer_write(&there->field, 0, scene->vertex_count * sizeof *tets->field,
                           tets->field);
}

/* Writes the parts that may change, into existing room. After a failure the scene is on no
 * device. */
static bb_status fill(bb_scene *scene)
{
    bb_scene_device *there = &scene->on_device;
    size_t bytes = (size_t)scene->vertex_count * 3 * sizeof(float);
    bb_status status = BB_OK;
    if (bytes > 0)
        status = bb_buffer_write(&there->vertices, 0, bytes, scene->vertices);
    if (status == BB_OK)
        status = write_prims(scene);
    if (status == BB_OK && scene->volume != NULL)
        status = bb_buffer_write(&there->seen, 0, sizeof scene->volume->seen, scene->volume->seen);
    if (status == BB_OK && scene->prim_count > 0)
        status = bb_scene_make_boxes(scene);
    if (status == BB_OK)
        status = bb_finish(there->device);
    if (status != BB_OK)
        there->device = NULL;
    return status;
}

static void list_parts(bb_scene *scene, part parts[PARTS])
{
    bb_scene_device *there = &scene->on_device;
    const bb_volume *volume = scene->volume;
    const uint64_t word = sizeof(uint32_t);
    const part all[PARTS] = {
        {"the scene's boxes", &there->boxes, bb_scene_box_room(scene) * sizeof(bb_box)},
        {"the scene's vertices", &there->vertices, vertex_bytes(scene)},
        {"the scene's primitives", &there->prims, prim_bytes(scene)},
        {"the volume's bricks", &there->bricks, volume != NULL ? bb_volume_bytes(volume) : 0},
        {"the ranges of the volume's bricks", &there->ranges,
         volume != NULL ? volume->brick_count * sizeof *volume->ranges : 0},
        {"what of the volume is seen", &there->seen, volume != NULL ? sizeof volume->seen : 0},
        {"flags of tetrahedra", &there->tet_flags, scene->prims[BB_TETRAHEDRON].count * word},
        {"a scalar field", &there->field, scene->tets != NULL ? scene->vertex_count * word : 0},
    };
    memcpy(parts, all, sizeof all);
}

bb_status bb_scene_has_room(bb_scene *scene, const bb_device *device)
{
    part parts[PARTS];
    list_parts(scene, parts);
    return check_room(scene, device, parts);
}

bb_status bb_scene_upload(bb_scene *scene, bb_device *device)
{
    bb_scene_device *there = &scene->on_device;
    if (there->device == device)
        return BB_OK;
    part parts[PARTS];
    list_parts(scene, parts);
    for (size_t i = 0; i < PARTS; i++)
        bb_buffer_release(parts[i].buffer); /* on another device */
    there->device = NULL;
    BB_TRY(check_room(scene, device, parts));
    for (size_t i = 0; i < PARTS; i++) {
        /* Kernels have an argument for each part, so each needs a buffer. */
        size_t bytes = parts[i].bytes > 0 ? (size_t)parts[i].bytes : sizeof(bb_box);
        BB_TRY(bb_buffer_reserve(device, &there->account, bytes, parts[i].what, parts[i].buffer));
    }
    there->device = device;
    BB_TRY(bb_scene_fill(scene));
    return bb_scene_seal(scene);
}

bb_status bb_scene_fill(bb_scene *scene)
{
    bb_status status = BB_OK;
    if (scene->volume != NULL)
        status = write_bricks(scene);
    if (status == BB_OK && scene->tets != NULL)
        status = write_tets(scene);
    if (status == BB_OK)
        return fill(scene);
    scene->on_device.device = NULL;
    return status;
}

bb_status bb_scene_upload_again(bb_scene *scene)
{
    if (scene->on_device.device == NULL)
        return BB_OK;
    BB_TRY(fill(scene));
    return bb_scene_seal(scene);
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
