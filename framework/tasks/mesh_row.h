/* What a mesh of tetrahedra is like: their number, how many are on its boundary, their shapes and
 * sizes; as a row of a table. */
#ifndef BB_MESH_ROW_H
#define BB_MESH_ROW_H

#include "framework/scene/scene.h"
#include "framework/table/table.h"

/* Of the tetrahedra of a mesh. The aspect ratio is that of the radii of the inscribed and of the
 * circumscribed sphere, at most 1/3; 0 without a volume. Volume ratio: of the largest to the
 * smallest that is not 0. Stroeter, Mueller-Roemer, Stork, Fellner 2020, table 1. */
typedef struct bb_mesh_shape {
    double aspect_min, aspect_median, aspect_max;
    double volume_ratio; /* NAN: none has a volume */
} bb_mesh_shape;

/* Of tetrahedron i, in the scene's units. */
double bb_mesh_volume_of(const bb_scene *scene, uint32_t i);

/* `scene` has tetrahedra. BB_REFUSED: no memory for the median, 8 bytes per tetrahedron. */
bb_status bb_mesh_shape_of(const bb_scene *scene, bb_mesh_shape *shape);

/* Fills a mesh's row; without memory for them, not its shapes. */
void bb_mesh_fill(bb_table *table, uint32_t row, const bb_scene *scene);

#endif
