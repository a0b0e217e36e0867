/* A tracer that is not a plug-in of bvhbench: brute force, every ray against every primitive, in
 * double precision.
 *
 *     outside_tracer RAYS HITS [careless]
 *
 * reads the rays file that `bvhbench rays` wrote, writes a hits file for `bvhbench judge`, and
 * prints its speed. It needs the C library and framework/workload/exchange.h, which defines the
 * format of both files. A real tracer would build its tree over the primitives before it begins to
 * trace.
 *
 * With `careless` it makes a mistake of many tutorials: the same test in single precision, with an
 * absolute epsilon on the determinant. The judge finds out.
 */
#include "framework/workload/exchange.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

typedef struct work {
    bb_rays_header header;
    bb_ray *rays;
    float (*vertices)[3];
    uint32_t (*indices)[3];
    float (*spheres)[4];
    bb_hit *hits;
} work;

/* ---- the files ---- */

static bool complain(const char *path, const char *what)
{
    fprintf(stderr, "outside_tracer: %s: %s\n", path, what);
    return false;
}

static void *read_array(FILE *file, uint64_t count, size_t size)
{
    void *data = malloc(count * size + 1);
    if (data != NULL && fread(data, size, count, file) == count)
        return data;
    free(data);
    return NULL;
}

/* The judge checks counts and hashes; this checks what the tracer relies on. */
static bool read_header(FILE *file, const char *path, bb_rays_header *h)
{
    if (fread(h, sizeof *h, 1, file) != 1 || memcmp(h->magic, BB_RAYS_MAGIC, sizeof h->magic) != 0)
        return complain(path, "no rays file");
    if (h->byte_order != BB_EXCHANGE_ORDER || h->version != BB_EXCHANGE_VERSION)
        return complain(path, "of a version or byte order that this tracer does not know");
    if (h->header_bytes != sizeof *h || h->interval != BB_EXCHANGE_OPEN ||
        (h->query != BB_EXCHANGE_CLOSEST && h->query != BB_EXCHANGE_ANY))
        return complain(path, "of a kind that this tracer does not know");
    for (int k = 0; k < BB_EXCHANGE_MORE_KINDS; k++)
        if (h->more_counts[k] > 0)
            return complain(path, "of primitives that this tracer does not know");
    const uint64_t most = UINT32_MAX;
    if (h->ray_count > most || h->vertex_count > most || h->triangle_count > most ||
        h->sphere_count > most)
        return complain(path, "too large");
    return true;
}

static bool read_rays(const char *path, work *w)
{
    FILE *file = fopen(path, "rb");
    if (file == NULL)
        return complain(path, "cannot be opened");
    bb_rays_header *h = &w->header;
    bool ok = read_header(file, path, h);
    if (ok) {
        w->rays = read_array(file, h->ray_count, sizeof *w->rays);
        w->vertices = read_array(file, h->vertex_count, sizeof *w->vertices);
        w->indices = read_array(file, h->triangle_count, sizeof *w->indices);
        w->spheres = read_array(file, h->sphere_count, sizeof *w->spheres);
        w->hits = malloc(h->ray_count * sizeof *w->hits + 1);
        if (!w->rays || !w->vertices || !w->indices || !w->spheres || !w->hits)
            ok = complain(path, "truncated, or more than the memory holds");
    }
    for (uint64_t i = 0; ok && i < 3 * h->triangle_count; i++)
        if (w->indices[i / 3][i % 3] >= h->vertex_count)
            ok = complain(path, "has an index without a vertex");
    fclose(file);
    return ok;
}

static bool write_hits(const char *path, const work *w, bool careless)
{
    bb_hits_header h = {
        .version = BB_EXCHANGE_VERSION,
        .byte_order = BB_EXCHANGE_ORDER,
        .header_bytes = sizeof h,
        .hit_count = w->header.ray_count,
        .scene_hash = w->header.scene_hash, /* repeated, to show which rays the answers belong to */
        .rays_hash = w->header.rays_hash,
        .checksum = 0, /* none */
    };
    memcpy(h.magic, BB_HITS_MAGIC, sizeof h.magic);
    snprintf(h.tracer, sizeof h.tracer, "%s", careless ? "careless-brute-force" : "brute-force");
    FILE *file = fopen(path, "wb");
    if (file == NULL)
        return complain(path, "cannot be written");
    bool ok = fwrite(&h, sizeof h, 1, file) == 1 &&
              fwrite(w->hits, sizeof *w->hits, h.hit_count, file) == h.hit_count;
    ok = fclose(file) == 0 && ok;
    return ok || complain(path, "cannot be written");
}

/* ---- ray against primitive: t of the hit, or NAN ---- */

/* Moeller and Trumbore: Fast, Minimum Storage Ray/Triangle Intersection, 1997; both sides. */
static double hit_triangle(const work *w, uint32_t triangle, const bb_ray *ray)
{
    const uint32_t *corner = w->indices[triangle];
    const float *a = w->vertices[corner[0]], *b = w->vertices[corner[1]],
                *c = w->vertices[corner[2]];
    double e1[3], e2[3], s[3], p[3], q[3];
    for (int k = 0; k < 3; k++) {
        e1[k] = (double)b[k] - a[k];
        e2[k] = (double)c[k] - a[k];
        s[k] = (double)ray->o[k] - a[k];
    }
    for (int k = 0; k < 3; k++) {
        int m = (k + 1) % 3, n = (k + 2) % 3;
        p[k] = ray->d[m] * e2[n] - ray->d[n] * e2[m];
        q[k] = s[m] * e1[n] - s[n] * e1[m];
    }
    double det = e1[0] * p[0] + e1[1] * p[1] + e1[2] * p[2];
    if (det == 0)
        return NAN;
    double u = (s[0] * p[0] + s[1] * p[1] + s[2] * p[2]) / det;
    double v = (ray->d[0] * q[0] + ray->d[1] * q[1] + ray->d[2] * q[2]) / det;
    if (u < 0 || v < 0 || u + v > 1)
        return NAN;
    return (e2[0] * q[0] + e2[1] * q[1] + e2[2] * q[2]) / det;
}

/* The same in single precision, and with an epsilon that ignores the scene's size. */
static double hit_triangle_carelessly(const work *w, uint32_t triangle, const bb_ray *ray)
{
    const uint32_t *corner = w->indices[triangle];
    const float *a = w->vertices[corner[0]], *b = w->vertices[corner[1]],
                *c = w->vertices[corner[2]];
    float e1[3], e2[3], s[3], p[3], q[3];
    for (int k = 0; k < 3; k++) {
        e1[k] = b[k] - a[k];
        e2[k] = c[k] - a[k];
        s[k] = ray->o[k] - a[k];
    }
    for (int k = 0; k < 3; k++) {
        int m = (k + 1) % 3, n = (k + 2) % 3;
        p[k] = ray->d[m] * e2[n] - ray->d[n] * e2[m];
        q[k] = s[m] * e1[n] - s[n] * e1[m];
    }
    float det = e1[0] * p[0] + e1[1] * p[1] + e1[2] * p[2];
    if (fabsf(det) < 1e-3f)
        return NAN;
    float u = (s[0] * p[0] + s[1] * p[1] + s[2] * p[2]) / det;
    float v = (ray->d[0] * q[0] + ray->d[1] * q[1] + ray->d[2] * q[2]) / det;
    if (u < 0 || v < 0 || u + v > 1)
        return NAN;
    return (e2[0] * q[0] + e2[1] * q[1] + e2[2] * q[2]) / det;
}

/* Returns the nearer root beyond tmin: from inside, the far side. */
static double hit_sphere(const float *sphere, const bb_ray *ray)
{
    double d[3], m[3], dd = 0, dm = 0;
    for (int k = 0; k < 3; k++) {
        d[k] = ray->d[k];
        m[k] = (double)sphere[k] - ray->o[k];
        dd += d[k] * d[k];
        dm += d[k] * m[k];
    }
    double middle = dm / dd, distance = 0; /* distance of the line's point nearest to the centre */
    for (int k = 0; k < 3; k++)
        distance += (m[k] - middle * d[k]) * (m[k] - middle * d[k]);
    double square = ((double)sphere[3] * sphere[3] - distance) / dd;
    if (square < 0)
        return NAN;
    double half = sqrt(square);
    return middle - half > ray->tmin ? middle - half : middle + half;
}

/* ---- all of them ---- */

static bb_hit trace(const work *w, const bb_ray *ray, bool careless)
{
    const bb_rays_header *h = &w->header;
    uint32_t triangles = (uint32_t)h->triangle_count, spheres = (uint32_t)h->sphere_count;
    bb_hit hit = {INFINITY, BB_NONE};
    double nearest = ray->tmax;
    for (uint32_t prim = 0; prim < triangles + spheres; prim++) {
        double t = prim >= triangles ? hit_sphere(w->spheres[prim - triangles], ray)
                   : careless        ? hit_triangle_carelessly(w, prim, ray)
                                     : hit_triangle(w, prim, ray);
        if (t > ray->tmin && t < nearest) { /* false if t is NAN */
            nearest = t;
            hit = (bb_hit){(float)t, prim};
            if (h->query == BB_EXCHANGE_ANY)
                break;
        }
    }
    return hit;
}

static double seconds(void)
{
    struct timespec now;
    timespec_get(&now, TIME_UTC);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

int main(int argc, char **argv)
{
    bool careless = argc == 4 && strcmp(argv[3], "careless") == 0;
    if (argc != 3 && !careless) {
        fprintf(stderr, "usage: outside_tracer RAYS HITS [careless]\n");
        return 2;
    }
    work w = {0};
    bool ok = read_rays(argv[1], &w);
    if (ok) {
        double start = seconds();
        for (uint64_t i = 0; i < w.header.ray_count; i++)
            w.hits[i] = trace(&w, &w.rays[i], careless);
        printf("%.9f\n", (double)w.header.ray_count / (seconds() - start) / 1e6); /* Mrays/s */
        ok = write_hits(argv[2], &w, careless);
    }
    free(w.rays);
    free(w.vertices);
    free(w.indices);
    free(w.spheres);
    free(w.hits);
    return ok ? 0 : 2;
}
