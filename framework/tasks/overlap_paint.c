/* What is left of two meshes without what meets the other, as in Stroeter, Mueller-Roemer, Stork,
 * Fellner 2020, Figure 9. */
#include "framework/tasks/overlap_paint.h"

#include "framework/base/memory.h"
#include "framework/bench/contest_table.h"
#include "framework/judge/queries.h"
#include "framework/picture/image.h"
#include "framework/picture/picture.h"
#include "framework/scene/tets_gather.h"
#include "framework/workload/workload.h"

#include <stdio.h>

enum { SIDE = 384 };

static const float tints[2][3] = {{1, 0.55f, 0.45f}, {0.5f, 0.7f, 1}};

static void tint(const bb_scene *scene, const bb_hit *hits, uint32_t first_of_second, float *rgb)
{
    const uint32_t first = scene->prims[BB_TETRAHEDRON].first;
    for (uint32_t i = 0; i < SIDE * SIDE; i++) {
        if (hits[i].prim == BB_NONE)
            continue;
        const float *colour = tints[hits[i].prim - first >= first_of_second];
        for (uint32_t k = 0; k < 3; k++)
            rgb[3 * (size_t)i + k] *= colour[k];
    }
}

static bb_status paint_view(const bb_scene *scene, bb_oracle *oracle, const bb_view *view,
                            uint32_t first_of_second, const char *path)
{
    bb_spec spec;
    bb_rays *rays = NULL;
    bb_hit *hits = NULL;
    float *rgb = NULL;
    BB_TRY(bb_spec_parse("primary", &spec));
    bb_rays_request request = {&spec, view, SIDE, SIDE, SIDE * SIDE, 1};
    bb_status status = bb_rays_make(scene, oracle, &request, &rays);
    if (status == BB_OK)
        status = bb_host_alloc(NULL, SIDE * SIDE * sizeof *hits, "hits", &hits);
    if (status == BB_OK)
        status = bb_host_alloc(NULL, 3 * SIDE * SIDE * sizeof *rgb, "picture", &rgb);
    if (status == BB_OK)
        status = bb_oracle_trace(oracle, rays->rays, SIDE * SIDE, &bb_query_closest, hits);
    if (status == BB_OK) {
        bb_picture_normals(scene, rays, hits, rgb);
        tint(scene, hits, first_of_second, rgb);
        status = bb_image_write(path, rgb, SIDE, SIDE);
    }
    bb_host_free(rgb);
    bb_host_free(hits);
    bb_rays_free(rays);
    return status;
}

/* How many of a scene's tetrahedra are left. */
static uint32_t left_of(const bb_scene *scene, const uint32_t *answers)
{
    uint32_t left = 0;
    for (uint32_t i = 0; i < scene->prims[BB_TETRAHEDRON].count; i++)
        left += answers[i] == 0;
    return left;
}

bb_status bb_overlap_paint(bb_scene *const scenes[2], uint32_t *const answers[2],
                           const char *folder, const char *name, bb_table *table)
{
    bb_tets_part parts[2];
    bb_scene *left;
    bb_oracle *oracle = NULL;
    for (int s = 0; s < 2; s++)
        parts[s] = (bb_tets_part){scenes[s], answers[s], 1, {0, 0, 0}};
    const uint32_t first_of_second = left_of(scenes[0], answers[0]);
    if (first_of_second + left_of(scenes[1], answers[1]) == 0)
        return BB_OK;
    BB_TRY(bb_tets_gather("what does not overlap", parts, 2, &left));
    bb_status status = bb_oracle_create(left, 0, &oracle);
    for (uint32_t v = 0; v < left->view_count && status == BB_OK; v++) {
        char file[64], path[4096];
        snprintf(file, sizeof file, "apart-%.48s.png", left->views[v].name);
        snprintf(path, sizeof path, "%s/%s", folder, file);
        status = paint_view(left, oracle, &left->views[v], first_of_second, path);
        if (status == BB_OK)
            bb_table_set_text(table, bb_contest_scene_row(table, name, file), &bb_column_picture,
                              file);
    }
    bb_oracle_destroy(oracle);
    bb_scene_free(left);
    return status;
}
