/* The density of particles that cluster as in an n-body simulation: clusters of clusters, and
 * nothing between them, so most of a volume is empty at any resolution.
 *
 * Soneira, Peebles 1978 (A computer model universe, Astronomical Journal 83): a sphere contains
 * `children` smaller ones, each of these as many again, and so on. Each of the last ones is spread
 * over a fixed radius; densities are added as whole numbers and saturate, so that all machines and
 * any number of threads give the same voxels.
 */
#include "framework/base/memory.h"
#include "framework/base/random.h"
#include "framework/base/threads.h"
#include "scenes/volume_scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    CHILDREN = 4,
    LEVELS = 7,
    PARTICLES = 1 << 2 * LEVELS,
    VOXELS_MAX = 2049,
    PEAK = 1024, /* density of one particle */
    HALF = 1536, /* density that is drawn at half the largest value */
};

static const double shrink = 1.75, spread = 0.02; /* of the volume's side */

static const bb_option options_table[] = {
    {"n", "64", NULL, "voxels along an edge, 2 to 2049"},
    {"seed", "1", NULL, "seed"},
    BB_VOLUME_OPTIONS,
    {0},
};

typedef struct particle {
    double at[3]; /* 0 to 1 */
} particle;

typedef struct job {
    particle *particles; /* sorted by z */
    uint32_t n;
    uint8_t *voxels;
    uint32_t **sums; /* of a slice, one per thread */
} job;

static void cluster(bb_random *random, const double centre[3], double radius, int level,
                    particle **to)
{
    for (int child = 0; child < CHILDREN; child++) {
        double direction[3], at[3], far = radius * bb_random_unit(random);
        bb_random_direction(random, direction);
        for (int k = 0; k < 3; k++)
            at[k] = centre[k] + far * direction[k];
        if (level > 1)
            cluster(random, at, radius / shrink, level - 1, to);
        else
            memcpy((*to)++, at, sizeof at);
    }
}

static int by_z(const void *a, const void *b)
{
    double x = ((const particle *)a)->at[2], y = ((const particle *)b)->at[2];
    return (x > y) - (x < y);
}

/* Finds the voxels of an axis, of n at 0, 1 / (n - 1), ..., 1, that are within `spread` of a
 * place. */
static void reach(double place, uint32_t n, uint32_t *first, uint32_t *end)
{
    double lo = ceil((place - spread) * (n - 1)), hi = floor((place + spread) * (n - 1)) + 1;
    *first = lo > 0 ? (uint32_t)fmin(lo, n) : 0;
    *end = hi > 0 ? (uint32_t)fmin(hi, n) : 0;
}

static void add_particle(const particle *p, double z, uint32_t n, uint32_t *sums)
{
    uint32_t first[2], end[2];
    double dz = z - p->at[2];
    for (int k = 0; k < 2; k++)
        reach(p->at[k], n, &first[k], &end[k]);
    for (uint32_t y = first[1]; y < end[1]; y++) {
        double dy = (double)y / (n - 1) - p->at[1];
        for (uint32_t x = first[0]; x < end[0]; x++) {
            double dx = (double)x / (n - 1) - p->at[0];
            double left = 1 - (dx * dx + dy * dy + dz * dz) / (spread * spread);
            if (left > 0)
                sums[(size_t)y * n + x] += (uint32_t)(PEAK * left * left);
        }
    }
}

static void fill_slice(const job *job, uint32_t slice, uint32_t *sums)
{
    const uint32_t n = job->n;
    const size_t count = (size_t)n * n;
    const double z = (double)slice / (n - 1);
    memset(sums, 0, count * sizeof *sums);
    uint32_t first = 0, end = PARTICLES;
    while (first < end) {
        uint32_t middle = first + (end - first) / 2;
        if (job->particles[middle].at[2] < z - spread)
            first = middle + 1;
        else
            end = middle;
    }
    for (uint32_t i = first; i < PARTICLES && job->particles[i].at[2] <= z + spread; i++)
        add_particle(&job->particles[i], z, n, sums);
    for (size_t i = 0; i < count; i++)
        job->voxels[slice * count + i] = (uint8_t)(255u * (uint64_t)sums[i] / (sums[i] + HALF));
}

static void fill_slices(void *context, size_t begin, size_t end, uint32_t thread)
{
    const job *job = context;
    for (size_t slice = begin; slice < end; slice++)
        fill_slice(job, (uint32_t)slice, job->sums[thread]);
}

static bb_status fill_in_parallel(job *job, bb_pool *pool)
{
    uint32_t threads = bb_pool_threads(pool);
    bb_status status = BB_OK;
    job->sums = calloc(threads, sizeof *job->sums);
    if (job->sums == NULL)
        return bb_fail(BB_REFUSED, "nbody: no memory for its sums");
    for (uint32_t i = 0; i < threads && status == BB_OK; i++)
        status = bb_host_alloc(NULL, (size_t)job->n * job->n * sizeof **job->sums,
                               "sums of densities", &job->sums[i]);
    if (status == BB_OK)
        bb_parallel_for(pool, job->n, 1, fill_slices, job);
    for (uint32_t i = 0; i < threads; i++)
        bb_host_free(job->sums[i]);
    free(job->sums);
    return status;
}

static bb_status fill(uint64_t seed, bb_voxels *voxels)
{
    static const double middle[3] = {0.5, 0.5, 0.5};
    bb_pool *pool;
    job job = {.n = voxels->dims[0], .voxels = voxels->values};
    BB_TRY(bb_host_alloc(NULL, PARTICLES * sizeof *job.particles, "particles", &job.particles));
    bb_random random = bb_random_make(seed, 11);
    particle *to = job.particles;
    cluster(&random, middle, 0.45, LEVELS, &to);
    qsort(job.particles, PARTICLES, sizeof *job.particles, by_z);
    bb_status status = bb_pool_create(0, &pool);
    if (status == BB_OK) {
        status = fill_in_parallel(&job, pool);
        bb_pool_destroy(pool);
    }
    bb_host_free(job.particles);
    return status;
}

static bb_status make(const bb_spec *spec, const bb_option *options, bb_scene *scene)
{
    uint64_t n, seed;
    BB_TRY(bb_spec_u64(spec, options, "n", 2, VOXELS_MAX, &n));
    BB_TRY(bb_spec_u64(spec, options, "seed", 0, UINT64_MAX, &seed));
    bb_voxels voxels = {.spacing = {1, 1, 1}, .bytes = 1};
    for (int k = 0; k < 3; k++)
        voxels.dims[k] = (uint32_t)n;
    BB_TRY(bb_volume_scene_reserve(scene, spec, options, &voxels));
    bb_status status = fill(seed, &voxels);
    if (status != BB_OK) {
        bb_voxels_free(&voxels);
        return status;
    }
    return bb_volume_scene_make(spec, options, &voxels, scene);
}

extern const bb_generator bb_generator_nbody;
const bb_generator bb_generator_nbody = {
    .name = "nbody",
    .summary = "volume: densities of clusters of clusters, most of it empty",
    .options = options_table,
    .make = make,
};
