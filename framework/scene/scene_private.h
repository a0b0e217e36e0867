/* Shared by the parts of a scene: loading, finishing, frames. */
#ifndef BB_SCENE_PRIVATE_H
#define BB_SCENE_PRIVATE_H

#include "framework/scene/scene.h"

/* The arguments of bb_scene_take_motion(). */
typedef struct bb_scene_motion {
    bb_scene_pose pose;
    void (*release)(void *data);
    void *data;
} bb_scene_motion;

/* The part of bb_scene_finish() that depends on positions, in existing memory: -0, boxes, bounds,
 * scale and hash. */
bb_status bb_scene_finish_frame(bb_scene *scene);

/* Records how the generator moves the scene that it has just made; does nothing if the scene does
 * not move. BB_FAILED if the generator claims frames that it cannot make. */
bb_status bb_scene_remember_motion(const bb_generator *generator, const char *text,
                                   bb_scene *scene);

/* Releases what the scene's motion owns. */
void bb_scene_free_motion(bb_scene *scene);

/* Like bb_scene_derive_views(), but appends to the existing views. */
void bb_scene_add_derived_views(bb_scene *scene);

/* Computes the box of the whole volume. */
void bb_scene_volume_bounds(const bb_scene *scene, bb_box *bounds);

/* Returns the number of boxes that there is room for: for a volume, all of its bricks. */
uint32_t bb_scene_box_room(const bb_scene *scene);

/* Writes everything to the device, where bb_scene_upload() has made room, and recomputes the
 * boxes. After a failure the scene is on no device. */
bb_status bb_scene_fill(bb_scene *scene);

/* Writes vertices and data of primitives to the device again, where bb_scene_upload() has made
 * room, and recomputes the boxes. Does nothing if the scene is on no device. */
bb_status bb_scene_upload_again(bb_scene *scene);

#endif
