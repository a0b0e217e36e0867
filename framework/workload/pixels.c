#include "framework/workload/pixels.h"

#include "framework/base/random.h"

bb_status bb_job_least(const bb_rays_job *job, uint64_t *least)
{
    *least = 0;
    if (bb_spec_value(job->request->spec, job->options, "least") == NULL)
        return BB_OK;
    return bb_spec_u64(job->request->spec, job->options, "least", 1, 1u << 30, least);
}

void bb_picture_ray(const bb_rays_request *request, const bb_camera *camera, uint64_t index,
                    bb_ray *ray)
{
    const uint64_t pixels = (uint64_t)request->width * request->height, pixel = index % pixels;
    double x = (double)(pixel % request->width), y = (double)(pixel / request->width);
    if (index >= pixels) {
        bb_random random = bb_random_make(request->seed, 0x7069786500000000 + index);
        x += bb_random_range(&random, -0.5, 0.5);
        y += bb_random_range(&random, -0.5, 0.5);
    }
    bb_camera_ray(camera, x, y, ray);
}
