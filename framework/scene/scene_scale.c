/* The units in which layouts and kernels reckon: kernels/ERROR_BUDGET.md, section "Domain". */
#include "framework/scene/scene.h"

#include <math.h>

enum {
    USUAL = 32,      /* exponent of the largest coordinate in the layout's units */
    HIGHEST = 58,    /* differences of coordinates, and then products of two, must not overflow */
    SCALE_MAX = 120, /* exponent of the scale: a float, also times a direction's */
    LARGEST_MIN = -100, /* below, floats that a device flushes to 0 would show */
};

static const double least_area = 0x1p-100; /* in the layout's units */

/* Twice the area of a triangle, or a sphere's radius squared: 0 where nothing can be hit. */
static double area_of(const bb_scene *scene, uint32_t prim)
{
    if (prim >= scene->triangle_count) {
        double radius = scene->spheres[4 * (size_t)(prim - scene->triangle_count) + 3];
        return radius * radius;
    }
    const float *a = bb_scene_vertex(scene, prim, 0), *b = bb_scene_vertex(scene, prim, 1),
                *c = bb_scene_vertex(scene, prim, 2);
    double square = 0.0;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        double n = ((double)b[j] - a[j]) * ((double)c[k] - a[k]) -
                   ((double)b[k] - a[k]) * ((double)c[j] - a[j]);
        square += n * n;
    }
    return sqrt(square);
}

/* The smallest area that is not 0; INFINITY if there is none. */
static double smallest_area(const bb_scene *scene)
{
    double smallest = INFINITY;
    for (uint32_t prim = 0; prim < scene->prim_count; prim++) {
        double area = area_of(scene, prim);
        if (area > 0.0 && area < smallest)
            smallest = area;
    }
    return smallest;
}

bb_status bb_scene_choose_scale(bb_scene *scene)
{
    double largest = 0.0;
    for (int k = 0; k < 3; k++)
        largest = fmax(largest,
                       fmax(fabs((double)scene->bounds.lo[k]), fabs((double)scene->bounds.hi[k])));
    int exponent = 0;
    scene->out_of_range = 0;
    if (largest > 0.0)
        frexp(largest, &exponent);
    if (exponent <= LARGEST_MIN)
        return bb_fail(BB_INVALID,
                       "%s: its largest coordinate is %g, too small for floats: scale it up",
                       scene->name, largest);
    double smallest = smallest_area(scene);
    int wanted = USUAL - exponent, most = HIGHEST - exponent;
    most = most < SCALE_MAX ? most : SCALE_MAX;
    wanted = wanted < most ? wanted : most;
    while (wanted < most && smallest * ldexp(1.0, 2 * wanted) < least_area)
        wanted++;
    scene->scale = (float)ldexp(1.0, wanted);
    double unit = ldexp(1.0, 2 * wanted);
    if (smallest * unit >= least_area)
        return BB_OK;
    for (uint32_t prim = 0; prim < scene->prim_count; prim++) {
        double area = area_of(scene, prim);
        scene->out_of_range += area > 0.0 && area * unit < least_area;
    }
    return BB_OK;
}
