/* Which tetrahedra hold points: searches of trees of tetrahedra against tracing of faces. */
#ifndef BB_LOCATE_CONTEST_H
#define BB_LOCATE_CONTEST_H

#include "framework/bench/contest.h"

/* Builders named "faces/..." build over the mesh's faces, which `contest.kernels` trace as Wald,
 * Usher, Morrical, Lediaev and Pascucci 2019 do: the nearest face on a ray from a point says which
 * tetrahedron holds the point. Rays are short, as there: as long as the mesh's longest edge. Embree
 * traces them, too, by each of its queries that there is: rows of the builder
 * "faces/embree-native", whose times are of its trace alone. */
typedef struct bb_location_request {
    bb_contest_request contest;
    uint32_t points; /* evenly spread over the mesh's volume */
} bb_location_request;

/* Measures, and puts figures into the table; nothing after a failure. The scene is on the device.
 * BB_UNSUPPORTED if no tetrahedron has a volume. */
bb_status bb_location_run(const bb_location_request *request, bb_scene *scene, bb_table *table);

#endif
