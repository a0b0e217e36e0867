/* Primary rays: one per pixel of a view. */
#include "framework/judge/queries.h"
#include "framework/scene/camera.h"
#include "framework/workload/workload.h"

static const bb_option options_table[] = {BB_TMIN_OPTION, BB_END_OPTION};

static bb_status make_primary(bb_rays_job *job)
{
    const bb_rays_request *request = job->request;
    if (request->view == NULL)
        return bb_fail(BB_INVALID, "rays primary: need a view");
    bb_camera camera;
    BB_TRY(bb_camera_make(request->view, request->width, request->height, &camera));
    BB_TRY(bb_rays_reserve(job->rays, request->width * request->height));
    job->rays->width = request->width;
    job->rays->height = request->height;
    for (uint32_t y = 0, i = 0; y < request->height; y++)
        for (uint32_t x = 0; x < request->width; x++, i++) {
            bb_camera_ray(&camera, x, y, &job->rays->rays[i]);
            job->rays->rays[i].tmin = job->tmin;
        }
    return BB_OK;
}

extern const bb_workload bb_workload_primary;
const bb_workload bb_workload_primary = {
    .name = "primary",
    .summary = "one ray per pixel, closest hit",
    .query = &bb_query_closest,
    .per_view = true,
    .options = options_table,
    .make = make_primary,
};
