/* Makes a ray set from a specification. Rays are computed in doubles and rounded to float once.
 * They only depend on scene, view, picture size, options and seed; secondary ones also on what
 * Embree hits on the way to them. */
#include "framework/workload/workload.h"

#include "framework/base/suggest.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const bb_workload *bb_workload_find(const char *name)
{
    for (uint32_t i = 0; bb_workloads[i] != NULL; i++)
        if (strcmp(bb_workloads[i]->name, name) == 0)
            return bb_workloads[i];
    return NULL;
}

bb_status bb_workload_parse(const char *text, bb_spec *spec, const bb_workload **workload)
{
    BB_TRY(bb_spec_parse(text, spec));
    *workload = bb_workload_find(spec->name);
    if (*workload != NULL) {
        char what[64];
        snprintf(what, sizeof what, "rays %s", spec->name);
        return bb_spec_validate(spec, (*workload)->options, what);
    }
    bb_suggestion meant = {.word = spec->name};
    for (uint32_t i = 0; bb_workloads[i] != NULL; i++)
        bb_suggest(&meant, bb_workloads[i]->name);
    return bb_fail(BB_INVALID, "unknown rays '%s'%s: `bvhbench list rays` shows them", spec->name,
                   bb_suggested(&meant));
}

static bool has_option(const bb_workload *workload, const char *name)
{
    const bb_option *option = workload->options;
    while (option != NULL && option->name != NULL && strcmp(option->name, name) != 0)
        option++;
    return option != NULL && option->name != NULL;
}

bb_status bb_workload_at_least(const char *text, uint32_t least, char *more, size_t capacity)
{
    bb_spec spec;
    const bb_workload *workload;
    BB_TRY(bb_workload_parse(text, &spec, &workload));
    bool added =
        has_option(workload, "least") && bb_spec_value(&spec, workload->options, "least") == NULL;
    int length = added ? snprintf(more, capacity, "%s%cleast=%u", text,
                                  strchr(text, ':') != NULL ? ',' : ':', least)
                       : snprintf(more, capacity, "%s", text);
    return (size_t)length < capacity
               ? BB_OK
               : bb_fail(BB_INVALID, "rays '%.80s...': longer than %zu characters", text, capacity);
}

/* Reads an option that is a number of rays, if it is given; else *count stays. */
static bb_status read_count(const bb_workload *workload, const bb_spec *spec, const char *name,
                            uint64_t *count)
{
    return has_option(workload, name) && bb_spec_value(spec, workload->options, name) != NULL
               ? bb_spec_u64(spec, workload->options, name, 1, INT32_MAX, count)
               : BB_OK;
}

bb_status bb_workload_most(const char *text, uint32_t width, uint32_t height, uint32_t max_rays,
                           uint64_t *most)
{
    bb_spec spec;
    const bb_workload *workload;
    const uint64_t pixels = (uint64_t)width * height;
    uint64_t count = max_rays, least = 0;
    BB_TRY(bb_workload_parse(text, &spec, &workload));
    BB_TRY(read_count(workload, &spec, "count", &count));
    BB_TRY(read_count(workload, &spec, "least", &least));
    if (workload->per_view) /* whole pictures */
        *most = least > pixels && pixels > 0 ? ((least - 1) / pixels + 1) * pixels : pixels;
    else
        *most = count < max_rays || workload->beyond_limit ? count : max_rays;
    return BB_OK;
}

bb_status bb_workload_check(const char *text, uint32_t max_rays)
{
    bb_spec spec;
    const bb_workload *workload;
    uint64_t count;
    BB_TRY(bb_workload_parse(text, &spec, &workload));
    if (!has_option(workload, "count"))
        return BB_OK; /* the picture, or its hits, determine the number of rays */
    BB_TRY(bb_workload_most(text, 0, 0, max_rays, &count));
    return bb_rays_check_room(text, count);
}

bool bb_workload_must_hit(const bb_workload *workload, const bb_scene *scene, const bb_spec *spec)
{
    return workload->must_hit != NULL && workload->must_hit(scene, spec);
}

bb_status bb_job_count(const bb_rays_job *job, uint64_t *count)
{
    const uint64_t limit = job->request->max_rays;
    *count = limit;
    if (bb_spec_value(job->request->spec, job->options, "count") != NULL)
        BB_TRY(bb_spec_u64(job->request->spec, job->options, "count", 1, INT32_MAX, count));
    *count = *count < limit ? *count : limit;
    return BB_OK;
}

static bb_status begin_job(const bb_workload *workload, const bb_scene *scene,
                           const bb_rays_request *request, bb_rays_job *job)
{
    const bb_spec *spec = request->spec;
    char what[64];
    snprintf(what, sizeof what, "rays %s", workload->name);
    BB_TRY(bb_spec_validate(spec, workload->options, what));
    if (strlen(spec->text) >= sizeof job->rays->name)
        return bb_fail(BB_INVALID, "rays '%s': longer than %zu characters", spec->text,
                       sizeof job->rays->name - 1);
    if (request->max_rays == 0)
        return bb_fail(BB_INVALID, "rays '%s': allow at least one", spec->text);
    double tmin = 0.0, diagonal = 0.0;
    if (bb_spec_value(spec, workload->options, "tmin") != NULL)
        BB_TRY(bb_spec_double(spec, workload->options, "tmin", 0.0, 1e30, &tmin));
    for (int k = 0; k < 3; k++)
        diagonal = hypot(diagonal, (double)scene->bounds.hi[k] - (double)scene->bounds.lo[k]);
    job->options = workload->options;
    job->diagonal = diagonal;
    job->tmin = (float)tmin;
    job->rays->options = workload->options;
    job->rays->query = workload->query;
    job->rays->must_hit = bb_workload_must_hit(workload, scene, spec);
    job->rays->seed = request->seed;
    job->rays->primary_width = request->width;
    job->rays->primary_height = request->height;
    job->rays->max_rays = request->max_rays;
    snprintf(job->rays->name, sizeof job->rays->name, "%s", spec->text);
    BB_TRY(bb_spec_parse(spec->text, &job->rays->spec));
    if (request->view != NULL)
        snprintf(job->rays->view, sizeof job->rays->view, "%s", request->view->name);
    return BB_OK;
}

bb_status bb_rays_make(const bb_scene *scene, bb_oracle *oracle, const bb_rays_request *request,
                       bb_rays **out)
{
    *out = NULL;
    const bb_workload *workload = bb_workload_find(request->spec->name);
    if (workload == NULL)
        return bb_fail(BB_INVALID, "no rays '%s': `bvhbench list rays` shows what there is",
                       request->spec->name);
    bb_rays *rays = calloc(1, sizeof *rays);
    if (rays == NULL)
        return bb_fail(BB_REFUSED, "the host refused the memory of a ray set");
    bb_rays_job job = {.scene = scene, .oracle = oracle, .request = request, .rays = rays};
    bb_status status = begin_job(workload, scene, request, &job);
    if (status == BB_OK)
        status = workload->make(&job);
    if (status == BB_OK)
        status = bb_rays_check(scene, rays);
    if (status != BB_OK) {
        bb_rays_free(rays);
        return status;
    }
    rays->hash = bb_rays_hash(rays);
    *out = rays;
    return BB_OK;
}
