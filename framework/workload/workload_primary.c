/* Primary rays: one per pixel of a view. */
#include "framework/judge/queries.h"
#include "framework/workload/pixels.h"
#include "framework/workload/workload.h"

static const bb_option options_table[] = {BB_TMIN_OPTION, BB_LEAST_OPTION, BB_END_OPTION};

static bb_status make_primary(bb_rays_job *job)
{
    const bb_rays_request *request = job->request;
    if (request->view == NULL)
        return bb_fail(BB_INVALID, "rays primary: need a view");
    bb_camera camera;
    uint64_t least;
    const uint64_t pixels = (uint64_t)request->width * request->height;
    BB_TRY(bb_job_least(job, &least));
    BB_TRY(bb_camera_make(request->view, request->width, request->height, &camera));
    const uint64_t pictures = least > pixels ? (least - 1) / pixels + 1 : 1;
    BB_TRY(bb_rays_reserve(job->rays, (uint32_t)(pictures * pixels)));
    job->rays->width = pictures == 1 ? request->width : 0;
    job->rays->height = pictures == 1 ? request->height : 0;
    for (uint32_t i = 0; i < job->rays->count; i++) {
        bb_picture_ray(request, &camera, i, &job->rays->rays[i]);
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
