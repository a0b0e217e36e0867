/* From voxels to a scene: what formats and generators of volumes share. */
#ifndef BB_VOLUME_SCENE_H
#define BB_VOLUME_SCENE_H

#include "framework/scene/scene.h"
#include "framework/volume/volume.h"

/* Rows of their tables of options. */
#define BB_VOLUME_OPTIONS                                                                          \
    {"transfer", "ramp", NULL,                                                                     \
     "transfer function: a preset (`bvhbench list transfers`) or a file"},                         \
    {                                                                                              \
        "brick", "8", "4|8|16|32", "cells along an edge of a brick"                                \
    }

/* Makes room for voxels->dims values. */
bb_status bb_volume_scene_reserve(const bb_scene *scene, const bb_spec *spec,
                                  const bb_option *options, bb_voxels *voxels);

/* Makes the scene of them: volume, transfer function, boxes and views. Frees the values, whatever
 * it returns. */
bb_status bb_volume_scene_make(const bb_spec *spec, const bb_option *options, bb_voxels *voxels,
                               bb_scene *scene);

#endif
