/* A static room in which a few small objects drive around: most of the scene does not move.
 * Modelled after the kitchen with a toy car of the BART benchmark (Lext, Assarsson, Moller 2001),
 * which Eisemann, Grosch, Mueller, Magnor 2007 use. */
#include "scenes/crowd.h"
#include "scenes/repeatable.h"
#include "scenes/shapes.h"

#include <string.h>

static const bb_option options_table[] = {
    {"room", "interior:n=20000", NULL, "scene of triangles that stands still; its name has no ','"},
    {"things", "5", NULL, "number of moving objects"},
    BB_MOTION_OPTIONS,
    {0},
};

enum { TESSELLATION = 3 };

/* Moves them on a circle around the middle of the room's box, a third of its size. */
static bb_status drive(const bb_motion *motion, uint32_t things, bb_scene *scene)
{
    static const double turn = 6.28318530717958647693;
    uint64_t own = things * bb_shape_sphere_vertices(TESSELLATION);
    uint64_t room = scene->vertex_room - own; /* vertices */
    double lo[3] = {INFINITY, INFINITY, INFINITY}, hi[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (uint64_t v = 0; v < room; v++)
        for (int axis = 0; axis < 3; axis++) {
            lo[axis] = fmin(lo[axis], scene->vertices[3 * v + (uint64_t)axis]);
            hi[axis] = fmax(hi[axis], scene->vertices[3 * v + (uint64_t)axis]);
        }
    double size[3], least = INFINITY;
    for (int axis = 0; axis < 3; axis++) {
        size[axis] = hi[axis] - lo[axis];
        least = fmin(least, size[axis] > 0 ? size[axis] : INFINITY);
    }
    double(*centres)[3] = NULL;
    BB_TRY(bb_host_alloc(NULL, things * sizeof *centres, "where things drive", &centres));
    for (uint32_t i = 0; i < things; i++) {
        double angle = turn * (motion->time + (double)i / things);
        centres[i][0] = 0.5 * (lo[0] + hi[0]) + size[0] / 3 * bb_cosine(angle);
        centres[i][1] = lo[1] + 0.2 * size[1];
        centres[i][2] = 0.5 * (lo[2] + hi[2]) + size[2] / 3 * bb_sine(angle);
    }
    bb_crowd crowd = {things, TESSELLATION, 0.04 * least};
    bb_status status =
        bb_crowd_write(&crowd, motion, (const double(*)[3])centres, scene->vertices + 3 * room);
    bb_host_free(centres);
    return status;
}

static bb_status read_things(const bb_spec *spec, const bb_option *options, uint32_t frame,
                             uint64_t *things, bb_motion *motion)
{
    BB_TRY(bb_spec_u64(spec, options, "things", 1, 10000, things));
    BB_TRY(bb_motion_read(spec, options, BB_MOTION_FRAMES, frame, motion));
    return motion->away == 0
               ? BB_OK
               : bb_fail(BB_INVALID, "scene car: the room stands still: leave 'away' out");
}

static bb_status set_frame(const bb_spec *spec, const bb_option *options, bb_scene *scene,
                           uint32_t frame)
{
    uint64_t things;
    bb_motion motion;
    BB_TRY(read_things(spec, options, frame, &things, &motion));
    return drive(&motion, (uint32_t)things, scene);
}

/* Each triangle of the room by itself, each thing as one; the things move. */
static bb_status list_objects(uint32_t room, uint32_t things, bb_scene *scene)
{
    const uint32_t size = (uint32_t)bb_shape_sphere_triangles(TESSELLATION);
    BB_TRY(bb_scene_reserve_objects(scene, room + things, things));
    for (uint32_t i = 0; i <= room + things; i++)
        scene->object_starts[i] = i < room ? i : room + (i - room) * size;
    for (uint32_t i = 0; i < things; i++)
        scene->movers[i] = room + i;
    return BB_OK;
}

/* Joins room and objects in one scene. */
static bb_status join(const bb_scene *room, uint32_t things, bb_scene *scene)
{
    bb_crowd crowd = {things, TESSELLATION, 1};
    uint64_t own = things * bb_shape_sphere_triangles(TESSELLATION);
    uint32_t triangles = room->prims[BB_TRIANGLE].count;
    if (room->kinds != BB_TRIANGLES || room->volume != NULL)
        return bb_fail(BB_INVALID, "scene car: %s has other primitives than triangles", room->name);
    if (memcmp(room->bounds.lo, room->bounds.hi, sizeof room->bounds.lo) == 0)
        return bb_fail(BB_INVALID, "scene car: %s is one point: take a larger scene", room->name);
    BB_TRY(bb_scene_reserve_mesh(
        scene, room->vertex_count + things * bb_shape_sphere_vertices(TESSELLATION),
        triangles + own));
    memcpy(scene->vertices, room->vertices, 3ull * room->vertex_count * sizeof(float));
    memcpy(bb_scene_indices(scene), room->prims[BB_TRIANGLE].data,
           3ull * triangles * sizeof(uint32_t));
    scene->view_count = room->view_count;
    memcpy(scene->views, room->views, sizeof scene->views);
    BB_TRY(list_objects(triangles, things, scene));
    return bb_crowd_index(&crowd, room->vertex_count, bb_scene_indices(scene) + 3ull * triangles);
}

static bb_status make(const bb_spec *spec, const bb_option *options, bb_scene *scene)
{
    uint64_t things;
    bb_motion motion;
    bb_scene *room;
    BB_TRY(read_things(spec, options, 0, &things, &motion));
    BB_TRY(bb_scene_load(bb_spec_value(spec, options, "room"), &room));
    bb_status status = join(room, (uint32_t)things, scene);
    bb_scene_free(room);
    BB_TRY(status);
    bb_motion_declare(&motion, scene);
    return set_frame(spec, options, scene, 0);
}

extern const bb_generator bb_generator_car;
const bb_generator bb_generator_car = {
    .name = "car",
    .summary = "a room in which a few small objects drive around, in frames",
    .options = options_table,
    .make = make,
    .set_frame = set_frame,
};
