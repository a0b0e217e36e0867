/* Derives views for a scene without any, deterministically, from the geometry alone.
 *
 * A few thousand discs represent the scene: points sampled on its surface by area (seeded), each
 * with its normal and with the same share of the total area, slightly enlarged so that they
 * overlap. A handful of rays can be traced against them by brute force, cheaply and without a tree.
 *
 * A scene counts as a room if from enough places inside its box nearly all directions meet a disc,
 * most of them far away, and its triangles have a boundary somewhere (closed meshes and spheres are
 * bodies, to be seen from outside). In a room the eye is where it sees far, and looks where many
 * primitives are visible and little is close or empty; further pictures are chosen to differ from
 * the earlier ones. Otherwise the camera is outside: three-quarter, back, above, and a close-up, as
 * near as the sampled points fit into the picture. Up is y, glTF's convention, unless the scene is
 * flat: then its shortest axis.
 */
#include "framework/base/random.h"
#include "framework/scene/prim.h"
#include "framework/scene/scene_private.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    DISCS = 2048,
    DETAILS = 512, /* primitives searched for in pictures */
    AROUND = 128,  /* directions tried from a place */
    GRID = 12,     /* a candidate picture has GRID * GRID rays */
    AZIMUTHS = 12,
    PLACES_X = 5,
    PLACES_UP = 3,
    PLACES = PLACES_X * PLACES_X * PLACES_UP,
    PLACES_LOOKED = 24,       /* places whose pictures are tried */
    ROOM_PLACES = PLACES / 8, /* a room has at least this many */
    ROOM_VIEWS = 3,
};

static const double enlarge =
    1.8; /* disc radius over that of its share of the area: 96 % are covered */
static const double room_share = 0.9;     /* of the directions must meet something */
static const double room_openness = 0.15; /* mean distance seen / diagonal, at the best place */
static const double fov_room = 65, fov_body = 40; /* degrees */
/* tan(fov / 2) as constants, so that no machine's tangent matters: 65 and 40 degrees. */
static const double tan_room = 0.6370702608, tan_body = 0.3639702343;

typedef struct disc {
    double at[3];
    double normal[3];
} disc;

typedef struct sketch {
    disc *discs;
    uint32_t count;
    double radius2;
    double centre[3];
    double side[3];
    double diagonal;
    int up; /* axis */
} sketch;

/* ---- vectors ---- */

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static double normalise(double v[3])
{
    double length = sqrt(dot(v, v));
    for (int axis = 0; axis < 3 && length > 0; axis++)
        v[axis] /= length;
    return length;
}

/* ---- the sketch ---- */

static double prim_area(const bb_scene *scene, uint32_t prim)
{
    uint32_t i;
    const bb_prim_kind *kind = bb_prim_of(scene, prim, &i);
    return kind->area(scene, i);
}

static void sample_prim(const bb_scene *scene, uint32_t prim, bb_random *random, disc *out)
{
    uint32_t i;
    const bb_prim_kind *kind = bb_prim_of(scene, prim, &i);
    kind->sample(scene, i, random, out->at, out->normal);
}

/* Systematic sampling by area: one walk over the primitives, with a disc each time the sum passes a
 * step. */
static void sample_discs(const bb_scene *scene, double area, sketch *sketch)
{
    bb_random random = bb_random_make(20, 0);
    double step = area / DISCS, next = step * 0.5, sum = 0;
    for (uint32_t prim = 0; prim < scene->prim_count && sketch->count < DISCS; prim++) {
        sum += prim_area(scene, prim);
        for (; next < sum && sketch->count < DISCS; next += step)
            sample_prim(scene, prim, &random, &sketch->discs[sketch->count++]);
    }
    sketch->radius2 = enlarge * enlarge * step / 3.14159265358979;
}

/* Without area (all triangles are needles) the corners of the box are used, which no ray meets.
 */
static void sample_corners(const bb_scene *scene, sketch *sketch)
{
    for (uint32_t i = 0; i < 8; i++)
        for (int axis = 0; axis < 3; axis++)
            sketch->discs[i].at[axis] =
                (double)((i >> axis & 1) != 0 ? scene->bounds.hi[axis] : scene->bounds.lo[axis]);
    sketch->count = 8;
}

static void make_sketch(const bb_scene *scene, sketch *sketch)
{
    double square = 0;
    for (int axis = 0; axis < 3; axis++) {
        double lo = (double)scene->bounds.lo[axis], hi = (double)scene->bounds.hi[axis];
        sketch->centre[axis] = 0.5 * (lo + hi);
        sketch->side[axis] = hi - lo;
        square += (hi - lo) * (hi - lo);
    }
    sketch->diagonal = sqrt(square);
    sketch->up = 1;
    for (int axis = 0; axis < 3; axis += 2) {
        double a = sketch->side[(axis + 1) % 3], b = sketch->side[(axis + 2) % 3];
        if (sketch->side[axis] < 0.3 * (a < b ? a : b))
            sketch->up = axis;
    }
    double area = 0;
    for (uint32_t prim = 0; prim < scene->prim_count; prim++)
        area += prim_area(scene, prim);
    if (area > 0 && isfinite(area))
        sample_discs(scene, area, sketch);
    if (sketch->count == 0)
        sample_corners(scene, sketch);
}

/* Returns the distance to the nearest disc, INFINITY if none is met. */
static double trace(const sketch *sketch, const double eye[3], const double direction[3])
{
    double nearest = INFINITY;
    for (uint32_t i = 0; i < sketch->count; i++) {
        const disc *disc = &sketch->discs[i];
        double to[3] = {disc->at[0] - eye[0], disc->at[1] - eye[1], disc->at[2] - eye[2]};
        double along = dot(direction, disc->normal);
        double t = dot(to, disc->normal) / along; /* along = 0 gives no number in range */
        if (!(t > 0 && t < nearest))
            continue;
        double off[3] = {t * direction[0] - to[0], t * direction[1] - to[1],
                         t * direction[2] - to[2]};
        if (dot(off, off) <= sketch->radius2)
            nearest = t;
    }
    return nearest;
}

/* ---- cameras ---- */

static void set_view(const sketch *sketch, const char *name, const double eye[3],
                     const double target[3], double fov, bb_scene *scene)
{
    bb_view view = {.fov_y = fov};
    memcpy(view.eye, eye, sizeof view.eye);
    memcpy(view.target, target, sizeof view.target);
    view.up[sketch->up] = 1;
    bb_scene_add_view(scene, name, &view);
}

/* Computes the directions right and up in the picture of a camera that looks along `ahead` (not
 * along up). */
static void make_axes(const sketch *sketch, const double ahead[3], double right[3], double above[3])
{
    double up[3] = {0, 0, 0};
    up[sketch->up] = 1;
    cross(ahead, up, right);
    normalise(right);
    cross(right, ahead, above);
}

/* ---- outside ---- */

/* Moves the target to the centre of the visible points, and the eye back until all fit into a
 * square picture. */
static void frame_body(const sketch *sketch, const double back[3], double target[3],
                       double *distance)
{
    double ahead[3] = {-back[0], -back[1], -back[2]}, right[3], above[3];
    make_axes(sketch, ahead, right, above);
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (uint32_t i = 0; i < sketch->count; i++) {
        const double *at = sketch->discs[i].at;
        double x = dot(at, right), y = dot(at, above);
        low[0] = fmin(low[0], x);
        high[0] = fmax(high[0], x);
        low[1] = fmin(low[1], y);
        high[1] = fmax(high[1], y);
    }
    double shift_x = 0.5 * (low[0] + high[0]) - dot(sketch->centre, right);
    double shift_y = 0.5 * (low[1] + high[1]) - dot(sketch->centre, above);
    for (int axis = 0; axis < 3; axis++)
        target[axis] = sketch->centre[axis] + shift_x * right[axis] + shift_y * above[axis];
    *distance = 0;
    for (uint32_t i = 0; i < sketch->count; i++) {
        const double *at = sketch->discs[i].at;
        double to[3] = {at[0] - target[0], at[1] - target[1], at[2] - target[2]};
        double aside = fmax(fabs(dot(to, right)), fabs(dot(to, above)));
        *distance = fmax(*distance, 1.04 * aside / tan_body + dot(to, back));
    }
    /* A scene of one point is still viewed from some distance. */
    if (!(*distance > 0))
        *distance = 1 + 0.001 * sqrt(dot(target, target));
}

static void look_from_outside(const sketch *sketch, bb_scene *scene)
{
    /* In the frame (side, up, other side); the last one is the first, closer. */
    static const struct {
        const char *name;
        double back[3];
        double nearness;
    } shots[] = {
        {"three-quarter", {0.8, 0.55, 1}, 1},
        {"back", {-1, 0.3, -0.45}, 1},
        {"above", {0.25, 1.5, -0.35}, 1},
        {"close", {-0.7, 0.4, 1}, 0.55},
    };
    for (size_t i = 0; i < sizeof shots / sizeof shots[0]; i++) {
        double back[3], target[3], eye[3], distance;
        back[(sketch->up + 2) % 3] = shots[i].back[0];
        back[sketch->up] = shots[i].back[1];
        back[(sketch->up + 1) % 3] = shots[i].back[2];
        normalise(back);
        frame_body(sketch, back, target, &distance);
        for (int axis = 0; axis < 3; axis++)
            eye[axis] = target[axis] + shots[i].nearness * distance * back[axis];
        set_view(sketch, shots[i].name, eye, target, fov_body, scene);
    }
}

/* ---- inside ---- */

/* A place and what is visible from it. */
typedef struct place {
    double eye[3];
    double openness;
    bool sees[DETAILS];
} place;

typedef struct picture {
    double eye[3];
    double ahead[3];
    double score;
} picture;

/* Takes points of evenly spaced primitives: dense primitives mean detail. */
static uint32_t find_details(const bb_scene *scene, double details[DETAILS][3])
{
    uint32_t count = scene->prim_count < DETAILS ? scene->prim_count : DETAILS;
    for (uint32_t i = 0; i < count; i++) {
        const bb_box *box = &scene->boxes[(uint64_t)i * scene->prim_count / count];
        for (int axis = 0; axis < 3; axis++)
            details[i][axis] = 0.5 * ((double)box->lo[axis] + (double)box->hi[axis]);
    }
    return count;
}

static double distance_to(const double eye[3], const double at[3], double to[3])
{
    for (int axis = 0; axis < 3; axis++)
        to[axis] = at[axis] - eye[axis];
    return normalise(to);
}

/* Returns how far a place sees; 0 if it is not in a room. */
static double openness(const sketch *sketch, const double eye[3])
{
    bb_random random = bb_random_make(21, 0);
    uint32_t misses = 0, near = 0;
    double sum = 0;
    for (uint32_t i = 0; i < AROUND; i++) {
        double direction[3];
        bb_random_direction(&random, direction);
        double t = trace(sketch, eye, direction) / sketch->diagonal;
        if (t <= 2)
            sum += t;
        misses += !(t <= 2);
        near += t < 0.02;
        if (misses > (1 - room_share) * AROUND || near > AROUND / 16)
            return 0;
    }
    return sum / AROUND;
}

/* Discs are coarse: points less than a disc's size behind one count as visible. */
static void find_seen(const sketch *sketch, double (*details)[3], uint32_t count, place *place)
{
    double slack = 2 * sqrt(sketch->radius2);
    for (uint32_t i = 0; i < count; i++) {
        double to[3], distance = distance_to(place->eye, details[i], to);
        place->sees[i] =
            distance > 0.06 * sketch->diagonal && trace(sketch, place->eye, to) > distance - slack;
    }
}

/* Returns the share of the details that the picture shows. */
static double detail_score(const place *place, const double ahead[3], const double right[3],
                           const double above[3], double (*details)[3], uint32_t count)
{
    uint32_t shown = 0;
    for (uint32_t i = 0; i < count; i++) {
        double to[3];
        distance_to(place->eye, details[i], to);
        double depth = tan_room * dot(to, ahead);
        shown += place->sees[i] && fabs(dot(to, right)) < depth && fabs(dot(to, above)) < depth;
    }
    return (double)shown / count;
}

/* Returns the share of the picture at a moderate distance. */
static double depth_score(const sketch *sketch, const double eye[3], const double ahead[3],
                          const double right[3], const double above[3])
{
    uint32_t good = 0;
    for (int y = 0; y < GRID; y++)
        for (int x = 0; x < GRID; x++) {
            double direction[3];
            double u = tan_room * (2 * (x + 0.5) / GRID - 1);
            double v = tan_room * (2 * (y + 0.5) / GRID - 1);
            for (int axis = 0; axis < 3; axis++)
                direction[axis] = ahead[axis] + u * right[axis] + v * above[axis];
            normalise(direction);
            double t = trace(sketch, eye, direction) / sketch->diagonal;
            good += t > 0.06 && t < 1;
        }
    return (double)good / (GRID * GRID);
}

/* Steps of 30 degrees, from the exact half and the correctly rounded root. */
static void azimuth(uint32_t step, double *x, double *y)
{
    static const double cosines[] = {1, 0.8660254037844386, 0.5, 0};
    uint32_t quarter = step / 3, rest = step % 3;
    double c = cosines[rest], s = cosines[3 - rest];
    *x = quarter == 0 ? c : quarter == 1 ? -s : quarter == 2 ? -c : s;
    *y = quarter == 0 ? s : quarter == 1 ? c : quarter == 2 ? -s : -c;
}

/* Makes all pictures that are tried from a place. */
static void try_pictures(const sketch *sketch, const place *place, double (*details)[3],
                         uint32_t count, picture pictures[AZIMUTHS])
{
    for (uint32_t step = 0; step < AZIMUTHS; step++) {
        picture *picture = &pictures[step];
        double right[3], above[3];
        memcpy(picture->eye, place->eye, sizeof picture->eye);
        azimuth(step, &picture->ahead[(sketch->up + 2) % 3], &picture->ahead[(sketch->up + 1) % 3]);
        picture->ahead[sketch->up] = -0.2;
        normalise(picture->ahead);
        make_axes(sketch, picture->ahead, right, above);
        double depth = depth_score(sketch, place->eye, picture->ahead, right, above);
        double detail = detail_score(place, picture->ahead, right, above, details, count);
        picture->score = depth * depth * (0.02 + detail);
    }
}

/* Finds places on a grid in the box, at three heights; returns how many are in a room, the most
 * open first. */
static uint32_t find_places(const sketch *sketch, place places[PLACES])
{
    static const double heights[PLACES_UP] = {0.4, 0.55, 0.7};
    uint32_t count = 0;
    for (int i = 0; i < PLACES; i++) {
        double share[3], eye[3];
        share[(sketch->up + 2) % 3] = 0.14 + 0.18 * (i % PLACES_X);
        share[(sketch->up + 1) % 3] = 0.14 + 0.18 * (i / PLACES_X % PLACES_X);
        share[sketch->up] = heights[i / (PLACES_X * PLACES_X)];
        for (int axis = 0; axis < 3; axis++)
            eye[axis] = sketch->centre[axis] + (share[axis] - 0.5) * sketch->side[axis];
        double open = openness(sketch, eye);
        if (open == 0)
            continue;
        uint32_t at = count++;
        for (; at > 0 && places[at - 1].openness < open; at--)
            places[at] = places[at - 1];
        memcpy(places[at].eye, eye, sizeof eye);
        places[at].openness = open;
    }
    return count;
}

/* Returns 1 for pictures with nothing in common, near 0 for equal ones. */
static double difference(const sketch *sketch, const picture *a, const picture *b)
{
    double apart[3];
    double away = distance_to(a->eye, b->eye, apart) / sketch->diagonal;
    double turned = 1 - dot(a->ahead, b->ahead); /* 0 .. 2 */
    return fmin(1, 0.05 + 0.6 * turned + away);
}

/* Takes the best picture, then repeatedly the best of those that differ from the ones taken. */
static void choose_pictures(const sketch *sketch, const picture *pictures, uint32_t count,
                            bb_scene *scene)
{
    static const char *const names[ROOM_VIEWS] = {"room-1", "room-2", "room-3"};
    const picture *taken[ROOM_VIEWS];
    for (uint32_t shot = 0; shot < ROOM_VIEWS; shot++) {
        const picture *best = &pictures[0];
        double most = -1, target[3];
        for (uint32_t i = 0; i < count; i++) {
            double score = pictures[i].score;
            for (uint32_t k = 0; k < shot; k++)
                score *= difference(sketch, &pictures[i], taken[k]);
            if (score > most) {
                most = score;
                best = &pictures[i];
            }
        }
        taken[shot] = best;
        for (int axis = 0; axis < 3; axis++)
            target[axis] = best->eye[axis] + 0.25 * sketch->diagonal * best->ahead[axis];
        set_view(sketch, names[shot], best->eye, target, fov_room, scene);
    }
}

static void look_inside(const sketch *sketch, place *places, uint32_t count, bb_scene *scene)
{
    picture pictures[PLACES_LOOKED * AZIMUTHS];
    double details[DETAILS][3];
    uint32_t detail_count = find_details(scene, details);
    uint32_t looked = count < PLACES_LOOKED ? count : PLACES_LOOKED;
    for (uint32_t i = 0; i < looked; i++) {
        find_seen(sketch, details, detail_count, &places[i]);
        try_pictures(sketch, &places[i], details, detail_count, pictures + i * AZIMUTHS);
    }
    choose_pictures(sketch, pictures, looked * AZIMUTHS, scene);
}

void bb_scene_derive_views(bb_scene *scene)
{
    if (scene->view_count == 0)
        bb_scene_add_derived_views(scene);
}

void bb_scene_add_derived_views(bb_scene *scene)
{
    disc discs[DISCS];
    place places[PLACES];
    sketch sketch = {.discs = discs};
    memset(discs, 0, sizeof discs);
    make_sketch(scene, &sketch);
    uint32_t count = 0;
    if (scene->profile.closed == 0 && sketch.diagonal > 0)
        count = find_places(&sketch, places);
    if (count >= ROOM_PLACES && places[0].openness >= room_openness)
        look_inside(&sketch, places, count, scene);
    else
        look_from_outside(&sketch, scene);
}
