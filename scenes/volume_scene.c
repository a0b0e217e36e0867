#include "scenes/volume_scene.h"

#include <math.h>
#include <string.h>

static uint32_t brick_side(const bb_spec *spec, const bb_option *options)
{
    uint64_t side = BB_BRICK_SIDE;
    (void)bb_spec_u64(spec, options, "brick", 1, BB_BRICK_SIDE_MAX, &side); /* one of the listed
                                                                             * values */
    return (uint32_t)side;
}

bb_status bb_volume_scene_reserve(const bb_scene *scene, const bb_spec *spec,
                                  const bb_option *options, bb_voxels *voxels)
{
    return bb_voxels_reserve(scene->name, brick_side(spec, options), voxels);
}

/* Adds views: all of it from in front, as in the paper; from a corner; and from its middle. */
static void add_views(const bb_volume_grid *grid, bb_scene *scene)
{
    static const double fov = 40, tangent = 0.3639702343; /* of half of it */
    double size[3], middle[3], diagonal = 0;
    int longest = 0;
    for (int k = 0; k < 3; k++) {
        size[k] = (double)grid->cell[k] * grid->cells[k];
        middle[k] = size[k] / 2;
        diagonal += size[k] * size[k];
        longest = size[k] > size[longest] ? k : longest;
    }
    diagonal = sqrt(diagonal);
    bb_view view = {.parallel = true, .fov_y = diagonal, .up = {0, 1, 0}};
    memcpy(view.target, middle, sizeof middle);
    memcpy(view.eye, middle, sizeof middle);
    view.eye[2] += diagonal;
    bb_scene_add_view(scene, "front", &view);
    view.parallel = false;
    view.fov_y = fov;
    for (int k = 0; k < 3; k++)
        view.eye[k] = middle[k] + (k == 0 ? 0.61 : k == 1 ? 0.42 : 0.67) * diagonal / 2 / tangent;
    bb_scene_add_view(scene, "corner", &view);
    memcpy(view.eye, middle, sizeof middle);
    memcpy(view.target, middle, sizeof middle);
    view.target[longest] += size[longest];
    view.target[(longest + 1) % 3] += size[longest] / 8;
    view.up[0] = longest == 1;
    view.up[1] = longest != 1;
    view.fov_y = 65;
    bb_scene_add_view(scene, "inside", &view);
}

bb_status bb_volume_scene_make(const bb_spec *spec, const bb_option *options, bb_voxels *voxels,
                               bb_scene *scene)
{
    bb_transfer transfer;
    bb_volume *volume = NULL;
    bb_status status = bb_transfer_load(bb_spec_value(spec, options, "transfer"), &transfer);
    if (status == BB_OK)
        status = bb_volume_make(scene->name, voxels, brick_side(spec, options), &volume);
    bb_voxels_free(voxels);
    if (status != BB_OK)
        return status;
    add_views(&volume->grid, scene);
    return bb_scene_take_volume(scene, volume, &transfer);
}
