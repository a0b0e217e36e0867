/* Crowds in motion, each by the rule of its kind. A refitted tree fares very differently with them:
 * rigid objects that keep apart, shards of an explosion, objects falling from a plane, mixing
 * particles, exchanged places, clouds that pass through each other, everything at the origin at
 * first, more and more objects, or none that moves.
 *
 * All are about one unit large (flow: 2 pi). */
#include "scenes/crowd.h"
#include "scenes/repeatable.h"

#include <string.h>

static const bb_option options_table[] = {
    {"kind", "rigid", "rigid|explode|fall|flow|shuffle|cross|origin|grow|still", "how they move"},
    {"n", "100000", NULL, "number of triangles, rounded down to whole objects"},
    {"share", NULL, NULL,
     "shuffle: pairs that exchange places in each frame; grow: things that come and go; as a share "
     "of all, 0 to 1; default: 0.01, and one at least"},
    BB_MOTION_OPTIONS,
    {0},
};

typedef struct bb_crowd_kind bb_crowd_kind;

/* A crowd at its motion's frame. */
typedef struct state {
    const bb_crowd_kind *kind;
    bb_motion motion;
    bb_crowd crowd;
    uint32_t least; /* number in frame 0 */
    uint32_t first; /* first of the current ones, which come and go in turn */
    uint32_t part;  /* number of those that come and go, or exchange places, in each frame */
} state;

struct bb_crowd_kind {
    const char *name;
    uint32_t frames; /* by default */
    uint32_t tessellation;
    double fill; /* share of the unit cube that the objects' own cubes fill */
    void (*place)(const state *s, double (*centres)[3]);
};

/* Returns the random numbers of object i. */
static bb_random random_of(const state *s, uint32_t i)
{
    return bb_random_make(s->motion.seed, i);
}

static void random_point(bb_random *random, double p[3])
{
    for (int axis = 0; axis < 3; axis++)
        p[axis] = bb_random_unit(random);
}

/* ---- one function per kind ---- */

/* Returns x, reflected until it is between low and high. */
static double reflect(double x, double low, double high)
{
    double period = 2 * (high - low), u = x - low;
    u -= period * floor(u / period);
    return low + (u <= high - low ? u : period - u);
}

static void place_rigid(const state *s, double (*centres)[3])
{
    for (uint32_t i = 0; i < s->crowd.count; i++) {
        bb_random random = random_of(s, i);
        random_point(&random, centres[i]);
        for (int axis = 0; axis < 3; axis++)
            centres[i][axis] =
                reflect(centres[i][axis] + s->motion.time * bb_random_range(&random, -2, 2),
                        s->crowd.radius, 1 - s->crowd.radius);
    }
}

static void place_explode(const state *s, double (*centres)[3])
{
    for (uint32_t i = 0; i < s->crowd.count; i++) {
        bb_random random = random_of(s, i);
        double radial[3], speed;
        bb_random_direction(&random, radial);
        speed = bb_random_range(&random, 0.3, 2);
        for (int axis = 0; axis < 3; axis++)
            centres[i][axis] =
                0.5 * radial[axis] +
                s->motion.time * (speed * radial[axis] + bb_random_range(&random, -0.5, 0.5));
    }
}

/* Objects fall from a plane to the floor, each at its own time. */
static void place_fall(const state *s, double (*centres)[3])
{
    for (uint32_t i = 0; i < s->crowd.count; i++) {
        bb_random random = random_of(s, i);
        random_point(&random, centres[i]);
        double since = fmax(0, s->motion.time - bb_random_range(&random, 0, 0.5));
        double speed = bb_random_range(&random, 0.5, 4);
        double down = fmin(1, speed * since), across = down / speed;
        centres[i][1] = 1 - down;
        for (int axis = 0; axis < 3; axis += 2)
            centres[i][axis] += across * bb_random_range(&random, -1, 1);
    }
}

/* The ABC flow (Arnold, Beltrami, Childress), periodic: neighbours separate exponentially. */
static void place_flow(const state *s, double (*centres)[3])
{
    enum { STEPS = 10 }; /* per frame */
    static const double a = 1, b = 0.8, c = 0.6, step = 0.02, period = 6.28318530717958647693;
    for (uint32_t i = 0; i < s->crowd.count; i++) {
        bb_random random = random_of(s, i);
        double *p = centres[i];
        random_point(&random, p);
        for (int axis = 0; axis < 3; axis++)
            p[axis] *= period;
        for (uint64_t k = 0; k < (uint64_t)STEPS * s->motion.frame; k++) {
            const double speed[3] = {a * bb_sine(p[2]) + c * bb_cosine(p[1]),
                                     b * bb_sine(p[0]) + a * bb_cosine(p[2]),
                                     c * bb_sine(p[1]) + b * bb_cosine(p[0])};
            for (int axis = 0; axis < 3; axis++) {
                p[axis] += step * speed[axis];
                p[axis] -= period * floor(p[axis] / period);
            }
        }
    }
}

static void place_still(const state *s, double (*centres)[3])
{
    for (uint32_t i = 0; i < s->crowd.count; i++) {
        bb_random random = random_of(s, s->first + i);
        random_point(&random, centres[i]);
    }
}

/* In each frame some pairs exchange places. */
static void place_shuffle(const state *s, double (*centres)[3])
{
    place_still(s, centres);
    for (uint32_t frame = 1; frame <= s->motion.frame; frame++) {
        bb_random random = bb_random_make(s->motion.seed ^ 0x5A5A, frame);
        for (uint32_t pair = 0; pair < s->part; pair++) {
            double *p = centres[bb_random_below(&random, s->crowd.count)],
                   *q = centres[bb_random_below(&random, s->crowd.count)];
            for (int axis = 0; axis < 3; axis++) {
                double kept = p[axis];
                p[axis] = q[axis];
                q[axis] = kept;
            }
        }
    }
}

/* Every other object goes the other way. */
static void place_cross(const state *s, double (*centres)[3])
{
    place_still(s, centres);
    for (uint32_t i = 0; i < s->crowd.count; i++)
        centres[i][0] += (i % 2 == 0 ? 3 : -3) * (s->motion.time - 0.5);
}

static void place_origin(const state *s, double (*centres)[3])
{
    place_still(s, centres);
    for (uint32_t i = 0; i < s->crowd.count; i++)
        for (int axis = 0; axis < 3; axis++)
            centres[i][axis] = s->motion.time * (2 * centres[i][axis] - 1);
}

static const bb_crowd_kind kinds[] = {
    {"rigid", 21, 6, 0.2, place_rigid},     {"explode", 21, 0, 0.05, place_explode},
    {"fall", 11, 0, 0.05, place_fall},      {"flow", 21, 1, 2, place_flow},
    {"shuffle", 21, 1, 0.1, place_shuffle}, {"cross", 21, 1, 0.1, place_cross},
    {"origin", 21, 1, 0.1, place_origin},   {"grow", 21, 1, 0.1, place_still},
    {"still", 21, 1, 0.1, place_still},
};

/* ---- all kinds ---- */

/* Objects come and go with each frame. */
static bb_status come_and_go(state *s)
{
    if (strcmp(s->kind->name, "grow") != 0)
        return BB_OK;
    uint64_t most = s->least + (uint64_t)s->part * (s->motion.frames - 1);
    if (most > INT32_MAX)
        return bb_fail(
            BB_INVALID,
            "scene crowd: %u things grow to %llu in %llu frames, too many to number: take "
            "a smaller n, or fewer frames",
            s->least, (unsigned long long)most, (unsigned long long)s->motion.frames);
    s->first = s->part * s->motion.frame;
    s->crowd.count = s->least + s->first;
    return BB_OK;
}

static bb_status read_state(const bb_spec *spec, const bb_option *options, uint32_t frame, state *s)
{
    const char *kind = bb_spec_value(spec, options, "kind");
    uint64_t n;
    double share;
    *s = (state){0};
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++)
        if (strcmp(kinds[i].name, kind) == 0)
            s->kind = &kinds[i];
    BB_TRY(bb_spec_u64(spec, options, "n", 1, 1 << 28, &n));
    BB_TRY(bb_motion_read(spec, options, s->kind->frames, frame, &s->motion));
    s->crowd = bb_crowd_of(n, s->kind->tessellation, 0);
    s->least = s->crowd.count;
    s->crowd.radius = 0.5 * bb_cube_root(s->kind->fill / s->least);
    s->part = s->least / 100 + 1;
    if (bb_spec_value(spec, options, "share") != NULL) {
        if (strcmp(kind, "shuffle") != 0 && strcmp(kind, "grow") != 0)
            return bb_fail(BB_INVALID,
                           "scene crowd: share is for kind=shuffle and kind=grow, not "
                           "kind=%s",
                           kind);
        BB_TRY(bb_spec_double(spec, options, "share", 0, 1, &share));
        s->part = (uint32_t)(share * s->least + 0.5);
    }
    return come_and_go(s);
}

static bb_status set_frame(const bb_spec *spec, const bb_option *options, bb_scene *scene,
                           uint32_t frame)
{
    state s;
    double(*centres)[3] = NULL;
    BB_TRY(read_state(spec, options, frame, &s));
    BB_TRY(
        bb_host_alloc(NULL, s.crowd.count * sizeof *centres, "where the crowd stands", &centres));
    s.kind->place(&s, centres);
    bb_status status = bb_crowd_place(&s.crowd, &s.motion, (const double(*)[3])centres, scene);
    bb_host_free(centres);
    return status;
}

static bb_status make(const bb_spec *spec, const bb_option *options, bb_scene *scene)
{
    state s;
    BB_TRY(read_state(spec, options, 0, &s));
    bb_motion_declare(&s.motion, scene);
    BB_TRY(read_state(spec, options, scene->frame_count - 1, &s)); /* frame with the most objects */
    BB_TRY(bb_crowd_reserve(&s.crowd, scene));
    return set_frame(spec, options, scene, 0);
}

extern const bb_generator bb_generator_crowd;
const bb_generator bb_generator_crowd = {
    .name = "crowd",
    .summary = "many small moving objects, in frames: nine kinds",
    .options = options_table,
    .make = make,
    .set_frame = set_frame,
};
