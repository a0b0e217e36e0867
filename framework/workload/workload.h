/* Workloads: the available ray sets. Each is one file, workload_NAME.c, which CMake finds: its
 * options, and the code that makes its rays. */
#ifndef BB_WORKLOAD_H
#define BB_WORKLOAD_H

#include "framework/workload/job.h"

typedef struct bb_workload {
    const char *name;
    const char *summary;
    const bb_query *query;
    bool per_view;            /* once per view; else once per scene */
    bool beyond_limit;        /* its option `count` may exceed the run's limit */
    const bb_option *options; /* length, count, offset, tmin ... with their defaults */
    /* Fills job->rays (framework/workload/job.h). BB_UNSUPPORTED if the scene has no such rays. */
    bb_status (*make)(bb_rays_job *job);
    /* Returns whether, with these parameters in this scene, each ray must hit something. NULL:
     * never. */
    bool (*must_hit)(const bb_scene *scene, const bb_spec *spec);
} bb_workload;

extern const bb_workload *const bb_workloads[]; /* generated table; ends with NULL */
const bb_workload *bb_workload_find(const char *name);
/* Finds the workload that `text` names and checks its specification. */
bb_status bb_workload_parse(const char *text, bb_spec *spec, const bb_workload **workload);

/* Returns in *most how many rays a set has at most, as far as is known without a scene: one for
 * each pixel of a view, in as many pictures as `least` asks for; of other sets as many as `count`
 * says, or the run's limit. */
bb_status bb_workload_most(const char *text, uint32_t width, uint32_t height, uint32_t max_rays,
                           uint64_t *most);

/* Checks a specification before a run: BB_REFUSED if its rays, at most `max_rays` and as far as is
 * known without a scene, need more memory than the host has. */
bb_status bb_workload_check(const char *text, uint32_t max_rays);

/* Writes to `more` a specification of the same rays, but at least `least` of them (of `path`: paths
 * that begin): `text` with least=, unless it has that itself, or its kind has no pictures and thus
 * as many rays as the run's limit anyway. BB_INVALID if `capacity` is too small. */
bb_status bb_workload_at_least(const char *text, uint32_t least, char *more, size_t capacity);

/* Returns whether each of these rays must hit something: they are aimed at a closed mesh from
 * inside. */
bool bb_workload_must_hit(const bb_workload *workload, const bb_scene *scene, const bb_spec *spec);

/* Makes the rays of `request`. Secondary rays start at primary hits of the oracle, so they do not
 * depend on any builder. BB_UNSUPPORTED if the scene has no such rays (no primary hit; `edges`
 * without triangles). The caller owns *rays. */
bb_status bb_rays_make(const bb_scene *scene, bb_oracle *oracle, const bb_rays_request *request,
                       bb_rays **rays);

#endif
