#include "framework/judge/rays.h"

#include "framework/base/limits.h"
#include "framework/base/memory.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <xxhash.h>

bb_status bb_rays_check_room(const char *name, uint64_t count)
{
    uint64_t bytes = 2 * (sizeof(bb_ray) + sizeof(bb_hit)), limit = bb_host_limit();
    if (count <= limit / bytes)
        return BB_OK;
    return bb_fail(BB_REFUSED,
                   "rays %s: %" PRIu64 " of them take %" PRIu64 " bytes, with their hits and on "
                   "the device, and three quarters of %s are %" PRIu64 ": take at most %" PRIu64
                   " (--max-rays, or count=)",
                   name, count, count * bytes, bb_memory_limit_by(), limit, limit / bytes);
}

bb_status bb_rays_reserve(bb_rays *rays, uint32_t count)
{
    BB_TRY(bb_rays_check_room(rays->name, count));
    BB_TRY(bb_host_alloc(NULL, count * sizeof(bb_ray), "rays", &rays->rays));
    rays->count = count;
    return BB_OK;
}

bool bb_ray_set_direction(bb_ray *ray, const double d[3])
{
    bool usable = false;
    for (int k = 0; k < 3; k++) {
        ray->d[k] = (float)d[k];
        if (!isfinite(ray->d[k]))
            return false;
        usable |= ray->d[k] != 0.0f;
    }
    return usable;
}

bb_status bb_rays_check(const bb_scene *scene, const bb_rays *rays)
{
    float farthest = 0x1p92f / scene->scale; /* 2^34 times the scene's largest coordinate or more */
    for (uint32_t i = 0; i < rays->count; i++) {
        const bb_ray *ray = &rays->rays[i];
        bool finite = ray->tmin >= 0.0f && ray->tmax > ray->tmin;
        float out = 0.0f, length = 0.0f;
        for (int k = 0; k < 3; k++) {
            finite = finite && isfinite(ray->o[k]) && isfinite(ray->d[k]);
            out = fmaxf(out, fabsf(ray->o[k]));
            length = fmaxf(length, fabsf(ray->d[k]));
        }
        if (!finite || length == 0.0f)
            return bb_fail(BB_INVALID,
                           "rays %s: ray %u is not finite or has no length: move the view closer, "
                           "or check length and tmin",
                           rays->name, i);
        if (length < 0x1p-120f || length > 0x1p120f || out > farthest)
            return bb_fail(
                BB_INVALID,
                "rays %s: ray %u starts %g from the origin with a direction of %g, beyond "
                "what floats serve in scene '%s': move the view closer",
                rays->name, i, (double)out, (double)length, scene->name);
    }
    return BB_OK;
}

uint64_t bb_rays_hash(const bb_rays *rays)
{
    return XXH3_64bits(rays->rays, rays->count * sizeof(bb_ray));
}

bb_status bb_rays_upload(bb_rays *rays, bb_device *device)
{
    size_t bytes = rays->count * sizeof(bb_ray);
    if (rays->on_device.mem != NULL && rays->on_device.device == device)
        return BB_OK;
    bb_buffer_release(&rays->on_device);
    BB_TRY(bb_buffer_reserve(device, NULL, bytes, "rays", &rays->on_device));
    bb_status status = bb_buffer_write(&rays->on_device, 0, bytes, rays->rays);
    if (status != BB_OK)
        bb_buffer_release(&rays->on_device);
    return status;
}

void bb_rays_free(bb_rays *rays)
{
    if (rays == NULL)
        return;
    bb_buffer_release(&rays->on_device);
    bb_host_free(rays->rays);
    free(rays);
}
