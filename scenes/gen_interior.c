/* A closed room: six walls of two triangles each, furniture made of boxes, and on it balls of very
 * many very small triangles. The areas differ by seven orders of magnitude; builders that only use
 * centroids do badly here, and every ray hits something. */
#include "framework/base/random.h"
#include "framework/scene/scene.h"
#include "scenes/shapes.h"

#include <math.h>

static const bb_option options_table[] = {
    {"n", "200000", NULL, "number of triangles, about"},
    {"seed", "1", NULL, "seed: where the balls lie"},
    {0},
};

static const double room_lo[3] = {0, 0, 0}, room_hi[3] = {10, 3, 8}; /* metres */

/* Furniture. Balls are on the floor and on furniture marked for it. */
static const struct {
    double lo[3];
    double hi[3];
    int holds_balls;
} furniture[] = {
    {{3.5, 0.72, 2.5}, {6.5, 0.76, 4.5}, 1}, /* table top */
    {{3.6, 0, 2.6}, {3.7, 0.72, 2.7}, 0},    /* its legs */
    {{6.3, 0, 2.6}, {6.4, 0.72, 2.7}, 0},    {{3.6, 0, 4.3}, {3.7, 0.72, 4.4}, 0},
    {{6.3, 0, 4.3}, {6.4, 0.72, 4.4}, 0},    {{0.05, 0, 1}, {0.45, 2.2, 4}, 0},    /* cupboard */
    {{8.2, 0, 5.2}, {9.6, 0.45, 7.4}, 1},                                          /* bench */
    {{7.5, 0.9, 0.02}, {9.5, 0.93, 0.4}, 1},                                       /* shelves */
    {{7.5, 1.4, 0.02}, {9.5, 1.43, 0.4}, 1}, {{1.5, 0, 5.5}, {1.9, 2.98, 5.9}, 0}, /* pillar */
    {{4.9, 2.4, 3.4}, {5.1, 2.99, 3.6}, 0},                                        /* lamp */
};
enum { FURNITURE = sizeof furniture / sizeof furniture[0], BALLS = 64, TRIES = 64 };

typedef struct ball {
    double centre[3];
    double radius;
} ball;

/* Balls on the floor keep off the furniture; balls on furniture stay within its top.
 */
static void place_ball(bb_random *random, uint32_t number, ball *out)
{
    static const double sizes[] = {0.3, 0.12, 0.05, 0.02};
    out->radius = sizes[number % 4];
    int on = -1;
    if (number % 4 != 0) { /* the largest are on the floor */
        do
            on = (int)bb_random_below(random, FURNITURE);
        while (!furniture[on].holds_balls);
    }
    const double *lo = on >= 0 ? furniture[on].lo : room_lo;
    const double *hi = on >= 0 ? furniture[on].hi : room_hi;
    double edge = out->radius + 0.01;
    out->centre[0] = bb_random_range(random, lo[0] + edge, hi[0] - edge);
    out->centre[2] = bb_random_range(random, lo[2] + edge, hi[2] - edge);
    out->centre[1] = (on >= 0 ? hi[1] : 0) + out->radius + 0.001;
}

static bool is_clear(const ball *balls, uint32_t count, const ball *ball)
{
    for (uint32_t i = 0; i < count; i++) {
        double square = 0, reach = balls[i].radius + ball->radius;
        for (int axis = 0; axis < 3; axis++) {
            double apart = balls[i].centre[axis] - ball->centre[axis];
            square += apart * apart;
        }
        if (square <= reach * reach)
            return false;
    }
    for (int i = 0; i < FURNITURE; i++) {
        bool apart = false;
        for (int axis = 0; axis < 3; axis++)
            apart = apart || ball->centre[axis] + ball->radius < furniture[i].lo[axis] ||
                    ball->centre[axis] - ball->radius > furniture[i].hi[axis];
        if (!apart)
            return false;
    }
    return true;
}

static bb_status make(const bb_spec *spec, const bb_option *options, bb_scene *scene)
{
    static const bb_view views[] = {
        {"room", false, {2.4, 1.7, 7.6}, {6, 0.6, 2.4}, {0, 1, 0}, 60},
        {"table", false, {3.2, 1.25, 5.2}, {5.2, 0.75, 3.3}, {0, 1, 0}, 50},
        {"shelves", false, {7.2, 1.5, 2.2}, {8.6, 1.1, 0.1}, {0, 1, 0}, 55},
    };
    uint64_t n, seed;
    BB_TRY(bb_spec_u64(spec, options, "n", 1000, INT32_MAX, &n));
    BB_TRY(bb_spec_u64(spec, options, "seed", 0, UINT64_MAX, &seed));
    uint64_t boxes = 1 + FURNITURE;
    uint64_t cuts =
        (uint64_t)floor(sqrt((double)(n - boxes * BB_SHAPE_BOX_TRIANGLES) / (8.0 * BALLS)) + 0.5);
    cuts = cuts < 1 ? 1 : cuts;
    BB_TRY(bb_scene_reserve_mesh(
        scene, boxes * BB_SHAPE_BOX_VERTICES + BALLS * bb_shape_sphere_vertices(cuts),
        boxes * BB_SHAPE_BOX_TRIANGLES + BALLS * bb_shape_sphere_triangles(cuts)));
    bb_shape_cursor cursor = bb_shape_start(scene, NULL);
    bb_shape_box(&cursor, room_lo, room_hi);
    for (int i = 0; i < FURNITURE; i++)
        bb_shape_box(&cursor, furniture[i].lo, furniture[i].hi);
    bb_random random = bb_random_make(seed, 6);
    ball balls[BALLS];
    for (uint32_t i = 0; i < BALLS; i++) {
        /* A full shelf may have no free place; the last try then stays, and two balls touch. */
        for (int attempt = 0; attempt < TRIES; attempt++) {
            place_ball(&random, i, &balls[i]);
            if (is_clear(balls, i, &balls[i]))
                break;
        }
        bb_shape_sphere(&cursor, balls[i].centre, balls[i].radius, (uint32_t)cuts);
    }
    scene->closed_from_inside = true;
    scene->inside_point[0] = 5;
    scene->inside_point[1] = 1.6;
    scene->inside_point[2] = 5.5;
    scene->view_count = sizeof views / sizeof views[0];
    for (uint32_t i = 0; i < scene->view_count; i++)
        scene->views[i] = views[i];
    return BB_OK;
}

extern const bb_generator bb_generator_interior;
const bb_generator bb_generator_interior = {
    .name = "interior",
    .summary = "closed room with very large and very small triangles",
    .options = options_table,
    .make = make,
};
