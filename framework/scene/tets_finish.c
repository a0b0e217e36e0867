/* What a scene of tetrahedra has beside them: flags, field. */
#include "framework/base/memory.h"
#include "framework/scene/tets_faces.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TETS_MAX = 1 << 30 }; /* tets_faces.h has four faces for each */

/* ---- flags ---- */

/* A face is inside if there are tetrahedra on both of its sides, however many; copies of a
 * tetrahedron are on the same side. */
static void flag_face(void *self, const bb_face_use *uses, uint32_t count)
{
    const bb_tets *tets = self;
    bool above = false, below = false;
    for (uint32_t i = 0; i < count; i++) {
        above = above || uses[i].side > 0;
        below = below || uses[i].side < 0;
    }
    for (uint32_t i = 0; i < count && !(above && below); i++)
        tets->flags[uses[i].tet] |= 1u << uses[i].face;
}

static void flag_volumes(const bb_scene *scene, bb_tets *tets)
{
    for (uint32_t i = 0; i < scene->prims[BB_TETRAHEDRON].count; i++) {
        const float *v[4];
        for (int c = 0; c < 4; c++)
            v[c] = scene->vertices + 3 * (size_t)bb_scene_tet(scene, i)[c];
        int side = bb_tet_side(v);
        tets->flags[i] |= side == 0 ? BB_TET_FLAT : side < 0 ? BB_TET_NEGATIVE : 0;
        tets->boundary_count += (tets->flags[i] & BB_TET_BOUNDARY) != 0;
        tets->flat_count += side == 0;
        tets->negative_count += side < 0;
    }
}

/* ---- the field ---- */

static bb_status take_tets(bb_scene *scene)
{
    if (scene->tets == NULL)
        scene->tets = calloc(1, sizeof *scene->tets);
    return scene->tets != NULL ? BB_OK : bb_fail(BB_REFUSED, "%s: no memory", scene->name);
}

bb_status bb_scene_reserve_field(bb_scene *scene, const char *name, float **field)
{
    BB_TRY(take_tets(scene));
    BB_TRY(bb_host_alloc(NULL, (size_t)scene->vertex_count * sizeof **field, "a scalar field",
                         &scene->tets->field));
    snprintf(scene->tets->field_name, sizeof scene->tets->field_name, "%s", name);
    *field = scene->tets->field;
    return BB_OK;
}

/* Shells around the centre, four of them out to the corners, dented along the axes: smooth, from 0
 * to 1, and nowhere constant. */
static float made_value(const bb_box *bounds, const float v[3])
{
    double square = 0, dents = 0;
    for (int k = 0; k < 3; k++) {
        double half = 0.5 * ((double)bounds->hi[k] - (double)bounds->lo[k]);
        double at = half > 0 ? ((double)v[k] - (double)bounds->lo[k]) / half - 1 : 0;
        square += at * at / 3;
        dents += cos(2.0 * M_PI * at) / 12;
    }
    double value = 0.5 - 0.5 * cos(4.0 * M_PI * (sqrt(square) + dents));
    return isfinite(value) ? (float)value : 0; /* of a vertex without tetrahedron */
}

static bb_status finish_field(bb_scene *scene)
{
    bb_tets *tets = scene->tets;
    float *field = tets->field;
    if (field == NULL) {
        BB_TRY(bb_scene_reserve_field(scene, "made", &field));
        for (uint32_t v = 0; v < scene->vertex_count; v++)
            field[v] = made_value(&scene->bounds, scene->vertices + 3 * (size_t)v);
    }
    tets->field_lo = INFINITY;
    tets->field_hi = -INFINITY;
    for (uint32_t v = 0; v < scene->vertex_count; v++) {
        if (!isfinite(field[v]))
            return bb_fail(BB_INVALID, "%s: field '%s' is %g at vertex %u: it must be finite",
                           scene->name, tets->field_name, (double)field[v], v);
        field[v] += 0.0f; /* no -0 */
        tets->field_lo = fminf(tets->field_lo, field[v]);
        tets->field_hi = fmaxf(tets->field_hi, field[v]);
    }
    return BB_OK;
}

bb_status bb_scene_finish_tets(bb_scene *scene)
{
    const uint32_t count = scene->prims[BB_TETRAHEDRON].count;
    if (count == 0)
        return BB_OK;
    if (count > TETS_MAX)
        return bb_fail(BB_REFUSED, "%s: has %u tetrahedra, at most %d can be handled", scene->name,
                       count, TETS_MAX);
    if (scene->frame_count > 1)
        return bb_fail(BB_UNSUPPORTED,
                       "%s: tetrahedra that move cannot be handled: their flags "
                       "are those of one frame",
                       scene->name);
    BB_TRY(take_tets(scene));
    bb_tets *tets = scene->tets;
    tets->boundary_count = tets->flat_count = tets->negative_count = 0;
    BB_TRY(bb_host_alloc(NULL, count * sizeof *tets->flags, "flags of tetrahedra", &tets->flags));
    memset(tets->flags, 0, count * sizeof *tets->flags);
    BB_TRY(bb_tets_visit_faces(scene, flag_face, tets));
    flag_volumes(scene, tets);
    return finish_field(scene);
}

void bb_tets_free(bb_tets *tets)
{
    if (tets == NULL)
        return;
    bb_host_free(tets->flags);
    bb_host_free(tets->field);
    free(tets);
}
