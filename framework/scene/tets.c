/* Tetrahedra: sides, flags, field. */
#include "framework/scene/tets.h"

#include "framework/base/memory.h"
#include "framework/scene/exact.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TETS_MAX = 1 << 30 }; /* a face's number is 4 times that of its tetrahedron, plus 0 to 3 */

const int bb_tet_faces[4][3] = {{1, 2, 3}, {0, 2, 3}, {0, 1, 3}, {0, 1, 2}};

static void corners_of(const bb_scene *scene, uint32_t i, const float *v[4])
{
    for (int c = 0; c < 4; c++)
        v[c] = scene->vertices + 3 * (size_t)bb_scene_tet(scene, i)[c];
}

int bb_tet_side(const float *const v[4])
{
    const double last[3] = {v[3][0], v[3][1], v[3][2]};
    return bb_exact_side(last, v[0], v[1], v[2]);
}

bool bb_tet_holds(const bb_scene *scene, uint32_t i, const double point[3])
{
    const float *v[4];
    corners_of(scene, i, v);
    if (bb_tet_side(v) == 0)
        return false;
    for (int f = 0; f < 4; f++) {
        const int *face = bb_tet_faces[f];
        const float *a = v[face[0]], *b = v[face[1]], *c = v[face[2]];
        const double opposite[3] = {v[f][0], v[f][1], v[f][2]};
        if (bb_exact_side(point, a, b, c) == -bb_exact_side(opposite, a, b, c))
            return false;
    }
    return true;
}

/* ---- the boundary ---- */

typedef struct face_use {
    uint32_t b, c; /* its second and third vertex, in ascending order */
    uint32_t tet;  /* number of the tetrahedron times 4, plus the face */
    int side;      /* side of the face on which the tetrahedron lies; 0: it has no volume */
} face_use;

typedef struct face_table {
    uint64_t *starts; /* by the first vertex; one entry more than vertices */
    face_use *uses;
} face_table;

static void sort_three(uint32_t v[3])
{
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2 - i; j++)
            if (v[j] > v[j + 1]) {
                uint32_t swap = v[j];
                v[j] = v[j + 1];
                v[j + 1] = swap;
            }
}

static void face_vertices(const bb_scene *scene, uint32_t i, int f, uint32_t v[3])
{
    for (int c = 0; c < 3; c++)
        v[c] = bb_scene_tet(scene, i)[bb_tet_faces[f][c]];
    sort_three(v);
}

static face_use use_of(const bb_scene *scene, uint32_t i, int f, const uint32_t v[3])
{
    const float *opposite = scene->vertices + 3 * (size_t)bb_scene_tet(scene, i)[f];
    const double at[3] = {opposite[0], opposite[1], opposite[2]};
    int side =
        bb_exact_side(at, scene->vertices + 3 * (size_t)v[0], scene->vertices + 3 * (size_t)v[1],
                      scene->vertices + 3 * (size_t)v[2]);
    return (face_use){v[1], v[2], 4 * i + (uint32_t)f, side};
}

/* Sorts faces by their first vertex: a counting sort. */
static void fill_table(const bb_scene *scene, face_table *table)
{
    const uint32_t count = scene->prims[BB_TETRAHEDRON].count;
    uint32_t v[3];
    memset(table->starts, 0, ((size_t)scene->vertex_count + 1) * sizeof *table->starts);
    for (uint32_t i = 0; i < count; i++)
        for (int f = 0; f < 4; f++) {
            face_vertices(scene, i, f, v);
            table->starts[v[0] + 1]++;
        }
    for (uint32_t at = 0; at < scene->vertex_count; at++)
        table->starts[at + 1] += table->starts[at];
    for (uint32_t i = count; i-- > 0;)
        for (int f = 4; f-- > 0;) {
            face_vertices(scene, i, f, v);
            table->uses[table->starts[v[0]]++] = use_of(scene, i, f, v);
        }
    for (uint32_t at = scene->vertex_count; at > 0; at--)
        table->starts[at] = table->starts[at - 1];
    table->starts[0] = 0;
}

static int by_vertices(const void *a, const void *b)
{
    const face_use *x = a, *y = b;
    if (x->b != y->b)
        return x->b < y->b ? -1 : 1;
    return x->c < y->c ? -1 : x->c > y->c;
}

/* A face is inside if there are tetrahedra on both of its sides, however many; copies of a
 * tetrahedron are on the same side. */
static void flag_faces(bb_tets *tets, face_use *uses, uint64_t count)
{
    qsort(uses, count, sizeof *uses, by_vertices);
    for (uint64_t first = 0, end; first < count; first = end) {
        bool above = false, below = false;
        for (end = first; end < count && by_vertices(&uses[first], &uses[end]) == 0; end++) {
            above = above || uses[end].side > 0;
            below = below || uses[end].side < 0;
        }
        for (uint64_t i = first; i < end && !(above && below); i++)
            tets->flags[uses[i].tet / 4] |= 1u << uses[i].tet % 4;
    }
}

static bb_status flag_boundary(const bb_scene *scene, bb_tets *tets)
{
    face_table table = {NULL, NULL};
    const size_t count = 4 * (size_t)scene->prims[BB_TETRAHEDRON].count;
    bb_status status = bb_host_alloc(NULL, ((size_t)scene->vertex_count + 1) * sizeof(uint64_t),
                                     "the faces of tetrahedra", &table.starts);
    if (status == BB_OK)
        status =
            bb_host_alloc(NULL, count * sizeof *table.uses, "the faces of tetrahedra", &table.uses);
    if (status == BB_OK) {
        fill_table(scene, &table);
        for (uint32_t v = 0; v < scene->vertex_count; v++)
            if (table.starts[v + 1] > table.starts[v])
                flag_faces(tets, table.uses + table.starts[v],
                           table.starts[v + 1] - table.starts[v]);
    }
    bb_host_free(table.starts);
    bb_host_free(table.uses);
    return status;
}

static void flag_volumes(const bb_scene *scene, bb_tets *tets)
{
    for (uint32_t i = 0; i < scene->prims[BB_TETRAHEDRON].count; i++) {
        const float *v[4];
        corners_of(scene, i, v);
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
    BB_TRY(flag_boundary(scene, tets));
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
