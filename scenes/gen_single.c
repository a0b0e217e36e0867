/* One triangle: the smallest scene. */
#include "framework/scene/scene.h"

#include <string.h>

static bb_status make(const bb_spec *spec, const bb_option *options, bb_scene *scene)
{
    static const float vertices[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    static const uint32_t indices[3] = {0, 1, 2};
    (void)spec;
    (void)options;
    BB_TRY(bb_scene_reserve_mesh(scene, 3, 1));
    memcpy(scene->vertices, vertices, sizeof vertices);
    memcpy(bb_scene_indices(scene), indices, sizeof indices);
    return BB_OK;
}

extern const bb_generator bb_generator_single;
const bb_generator bb_generator_single = {
    .name = "single",
    .summary = "one triangle: (0,0,0) (1,0,0) (0,1,0)",
    .make = make,
};
