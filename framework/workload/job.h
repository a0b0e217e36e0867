/* A request for rays in progress, and options that several workloads have. */
#ifndef BB_JOB_H
#define BB_JOB_H

#include "framework/judge/oracle.h"
#include "framework/judge/rays.h"

typedef struct bb_rays_request {
    const bb_spec *spec; /* workload and parameters */
    const bb_view *view; /* NULL for sets per scene: the primary hits of all views are sampled */
    uint32_t width, height;
    uint32_t max_rays; /* ao, diffuse, path, shadow, random: at most this many */
    uint64_t seed;
} bb_rays_request;

/* A request in progress. */
typedef struct bb_rays_job {
    const bb_scene *scene;
    bb_oracle *oracle;
    const bb_rays_request *request;
    const bb_option *options;
    bb_rays *rays;
    double diagonal; /* of the scene's box */
    float tmin;
} bb_rays_job;

/* Rows of tables of options. */
#define BB_TMIN_OPTION                                                                             \
    {                                                                                              \
        "tmin", "0", NULL, "hits count beyond this t"                                              \
    }
#define BB_OFFSET_OPTION                                                                           \
    {                                                                                              \
        "offset", "1e-5", NULL,                                                                    \
            "origins are moved off the surface by this, in scene diagonals (but by 2^-20 of "      \
            "their largest coordinate at least)"                                                   \
    }
#define BB_LEAST_OPTION                                                                            \
    {                                                                                              \
        "least", NULL, NULL,                                                                       \
            "at least so many rays: more pictures are taken, each ray at a random place of its "   \
            "pixel; default: one picture"                                                          \
    }
#define BB_COUNT_OPTION                                                                            \
    {                                                                                              \
        "count", NULL, NULL, "number of rays; default: the run's limit"                            \
    }
#define BB_END_OPTION                                                                              \
    {                                                                                              \
        NULL, NULL, NULL, NULL                                                                     \
    }

/* Gets the number from BB_COUNT_OPTION, at most the run's limit. */
bb_status bb_job_count(const bb_rays_job *job, uint64_t *count);

#endif
