/* glTF 2.0 files (.gltf, .glb): the C door to the C++ of tinygltf. */
#ifndef BB_GLTF_H
#define BB_GLTF_H

#include "framework/scene/scene.h"

/* Asked once, when the counts are known: makes room for 3 floats per vertex and 3 indices per
 * triangle, or refuses. */
typedef bb_status (*bb_gltf_reserve)(void *user, uint64_t vertex_count, uint64_t triangle_count,
                                     float **vertices, uint32_t **indices);

/* A perspective or orthographic camera of the file: its name there, and the view but for its name.
 */
typedef void (*bb_gltf_add_view)(void *user, const char *name, const bb_view *view);

/* Reads all triangles of all scenes of the file, transformed into scene units, into what `reserve`
 * gives. Vertices stay as they are in the file, nothing is merged; zero-area triangles stay.
 * *ignored gets the number of primitives of other kinds. Then `add_view` is called for each camera
 * of the default scene. What is read and what is refused:
 * scenes/README.md. BB_INVALID for a bad file, BB_UNSUPPORTED for an extension that changes the
 * geometry and is not implemented, BB_REFUSED for what is too big. */
bb_status bb_gltf_load(const char *path, bb_gltf_reserve reserve, bb_gltf_add_view add_view,
                       void *user, uint32_t *ignored);

#endif
