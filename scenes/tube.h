/* Closed tubes of cells that a rule bends: a bar that twists, a limb with bones. */
#ifndef BB_TUBE_H
#define BB_TUBE_H

#include "scenes/motion.h"

/* A regular prism around the z axis, from 0 to `length`, with given corners; its faces are divided
 * into cells. */
typedef struct bb_tube {
    uint32_t corners;           /* of its section, at most 64 */
    const double (*section)[2]; /* x y of each */
    double length;
    uint32_t across, along; /* cells of a face in both directions */
} bb_tube;

/* Reserves room for it in an empty scene and writes its triangles. */
bb_status bb_tube_reserve(const bb_tube *tube, bb_scene *scene);

/* Writes its vertices, each moved by bend(user, p). Equal points of neighbouring faces give equal
 * floats, so it is closed. */
void bb_tube_place(const bb_tube *tube, const bb_motion *motion,
                   void (*bend)(const void *user, double p[3]), const void *user, bb_scene *scene);

#endif
