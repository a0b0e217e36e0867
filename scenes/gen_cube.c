/* The closed cube of 12 triangles from -1/2 to 1/2. Every coordinate is a power of two, so that
 * tests on it can be solved by hand. */
#include "framework/scene/scene.h"
#include "scenes/shapes.h"

static bb_status make(const bb_spec *spec, const bb_option *options, bb_scene *scene)
{
    static const double lo[3] = {-0.5, -0.5, -0.5}, hi[3] = {0.5, 0.5, 0.5};
    (void)spec;
    (void)options;
    BB_TRY(bb_scene_reserve_mesh(scene, BB_SHAPE_BOX_VERTICES, BB_SHAPE_BOX_TRIANGLES));
    bb_shape_cursor cursor = bb_shape_start(scene, NULL);
    bb_shape_box(&cursor, lo, hi);
    scene->closed_from_inside = true; /* inside_point is the origin */
    return BB_OK;
}

extern const bb_generator bb_generator_cube;
const bb_generator bb_generator_cube = {
    .name = "cube",
    .summary = "closed cube of 12 triangles, from -1/2 to 1/2",
    .make = make,
};
