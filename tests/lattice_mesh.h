/* Meshes whose corners are integers, and exact answers about them: products of three differences
 * fit into 64 bits. Lengths are at most 2^12, so that all of it is exact in floats, too, after a
 * shift by a power of two or a scaling by one. */
#ifndef BB_TEST_LATTICE_MESH_H
#define BB_TEST_LATTICE_MESH_H

#include "framework/base/random.h"
#include "framework/bench/tet_search.h"
#include "framework/builder/instance.h"
#include "tests/device_fixture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct solid {
    int64_t v[8][3];
    int count;
} solid;

/* ---- meshes ---- */

/* Cubes of 16 a side, `side` along each axis, cut into six each; inner corners moved by up to
 * `jitter`, all by `shift`. With `holes`, some of the cubes are left out. */
typedef struct lattice {
    int side, jitter, holes;
    int64_t shift[3];
    double scale; /* a power of two, of what the scene gets */
} lattice;

enum { LATTICE_STEP = 16 };

static inline uint32_t lattice_corner(const lattice *l, int x, int y, int z)
{
    return (uint32_t)((z * (l->side + 1) + y) * (l->side + 1) + x);
}

static inline void lattice_vertices(const lattice *l, bb_random *random, float *vertices)
{
    for (int z = 0; z <= l->side; z++)
        for (int y = 0; y <= l->side; y++)
            for (int x = 0; x <= l->side; x++) {
                const int at[3] = {x, y, z};
                float *v = vertices + 3 * (size_t)lattice_corner(l, x, y, z);
                for (int k = 0; k < 3; k++) {
                    int64_t moved =
                        (int64_t)bb_random_below(random, 2 * (uint32_t)l->jitter + 1) - l->jitter;
                    int64_t place = LATTICE_STEP * at[k] + l->shift[k];
                    if (at[k] > 0 && at[k] < l->side)
                        place += moved;
                    v[k] = (float)((double)place * l->scale);
                }
            }
}

/* Six ways from one corner of a cube to the opposite one, along its edges (Kuhn 1960). */
static const int lattice_orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2},
                                         {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};

static inline bb_scene *make_lattice(const lattice *l, uint64_t number)
{
    bb_random random = bb_random_make(seed, number);
    const int cubes = l->side * l->side * l->side, edge = l->side + 1;
    bool *left_out = calloc((size_t)cubes, sizeof *left_out);
    uint64_t tets = 0;
    for (int c = 0; c < cubes; c++) {
        left_out[c] = c > 0 && l->holes > 0 && bb_random_below(&random, (uint32_t)l->holes) == 0;
        tets += left_out[c] ? 0 : 6;
    }
    bb_scene *scene = calloc(1, sizeof *scene);
    strcpy(scene->name, "lattice");
    check(bb_scene_reserve(scene, (uint64_t)edge * edge * edge,
                           &(bb_prim_counts){.of = {[BB_TETRAHEDRON] = tets}}),
          "lattice");
    lattice_vertices(l, &random, scene->vertices);
    uint32_t *indices = (uint32_t *)scene->prims[BB_TETRAHEDRON].data;
    for (int c = 0; c < cubes; c++)
        for (int o = 0; o < 6 && !left_out[c]; o++) {
            int at[3] = {c % l->side, c / l->side % l->side, c / (l->side * l->side)};
            *indices++ = lattice_corner(l, at[0], at[1], at[2]);
            for (int k = 0; k < 3; k++) {
                at[lattice_orders[o][k]]++;
                *indices++ = lattice_corner(l, at[0], at[1], at[2]);
            }
        }
    free(left_out);
    check(bb_scene_finish(scene), "lattice");
    return scene;
}

static inline solid tet_of(const bb_scene *scene, const lattice *l, uint32_t i)
{
    solid s = {.count = 4};
    for (int c = 0; c < 4; c++)
        for (int k = 0; k < 3; k++)
            s.v[c][k] =
                (int64_t)((double)scene->vertices[3 * bb_scene_tet(scene, i)[c] + k] / l->scale);
    return s;
}

/* ---- exact answers ---- */

static inline int64_t triple(const int64_t x[3], const int64_t y[3], const int64_t z[3])
{
    return x[0] * (y[1] * z[2] - y[2] * z[1]) + x[1] * (y[2] * z[0] - y[0] * z[2]) +
           x[2] * (y[0] * z[1] - y[1] * z[0]);
}

static inline void less(const int64_t a[3], const int64_t b[3], int64_t out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = a[k] - b[k];
}

/* Whether the projections on u x v are apart. */
static inline bool parts(const solid *a, const solid *b, const int64_t u[3], const int64_t v[3])
{
    int64_t ends[2][2];
    for (int s = 0; s < 2; s++) {
        const solid *solid = s == 0 ? a : b;
        for (int i = 0; i < solid->count; i++) {
            int64_t from[3];
            less(solid->v[i], a->v[0], from);
            int64_t at = triple(from, u, v);
            ends[s][0] = i == 0 || at < ends[s][0] ? at : ends[s][0];
            ends[s][1] = i == 0 || at > ends[s][1] ? at : ends[s][1];
        }
    }
    return ends[0][1] < ends[1][0] || ends[1][1] < ends[0][0];
}

/* Directions of edges: all pairs of corners of a tetrahedron, the axes of a box. */
static inline int edges_of(const solid *s, int64_t edges[6][3])
{
    static const int pairs[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
    if (s->count == 8) {
        memset(edges, 0, 3 * sizeof *edges);
        for (int k = 0; k < 3; k++)
            edges[k][k] = 1;
        return 3;
    }
    for (int e = 0; e < 6; e++)
        less(s->v[pairs[e][1]], s->v[pairs[e][0]], edges[e]);
    return 6;
}

/* Every pair of edges of one solid has the normals of its faces among their products; that of both,
 * the rest. More axes than needed do no harm. */
static inline bool solids_meet(const solid *a, const solid *b)
{
    int64_t edges[12][3];
    int count = edges_of(a, edges);
    count += edges_of(b, edges + count);
    for (int i = 0; i < count; i++)
        for (int j = i + 1; j < count; j++)
            if (parts(a, b, edges[i], edges[j]))
                return false;
    return true;
}

static inline bool has_volume(const solid *tet)
{
    int64_t e[3][3];
    for (int c = 0; c < 3; c++)
        less(tet->v[c + 1], tet->v[0], e[c]);
    return triple(e[0], e[1], e[2]) != 0;
}

/* ---- ways to search ---- */

typedef struct tet_way {
    const char *builder, *layout; /* NULL: no tree */
    bool boundary;
} tet_way;

static const tet_way tet_ways[] = {
    {"lbvh", "skip", false},
    {"olbvh", "skip", false},
    {"olbvh", "octree", false},
    {"olbvh", "octree", true},
    {"olbvh:alpha=1", "octree", true},
    {"olbvh:bits=1", "octree", true},
    {"olbvh", "olbvh", false},
    {"olbvh", "olbvh", true},
    {"olbvh:alpha=1", "olbvh", true},
    {"olbvh:bits=0", "olbvh", true},
    {NULL, NULL, false},
};
enum { TET_WAYS = sizeof tet_ways / sizeof tet_ways[0] };

typedef struct searched {
    bb_instance instance;
    bb_layout_maker maker;
    bb_layout_data data;
    bb_buffer list;
    bb_tet_search search;
} searched;

/* The scene is on the device. Zeroed before. */
static inline void open_search(searched *s, bb_scene *scene, const tet_way *way)
{
    if (way->builder == NULL) {
        check(bb_tet_list_make(scene, &s->list), "list");
        bb_tet_search_all(scene, &s->list, &s->search);
        return;
    }
    const bb_layout *layout = bb_layout_find(way->layout);
    check(bb_instance_create(device, way->builder, scene, 1, &s->instance), way->builder);
    check(bb_instance_build(&s->instance, scene, false, NULL), way->builder);
    check(bb_layout_maker_create(layout, device, &s->maker), way->layout);
    check(
        bb_layout_maker_make(&s->maker, scene, &s->instance.tree, 1, BB_FORMAT_VERTICES, &s->data),
        way->layout);
    check(bb_tet_search_by(scene, layout, &s->data, &s->search), way->layout);
}

static inline void close_search(searched *s)
{
    bb_layout_data_release(&s->data);
    bb_layout_maker_destroy(&s->maker);
    bb_instance_destroy(&s->instance);
    bb_buffer_release(&s->list);
}

#endif
