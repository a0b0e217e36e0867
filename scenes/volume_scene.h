/* Makes a scene from voxels: shared by formats and generators of volumes. */
#ifndef BB_VOLUME_SCENE_H
#define BB_VOLUME_SCENE_H

#include "framework/scene/scene.h"
#include "framework/scene/volume.h"

/* Options for their tables. */
#define BB_VOLUME_OPTIONS                                                                          \
    {"transfer", "ramp", NULL,                                                                     \
     "transfer function: a preset (`bvhbench list transfers`) or a file"},                         \
    {                                                                                              \
        "brick", "8", "4|8|16|32", "cells along an edge of a brick"                                \
    }

/* Reserves room for voxels->dims values. */
bb_status bb_volume_scene_reserve(const bb_scene *scene, const bb_spec *spec,
                                  const bb_option *options, bb_voxels *voxels);

/* Makes the scene from them: volume, transfer function, boxes and views. Frees the values in any
 * case. */
bb_status bb_volume_scene_make(const bb_spec *spec, const bb_option *options, bb_voxels *voxels,
                               bb_scene *scene);

#endif
