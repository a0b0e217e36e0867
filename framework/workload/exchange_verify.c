/* Checks that the rays of a file are those of its workload, by generating them again. */
#include "framework/scene/camera.h"
#include "framework/workload/exchange_file.h"
#include "framework/workload/workload.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

static const bb_view *find_view(const bb_scene *scene, const char *name)
{
    for (uint32_t i = 0; i < scene->view_count; i++)
        if (strcmp(scene->views[i].name, name) == 0)
            return &scene->views[i];
    return NULL;
}

static bb_status compare(const char *path, const bb_rays *rays, const bb_rays *again)
{
    if (rays->hash == again->hash && rays->count == again->count && rays->width == again->width &&
        rays->height == again->height)
        return BB_OK;
    return bb_fail(BB_INVALID,
                   "rays file %s: its %" PRIu32 " rays with hash %016" PRIx64
                   " are not those of '%s', which are %" PRIu32 " with hash %016" PRIx64
                   ": make it anew, by this program on this machine",
                   path, rays->count, rays->hash, rays->name, again->count, again->hash);
}

bb_status bb_exchange_verify_rays(const char *path, const bb_scene *scene, bb_oracle *oracle,
                                  const bb_rays *rays)
{
    bb_rays_request request = {.spec = &rays->spec,
                               .width = rays->primary_width,
                               .height = rays->primary_height,
                               .max_rays = rays->max_rays,
                               .seed = rays->seed};
    uint64_t pixels = (uint64_t)request.width * request.height;
    if (pixels == 0 || pixels > BB_PIXELS_MAX)
        return bb_fail(BB_INVALID,
                       "rays file %s: primary rays of %" PRIu32 "x%" PRIu32
                       ": must be 1 to %u pixels",
                       path, request.width, request.height, (unsigned)BB_PIXELS_MAX);
    if (rays->view[0] != '\0') {
        request.view = find_view(scene, rays->view);
        if (request.view == NULL)
            return bb_fail(BB_INVALID, "rays file %s: the scene has no view '%s'", path,
                           rays->view);
    }
    bb_rays *again = NULL;
    if (bb_rays_make(scene, oracle, &request, &again) != BB_OK) {
        char reason[512];
        snprintf(reason, sizeof reason, "%s", bb_message());
        return bb_fail(BB_INVALID, "rays file %s: its rays cannot be made again: %s", path, reason);
    }
    bb_status status = compare(path, rays, again);
    bb_rays_free(again);
    return status;
}
