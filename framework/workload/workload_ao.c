/* Ambient occlusion: any hit within a short distance. */
#include "framework/judge/queries.h"
#include "framework/workload/hemisphere.h"
#include "framework/workload/workload.h"

static const bb_option options_table[] = {
    {"per_hit", "32", NULL, "rays per hit"},
    {"length", "0.1", NULL, "length of the rays, in scene diagonals"},
    BB_OFFSET_OPTION,
    BB_TMIN_OPTION,
    BB_LEAST_OPTION,
    BB_END_OPTION,
};

static bb_status make_ao(bb_rays_job *job)
{
    double length;
    BB_TRY(bb_spec_double(job->request->spec, job->options, "length", 1e-12, 1e12, &length));
    return bb_hemisphere_rays(job, (float)(length * job->diagonal));
}

extern const bb_workload bb_workload_ao;
const bb_workload bb_workload_ao = {
    .name = "ao",
    .summary = "ambient occlusion: short cosine-weighted rays from primary hits, any hit",
    .query = &bb_query_any,
    .options = options_table,
    .make = make_ao,
};
