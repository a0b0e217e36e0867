/* Triangles whose centres halve their distance to a corner, axis by axis: by Morton codes, and by
 * most other measures, the tree is a chain. Seen from that corner the rest of the chain is always
 * nearer than the triangle that leaves it, so an ordered traversal pushes once per level and fills
 * a stack of rungs - 1 entries to the last; 17 rungs fill the smallest stack that the host makes.
 * Every second triangle points the other way: some rays miss the first triangle tested and must hit
 * the one pushed last. */
#include "scenes/shapes.h"

enum { RUNGS_MAX = 48 }; /* floats do not distinguish the centres of more */

static const double ratio = 0.45; /* not 0.5, where rounding would decide the bit */
static const double half_size = 4;

static const bb_option options_table[] = {
    {"rungs", "17", NULL, "triangles, 2 to 48: a chain of rungs - 1 levels"},
    BB_PLACEMENT_OPTIONS,
    {0},
};

/* Puts an equilateral triangle across the diagonal; its box is a cube around the centre. */
static void put_rung(bb_shape_cursor *cursor, const double centre[3], double half)
{
    static const double corners[3][3] = {{1, -1, 0}, {0, 1, -1}, {-1, 0, 1}};
    uint32_t at[3];
    for (int c = 0; c < 3; c++) {
        double p[3];
        for (int k = 0; k < 3; k++)
            p[k] = centre[k] + half * corners[c][k];
        at[c] = bb_shape_vertex(cursor, p);
    }
    bb_shape_triangle(cursor, at[0], at[1], at[2]);
}

static bb_status make(const bb_spec *spec, const bb_option *options, bb_scene *scene)
{
    static const double middle[3] = {0, 0, 0}, up[3] = {0, 1, 0};
    static const double corner[3] = {-24, -23.5, -24.5}, opposite[3] = {25, 24, 23};
    bb_placement placement;
    uint64_t rungs;
    BB_TRY(bb_placement_read(spec, options, &placement));
    BB_TRY(bb_spec_u64(spec, options, "rungs", 2, RUNGS_MAX, &rungs));
    BB_TRY(bb_scene_reserve_mesh(scene, 3 * rungs, rungs));
    bb_shape_cursor cursor = bb_shape_start(scene, &placement);
    double distance = 1;
    for (uint64_t rung = 0; rung < rungs; rung++) {
        double centre[3] = {0, 0, 0};
        if (rung + 1 < rungs) /* the last is at the corner itself */
            centre[rung % 3] = distance;
        put_rung(&cursor, centre, rung % 2 == 0 ? half_size : -half_size);
        if (rung % 3 == 2)
            distance *= ratio;
    }
    bb_placement_view(&placement, scene, "corner", corner, middle, up, 18);
    bb_placement_view(&placement, scene, "opposite", opposite, middle, up, 18);
    return BB_OK;
}

extern const bb_generator bb_generator_ladder;
const bb_generator bb_generator_ladder = {
    .name = "ladder",
    .summary =
        "triangles whose tree is a chain, met at every level: fills a stack to its last entry",
    .options = options_table,
    .make = make,
};
