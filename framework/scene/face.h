/* A flat face with three corners, for kinds of primitives that consist of such faces. prim.h
 * documents each function. */
#ifndef BB_FACE_H
#define BB_FACE_H

#include "framework/base/random.h"

#include <stdbool.h>

typedef struct bb_face {
    const float *v[3]; /* corners: x y z */
} bb_face;

/* The normal's length is twice the area. */
void bb_face_normal(const bb_face *face, double normal[3]);
double bb_face_twice_area(const bb_face *face);

/* Returns whether its area is exactly 0. */
bool bb_face_is_flat(const bb_face *face);

/* On a plane of constant coordinate the point is exactly on that plane. */
void bb_face_sample(const bb_face *face, bb_random *random, double point[3], double normal[3]);

/* Shrinks lo..hi towards the part of the face in it; returns false if there is none. */
bool bb_face_shrink(const bb_face *face, double lo[3], double hi[3]);

/* Returns the smallest height; 0 if the face has no area. */
float bb_face_height(const bb_face *face);

/* Returns max |v - o| over the coordinates of `count` corners. */
double bb_corners_reach(const float *const v[], int count, const double o[3]);

#endif
