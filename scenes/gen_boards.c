/* A wall of long boards, seen along. Each board extends much farther along the ray's dominant axis
 * than the distance of the hit. The rounding of a triangle test that shears its vertices then
 * exceeds the padding of a box test that handles each axis separately, and a ray near an edge is
 * lost: the box of one board is culled, the triangle of the other is missed. */
#include "scenes/shapes.h"

static const bb_option options_table[] = {
    {"n", "40", NULL, "number of boards"},
    {"width", "0.1", NULL, "width of a board"},
    {"length", "1000", NULL, "length of a board, at most 1e6 times the distance"},
    {"distance", "1", NULL, "distance from the eye, at the origin, to the wall"},
    BB_PLACEMENT_OPTIONS,
    {0},
};

typedef struct wall {
    uint64_t n;
    double width;
    double length;
    double distance;
} wall;

static bb_status read_wall(const bb_spec *spec, const bb_option *options, wall *out)
{
    BB_TRY(bb_spec_u64(spec, options, "n", 1, 1 << 22, &out->n));
    BB_TRY(bb_spec_double(spec, options, "width", 1e-6, 1e6, &out->width));
    BB_TRY(bb_spec_double(spec, options, "length", 1e-6, 1e9, &out->length));
    BB_TRY(bb_spec_double(spec, options, "distance", 1e-6, 1e6, &out->distance));
    if (out->length > 1e6 * out->distance)
        return bb_fail(BB_INVALID, "%s: length %g over distance %g is more than 1e6", spec->text,
                       out->length, out->distance);
    return BB_OK;
}

/* In the plane x = distance: boards along z, one above the other. Neighbours share their
 * corners. */
static void put_boards(const wall *wall, bb_shape_cursor *cursor)
{
    for (uint64_t i = 0; i <= wall->n; i++) {
        double y = ((double)i - 0.5 * (double)wall->n) * wall->width;
        for (int side = -1; side <= 1; side += 2)
            bb_shape_vertex(cursor, (const double[3]){wall->distance, y, side * wall->length / 2});
    }
    for (uint32_t i = 0; i < wall->n; i++)
        bb_shape_quad(cursor, 2 * i, 2 * i + 1, 2 * i + 3, 2 * i + 2);
}

static bb_status make(const bb_spec *spec, const bb_option *options, bb_scene *scene)
{
    static const double eye[3] = {0, 0, 0}, up[3] = {0, 1, 0};
    bb_placement placement;
    wall wall;
    BB_TRY(bb_placement_read(spec, options, &placement));
    BB_TRY(read_wall(spec, options, &wall));
    double height = (double)wall.n * wall.width;
    double farthest = 0.5 * (wall.length + height) + wall.distance;
    BB_TRY(bb_placement_check(&placement, spec, farthest, wall.width));
    BB_TRY(bb_scene_reserve_mesh(scene, 2 * (wall.n + 1), 2 * wall.n));
    bb_shape_cursor cursor = bb_shape_start(scene, &placement);
    put_boards(&wall, &cursor);
    const double along[3] = {wall.distance, 0, 4 * wall.distance};
    const double straight[3] = {wall.distance, 0, 0};
    bb_placement_view(&placement, scene, "along", eye, along, up, 40);
    bb_placement_view(&placement, scene, "straight", eye, straight, up, 60);
    return BB_OK;
}

extern const bb_generator bb_generator_boards;
const bb_generator bb_generator_boards = {
    .name = "boards",
    .summary = "wall of long boards without gaps, seen along: loses rays between boxes",
    .options = options_table,
    .make = make,
};
