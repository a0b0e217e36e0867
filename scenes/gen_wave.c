/* A sheet in strips that moves: it ripples, its strips slide against each other, and half of it
 * folds over the rest. Neighbours in frame 0 are no longer neighbours in the last frame: a tree
 * that is only refitted gets worse from frame to frame.
 *
 * Everything is computed in doubles by + - * / only and rounded once, so that it is the same on
 * every machine: a ripple is made of parabolas, and a fold is turned by the tangent of half its
 * angle. */
#include "framework/base/random.h"
#include "framework/scene/scene.h"

#include <math.h>

static const bb_option options_table[] = {
    {"n", "100000", NULL, "number of triangles, rounded to whole strips"},
    {"frames", "16", NULL, "number of frames; 1: it does not move"},
    {"strips", "24", NULL, "strips that slide against each other"},
    {"seed", "1", NULL, "seed of their speeds"},
    {0},
};

static const double side = 100;    /* of the sheet in frame 0, in scene units */
static const double slide = 40;    /* most that a strip moves, either way */
static const double half_turn = 2; /* tangent of half the angle of the whole fold: 127 degrees */
static const double wavelength = 27;

typedef struct sheet {
    uint64_t strips, seed, frames;
    uint32_t along, across; /* cells of a strip */
} sheet;

static bb_status read_sheet(const bb_spec *spec, const bb_option *options, sheet *s)
{
    uint64_t n;
    BB_TRY(bb_spec_u64(spec, options, "n", 2, INT32_MAX, &n));
    BB_TRY(bb_spec_u64(spec, options, "frames", 1, 1000000, &s->frames));
    BB_TRY(bb_spec_u64(spec, options, "strips", 1, 100000, &s->strips));
    BB_TRY(bb_spec_u64(spec, options, "seed", 0, UINT64_MAX, &s->seed));
    double quads = fmax(1, (double)n / 2 / (double)s->strips);
    /* square cells, as far as whole numbers allow */
    s->across = (uint32_t)fmax(1, floor(sqrt(quads / (double)s->strips) + 0.5));
    s->along = (uint32_t)fmax(1, floor(quads / s->across + 0.5));
    return BB_OK;
}

/* Goes from -1 to 1 and back as x grows by 1: two parabolas, smooth where they meet. */
static double ripple(double x)
{
    double u = x - floor(x);
    return u < 0.5 ? 16 * u * (0.5 - u) : -16 * (u - 0.5) * (1 - u);
}

/* Computes the position of (x, z) of strip `strip` at `time`, 0 to 1. */
static void place(const sheet *s, uint64_t strip, double x, double z, double time, float *to)
{
    bb_random random = bb_random_make(s->seed, strip);
    double speed = bb_random_range(&random, -1, 1), phase = bb_random_unit(&random);
    double height = (2 + 5 * time) * ripple(x / wavelength + phase * time - 2 * time) +
                    (1 + 2 * time) * ripple(z / wavelength + time);
    double t = half_turn * time, cosine = (1 - t * t) / (1 + t * t), sine = 2 * t / (1 + t * t);
    double beyond = x + slide * speed * time - side / 2;
    bool folds = beyond > 0;
    to[0] = (float)(side / 2 + (folds ? beyond * cosine - height * sine : beyond));
    to[1] = (float)(folds ? beyond * sine + height * cosine : height);
    to[2] = (float)z;
}

static bb_status set_frame(const bb_spec *spec, const bb_option *options, bb_scene *scene,
                           uint32_t frame)
{
    sheet s;
    BB_TRY(read_sheet(spec, options, &s));
    double time = s.frames > 1 ? (double)frame / (double)(s.frames - 1) : 0;
    float *to = scene->vertices;
    for (uint64_t strip = 0; strip < s.strips; strip++)
        for (uint32_t j = 0; j <= s.across; j++)
            for (uint32_t i = 0; i <= s.along; i++, to += 3) {
                double row = (double)strip + (double)j / s.across;
                place(&s, strip, (double)i / s.along * side, row / (double)s.strips * side, time,
                      to);
            }
    return BB_OK;
}

/* Puts the quads of all strips; each strip has its own vertices. */
static void put_quads(const sheet *s, bb_scene *scene)
{
    uint32_t *to = bb_scene_indices(scene), row = s->along + 1;
    for (uint64_t strip = 0; strip < s->strips; strip++)
        for (uint32_t j = 0; j < s->across; j++)
            for (uint32_t i = 0; i < s->along; i++, to += 6) {
                uint32_t corner = ((uint32_t)strip * (s->across + 1) + j) * row + i;
                to[0] = to[3] = corner;
                to[1] = corner + row;
                to[2] = to[4] = corner + row + 1;
                to[5] = corner + 1;
            }
}

static bb_status make(const bb_spec *spec, const bb_option *options, bb_scene *scene)
{
    static const bb_view views[] = {
        {"overall", false, {-40, 90, 150}, {40, 10, 48}, {0, 1, 0}, 50},
        {"along", false, {-30, 14, 50}, {60, 8, 50}, {0, 1, 0}, 60},
        {"above", true, {50, 150, 50}, {50, 0, 50}, {0, 0, -1}, 120},
    };
    sheet s;
    BB_TRY(read_sheet(spec, options, &s));
    uint64_t vertices = s.strips * (s.along + 1ull) * (s.across + 1ull);
    BB_TRY(bb_scene_reserve_mesh(scene, vertices, 2 * s.strips * s.along * s.across));
    put_quads(&s, scene);
    scene->frame_count = (uint32_t)s.frames;
    scene->view_count = sizeof views / sizeof views[0];
    for (uint32_t i = 0; i < scene->view_count; i++)
        scene->views[i] = views[i];
    return set_frame(spec, options, scene, 0);
}

extern const bb_generator bb_generator_wave;
const bb_generator bb_generator_wave = {
    .name = "wave",
    .summary = "a sheet in strips that ripples, slides and folds, in frames",
    .options = options_table,
    .make = make,
    .set_frame = set_frame,
};
