/* A closed cube of slivers, turned so that nothing in it is parallel to an axis.
 *
 * Six edges of a cube form a ring through all corners except two opposite ones (its Petrie
 * polygon), here called poles. Each face has two edges of the ring and one pole. The ring is
 * divided into short pieces, and each piece has a sliver to either pole. */
#include "scenes/shapes.h"

static const bb_option options_table[] = {
    {"aspect", "1000", NULL,
     "longest side over height of a sliver, at least; 12 times as many triangles"},
    BB_PLACEMENT_OPTIONS,
    {0},
};

/* Transforms from the cube's own frame, -1/2 to 1/2, to the turned one. */
static void set_askew(const double p[3], double out[3])
{
    static const double rows[3][3] = {{2, 2, 1}, {-2, 1, 2}, {1, -2, 2}};
    for (int k = 0; k < 3; k++)
        out[k] = (rows[k][0] * p[0] + rows[k][1] * p[1] + rows[k][2] * p[2]) / 3;
}

static uint32_t put_vertex(bb_shape_cursor *cursor, const double p[3])
{
    double at[3];
    set_askew(p, at);
    return bb_shape_vertex(cursor, at);
}

static void put_slivers(uint32_t pieces, bb_shape_cursor *cursor)
{
    static const double ring[7][3] = {{1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 1, 1},
                                      {0, 0, 1}, {1, 0, 1}, {1, 0, 0}};
    uint32_t count = 6 * pieces;
    for (uint32_t i = 0; i < count; i++) {
        const double *from = ring[i / pieces], *to = ring[i / pieces + 1];
        double share = (double)(i % pieces) / pieces, p[3];
        for (int k = 0; k < 3; k++)
            p[k] = from[k] + share * (to[k] - from[k]) - 0.5;
        put_vertex(cursor, p);
    }
    uint32_t low = put_vertex(cursor, (const double[3]){-0.5, -0.5, -0.5});
    uint32_t high = put_vertex(cursor, (const double[3]){0.5, 0.5, 0.5});
    for (uint32_t i = 0; i < count; i++) {
        bb_shape_triangle(cursor, low, (i + 1) % count, i);
        bb_shape_triangle(cursor, high, i, (i + 1) % count);
    }
}

static void put_view(const bb_placement *placement, bb_scene *scene, const char *name,
                     const double from[3], const double to[3])
{
    static const double up[3] = {0, 1, 0};
    double eye[3], target[3];
    set_askew(from, eye);
    set_askew(to, target);
    bb_placement_view(placement, scene, name, eye, target, up, 90);
}

static bb_status make(const bb_spec *spec, const bb_option *options, bb_scene *scene)
{
    static const double centre[3] = {0, 0, 0}, pole[3] = {-0.5, -0.5, -0.5};
    static const double close[3] = {-0.3, -0.2, -0.49}, along[3] = {0.3, 0.3, -0.5};
    bb_placement placement;
    uint64_t aspect;
    BB_TRY(bb_placement_read(spec, options, &placement));
    BB_TRY(bb_spec_u64(spec, options, "aspect", 1, 1000000, &aspect));
    BB_TRY(bb_scene_reserve_mesh(scene, 6 * aspect + 2, 12 * aspect));
    bb_shape_cursor cursor = bb_shape_start(scene, &placement);
    put_slivers((uint32_t)aspect, &cursor);
    put_view(&placement, scene, "pole", centre, pole);
    put_view(&placement, scene, "grazing", close, along);
    bb_placement_inside(&placement, scene, centre);
    return BB_OK;
}

extern const bb_generator bb_generator_slivers;
const bb_generator bb_generator_slivers = {
    .name = "slivers",
    .summary = "closed cube of slivers, askew to all axes, seen from inside",
    .options = options_table,
    .make = make,
};
