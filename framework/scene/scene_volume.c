/* Scenes made of a volume: their boxes are the visible bricks. */
#include "framework/scene/prim.h"
#include "framework/scene/scene_private.h"

#include <string.h>

static void choose_bricks(bb_scene *scene, const bb_transfer *transfer)
{
    bb_volume *volume = scene->volume;
    float *corners = bb_scene_floats(scene, BB_AABB);
    bb_volume_set_transfer(volume, transfer);
    uint32_t count = bb_volume_active(volume, scene->bricks);
    for (uint32_t i = 0; i < count; i++)
        bb_volume_brick_box(&volume->grid, scene->bricks[i], corners + 6 * (size_t)i);
    scene->prims[BB_AABB].count = count;
    bb_scene_number_kinds(scene);
}

bb_status bb_scene_take_volume(bb_scene *scene, bb_volume *volume, const bb_transfer *transfer)
{
    scene->volume = volume;
    BB_TRY(bb_scene_reserve(scene, 0, &(bb_prim_counts){.of = {[BB_AABB] = volume->brick_count}}));
    BB_TRY(bb_host_alloc(NULL, volume->brick_count * sizeof *scene->bricks, "numbers of bricks",
                         &scene->bricks));
    choose_bricks(scene, transfer);
    return BB_OK;
}

bb_status bb_scene_set_transfer(bb_scene *scene, const bb_transfer *transfer, uint32_t *changed)
{
    *changed = 0;
    if (scene->volume == NULL)
        return bb_fail(BB_INVALID, "%s: has no volume that a transfer function could be for",
                       scene->name);
    choose_bricks(scene, transfer);
    BB_TRY(bb_scene_finish_frame(scene));
    BB_TRY(bb_scene_upload_again(scene));
    *changed = BB_CHANGED_TRANSFER;
    return scene->prim_count > 0 ? bb_scene_profile(scene) : BB_OK;
}

void bb_scene_volume_bounds(const bb_scene *scene, bb_box *bounds)
{
    const bb_volume_grid *grid = &scene->volume->grid;
    memset(bounds, 0, sizeof *bounds);
    for (int k = 0; k < 3; k++) {
        bounds->lo[k] = bb_brick_lo(0, grid->side, grid->cell[k], grid->margin);
        bounds->hi[k] = bb_brick_hi(grid->bricks[k] - 1, grid->side, grid->cells[k], grid->cell[k],
                                    grid->margin);
    }
}

uint32_t bb_scene_box_room(const bb_scene *scene)
{
    uint32_t room = 0;
    if (scene->volume != NULL)
        return scene->volume->brick_count;
    for (uint32_t kind = 0; kind < BB_KIND_COUNT; kind++)
        room += scene->prims[kind].room;
    return room > scene->prim_count ? room : scene->prim_count;
}
