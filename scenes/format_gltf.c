/* glTF 2.0: what is read is in scenes/README.md, the reading in gltf*.cpp. */
#include "framework/scene/camera.h"
#include "scenes/gltf.h"

static bb_status reserve(void *user, uint64_t vertex_count, uint64_t triangle_count,
                         float **vertices, uint32_t **indices)
{
    bb_scene *scene = user;
    BB_TRY(bb_scene_reserve_mesh(scene, vertex_count, triangle_count));
    *vertices = scene->vertices;
    *indices = bb_scene_indices(scene);
    return BB_OK;
}

/* Those that no picture can be made of are left out. */
static void add_view(void *user, const char *name, const bb_view *view)
{
    bb_camera camera;
    if (bb_camera_make(view, 1, 1, &camera) == BB_OK)
        bb_scene_add_view(user, name, view);
}

static bb_status load(const char *path, const bb_spec *spec, bb_scene *scene)
{
    (void)spec;
    return bb_gltf_load(path, reserve, add_view, scene, &scene->ignored);
}

static const char *const endings[] = {".gltf", ".glb", NULL};

extern const bb_scene_format bb_scene_format_gltf;
const bb_scene_format bb_scene_format_gltf = {.name = "glTF", .endings = endings, .load = load};
