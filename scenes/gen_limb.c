/* A round limb over a chain of eight bones, each of which swings by up to 60 degrees relative to
 * the previous one, one after the other, as in skinned characters. A vertex follows two bones,
 * blended linearly. */
#include "scenes/repeatable.h"
#include "scenes/tube.h"

static const bb_option options_table[] = {
    {"n", "100000", NULL, "number of triangles, about"},
    BB_MOTION_OPTIONS,
    {0},
};

enum { BONES = 8, CORNERS = 24 };

static const double radius = 0.3, swing = 1.04719755119659774615; /* 60 degrees */
static const double turn = 6.28318530717958647693;

/* The chain is in the plane of x and z; a bone has length 1. */
typedef struct limb {
    bb_tube tube;
    double section[CORNERS][2];
    double joint[BONES][2], sine[BONES], cosine[BONES]; /* position of each bone's beginning, and
                                                         * its turn */
} limb;

static void pose(limb *l, double time)
{
    double angle = 0, at[2] = {0, 0};
    for (int b = 0; b < BONES; b++) {
        angle += b > 0 ? swing * bb_sine(turn * (time - (double)b / BONES)) : 0;
        l->joint[b][0] = at[0];
        l->joint[b][1] = at[1];
        at[0] += l->sine[b] = bb_sine(angle);
        at[1] += l->cosine[b] = bb_cosine(angle);
    }
}

static bb_status read_limb(const bb_spec *spec, const bb_option *options, uint32_t frame, limb *l,
                           bb_motion *motion)
{
    uint64_t n;
    BB_TRY(bb_spec_u64(spec, options, "n", 2 * CORNERS * (BONES + 1), INT32_MAX, &n));
    BB_TRY(bb_motion_read(spec, options, BB_MOTION_FRAMES, frame, motion));
    for (int i = 0; i < CORNERS; i++) {
        l->section[i][0] = radius * bb_cosine(turn * i / CORNERS);
        l->section[i][1] = radius * bb_sine(turn * i / CORNERS);
    }
    /* square cells: a cell of the ring is turn * radius / (CORNERS * across) wide */
    double cell = sqrt(turn * radius * BONES * 2 / (double)n);
    uint32_t across = (uint32_t)fmax(1, floor(turn * radius / CORNERS / cell + 0.5));
    uint32_t along = (uint32_t)fmax(BONES, floor((double)n / 2 / (CORNERS * across) - 0.5));
    l->tube = (bb_tube){CORNERS, (const double(*)[2])l->section, BONES, across, along};
    pose(l, motion->time);
    return BB_OK;
}

static void bend(const void *user, double p[3])
{
    const limb *l = user;
    double along = fmin(fmax(p[2] - 0.5, 0), BONES - 1), x = 0, z = 0;
    int first = (int)fmin(floor(along), BONES - 2);
    for (int k = 0; k < 2; k++) {
        int b = first + k;
        double weight = k == 0 ? 1 - (along - first) : along - first, above = p[2] - b;
        x += weight * (l->joint[b][0] + l->cosine[b] * p[0] + l->sine[b] * above);
        z += weight * (l->joint[b][1] - l->sine[b] * p[0] + l->cosine[b] * above);
    }
    p[0] = x;
    p[2] = z;
}

static bb_status set_frame(const bb_spec *spec, const bb_option *options, bb_scene *scene,
                           uint32_t frame)
{
    limb l;
    bb_motion motion;
    BB_TRY(read_limb(spec, options, frame, &l, &motion));
    bb_tube_place(&l.tube, &motion, bend, &l, scene);
    return BB_OK;
}

static bb_status make(const bb_spec *spec, const bb_option *options, bb_scene *scene)
{
    limb l;
    bb_motion motion;
    BB_TRY(read_limb(spec, options, 0, &l, &motion));
    BB_TRY(bb_tube_reserve(&l.tube, scene));
    bb_motion_declare(&motion, scene);
    return set_frame(spec, options, scene, 0);
}

extern const bb_generator bb_generator_limb;
const bb_generator bb_generator_limb = {
    .name = "limb",
    .summary = "a tube over eight bones that swing, in frames: a skinned character",
    .options = options_table,
    .make = make,
    .set_frame = set_frame,
};
