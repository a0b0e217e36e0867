#include "scenes/crowd.h"

#include "scenes/shapes.h"

#include <math.h>

enum { TURNS = 1000 }; /* stream of the random numbers that turn triangles */

/* One ball around the origin. */
typedef struct ball {
    float *vertices;
    uint32_t *indices;
} ball;

static uint64_t vertices_of(const bb_crowd *crowd)
{
    return crowd->tessellation == 0 ? 3 : bb_shape_sphere_vertices(crowd->tessellation);
}

static uint64_t triangles_of(uint32_t tessellation)
{
    return tessellation == 0 ? 1 : bb_shape_sphere_triangles(tessellation);
}

bb_crowd bb_crowd_of(uint64_t triangles, uint32_t tessellation, double radius)
{
    uint64_t count = triangles / triangles_of(tessellation);
    return (bb_crowd){count < 1 ? 1 : (uint32_t)count, tessellation, radius};
}

static void free_ball(ball *b)
{
    bb_host_free(b->vertices);
    bb_host_free(b->indices);
}

static bb_status make_ball(const bb_crowd *crowd, ball *b)
{
    static const double origin[3];
    *b = (ball){0};
    bb_status status =
        bb_host_alloc(NULL, 3 * vertices_of(crowd) * sizeof(float), "a ball", &b->vertices);
    if (status == BB_OK)
        status = bb_host_alloc(NULL, 3 * triangles_of(crowd->tessellation) * sizeof(uint32_t),
                               "a ball", &b->indices);
    if (status == BB_OK) {
        bb_shape_cursor cursor = {.vertices = b->vertices, .indices = b->indices};
        bb_shape_sphere(&cursor, origin, crowd->radius, crowd->tessellation);
    } else
        free_ball(b);
    return status;
}

/* ---- balls ---- */

static bb_status index_balls(const bb_crowd *crowd, uint32_t first, uint32_t *to)
{
    uint64_t corners = 3 * triangles_of(crowd->tessellation), vertices = vertices_of(crowd);
    ball b;
    BB_TRY(make_ball(crowd, &b));
    for (uint64_t i = 0; i < crowd->count; i++)
        for (uint64_t k = 0; k < corners; k++)
            *to++ = (uint32_t)(first + i * vertices + b.indices[k]);
    free_ball(&b);
    return BB_OK;
}

static bb_status place_balls(const bb_crowd *crowd, const bb_motion *motion,
                             const double (*centres)[3], float *to)
{
    uint64_t vertices = vertices_of(crowd);
    ball b;
    BB_TRY(make_ball(crowd, &b));
    for (uint32_t i = 0; i < crowd->count; i++)
        for (uint64_t v = 0; v < vertices; v++) {
            double corner[3];
            for (uint64_t axis = 0; axis < 3; axis++)
                corner[axis] = centres[i][axis] + b.vertices[3 * v + axis];
            to = bb_motion_put(motion, corner, to);
        }
    free_ball(&b);
    return BB_OK;
}

/* ---- triangles ---- */

/* Makes a triangle around its centre: two random directions, and the one that balances them. */
static float *put_triangle(const bb_crowd *crowd, const bb_motion *motion, uint32_t i,
                           const double centre[3], float *to)
{
    bb_random random = bb_random_make(motion->seed + TURNS, i);
    double u[3], v[3], corner[3];
    bb_random_direction(&random, u);
    bb_random_direction(&random, v);
    for (int k = 0; k < 3; k++) {
        for (int axis = 0; axis < 3; axis++) {
            double w = -0.5 * (u[axis] + v[axis]);
            corner[axis] = centre[axis] + crowd->radius * (k == 0 ? u[axis] : k == 1 ? v[axis] : w);
        }
        to = bb_motion_put(motion, corner, to);
    }
    return to;
}

/* ---- both ---- */

bb_status bb_crowd_index(const bb_crowd *crowd, uint32_t first, uint32_t *to)
{
    if (crowd->tessellation > 0)
        return index_balls(crowd, first, to);
    for (uint32_t i = 0; i < 3 * crowd->count; i++)
        to[i] = first + i;
    return BB_OK;
}

bb_status bb_crowd_write(const bb_crowd *crowd, const bb_motion *motion, const double (*centres)[3],
                         float *to)
{
    if (crowd->tessellation > 0)
        return place_balls(crowd, motion, centres, to);
    for (uint32_t i = 0; i < crowd->count; i++)
        to = put_triangle(crowd, motion, i, centres[i], to);
    return BB_OK;
}

bb_status bb_crowd_reserve(const bb_crowd *crowd, bb_scene *scene)
{
    BB_TRY(bb_scene_reserve_mesh(scene, crowd->count * vertices_of(crowd),
                                 crowd->count * triangles_of(crowd->tessellation)));
    return bb_crowd_index(crowd, 0, bb_scene_indices(scene));
}

bb_status bb_crowd_place(const bb_crowd *crowd, const bb_motion *motion, const double (*centres)[3],
                         bb_scene *scene)
{
    scene->vertex_count = (uint32_t)(crowd->count * vertices_of(crowd));
    scene->prims[BB_TRIANGLE].count = (uint32_t)(crowd->count * triangles_of(crowd->tessellation));
    return bb_crowd_write(crowd, motion, centres, scene->vertices);
}
