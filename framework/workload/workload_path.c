/* The rays of one bounce of a path tracer, as Meister and Bittner 2022 ("Performance Comparison of
 * Bounding Volume Hierarchies for GPU Ray Tracing") time them: with each bounce they are fewer and
 * less coherent. Surfaces are diffuse; no path is ended at random. */
#include "framework/judge/queries.h"
#include "framework/workload/hemisphere.h"
#include "framework/workload/workload.h"

static const bb_option options_table[] = {
    {"bounce", "2", NULL,
     "which rays of the paths, 1 to 64: 1 starts at primary hits, 2 where these rays hit"},
    BB_OFFSET_OPTION,
    BB_TMIN_OPTION,
    {"least", NULL, NULL,
     "at least so many paths begin: more pictures are taken, each ray at a random place of its "
     "pixel; default: one picture"},
    BB_END_OPTION,
};

static bb_status make_paths(bb_rays_job *job)
{
    uint64_t bounce;
    BB_TRY(bb_spec_u64(job->request->spec, job->options, "bounce", 1, 64, &bounce));
    return bb_hemisphere_paths(job, (uint32_t)bounce);
}

extern const bb_workload bb_workload_path;
const bb_workload bb_workload_path = {
    .name = "path",
    .summary = "one bounce of diffuse paths, one ray per path, closest hit",
    .query = &bb_query_closest,
    .options = options_table,
    .make = make_paths,
};
