/* Reads rays, writes hits. Counts and hashes are the judge's business; what the tracer relies on is
 * checked. */
#include "tests/cheats/rays_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool complain(const char *path, const char *what)
{
    fprintf(stderr, "cheat_tracer: %s: %s\n", path, what);
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

static bool read_header(FILE *file, const char *path, bb_rays_header *h)
{
    const uint64_t most = INT32_MAX;
    if (fread(h, sizeof *h, 1, file) != 1 || memcmp(h->magic, BB_RAYS_MAGIC, sizeof h->magic) != 0)
        return complain(path, "no rays file");
    if (h->byte_order != BB_EXCHANGE_ORDER || h->version != BB_EXCHANGE_VERSION ||
        h->header_bytes != sizeof *h || h->interval != BB_EXCHANGE_OPEN || h->ray_count > most ||
        h->vertex_count > most || h->triangle_count > most || h->sphere_count > most)
        return complain(path, "of a kind that this tracer does not know");
    for (int k = 0; k < BB_EXCHANGE_MORE_KINDS; k++)
        if (h->more_counts[k] > 0)
            return complain(path, "of primitives that this tracer does not know");
    return true;
}

bool scene_read(const char *path, scene *s)
{
    FILE *file = fopen(path, "rb");
    if (file == NULL)
        return complain(path, "cannot be opened");
    bb_rays_header *h = &s->header;
    bool ok = read_header(file, path, h);
    if (ok) {
        s->rays = read_array(file, h->ray_count, sizeof *s->rays);
        s->vertices = read_array(file, h->vertex_count, sizeof *s->vertices);
        s->indices = read_array(file, h->triangle_count, sizeof *s->indices);
        s->spheres = read_array(file, h->sphere_count, sizeof *s->spheres);
        s->triangles = (uint32_t)h->triangle_count;
        s->prims = s->triangles + (uint32_t)h->sphere_count;
        if (!s->rays || !s->vertices || !s->indices || !s->spheres)
            ok = complain(path, "truncated, or more than the memory holds");
    }
    for (uint64_t i = 0; ok && i < 3 * h->triangle_count; i++)
        if (s->indices[i / 3][i % 3] >= h->vertex_count)
            ok = complain(path, "has an index without a vertex");
    fclose(file);
    return ok;
}

void scene_free(scene *s)
{
    free(s->rays);
    free(s->vertices);
    free(s->indices);
    free(s->spheres);
}

bool hits_write(const char *path, const scene *s, const bb_hit *hits, const char *tracer)
{
    bb_hits_header h = {
        .version = BB_EXCHANGE_VERSION,
        .byte_order = BB_EXCHANGE_ORDER,
        .header_bytes = sizeof h,
        .hit_count = s->header.ray_count,
        .scene_hash = s->header.scene_hash,
        .rays_hash = s->header.rays_hash,
    };
    memcpy(h.magic, BB_HITS_MAGIC, sizeof h.magic);
    snprintf(h.tracer, sizeof h.tracer, "%s", tracer);
    FILE *file = fopen(path, "wb");
    if (file == NULL)
        return complain(path, "cannot be written");
    bool ok = fwrite(&h, sizeof h, 1, file) == 1 &&
              fwrite(hits, sizeof *hits, h.hit_count, file) == h.hit_count;
    ok = fclose(file) == 0 && ok;
    return ok || complain(path, "cannot be written");
}
