#include "framework/scene/tets_gather.h"

#include "framework/scene/scene_private.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static uint32_t tets_of(const bb_scene *scene)
{
    return scene->prims[BB_TETRAHEDRON].count;
}

static bool is_taken(const bb_tets_part *part, uint32_t i)
{
    return part->left_out == NULL || part->left_out[i] == 0;
}

/* Appends a part after the given vertices and tetrahedra, with its field. */
static void add(const bb_tets_part *part, bb_scene *scene, float *field, uint32_t *vertices,
                uint32_t *tets)
{
    const bb_scene *from = part->scene;
    uint32_t *indices = (uint32_t *)scene->prims[BB_TETRAHEDRON].data;
    for (uint32_t v = 0; v < from->vertex_count; v++)
        for (uint32_t k = 0; k < 3; k++)
            scene->vertices[3 * (size_t)(*vertices + v) + k] =
                (float)((double)from->vertices[3 * (size_t)v + k] * part->scale + part->shift[k]);
    memcpy(field + *vertices, from->tets->field, from->vertex_count * sizeof *field);
    for (uint32_t i = 0; i < tets_of(from); i++) {
        if (!is_taken(part, i))
            continue;
        for (uint32_t c = 0; c < 4; c++)
            indices[4 * (size_t)*tets + c] = *vertices + bb_scene_tet(from, i)[c];
        ++*tets;
    }
    *vertices += from->vertex_count;
}

static bb_status fill(const bb_tets_part *parts, uint32_t count, bb_scene *scene)
{
    uint64_t vertices = 0, tets = 0;
    uint32_t vertex = 0, tet = 0;
    float *field;
    for (uint32_t p = 0; p < count; p++) {
        vertices += parts[p].scene->vertex_count;
        for (uint32_t i = 0; i < tets_of(parts[p].scene); i++)
            tets += is_taken(&parts[p], i);
    }
    if (tets == 0)
        return bb_fail(BB_INVALID, "%s: there is no tetrahedron left", scene->name);
    BB_TRY(bb_scene_reserve(scene, vertices,
                            &(bb_prim_counts){.of = {[BB_TETRAHEDRON] = (uint64_t)tets}}));
    BB_TRY(bb_scene_reserve_field(scene, "gathered", &field));
    for (uint32_t p = 0; p < count; p++)
        add(&parts[p], scene, field, &vertex, &tet);
    BB_TRY(bb_scene_finish(scene));
    BB_TRY(bb_scene_profile(scene));
    bb_scene_derive_views(scene);
    return BB_OK;
}

bb_status bb_tets_gather(const char *name, const bb_tets_part *parts, uint32_t count,
                         bb_scene **out)
{
    *out = NULL;
    bb_scene *scene = calloc(1, sizeof *scene);
    if (scene == NULL)
        return bb_fail(BB_REFUSED, "%s: no memory for a scene", name);
    snprintf(scene->name, sizeof scene->name, "%s", name);
    bb_status status = fill(parts, count, scene);
    if (status == BB_OK)
        *out = scene;
    else
        bb_scene_free(scene);
    return status;
}

/* ---- fitting ---- */

static double longest_side(const bb_scene *scene)
{
    double longest = 0;
    for (int k = 0; k < 3; k++)
        longest = fmax(longest, (double)scene->bounds.hi[k] - (double)scene->bounds.lo[k]);
    return longest;
}

static double middle(const bb_scene *scene, int k)
{
    return ((double)scene->bounds.lo[k] + (double)scene->bounds.hi[k]) / 2;
}

bb_status bb_tets_fit(const bb_scene *mesh, const bb_scene *into, double times, bb_scene **out)
{
    bb_tets_part part = {.scene = mesh};
    char name[256];
    part.scale = times * longest_side(into) / longest_side(mesh);
    for (int k = 0; k < 3; k++)
        part.shift[k] = middle(into, k) - part.scale * middle(mesh, k);
    snprintf(name, sizeof name, "%.200s, fitted by %g", mesh->name, times);
    return bb_tets_gather(name, &part, 1, out);
}
