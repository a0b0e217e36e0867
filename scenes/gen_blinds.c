/* Layers of pleated blinds, one behind the other. The slats are long and tilt forwards and
 * backwards in turn; layers are shifted up relative to each other. Closed, the slats of a layer
 * meet edge to edge. Open, each slat is narrower, and rays pass to the layers behind. Unlike
 * boards, neighbours are not in one plane, and their boxes overlap. */
#include "scenes/shapes.h"

static const bb_option options_table[] = {
    {"layers", "4", NULL, "number of layers"},
    {"n", "40", NULL, "slats of a layer"},
    {"width", "0.1", NULL, "height of a slat in its layer"},
    {"tilt", "1", NULL, "depth of a slat in widths: 1 tilts it by 45 degrees, 0 not at all"},
    {"length", "1000", NULL, "length of a slat, at most 1e6 times the distance"},
    {"distance", "1", NULL, "distance from the eye, at the origin, to the first layer"},
    {"gap", "0.5", NULL, "distance between layers"},
    {"open", "0", NULL, "missing share of each slat, 0 to 0.9"},
    BB_PLACEMENT_OPTIONS,
    {0},
};

typedef struct blinds {
    uint64_t layers;
    uint64_t n;
    double width, tilt, length, distance, gap, open;
} blinds;

static bb_status read_blinds(const bb_spec *spec, const bb_option *options, blinds *out)
{
    BB_TRY(bb_spec_u64(spec, options, "layers", 1, 1000, &out->layers));
    BB_TRY(bb_spec_u64(spec, options, "n", 1, 1 << 18, &out->n));
    BB_TRY(bb_spec_double(spec, options, "width", 1e-6, 1e6, &out->width));
    BB_TRY(bb_spec_double(spec, options, "tilt", 0, 100, &out->tilt));
    BB_TRY(bb_spec_double(spec, options, "length", 1e-6, 1e9, &out->length));
    BB_TRY(bb_spec_double(spec, options, "distance", 1e-6, 1e6, &out->distance));
    BB_TRY(bb_spec_double(spec, options, "gap", 0, 1e6, &out->gap));
    BB_TRY(bb_spec_double(spec, options, "open", 0, 0.9, &out->open));
    if (out->length > 1e6 * out->distance)
        return bb_fail(BB_INVALID, "%s: length %g over distance %g is more than 1e6", spec->text,
                       out->length, out->distance);
    return BB_OK;
}

/* Returns edge i of a layer in x and y: the same numbers for the slats on both of its sides. */
static void find_edge(const blinds *blinds, uint64_t layer, uint64_t i, double at[2])
{
    double depth = blinds->tilt * blinds->width;
    double shift = (double)layer / (double)blinds->layers;
    at[0] = blinds->distance + (double)layer * blinds->gap + (i % 2 == 0 ? -0.5 : 0.5) * depth;
    at[1] = ((double)i - 0.5 * (double)blinds->n + shift) * blinds->width;
}

static void put_slat(const blinds *blinds, uint64_t layer, uint64_t i, bb_shape_cursor *cursor)
{
    double low[2], high[2];
    uint32_t corner[4];
    find_edge(blinds, layer, i, low);
    find_edge(blinds, layer, i + 1, high);
    for (int k = 0; k < 2; k++) {
        double cut = 0.5 * blinds->open * (high[k] - low[k]); /* 0: exactly the edges */
        low[k] += cut;
        high[k] -= cut;
    }
    for (int k = 0; k < 4; k++) {
        const double *edge = k < 2 ? low : high;
        double z = (k == 0 || k == 3 ? -0.5 : 0.5) * blinds->length;
        corner[k] = bb_shape_vertex(cursor, (const double[3]){edge[0], edge[1], z});
    }
    bb_shape_quad(cursor, corner[0], corner[1], corner[2], corner[3]);
}

static bb_status make(const bb_spec *spec, const bb_option *options, bb_scene *scene)
{
    static const double eye[3] = {0, 0, 0}, up[3] = {0, 1, 0};
    bb_placement placement;
    blinds blinds;
    BB_TRY(bb_placement_read(spec, options, &placement));
    BB_TRY(read_blinds(spec, options, &blinds));
    double height = ((double)blinds.n + 2) * blinds.width;
    double depth =
        blinds.distance + (double)blinds.layers * blinds.gap + blinds.tilt * blinds.width;
    double farthest = 0.5 * (blinds.length + height) + depth;
    BB_TRY(bb_placement_check(&placement, spec, farthest, blinds.width * (1 - blinds.open)));
    uint64_t slats = blinds.layers * blinds.n;
    BB_TRY(bb_scene_reserve_mesh(scene, 4 * slats, 2 * slats));
    bb_shape_cursor cursor = bb_shape_start(scene, &placement);
    for (uint64_t layer = 0; layer < blinds.layers; layer++)
        for (uint64_t i = 0; i < blinds.n; i++)
            put_slat(&blinds, layer, i, &cursor);
    const double along[3] = {blinds.distance, 0, 4 * blinds.distance};
    const double across[3] = {blinds.distance, 0, 0.3 * blinds.distance};
    bb_placement_view(&placement, scene, "along", eye, along, up, 40);
    bb_placement_view(&placement, scene, "across", eye, across, up, 60);
    return BB_OK;
}

extern const bb_generator bb_generator_blinds;
const bb_generator bb_generator_blinds = {
    .name = "blinds",
    .summary = "layers of long tilted slats that meet edge to edge, seen along and across",
    .options = options_table,
    .make = make,
};
