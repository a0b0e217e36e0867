/* Box and sphere meshes.
 *
 * The vertices of the sphere are the integer points (i, j, k) with |i| + |j| + |k| = n, scaled to
 * the radius: neighbouring faces find the same vertex by the same integer arithmetic, so there is
 * no seam and no pole to be closed. Rows of one j are stored one after the other: first the half k
 * >= 0, then k < 0.
 */
#include "scenes/shapes.h"

#include <math.h>
#include <stdlib.h>

bb_shape_cursor bb_shape_start(bb_scene *scene, const bb_placement *placement)
{
    return (bb_shape_cursor){
        .vertices = scene->vertices, .indices = bb_scene_indices(scene), .placement = placement};
}

uint32_t bb_shape_vertex(bb_shape_cursor *cursor, const double p[3])
{
    double placed[3] = {p[0], p[1], p[2]};
    float *to = cursor->vertices + 3 * (size_t)cursor->vertex_count;
    if (cursor->placement != NULL)
        bb_placement_point(cursor->placement, p, placed);
    for (int k = 0; k < 3; k++)
        to[k] = (float)placed[k];
    return cursor->vertex_count++;
}

void bb_shape_triangle(bb_shape_cursor *cursor, uint32_t a, uint32_t b, uint32_t c)
{
    uint32_t *to = cursor->indices + 3 * (size_t)cursor->triangle_count++;
    to[0] = a;
    to[1] = b;
    to[2] = c;
}

void bb_shape_quad(bb_shape_cursor *cursor, uint32_t a, uint32_t b, uint32_t c, uint32_t d)
{
    bb_shape_triangle(cursor, a, b, c);
    bb_shape_triangle(cursor, a, c, d);
}

void bb_shape_box(bb_shape_cursor *cursor, const double lo[3], const double hi[3])
{
    /* Corner number: bit 0 is x, bit 1 is y, bit 2 is z. */
    static const uint32_t faces[12][3] = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5},
                                          {0, 1, 5}, {0, 5, 4}, {2, 6, 7}, {2, 7, 3},
                                          {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
    uint32_t base = cursor->vertex_count;
    for (int i = 0; i < 8; i++)
        bb_shape_vertex(cursor, (const double[3]){(i & 1) != 0 ? hi[0] : lo[0],
                                                  (i & 2) != 0 ? hi[1] : lo[1],
                                                  (i & 4) != 0 ? hi[2] : lo[2]});
    for (int i = 0; i < 12; i++)
        bb_shape_triangle(cursor, base + faces[i][0], base + faces[i][1], base + faces[i][2]);
}

uint64_t bb_shape_sphere_vertices(uint64_t n)
{
    return 4 * n * n + 2;
}

uint64_t bb_shape_sphere_triangles(uint64_t n)
{
    return 8 * n * n;
}

/* Returns the number of points with |i| + |j| <= m in rows before row j. */
static int64_t rows_before(int64_t m, int64_t j)
{
    int64_t rows = j + m; /* rows -m .. j - 1 have 1, 3, 5 ... points up to row 0, then fewer */
    if (j <= 0)
        return rows * rows;
    return 2 * m * m + 2 * m + 1 - (m - j + 1) * (m - j + 1);
}

/* Returns the number of the vertex (i, j, +-(n - |i| - |j|)). */
static uint32_t vertex_number(int64_t n, int64_t i, int64_t j, int sign)
{
    int64_t k = n - llabs(i) - llabs(j);
    int64_t m = sign > 0 || k == 0 ? n : n - 1;
    int64_t before = m == n ? 0 : 2 * n * n + 2 * n + 1;
    return (uint32_t)(before + rows_before(m, j) + i + m - llabs(j));
}

static void put_points(bb_shape_cursor *cursor, const double centre[3], double radius, int64_t n,
                       int64_t m, int sign)
{
    for (int64_t j = -m; j <= m; j++)
        for (int64_t i = -(m - llabs(j)); i <= m - llabs(j); i++) {
            double x = (double)i, y = (double)j, z = (double)(sign * (n - llabs(i) - llabs(j)));
            double scale = radius / sqrt(x * x + y * y + z * z);
            bb_shape_vertex(cursor, (const double[3]){centre[0] + scale * x, centre[1] + scale * y,
                                                      centre[2] + scale * z});
        }
}

/* Puts one face of the octahedron, with the signs of its coordinates. */
static void put_face(bb_shape_cursor *cursor, uint32_t base, int64_t n, int sx, int sy, int sz)
{
    int turned = sx * sy * sz < 0; /* keeps all faces wound to be seen from outside */
    for (int64_t a = 0; a < n; a++)
        for (int64_t b = 0; a + b < n; b++) {
            uint32_t p = base + vertex_number(n, sx * a, sy * b, sz);
            uint32_t q = base + vertex_number(n, sx * (a + 1), sy * b, sz);
            uint32_t r = base + vertex_number(n, sx * a, sy * (b + 1), sz);
            bb_shape_triangle(cursor, p, turned ? r : q, turned ? q : r);
            if (a + b + 1 >= n)
                continue;
            uint32_t s = base + vertex_number(n, sx * (a + 1), sy * (b + 1), sz);
            bb_shape_triangle(cursor, q, turned ? r : s, turned ? s : r);
        }
}

void bb_shape_sphere(bb_shape_cursor *cursor, const double centre[3], double radius, uint32_t n)
{
    uint32_t base = cursor->vertex_count;
    put_points(cursor, centre, radius, n, n, 1);
    put_points(cursor, centre, radius, n, (int64_t)n - 1, -1);
    for (int face = 0; face < 8; face++)
        put_face(cursor, base, n, (face & 1) != 0 ? -1 : 1, (face & 2) != 0 ? -1 : 1,
                 (face & 4) != 0 ? -1 : 1);
}
