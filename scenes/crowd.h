/* Crowds: many equal small objects, each of which moves as a whole without turning. */
#ifndef BB_CROWD_H
#define BB_CROWD_H

#include "scenes/motion.h"

typedef struct bb_crowd {
    uint32_t count;        /* number of objects */
    uint32_t tessellation; /* 0: triangles, each with a random orientation; n: balls of 8 n^2
                            * triangles */
    double radius;
} bb_crowd;

/* Returns a crowd with as many objects as make about `triangles` triangles, at least one. */
bb_crowd bb_crowd_of(uint64_t triangles, uint32_t tessellation, double radius);

/* Reserves room for it in an empty scene, after which bb_crowd_place() may be called. BB_REFUSED
 * like bb_scene_reserve(). */
bb_status bb_crowd_reserve(const bb_crowd *crowd, bb_scene *scene);

/* Puts the objects at their centres, `count` of them, at most as many as there is room for:
 * rewrites vertices, and sets the scene's numbers of vertices and triangles. */
bb_status bb_crowd_place(const bb_crowd *crowd, const bb_motion *motion, const double (*centres)[3],
                         bb_scene *scene);

/* The same into memory: indices of triangles, from vertex number `first` on; and vertices. */
bb_status bb_crowd_index(const bb_crowd *crowd, uint32_t first, uint32_t *to);
bb_status bb_crowd_write(const bb_crowd *crowd, const bb_motion *motion, const double (*centres)[3],
                         float *to);

#endif
