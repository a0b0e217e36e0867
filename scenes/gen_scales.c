/* Closed shells around each other, one per decade of sizes. From inside the innermost each ray must
 * hit, regardless of underflow, overflow, or absolute epsilons. */
#include "scenes/shapes.h"

static const bb_option options_table[] = {
    {"from", "-15", NULL, "the innermost shell has radius 10^from: a whole number from -15 to 15"},
    {"to", "15", NULL, "the outermost has radius 10^to; the same as from: a single shell"},
    {"n", "2", NULL, "tessellation of a shell: 8 * n * n triangles"},
    BB_PLACEMENT_OPTIONS,
    {0},
};

static bb_status read_decade(const bb_spec *spec, const bb_option *options, const char *key,
                             int *out)
{
    double value;
    BB_TRY(bb_spec_double(spec, options, key, -15, 15, &value));
    *out = (int)value;
    if (*out != value)
        return bb_fail(BB_INVALID, "%s: option '%s' is %g, must be a whole number", spec->text, key,
                       value);
    return BB_OK;
}

/* Rounded once: powers of ten up to 10^22 are exact doubles. */
static double power_of_ten(int exponent)
{
    double power = 1;
    for (int i = 0; i < (exponent < 0 ? -exponent : exponent); i++)
        power *= 10;
    return exponent < 0 ? 1 / power : power;
}

static void put_views(const bb_placement *placement, int from, int to, bb_scene *scene)
{
    static const double middle[3] = {0, 0, 0}, up[3] = {0, 1, 0};
    double inner = power_of_ten(from), between = 3 * power_of_ten(from + (to - from) / 2);
    double outer = 3 * power_of_ten(to);
    const double inside[3] = {0.1 * inner, -0.2 * inner, 0.15 * inner};
    bb_placement_view(placement, scene, "inside", inside, middle, up, 90);
    if (from < to) /* shells outside, shells inside */
        bb_placement_view(placement, scene, "between",
                          (const double[3]){0.6 * between, 0.48 * between, 0.64 * between}, middle,
                          up, 90);
    bb_placement_view(placement, scene, "outside",
                      (const double[3]){0.6 * outer, 0.48 * outer, 0.64 * outer}, middle, up, 40);
    bb_placement_inside(placement, scene, inside);
}

static bb_status make(const bb_spec *spec, const bb_option *options, bb_scene *scene)
{
    static const double centre[3] = {0, 0, 0};
    bb_placement placement;
    int from, to;
    uint64_t n;
    BB_TRY(bb_placement_read(spec, options, &placement));
    BB_TRY(read_decade(spec, options, "from", &from));
    BB_TRY(read_decade(spec, options, "to", &to));
    BB_TRY(bb_spec_u64(spec, options, "n", 1, 1000, &n));
    if (from > to)
        return bb_fail(BB_INVALID, "%s: from=%d is above to=%d: exchange them", spec->text, from,
                       to);
    uint64_t shells = (uint64_t)(to - from) + 1;
    BB_TRY(bb_scene_reserve_mesh(scene, shells * bb_shape_sphere_vertices(n),
                                 shells * bb_shape_sphere_triangles(n)));
    bb_shape_cursor cursor = bb_shape_start(scene, &placement);
    for (int decade = from; decade <= to; decade++)
        bb_shape_sphere(&cursor, centre, power_of_ten(decade), (uint32_t)n);
    put_views(&placement, from, to, scene);
    return BB_OK;
}

extern const bb_generator bb_generator_scales;
const bb_generator bb_generator_scales = {
    .name = "scales",
    .summary = "closed shells around each other, one per decade of sizes, seen from the innermost",
    .options = options_table,
    .make = make,
};
