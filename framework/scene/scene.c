/* A scene's memory, its checks, its boxes and its hash, and its copy on the device. */
#include "framework/scene/scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <xxhash.h>

enum { PRIM_LIMIT = 0x7FFFFFFF, GROUP_SIZE = 64 };

/* ---- memory ---- */

/* Bytes that a scene of these counts takes on the host, or on the device. At most 2^38 or so: the
 * counts are bounded. */
static uint64_t scene_bytes(uint64_t vertices, uint64_t triangles, uint64_t spheres)
{
    return vertices * 3 * sizeof(float) + triangles * 3 * sizeof(uint32_t) +
           spheres * 4 * sizeof(float) + (triangles + spheres) * sizeof(bb_box);
}

bb_status bb_scene_reserve(bb_scene *scene, uint64_t vertex_count, uint64_t triangle_count,
                           uint64_t sphere_count)
{
    if (triangle_count > PRIM_LIMIT || sphere_count > PRIM_LIMIT - triangle_count ||
        vertex_count > UINT32_MAX)
        return bb_fail(BB_REFUSED,
                       "%s: %llu vertices, %llu triangles and %llu spheres are more than 2^32 - 1 "
                       "vertices or 2^31 - 1 primitives",
                       scene->name, (unsigned long long)vertex_count,
                       (unsigned long long)triangle_count, (unsigned long long)sphere_count);
    uint64_t bytes = scene_bytes(vertex_count, triangle_count, sphere_count);
    if (bytes > bb_host_limit())
        return bb_fail(
            BB_REFUSED,
            "%s: the scene needs %llu bytes, three quarters of the host's memory are %llu",
            scene->name, (unsigned long long)bytes, (unsigned long long)bb_host_limit());
    BB_TRY(bb_host_alloc(NULL, (size_t)vertex_count * 3 * sizeof(float), "the scene's vertices",
                         &scene->vertices));
    BB_TRY(bb_host_alloc(NULL, (size_t)triangle_count * 3 * sizeof(uint32_t), "the scene's indices",
                         &scene->indices));
    BB_TRY(bb_host_alloc(NULL, (size_t)sphere_count * 4 * sizeof(float), "the scene's spheres",
                         &scene->spheres));
    scene->vertex_count = (uint32_t)vertex_count;
    scene->triangle_count = (uint32_t)triangle_count;
    scene->sphere_count = (uint32_t)sphere_count;
    scene->prim_count = (uint32_t)(triangle_count + sphere_count);
    scene->kinds = (triangle_count > 0 ? (uint32_t)BB_TRIANGLES : 0) |
                   (sphere_count > 0 ? (uint32_t)BB_SPHERES : 0);
    return BB_OK;
}

void bb_scene_free(bb_scene *scene)
{
    if (scene == NULL)
        return;
    bb_buffer_release(&scene->on_device.boxes);
    bb_buffer_release(&scene->on_device.vertices);
    bb_buffer_release(&scene->on_device.indices);
    bb_buffer_release(&scene->on_device.spheres);
    bb_host_free(scene->vertices);
    bb_host_free(scene->indices);
    bb_host_free(scene->spheres);
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

static bb_status triangle_box(const bb_scene *scene, uint32_t triangle, bb_box *box)
{
    const float *corner[3];
    for (uint32_t k = 0; k < 3; k++) {
        uint32_t index = scene->indices[3 * (size_t)triangle + k];
        if (index >= scene->vertex_count)
            return bb_fail(BB_INVALID, "%s: triangle %u: index %u is beyond its %u vertices",
                           scene->name, triangle, index, scene->vertex_count);
        corner[k] = scene->vertices + 3 * (size_t)index;
    }
    for (int axis = 0; axis < 3; axis++) {
        float a = corner[0][axis], b = corner[1][axis], c = corner[2][axis];
        float low = a < b ? a : b, high = a < b ? b : a;
        box->lo[axis] = c < low ? c : low;
        box->hi[axis] = c > high ? c : high;
        if (!isfinite(a) || !isfinite(b) || !isfinite(c))
            return bb_fail(BB_INVALID, "%s: triangle %u has a vertex that is not finite (%g %g %g)",
                           scene->name, triangle, (double)a, (double)b, (double)c);
    }
    return BB_OK;
}

/* The largest float that is not above a + b. The double sum and its error are exact together
 * (Knuth's two-sum), so the result bounds the true sum, however far apart the two are. */
static float sum_down(float a, float b)
{
    double x = a, y = b;
    double sum = x + y;
    double part = sum - x;
    double error = (x - (sum - part)) + (y - part);
    float down = (float)sum;
    if ((double)down > sum || ((double)down == sum && error < 0))
        down = nextafterf(down, -INFINITY);
    return down;
}

static bb_status sphere_box(const bb_scene *scene, uint32_t sphere, bb_box *box)
{
    const float *s = scene->spheres + 4 * (size_t)sphere;
    bool good = isfinite(s[3]) && s[3] >= 0;
    for (int axis = 0; axis < 3; axis++) {
        box->lo[axis] = sum_down(s[axis], -s[3]);
        box->hi[axis] = -sum_down(-s[axis], -s[3]);
        good = good && isfinite(s[axis]) && isfinite(box->lo[axis]) && isfinite(box->hi[axis]);
    }
    if (!good)
        return bb_fail(BB_INVALID,
                       "%s: sphere %u (centre %g %g %g, radius %g) must be finite, its radius not "
                       "negative",
                       scene->name, sphere, (double)s[0], (double)s[1], (double)s[2], (double)s[3]);
    return BB_OK;
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

static bb_status make_boxes(bb_scene *scene)
{
    BB_TRY(bb_host_alloc(NULL, (size_t)scene->prim_count * sizeof(bb_box), "the scene's boxes",
                         &scene->boxes));
    memset(&scene->bounds, 0, sizeof scene->bounds);
    for (uint32_t prim = 0; prim < scene->prim_count; prim++) {
        bb_box *box = &scene->boxes[prim];
        box->pad0 = box->pad1 = 0;
        if (prim < scene->triangle_count)
            BB_TRY(triangle_box(scene, prim, box));
        else
            BB_TRY(sphere_box(scene, prim - scene->triangle_count, box));
        if (prim == 0)
            scene->bounds = *box;
        else
            grow(&scene->bounds, box);
    }
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

static bb_status hash_geometry(bb_scene *scene)
{
    XXH3_state_t *state = XXH3_createState();
    if (state == NULL)
        return bb_fail(BB_REFUSED, "%s: no memory for a hash", scene->name);
    const uint32_t counts[] = {scene->vertex_count, scene->triangle_count, scene->sphere_count};
    XXH3_64bits_reset(state);
    XXH3_64bits_update(state, counts, sizeof counts);
    if (scene->vertex_count > 0)
        XXH3_64bits_update(state, scene->vertices, (size_t)scene->vertex_count * 3 * sizeof(float));
    if (scene->triangle_count > 0)
        XXH3_64bits_update(state, scene->indices,
                           (size_t)scene->triangle_count * 3 * sizeof(uint32_t));
    if (scene->sphere_count > 0)
        XXH3_64bits_update(state, scene->spheres, (size_t)scene->sphere_count * 4 * sizeof(float));
    scene->hash = XXH3_64bits_digest(state);
    XXH3_freeState(state);
    return BB_OK;
}

bb_status bb_scene_finish(bb_scene *scene)
{
    uint64_t prims = (uint64_t)scene->triangle_count + scene->sphere_count;
    if (prims == 0)
        return bb_fail(BB_INVALID, "%s: has no primitive", scene->name);
    if (prims > PRIM_LIMIT)
        return bb_fail(BB_REFUSED, "%s: has %llu primitives, at most 2^31 - 1 can be handled",
                       scene->name, (unsigned long long)prims);
    scene->prim_count = (uint32_t)prims;
    scene->kinds = (scene->triangle_count > 0 ? (uint32_t)BB_TRIANGLES : 0) |
                   (scene->sphere_count > 0 ? (uint32_t)BB_SPHERES : 0);
    drop_negative_zeros(scene->vertices, 3 * (size_t)scene->vertex_count);
    drop_negative_zeros(scene->spheres, 4 * (size_t)scene->sphere_count);
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

bb_status bb_scene_upload(bb_scene *scene, bb_device *device)
{
    bb_scene_device *there = &scene->on_device;
    if (there->device == device)
        return BB_OK;
    const part parts[] = {
        {"the scene's boxes", &there->boxes, NULL, (uint64_t)scene->prim_count * sizeof(bb_box)},
        {"the scene's vertices", &there->vertices, scene->vertices,
         (uint64_t)scene->vertex_count * 3 * sizeof(float)},
        {"the scene's indices", &there->indices, scene->indices,
         (uint64_t)scene->triangle_count * 3 * sizeof(uint32_t)},
        {"the scene's spheres", &there->spheres, scene->spheres,
         (uint64_t)scene->sphere_count * 4 * sizeof(float)},
    };
    enum { PARTS = sizeof parts / sizeof parts[0] };
    for (size_t i = 0; i < PARTS; i++)
        bb_buffer_release(parts[i].buffer); /* of another device */
    there->device = NULL;
    BB_TRY(check_room(scene, device, parts, PARTS));
    for (size_t i = 0; i < PARTS; i++) {
        /* Kernels take a buffer for each kind, so none of them stays without one. */
        size_t bytes = parts[i].bytes > 0 ? (size_t)parts[i].bytes : sizeof(bb_box);
        BB_TRY(bb_buffer_reserve(device, &there->account, bytes, parts[i].what, parts[i].buffer));
        if (parts[i].bytes > 0 && parts[i].source != NULL)
            BB_TRY(bb_buffer_write(parts[i].buffer, 0, (size_t)parts[i].bytes, parts[i].source));
    }
    there->device = device;
    bb_status status = bb_scene_make_boxes(scene);
    if (status == BB_OK)
        status = bb_finish(device);
    if (status != BB_OK)
        there->device = NULL;
    return status;
}

bb_status bb_scene_make_boxes(bb_scene *scene)
{
    const bb_scene_device *there = &scene->on_device;
    cl_program program = NULL;
    cl_kernel kernel = NULL;
    bb_status status = bb_program_build(there->device, bb_source_find("boxes.cl"), "", &program);
    if (status == BB_OK)
        status = bb_kernel_get(program, "make_boxes", &kernel);
    if (status == BB_OK)
        status = bb_launch(there->device, kernel, scene->prim_count, GROUP_SIZE,
                           BB_MEM(there->vertices), BB_MEM(there->indices), BB_MEM(there->spheres),
                           BB_VALUE(scene->triangle_count), BB_VALUE(scene->prim_count),
                           BB_MEM(there->boxes));
    bb_kernel_release(kernel);
    bb_program_release(program);
    return status;
}
