/* Shadow rays: from visible surfaces to points of a square light under the top of the scene's
 * box. */
#include "framework/judge/queries.h"
#include "framework/workload/surface.h"
#include "framework/workload/workload.h"

#include <math.h>

static const bb_option options_table[] = {
    {"size", "0.25", NULL, "side of the square light, relative to the box's shorter side"},
    {"drop", "0.01", NULL, "distance of the light below the box's top, relative to its height"},
    BB_OFFSET_OPTION,
    BB_TMIN_OPTION,
    BB_LEAST_OPTION,
    BB_END_OPTION,
};

/* A square, perpendicular to the axis that points up in the first view. */
typedef struct light {
    int axis;
    double centre[3];
    double half; /* of its side */
    float tmin;
} light;

static bb_status place_light(const bb_rays_job *job, light *light)
{
    double size, drop, side = INFINITY, widest = 0.0;
    BB_TRY(bb_spec_double(job->request->spec, job->options, "size", 0.0, 100.0, &size));
    BB_TRY(bb_spec_double(job->request->spec, job->options, "drop", 0.0, 1.0, &drop));
    const bb_view *view = job->request->view != NULL ? job->request->view : &job->scene->views[0];
    const bb_box *box = &job->scene->bounds;
    light->axis = 0;
    for (int k = 1; k < 3; k++)
        if (fabs(view->up[k]) > fabs(view->up[light->axis]))
            light->axis = k;
    for (int k = 0; k < 3; k++) {
        double extent = (double)box->hi[k] - (double)box->lo[k];
        light->centre[k] = 0.5 * box->lo[k] + 0.5 * box->hi[k];
        if (k == light->axis)
            light->centre[k] =
                view->up[k] < 0.0 ? box->lo[k] + drop * extent : box->hi[k] - drop * extent;
        else {
            side = fmin(side, extent);
            widest = fmax(widest, extent);
        }
    }
    light->half = 0.5 * size * (side > 0.0 ? side : widest);
    light->tmin = job->tmin;
    return BB_OK;
}

/* Makes a ray from the surface (t = 0) to the light (t = 1). */
static bb_status make_shadow(void *context, const bb_surface_point *point, bb_random *random,
                             bb_ray *ray)
{
    const light *light = context;
    ray->tmin = light->tmin;
    ray->tmax = 1.0f;
    for (int tries = 0; tries < 1000; tries++) {
        double d[3];
        for (int k = 0; k < 3; k++) {
            ray->o[k] = (float)point->o[k];
            double at = light->centre[k];
            if (k != light->axis)
                at += light->half * bb_random_range(random, -1.0, 1.0);
            d[k] = at - point->o[k];
        }
        if (bb_ray_set_direction(ray, d))
            return BB_OK;
    }
    return bb_fail(BB_UNSUPPORTED, "rays shadow: a surface lies in the light, which is a point: "
                                   "give drop or size");
}

static bb_status make_shadows(bb_rays_job *job)
{
    light light;
    if (job->request->view == NULL && job->scene->view_count == 0)
        return bb_fail(BB_UNSUPPORTED, "rays shadow: scene '%s' has no view", job->scene->name);
    BB_TRY(place_light(job, &light));
    return bb_surface_rays(job, 1, make_shadow, &light);
}

extern const bb_workload bb_workload_shadow;
const bb_workload bb_workload_shadow = {
    .name = "shadow",
    .summary = "one ray per primary hit to a point of a square light, any hit",
    .query = &bb_query_any,
    .options = options_table,
    .make = make_shadows,
};
