/* Finds out who wrote into a scene, which all builders share. */
#ifndef BB_SEAL_H
#define BB_SEAL_H

#include "framework/scene/scene.h"

/* Hashes all of the scene that builders get pointers to, on host and device: arrays, the structs of
 * a volume and of tetrahedra, buffers. Of a part of more than 256 MiB, evenly spaced lines are
 * hashed. bb_scene_upload() and what follows it call this. */
bb_status bb_scene_seal(bb_scene *scene);

/* Hashes it again: *changed names a part that is not what it was ("boxes on the device"); NULL: all
 * is, or it was never sealed. What was changed is put back: the host's memory from the scene's file
 * or generator, the device's from the host. If that fails, this and all later calls return
 * BB_FAILED. The device's queue must be finished. */
bb_status bb_scene_check_seal(const bb_scene *scene, const char **changed);

/* The same for whoever was given no buffers: hashes the host's memory alone. */
bb_status bb_scene_check_seal_on_host(const bb_scene *scene, const char **changed);

/* Puts back what a destroy(), which cannot fail, wrote into the scene. bb_message() stays. */
void bb_scene_put_back(const bb_scene *scene);

/* The caller has put everything back: a scene that could not be is whole again. */
void bb_scene_is_whole(bb_scene *scene);

#endif
