#include "framework/stress/stress_private.h"

#include "framework/base/clock.h"
#include "framework/base/interrupt.h"
#include "framework/base/progress.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

typedef struct watched {
    bb_points points;
    bb_progress *progress;
} watched;

static bb_status measure(void *user, bb_wish *wishes, uint32_t count, bool again)
{
    watched *w = user;
    bb_progress_step(w->progress);
    return bb_point_measure(&w->points, wishes, count, again);
}

/* The extent of a run. */
static uint32_t max_rays(const bb_stress_request *request)
{
    return request->quick ? 1024 : 4096;
}

static uint32_t repeats(const bb_stress_request *request)
{
    return request->quick ? 1 : 3;
}

bb_points bb_stress_points(const bb_stress_request *r, const bb_axis *axis)
{
    return (bb_points){.axis = axis,
                       .methods = r->methods,
                       .method_count = r->method_count,
                       .n = r->quick ? axis->quick_n : axis->n,
                       .max_rays = max_rays(r),
                       .repeats = repeats(r),
                       .seed = r->seed,
                       .metrics = r->metrics,
                       .simts = r->simts,
                       .simt_count = r->simt_count,
                       .limits = r->limits,
                       .open_device = r->open_device,
                       .user = r->user};
}

static bb_status search_axis(bb_stress *s, bb_stress_axis *a, const char *points,
                             bb_progress *progress)
{
    const bb_stress_request *r = s->request;
    const uint32_t quick_intervals = a->axis.intervals < 2 ? a->axis.intervals : 2;
    watched w = {.progress = progress, .points = bb_stress_points(r, &a->axis)};
    w.points.folder = points;
    w.points.identity = s->identity;
    a->n = w.points.n;
    a->search = (bb_search){.axis = &a->axis,
                            .method_count = r->method_count,
                            .intervals = r->quick ? quick_intervals : a->axis.intervals,
                            .bisections = r->quick ? 0 : 5,
                            .times = !r->quick,
                            .measure = measure,
                            .user = &w};
    bb_progress_stage(progress, (1 + a->search.times) * (1 + a->search.bisections), "%s",
                      a->axis.name);
    bb_progress_weigh(progress, 1);
    bb_status status = bb_search_run(&a->search);
    snprintf(a->mishap, sizeof a->mishap, "%s", w.points.mishap);
    s->measured += w.points.measured;
    s->taken_over += w.points.taken_over;
    if (w.points.device[0] != '\0') {
        snprintf(s->device, sizeof s->device, "%s", w.points.device);
        snprintf(s->driver, sizeof s->driver, "%s", w.points.driver);
    }
    if (status == BB_OK)
        status = bb_stress_picture(r, a);
    a->complete = !bb_interrupted();
    return status;
}

bb_status bb_stress_run(const bb_stress_request *request, bb_stress *out)
{
    char points[1100];
    memset(out, 0, sizeof *out);
    out->request = request;
    out->max_rays = max_rays(request);
    out->repeats = repeats(request);
    double start = bb_wall_ms();
    snprintf(points, sizeof points, "%s/points", request->folder);
    if (mkdir(points, 0777) != 0 && errno != EEXIST)
        return bb_fail(BB_INVALID, "cannot make the folder %s: %s", points, strerror(errno));
    out->axes = calloc(request->axis_count, sizeof *out->axes);
    if (out->axes == NULL)
        return bb_fail(BB_FAILED, "stress: no memory");
    BB_TRY(bb_stress_identify(request, &out->identity));
    BB_TRY(bb_stress_check_parameters(request));
    bb_progress progress;
    bb_progress_start(&progress, request->quiet);
    bb_progress_plan(&progress, request->axis_count);
    bb_status status = BB_OK;
    for (uint32_t i = 0; i < request->axis_count && status == BB_OK && !bb_interrupted(); i++) {
        bb_stress_axis *a = &out->axes[i];
        status = bb_axis_load(request->axes[i], &a->axis);
        out->axis_count++;
        if (status == BB_OK)
            status = search_axis(out, a, points, &progress);
    }
    bb_progress_end(&progress);
    out->ms = bb_wall_ms() - start;
    return status;
}

void bb_stress_free(bb_stress *stress)
{
    for (uint32_t i = 0; i < stress->axis_count; i++) {
        bb_search_free(&stress->axes[i].search);
        bb_axis_free(&stress->axes[i].axis);
    }
    free(stress->axes);
    stress->axes = NULL;
}
