#include "framework/tasks/mesh_row.h"

#include "framework/base/memory.h"
#include "framework/scene/tets.h"

#include <math.h>
#include <stdlib.h>

static void less(const double a[3], const double b[3], double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = a[k] - b[k];
}

static void cross(const double a[3], const double b[3], double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Returns the ratio of the radii. With edges a, b, c from a corner, and faces bc = b x c and so on:
 * 6 volume = a . bc;  the inscribed radius is 3 volume / surface;  the circumscribed one is
 * |a.a bc + b.b ca + c.c ab| / (12 volume). */
static double shape_of(const bb_scene *scene, uint32_t i, double *volume)
{
    const uint32_t *corners = bb_scene_tet(scene, i);
    double at[4][3], a[3], b[3], c[3], ab[3], bc[3], ca[3], opposite[3], centre[3];
    for (int v = 0; v < 4; v++)
        for (int k = 0; k < 3; k++)
            at[v][k] = (double)scene->vertices[3 * (size_t)corners[v] + k];
    less(at[1], at[0], a);
    less(at[2], at[0], b);
    less(at[3], at[0], c);
    cross(a, b, ab);
    cross(b, c, bc);
    cross(c, a, ca);
    *volume = fabs(dot(a, bc)) / 6;
    for (int k = 0; k < 3; k++) {
        opposite[k] = ab[k] + bc[k] + ca[k];
        centre[k] = dot(a, a) * bc[k] + dot(b, b) * ca[k] + dot(c, c) * ab[k];
    }
    const double surface = (sqrt(dot(ab, ab)) + sqrt(dot(bc, bc)) + sqrt(dot(ca, ca)) +
                            sqrt(dot(opposite, opposite))) /
                           2;
    const double ratio = 3 * *volume / surface * 12 * *volume / sqrt(dot(centre, centre));
    return isfinite(ratio) ? fmin(ratio, 1.0 / 3) : 0;
}

double bb_mesh_volume_of(const bb_scene *scene, uint32_t i)
{
    double volume;
    (void)shape_of(scene, i, &volume);
    return volume;
}

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

bb_status bb_mesh_shape_of(const bb_scene *scene, bb_mesh_shape *shape)
{
    const uint32_t count = scene->prims[BB_TETRAHEDRON].count;
    double *ratios = NULL, least = INFINITY, most = 0;
    BB_TRY(bb_host_alloc(NULL, count * sizeof *ratios, "aspect ratios", &ratios));
    for (uint32_t i = 0; i < count; i++) {
        double volume;
        ratios[i] = shape_of(scene, i, &volume);
        most = fmax(most, volume);
        least = volume > 0 ? fmin(least, volume) : least;
    }
    qsort(ratios, count, sizeof *ratios, by_value);
    *shape = (bb_mesh_shape){
        .aspect_min = ratios[0],
        .aspect_median = (ratios[(count - 1) / 2] + ratios[count / 2]) / 2,
        .aspect_max = ratios[count - 1],
        .volume_ratio = most > 0 ? most / least : NAN,
    };
    bb_host_free(ratios);
    return BB_OK;
}

BB_EXACT(tetrahedra, "tetrahedra", "tetrahedra", "", "Of the mesh.", NEITHER, 0);
BB_EXACT(boundary, "boundary_tetrahedra", "on the boundary", "",
         "Tetrahedra with a face that no other has.", NEITHER, 0);
BB_EXACT(flat, "flat_tetrahedra", "without a volume", "", "Tetrahedra of the mesh.", NEITHER, 0);
BB_EXACT(volume_ratio, "volume_ratio", "volume ratio", "",
         "Volume of the largest tetrahedron, in those of the smallest that has one.", NEITHER, -1);
BB_EXACT(aspect_min, "aspect_min", "aspect min", "",
         "Inradius over circumradius of tetrahedra, at most 1/3.", NEITHER, 3);
BB_EXACT(aspect_median, "aspect_median", "median", "",
         "Inradius over circumradius of tetrahedra, at most 1/3.", NEITHER, 3);
BB_EXACT(aspect_max, "aspect_max", "max", "",
         "Inradius over circumradius of tetrahedra, at most 1/3.", NEITHER, 3);
BB_TEXT(field, "field", "field", "Whose values are shown.");

void bb_mesh_fill(bb_table *table, uint32_t row, const bb_scene *scene)
{
    bb_mesh_shape shape;
    bb_table_set_number(table, row, &tetrahedra, scene->prims[BB_TETRAHEDRON].count);
    bb_table_set_number(table, row, &boundary, scene->tets->boundary_count);
    bb_table_set_number(table, row, &flat, scene->tets->flat_count);
    bb_table_set_text(table, row, &field, scene->tets->field_name);
    if (bb_mesh_shape_of(scene, &shape) != BB_OK)
        return;
    bb_table_set_number(table, row, &volume_ratio, shape.volume_ratio);
    bb_table_set_number(table, row, &aspect_min, shape.aspect_min);
    bb_table_set_number(table, row, &aspect_median, shape.aspect_median);
    bb_table_set_number(table, row, &aspect_max, shape.aspect_max);
}
