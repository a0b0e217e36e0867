#include "framework/scene/tets_faces.h"

#include "framework/base/memory.h"
#include "framework/scene/exact.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- each face once ---- */

typedef struct face_table {
    uint64_t *starts; /* by the first corner; one entry more than vertices */
    bb_face_use *uses;
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

static void face_corners(const bb_scene *scene, uint32_t i, uint32_t f, uint32_t v[3])
{
    for (int c = 0; c < 3; c++)
        v[c] = bb_scene_tet(scene, i)[bb_tet_faces[f][c]];
    sort_three(v);
}

static const float *vertex(const bb_scene *scene, uint32_t v)
{
    return scene->vertices + 3 * (size_t)v;
}

static bb_face_use use_of(const bb_scene *scene, uint32_t i, uint32_t f, const uint32_t v[3])
{
    const float *opposite = vertex(scene, bb_scene_tet(scene, i)[f]);
    const double at[3] = {opposite[0], opposite[1], opposite[2]};
    const int side =
        bb_exact_side(at, vertex(scene, v[0]), vertex(scene, v[1]), vertex(scene, v[2]));
    return (bb_face_use){{v[0], v[1], v[2]}, i & 0x3fffffffu, f & 3u, side};
}

/* Sorts faces by their first corner: a counting sort. */
static void fill_table(const bb_scene *scene, face_table *table)
{
    const uint32_t count = scene->prims[BB_TETRAHEDRON].count;
    uint32_t v[3];
    memset(table->starts, 0, ((size_t)scene->vertex_count + 1) * sizeof *table->starts);
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t f = 0; f < 4; f++) {
            face_corners(scene, i, f, v);
            table->starts[v[0] + 1]++;
        }
    for (uint32_t at = 0; at < scene->vertex_count; at++)
        table->starts[at + 1] += table->starts[at];
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t f = 0; f < 4; f++) {
            face_corners(scene, i, f, v);
            table->uses[table->starts[v[0]]++] = use_of(scene, i, f, v);
        }
    for (uint32_t at = scene->vertex_count; at > 0; at--)
        table->starts[at] = table->starts[at - 1];
    table->starts[0] = 0;
}

/* By the second and third corner, then by tetrahedron and face. */
static int compare_uses(const void *a, const void *b)
{
    const bb_face_use *x = a, *y = b;
    for (int c = 1; c < 3; c++)
        if (x->corners[c] != y->corners[c])
            return x->corners[c] < y->corners[c] ? -1 : 1;
    if (x->tet != y->tet)
        return x->tet < y->tet ? -1 : 1;
    return (int)x->face - (int)y->face;
}

static bool same_face(const bb_face_use *a, const bb_face_use *b)
{
    return memcmp(a->corners, b->corners, sizeof a->corners) == 0;
}

bb_status bb_tets_visit_faces(const bb_scene *scene,
                              void (*visit)(void *self, const bb_face_use *uses, uint32_t count),
                              void *self)
{
    face_table table = {NULL, NULL};
    const uint64_t count = 4 * (uint64_t)scene->prims[BB_TETRAHEDRON].count;
    bb_status status = bb_host_alloc(NULL, ((size_t)scene->vertex_count + 1) * sizeof(uint64_t),
                                     "the faces of tetrahedra", &table.starts);
    if (status == BB_OK)
        status =
            bb_host_alloc(NULL, count * sizeof *table.uses, "the faces of tetrahedra", &table.uses);
    if (status == BB_OK)
        fill_table(scene, &table);
    for (uint32_t v = 0; v < scene->vertex_count && status == BB_OK; v++)
        qsort(table.uses + table.starts[v], table.starts[v + 1] - table.starts[v],
              sizeof *table.uses, compare_uses);
    for (uint64_t first = 0, end; first < count && status == BB_OK; first = end) {
        for (end = first + 1; end < count && same_face(&table.uses[first], &table.uses[end]);)
            end++;
        visit(self, table.uses + first, (uint32_t)(end - first));
    }
    bb_host_free(table.starts);
    bb_host_free(table.uses);
    return status;
}

/* ---- as triangles ---- */

typedef struct face_list {
    uint32_t count;
    uint32_t *corners; /* NULL: faces are only counted */
    bb_face_sides *sides;
} face_list;

static void add_face(void *self, const bb_face_use *uses, uint32_t count)
{
    face_list *list = self;
    bb_face_sides sides = {BB_NONE, BB_NONE};
    for (uint32_t i = count; i-- > 0;)
        if (uses[i].side != 0)
            *(uses[i].side > 0 ? &sides.above : &sides.below) = uses[i].tet;
    if (sides.above == BB_NONE && sides.below == BB_NONE)
        return;
    if (list->corners != NULL) {
        memcpy(list->corners + 3 * (size_t)list->count, uses[0].corners, sizeof uses[0].corners);
        list->sides[list->count] = sides;
    }
    list->count++;
}

static bb_status fill(const bb_scene *mesh, bb_scene *faces, bb_face_sides **sides)
{
    face_list counted = {0}, list = {0};
    BB_TRY(bb_tets_visit_faces(mesh, add_face, &counted));
    if (counted.count == 0)
        return bb_fail(BB_UNSUPPORTED, "%s: no tetrahedron has a volume", mesh->name);
    BB_TRY(bb_host_alloc(NULL, counted.count * sizeof **sides, "sides of faces", sides));
    BB_TRY(bb_scene_reserve_mesh(faces, mesh->vertex_count, counted.count));
    memcpy(faces->vertices, mesh->vertices,
           3 * (size_t)mesh->vertex_count * sizeof *mesh->vertices);
    list.corners = (uint32_t *)faces->prims[BB_TRIANGLE].data;
    list.sides = *sides;
    BB_TRY(bb_tets_visit_faces(mesh, add_face, &list));
    BB_TRY(bb_scene_finish(faces));
    return bb_scene_profile(faces);
}

bb_status bb_tets_faces(const bb_scene *mesh, bb_scene **faces, bb_face_sides **sides)
{
    bb_scene *scene = calloc(1, sizeof *scene);
    *faces = NULL;
    *sides = NULL;
    if (scene == NULL)
        return bb_fail(BB_REFUSED, "%s: no memory for its faces", mesh->name);
    snprintf(scene->name, sizeof scene->name, "faces of %.200s", mesh->name);
    const bb_status status = fill(mesh, scene, sides);
    if (status == BB_OK) {
        *faces = scene;
        return BB_OK;
    }
    bb_scene_free(scene);
    bb_host_free(*sides);
    *sides = NULL;
    return status;
}
