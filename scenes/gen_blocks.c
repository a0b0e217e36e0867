/* A heap of axis-aligned boxes, as in voxel worlds and bricks of volumes. Half of the cells of a
 * grid are filled by a box that shares its faces with its neighbours, bit for bit; the others have
 * a plate without thickness, a rod, a small box or nothing. `mixed` puts spheres, octahedra and
 * tetrahedra into some of the empty cells, so that all kinds of primitives are in one tree.
 */
#include "framework/base/random.h"
#include "scenes/shapes.h"

enum { SIDE_MAX = 400 };

typedef enum cell { FULL, PLATE, ROD, SMALL, BALL, MESH, TET, EMPTY } cell;

static const bb_option options_table[] = {
    {"side", "16", NULL, "cells along an edge of the heap"},
    {"mixed", "no", "no|yes", "spheres, triangles and tetrahedra as well"},
    {"seed", "1", NULL, "seed"},
    {0},
};

/* Chooses the content of a cell, and the axis along which it lies. */
static cell choose(uint64_t seed, uint64_t number, bool mixed, uint32_t *axis)
{
    static const cell cells[] = {FULL,  FULL, FULL,  FULL, FULL, FULL, FULL,  FULL,
                                 PLATE, ROD,  SMALL, BALL, MESH, TET,  EMPTY, EMPTY};
    bb_random random = bb_random_make(seed, number);
    cell chosen = cells[bb_random_below(&random, 16)];
    *axis = bb_random_below(&random, 3);
    return chosen >= BALL && !mixed ? EMPTY : chosen;
}

/* Cells are cubes of side 1; all coordinates are multiples of 1/8, and so exact. */
static void put_box(cell chosen, uint32_t axis, const double corner[3], float to[6])
{
    for (uint32_t k = 0; k < 3; k++) {
        bool along = k == axis;
        double lo = 0, hi = 1;
        if ((chosen == PLATE && along) || chosen == SMALL)
            lo = 0.375;
        if (chosen == PLATE && along)
            hi = lo;
        if (chosen == SMALL)
            hi = 0.625;
        if (chosen == ROD && !along) {
            lo = 0.25;
            hi = 0.375;
        }
        to[k] = (float)(corner[k] + lo);
        to[k + 3] = (float)(corner[k] + hi);
    }
}

/* Puts a tetrahedron: a corner cut off the cell. */
static void put_tet(bb_shape_cursor *cursor, uint32_t axis, const double corner[3], uint32_t to[4])
{
    for (uint32_t c = 0; c < 4; c++) {
        double p[3];
        for (uint32_t k = 0; k < 3; k++)
            p[k] = corner[k] + ((k + axis) % 3 + 1 == c ? 1.0 : 0.0);
        to[c] = bb_shape_vertex(cursor, p);
    }
}

static void fill(uint64_t side, bool mixed, uint64_t seed, bb_scene *scene)
{
    float *boxes = bb_scene_floats(scene, BB_AABB), *balls = bb_scene_floats(scene, BB_SPHERE);
    uint32_t *tets = (uint32_t *)scene->prims[BB_TETRAHEDRON].data;
    bb_shape_cursor cursor = bb_shape_start(scene, NULL);
    for (uint64_t i = 0; i < side * side * side; i++) {
        uint32_t axis;
        const double corner[3] = {(double)(i % side), (double)(i / side % side),
                                  (double)(i / side / side)};
        const double middle[3] = {corner[0] + 0.5, corner[1] + 0.5, corner[2] + 0.5};
        cell chosen = choose(seed, i, mixed, &axis);
        if (chosen <= SMALL) {
            put_box(chosen, axis, corner, boxes);
            boxes += 6;
        } else if (chosen == BALL) {
            for (int k = 0; k < 3; k++)
                balls[k] = (float)middle[k];
            balls[3] = 0.5f;
            balls += 4;
        } else if (chosen == MESH) {
            bb_shape_sphere(&cursor, middle, 0.5, 1);
        } else if (chosen == TET) {
            put_tet(&cursor, axis, corner, tets);
            tets += 4;
        }
    }
}

static bb_status make(const bb_spec *spec, const bb_option *options, bb_scene *scene)
{
    uint64_t side, seed;
    bool mixed = bb_spec_is(spec, options, "mixed", "yes");
    BB_TRY(bb_spec_u64(spec, options, "side", 1, SIDE_MAX, &side));
    BB_TRY(bb_spec_u64(spec, options, "seed", 0, UINT64_MAX, &seed));
    bb_prim_counts counts = {{0}};
    uint64_t vertices = 0;
    for (uint64_t i = 0; i < side * side * side; i++) {
        uint32_t axis;
        cell chosen = choose(seed, i, mixed, &axis);
        counts.of[BB_AABB] += chosen <= SMALL;
        counts.of[BB_SPHERE] += chosen == BALL;
        counts.of[BB_TRIANGLE] += chosen == MESH ? bb_shape_sphere_triangles(1) : 0;
        counts.of[BB_TETRAHEDRON] += chosen == TET;
        vertices += chosen == MESH ? bb_shape_sphere_vertices(1) : chosen == TET ? 4 : 0;
    }
    BB_TRY(bb_scene_reserve(scene, vertices, &counts));
    fill(side, mixed, seed, scene);
    return BB_OK;
}

extern const bb_generator bb_generator_blocks;
const bb_generator bb_generator_blocks = {
    .name = "blocks",
    .summary = "heap of axis-aligned boxes that share faces; with all other kinds if mixed",
    .options = options_table,
    .make = make,
};
