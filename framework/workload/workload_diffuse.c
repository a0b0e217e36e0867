/* Diffuse rays: one unbounded bounce. */
#include "framework/judge/queries.h"
#include "framework/workload/hemisphere.h"
#include "framework/workload/workload.h"

#include <math.h>

static const bb_option options_table[] = {
    {"per_hit", "32", NULL, "rays per hit"},
    BB_OFFSET_OPTION,
    BB_TMIN_OPTION,
    BB_LEAST_OPTION,
    BB_END_OPTION,
};

static bb_status make_diffuse(bb_rays_job *job)
{
    return bb_hemisphere_rays(job, INFINITY);
}

extern const bb_workload bb_workload_diffuse;
const bb_workload bb_workload_diffuse = {
    .name = "diffuse",
    .summary = "unbounded cosine-weighted rays from primary hits, closest hit",
    .query = &bb_query_closest,
    .options = options_table,
    .make = make_diffuse,
};
