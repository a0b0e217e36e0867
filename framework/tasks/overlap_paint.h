/* Pictures of what does not overlap. */
#ifndef BB_OVERLAP_PAINT_H
#define BB_OVERLAP_PAINT_H

#include "framework/scene/scene.h"
#include "framework/table/table.h"

/* Shows both meshes without what meets the other, from outside, as PNG files of `folder`, which get
 * rows of the table. answers[s]: per tetrahedron of scene s, 1 if it meets the other, else 0. */
bb_status bb_overlap_paint(bb_scene *const scenes[2], uint32_t *const answers[2],
                           const char *folder, const char *name, bb_table *table);

#endif
