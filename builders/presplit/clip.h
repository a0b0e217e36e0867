/* The part of a primitive that is in a box, as a box. */
#ifndef BB_PRESPLIT_CLIP_H
#define BB_PRESPLIT_CLIP_H

#include "framework/scene/scene.h"

/* Shrinks `box`, a part of the primitive's own box, to what holds all of the primitive in it: a
 * triangle is clipped, any other kind leaves the box as it is. Never cuts off anything of the
 * primitive; what it leaves too much is below 2^-43 of the triangle's largest coordinate, and the
 * last place of a float. `scene` has its geometry on the host. */
void bb_clip_primitive(const bb_scene *scene, uint32_t prim, bb_box *box);

#endif
