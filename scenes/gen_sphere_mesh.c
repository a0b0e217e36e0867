/* A closed sphere mesh at any position: every ray from inside must hit it, so every miss is wrong,
 * and the offset leads the intersector to coordinates whose differences have few bits. */
#include "framework/scene/scene.h"
#include "scenes/shapes.h"

#include <math.h>

static const bb_option options_table[] = {
    {"n", "64", NULL, "tessellation: 8 * n * n triangles"},
    {"radius", "1", NULL, "radius, in scene units"},
    {"x", "0", NULL, "centre, in scene units"},
    {"y", "0", NULL, "centre, in scene units"},
    {"z", "0", NULL, "centre, in scene units"},
    {0},
};

static bb_status make(const bb_spec *spec, const bb_option *options, bb_scene *scene)
{
    uint64_t n;
    double radius, centre[3], farthest = 0;
    BB_TRY(bb_spec_u64(spec, options, "n", 1, 16383, &n));
    BB_TRY(bb_spec_double(spec, options, "radius", 1e-15, 1e15, &radius));
    for (int axis = 0; axis < 3; axis++) {
        const char key[2] = {"xyz"[axis], '\0'};
        BB_TRY(bb_spec_double(spec, options, key, -1e15, 1e15, &centre[axis]));
        farthest = fmax(farthest, fabs(centre[axis]));
    }
    /* Its vertices are floats: if these are as far apart as the sphere is wide, it is not a sphere,
     * and its inside is lost. */
    if (radius < farthest * 0x1p-20)
        return bb_fail(BB_INVALID,
                       "%s: a radius of %g at a distance of %g is less than 16 steps of a float: "
                       "take a larger radius",
                       spec->text, radius, farthest);
    BB_TRY(bb_scene_reserve_mesh(scene, bb_shape_sphere_vertices(n), bb_shape_sphere_triangles(n)));
    bb_shape_cursor cursor = bb_shape_start(scene, NULL);
    bb_shape_sphere(&cursor, centre, radius, (uint32_t)n);
    scene->closed_from_inside = true;
    for (int axis = 0; axis < 3; axis++)
        scene->inside_point[axis] = centre[axis];
    return BB_OK;
}

extern const bb_generator bb_generator_sphere_mesh;
const bb_generator bb_generator_sphere_mesh = {
    .name = "sphere-mesh",
    .summary = "closed sphere mesh of given tessellation, radius and offset",
    .options = options_table,
    .make = make,
};
