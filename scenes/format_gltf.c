/* glTF 2.0: scenes/README.md lists what is read; gltf*.cpp read it. */
#include "framework/scene/camera.h"
#include "scenes/gltf.h"
#include "scenes/motion.h"

static const bb_option options_table[] = {
    {"clip", NULL, NULL,
     "the animation that moves it, by name or number; default: it does not move"},
    {"frames", NULL, NULL, "number of frames of the clip, from its start to its end; default: 21"},
    {0},
};

static bb_status reserve(void *user, uint64_t vertex_count, uint64_t triangle_count,
                         float **vertices, uint32_t **indices)
{
    bb_scene *scene = user;
    BB_TRY(bb_scene_reserve_mesh(scene, vertex_count, triangle_count));
    *vertices = scene->vertices;
    *indices = bb_scene_indices(scene);
    return BB_OK;
}

/* Leaves out views that no picture can be made of. */
static void add_view(void *user, const char *name, const bb_view *view)
{
    bb_camera camera;
    if (bb_camera_make(view, 1, 1, &camera) == BB_OK)
        bb_scene_add_view(user, name, view);
}

static bb_status pose(void *data, bb_scene *scene, uint32_t frame)
{
    return bb_gltf_pose(data, frame, scene->vertices);
}

static void release(void *data)
{
    bb_gltf_free(data);
}

static bb_status load(const char *path, const bb_spec *spec, bb_scene *scene)
{
    const bb_gltf_taker taker = {reserve, add_view, scene};
    const char *clip = bb_spec_value(spec, options_table, "clip");
    uint64_t frames = BB_MOTION_FRAMES;
    bool given = bb_spec_value(spec, options_table, "frames") != NULL;
    bb_gltf_moving *moving;
    if (clip == NULL && given)
        return bb_fail(BB_INVALID, "%s: frames= needs clip=, the animation to play", path);
    if (clip == NULL)
        return bb_gltf_load(path, &taker, &scene->ignored);
    if (given)
        BB_TRY(bb_spec_u64(spec, options_table, "frames", 2, 1000000, &frames));
    BB_TRY(bb_gltf_load_clip(path, clip, (uint32_t)frames, &taker, &scene->ignored, &moving));
    return bb_scene_take_motion(scene, (uint32_t)frames, pose, release, moving);
}

static const char *const endings[] = {".gltf", ".glb", NULL};

extern const bb_scene_format bb_scene_format_gltf;
const bb_scene_format bb_scene_format_gltf = {
    .name = "glTF", .endings = endings, .load = load, .options = options_table};
