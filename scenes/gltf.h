/* glTF 2.0 files (.gltf, .glb): a C interface to tinygltf's C++. */
#ifndef BB_GLTF_H
#define BB_GLTF_H

#include "framework/scene/scene.h"

/* Called once, when the counts are known: reserves 3 floats per vertex and 3 indices per triangle,
 * or refuses. */
typedef bb_status (*bb_gltf_reserve)(void *user, uint64_t vertex_count, uint64_t triangle_count,
                                     float **vertices, uint32_t **indices);

/* A perspective or orthographic camera of the file: its name there, and the view without its name.
 */
typedef void (*bb_gltf_add_view)(void *user, const char *name, const bb_view *view);

/* Receives the contents of a file. */
typedef struct bb_gltf_taker {
    bb_gltf_reserve reserve;
    bb_gltf_add_view add_view;
    void *user;
} bb_gltf_taker;

/* A loaded file that can be posed. */
typedef struct bb_gltf_moving bb_gltf_moving;

/* Reads all triangles of all scenes of the file, transformed into scene units, into the arrays from
 * `reserve`. Vertices stay as in the file, nothing is merged; triangles of zero area stay.
 * *ignored: number of primitives of other kinds. Then calls `add_view` for each camera of the
 * default scene. scenes/README.md lists what is read and what is refused. BB_INVALID for a bad
 * file, BB_UNSUPPORTED for an extension that changes the geometry and is not implemented,
 * BB_REFUSED if the file is too big. */
bb_status bb_gltf_load(const char *path, const bb_gltf_taker *taker, uint32_t *ignored);

/* The same, posed as at the start of the animation that `clip` names, by name or number. It is
 * played in `frames` frames, at least 2, which bb_gltf_pose() makes. *ignored also counts channels
 * with an unknown target. The caller owns *moving: bb_gltf_free(); NULL after a failure. */
bb_status bb_gltf_load_clip(const char *path, const char *clip, uint32_t frames,
                            const bb_gltf_taker *taker, uint32_t *ignored, bb_gltf_moving **moving);

/* Rewrites the vertices, as many as were reserved, to those of a frame; the last frame is the end
 * of the clip. BB_INVALID, with one line, if a vertex is not finite there. */
bb_status bb_gltf_pose(bb_gltf_moving *moving, uint32_t frame, float *vertices);

void bb_gltf_free(bb_gltf_moving *moving); /* NULL is allowed */

#endif
