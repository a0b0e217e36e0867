#include "framework/picture/picture.h"
#include "framework/judge/queries.h"

#include "framework/picture/image.h"
#include "framework/scene/prim.h"
#include "framework/workload/workload.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <xxhash.h>

static void surface_normal(const bb_scene *scene, const bb_ray *ray, const bb_hit *hit, double n[3])
{
    uint32_t i;
    const bb_prim_kind *kind = bb_prim_of(scene, hit->prim, &i);
    double on[3];
    for (int k = 0; k < 3; k++)
        on[k] = ray->o[k] + (double)hit->t * ray->d[k];
    kind->normal(scene, i, on, n);
    double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int k = 0; k < 3; k++)
        n[k] = length > 0 ? n[k] / length : 0;
}

void bb_picture_normals(const bb_scene *scene, const bb_rays *rays, const bb_hit *hits, float *rgb)
{
    for (uint32_t i = 0; i < rays->count; i++) {
        float *pixel = rgb + 3 * (size_t)i;
        if (hits[i].prim >= scene->prim_count) {
            pixel[0] = pixel[1] = pixel[2] = 0.80f;
            continue;
        }
        const bb_ray *ray = &rays->rays[i];
        double n[3];
        surface_normal(scene, ray, &hits[i], n);
        double length = sqrt((double)ray->d[0] * ray->d[0] + (double)ray->d[1] * ray->d[1] +
                             (double)ray->d[2] * ray->d[2]);
        double facing = -(n[0] * ray->d[0] + n[1] * ray->d[1] + n[2] * ray->d[2]) / length;
        double side = facing < 0 ? -1 : 1;
        for (int k = 0; k < 3; k++) {
            double tint = 0.5 + 0.5 * side * n[(k + 2) % 3];
            pixel[k] = (float)((0.10 + 0.75 * fabs(facing)) * (0.35 + 0.65 * tint));
        }
    }
}

void bb_values_normals(const bb_scene *scene, const bb_rays *rays, const bb_hit *hits, float *xyz)
{
    for (uint32_t i = 0; i < rays->count; i++) {
        double n[3] = {0, 0, 0};
        if (hits[i].prim < scene->prim_count)
            surface_normal(scene, &rays->rays[i], &hits[i], n);
        for (int k = 0; k < 3; k++)
            xyz[3 * (size_t)i + (size_t)k] = (float)n[k];
    }
}

static int compare_floats(const void *a, const void *b)
{
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

bb_status bb_picture_depth(const bb_rays *rays, const bb_hit *hits, float *rgb)
{
    float *sorted = malloc((rays->count + 1) * sizeof *sorted);
    if (sorted == NULL)
        return bb_fail(BB_FAILED, "out of memory");
    size_t count = 0;
    for (uint32_t i = 0; i < rays->count; i++)
        if (hits[i].prim != BB_NONE && isfinite(hits[i].t))
            sorted[count++] = hits[i].t;
    qsort(sorted, count, sizeof *sorted, compare_floats);
    /* the nearest and farthest 1 % share the end shades */
    float low = count > 0 ? sorted[count / 100] : 0;
    float high = count > 0 ? sorted[count - 1 - count / 100] : 1;
    for (uint32_t i = 0; i < rays->count; i++) {
        float shade = 0.95f;
        if (hits[i].prim != BB_NONE) {
            float x = high > low ? (hits[i].t - low) / (high - low) : 0;
            shade = 0.80f - 0.77f * fminf(fmaxf(x, 0.0f), 1.0f);
        }
        rgb[3 * (size_t)i] = rgb[3 * (size_t)i + 1] = rgb[3 * (size_t)i + 2] = shade;
    }
    free(sorted);
    return BB_OK;
}

enum { STEM_LETTERS = 64 };

/* Makes a part of a file name: letters, digits and dashes behind the text's last slash. If the text
 * has more than these, a hash of the whole text follows. */
static void file_stem(const char *text, char stem[STEM_LETTERS + 16])
{
    const char *slash = strrchr(text, '/'), *from = slash != NULL ? slash + 1 : text;
    bool whole = slash == NULL;
    int used = 0;
    for (; *from != '\0' && used < STEM_LETTERS; from++) {
        const bool plain = isalnum((unsigned char)*from) || *from == '-';
        stem[used++] = plain ? *from : '-';
        whole = whole && plain;
    }
    stem[used] = '\0';
    if (!whole || *from != '\0')
        sprintf(stem + used, "-%08x", (unsigned)XXH3_64bits(text, strlen(text)));
}

bb_status bb_picture_trace(const bb_scene *scene, bb_oracle *oracle, const bb_view *view,
                           uint32_t width, uint32_t height, float *rgb)
{
    bb_spec spec;
    BB_TRY(bb_spec_parse("primary", &spec));
    bb_rays_request request = {&spec, view, width, height, width * height, 1};
    bb_rays *rays = NULL;
    bb_hit *hits = NULL;
    bb_status status = bb_rays_make(scene, oracle, &request, &rays);
    if (status == BB_OK)
        status = bb_host_alloc(NULL, rays->count * sizeof *hits, "hits", &hits);
    if (status == BB_OK)
        status = bb_oracle_trace(oracle, rays->rays, rays->count, &bb_query_closest, hits);
    if (status == BB_OK)
        bb_picture_normals(scene, rays, hits, rgb);
    bb_host_free(hits);
    bb_rays_free(rays);
    return status;
}

bb_status bb_picture_write(const bb_scene *scene, bb_oracle *oracle, const bb_view *view,
                           uint32_t width, uint32_t height, const char *path)
{
    float *rgb = NULL;
    BB_TRY(bb_host_alloc(NULL, 3 * (size_t)width * height * sizeof *rgb, "picture", &rgb));
    bb_status status = bb_picture_trace(scene, oracle, view, width, height, rgb);
    if (status == BB_OK)
        status = bb_image_write(path, rgb, width, height);
    bb_host_free(rgb);
    return status;
}

bb_status bb_picture_of_view(const bb_scene *scene, bb_oracle *oracle, const bb_view *view,
                             uint32_t width, uint32_t height, const char *folder,
                             bb_results *results)
{
    char scene_stem[STEM_LETTERS + 16], view_stem[STEM_LETTERS + 16], file[256], path[1024];
    file_stem(scene->name, scene_stem);
    file_stem(view->name, view_stem);
    snprintf(file, sizeof file, "%s_%s.png", scene_stem, view_stem); /* neither stem has '_' */
    if (snprintf(path, sizeof path, "%s/%s", folder, file) >= (int)sizeof path)
        return bb_fail(BB_INVALID, "the path of the output folder is too long: %.60s...", folder);
    BB_TRY(bb_picture_write(scene, oracle, view, width, height, path));
    return bb_results_add_picture(results, scene->name, view->name, "surface normals", file);
}
