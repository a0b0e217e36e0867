/* Computes the part of a primitive that is in a box, as a box. */
#ifndef BB_PRESPLIT_CLIP_H
#define BB_PRESPLIT_CLIP_H

#include "framework/scene/scene.h"

/* Shrinks `box`, a part of the primitive's own box, to a box of all of the primitive inside it:
 * triangles are clipped, for other kinds the box stays. Never cuts off any part of the primitive;
 * the excess is below 2^-43 of the triangle's largest coordinate, plus the last place of a float.
 * `scene` has its geometry on the host. */
void bb_clip_primitive(const bb_scene *scene, uint32_t prim, bb_box *box);

#endif
