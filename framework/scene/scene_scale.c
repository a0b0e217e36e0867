/* The units in which layouts and kernels compute: kernels/ERROR_BUDGET.md, section "Domain". */
#include "framework/scene/prim.h"

#include <math.h>

enum {
    USUAL = 32,      /* exponent of the largest coordinate in the layout's units */
    HIGHEST = 58,    /* differences of coordinates, and then products of two, must not overflow */
    SCALE_MAX = 120, /* exponent of the scale: it must be a float, also times a direction's scale */
    LARGEST_MIN = -100, /* below, effects of flushing floats to 0 would show */
};

static const double least_product = 0x1p-100; /* in the layout's units */

static double product_of(const bb_scene *scene, uint32_t prim)
{
    uint32_t i;
    const bb_prim_kind *kind = bb_prim_of(scene, prim, &i);
    return kind->product(scene, i);
}

/* Returns the smallest that is not 0; INFINITY if there is none. */
static double smallest_product(const bb_scene *scene)
{
    double smallest = INFINITY;
    for (uint32_t prim = 0; prim < scene->prim_count; prim++) {
        double product = product_of(scene, prim);
        if (product > 0.0 && product < smallest)
            smallest = product;
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
    double smallest = smallest_product(scene);
    int wanted = USUAL - exponent, most = HIGHEST - exponent;
    most = most < SCALE_MAX ? most : SCALE_MAX;
    wanted = wanted < most ? wanted : most;
    while (wanted < most && smallest * ldexp(1.0, 2 * wanted) < least_product)
        wanted++;
    scene->scale = (float)ldexp(1.0, wanted);
    double unit = ldexp(1.0, 2 * wanted);
    if (smallest * unit >= least_product)
        return BB_OK;
    for (uint32_t prim = 0; prim < scene->prim_count; prim++) {
        double product = product_of(scene, prim);
        scene->out_of_range += product > 0.0 && product * unit < least_product;
    }
    return BB_OK;
}
