/* A long closed tube, seen from inside: four walls divided lengthwise into strips, and a fan of
 * triangles at each end. Strips extend much farther than the distance of most hits (see
 * gen_boards.c), and in a closed mesh every miss is known to be wrong. */
#include "scenes/shapes.h"

static const bb_option options_table[] = {
    {"length", "1000", NULL, "of the tube, 2 to 1e6 widths"},
    {"width", "2", NULL, "of its square section"},
    {"strips", "8", NULL, "strips of a wall, each of two triangles"},
    {"inside", "middle", "middle|end",
     "where the eye and the inside point are: a width from an end"},
    BB_PLACEMENT_OPTIONS,
    {0},
};

typedef struct tube {
    double length;
    double width;
    uint32_t strips;
} tube;

/* Puts the points of the tube's section at z: 4 * strips of them, counter-clockwise seen from
 * +z. */
static void put_section(const tube *tube, double z, bb_shape_cursor *cursor)
{
    static const double corners[5][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}, {-1, -1}};
    for (uint32_t k = 0; k < 4 * tube->strips; k++) {
        const double *from = corners[k / tube->strips], *to = corners[k / tube->strips + 1];
        double share = (double)(k % tube->strips) / tube->strips, p[3] = {0, 0, z};
        for (int axis = 0; axis < 2; axis++)
            p[axis] = tube->width / 2 * (from[axis] + share * (to[axis] - from[axis]));
        bb_shape_vertex(cursor, p);
    }
}

static void put_tube(const tube *tube, bb_shape_cursor *cursor)
{
    uint32_t around = 4 * tube->strips;
    put_section(tube, -tube->length / 2, cursor);
    put_section(tube, tube->length / 2, cursor);
    uint32_t near = bb_shape_vertex(cursor, (const double[3]){0, 0, -tube->length / 2});
    uint32_t far = bb_shape_vertex(cursor, (const double[3]){0, 0, tube->length / 2});
    for (uint32_t k = 0; k < around; k++) {
        uint32_t next = (k + 1) % around;
        bb_shape_quad(cursor, k, next, around + next, around + k);
        bb_shape_triangle(cursor, near, next, k);
        bb_shape_triangle(cursor, far, around + k, around + next);
    }
}

static void put_views(const tube *tube, const bb_placement *placement, double z, bb_scene *scene)
{
    static const double up[3] = {0, 1, 0};
    double w = tube->width;
    const double eye[3] = {0.2 * w, -0.15 * w, z};
    const double along[3] = {0.3 * w, -0.1 * w, z + w}, across[3] = {-0.5 * w, 0, z + 0.2 * w};
    bb_placement_view(placement, scene, "along", eye, along, up, 60);
    bb_placement_view(placement, scene, "across", eye, across, up, 90);
}

static bb_status make(const bb_spec *spec, const bb_option *options, bb_scene *scene)
{
    bb_placement placement;
    tube tube;
    uint64_t strips;
    BB_TRY(bb_placement_read(spec, options, &placement));
    BB_TRY(bb_spec_double(spec, options, "width", 1e-6, 1e6, &tube.width));
    BB_TRY(bb_spec_double(spec, options, "length", 1e-6, 1e12, &tube.length));
    BB_TRY(bb_spec_u64(spec, options, "strips", 1, 1 << 20, &strips));
    if (tube.length < 2 * tube.width || tube.length > 1e6 * tube.width)
        return bb_fail(BB_INVALID, "%s: length %g over width %g is not from 2 to 1e6", spec->text,
                       tube.length, tube.width);
    double farthest = tube.length / 2 + tube.width;
    BB_TRY(bb_placement_check(&placement, spec, farthest, tube.width / (double)strips));
    tube.strips = (uint32_t)strips;
    BB_TRY(bb_scene_reserve_mesh(scene, 8 * strips + 2, 16 * strips));
    bb_shape_cursor cursor = bb_shape_start(scene, &placement);
    put_tube(&tube, &cursor);
    bool at_end = bb_spec_is(spec, options, "inside", "end");
    double z = at_end ? tube.width - tube.length / 2 : 0;
    put_views(&tube, &placement, z, scene);
    bb_placement_inside(&placement, scene, (const double[3]){0, 0, z});
    return BB_OK;
}

extern const bb_generator bb_generator_corridor;
const bb_generator bb_generator_corridor = {
    .name = "corridor",
    .summary = "long closed tube whose walls are cut into strips, seen from inside",
    .options = options_table,
    .make = make,
};
