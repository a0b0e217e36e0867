/* Whether the way of a ray is clear: an exact answer for the ray itself, without any margin, and
 * fast, as every judged ray needs it. It uses the arbiter's boxes, four at a time (clear_way.c). */
#ifndef BB_CLEAR_WAY_H
#define BB_CLEAR_WAY_H

#include "framework/judge/box_tree.h"
#include "framework/scene/scene.h"

typedef struct bb_way bb_way;

/* Makes a way from `scene` and `tree`, which must outlive it. */
bb_status bb_way_create(const bb_scene *scene, const bb_box_tree *tree, bb_way **out);
void bb_way_destroy(bb_way *way); /* NULL is allowed */

typedef enum bb_way_state {
    BB_WAY_CLEAR,   /* nothing is hit */
    BB_WAY_BLOCKED, /* something is hit, more than 2^-28 of its t from either end */
    BB_WAY_UNSURE,  /* something is hit, but nearer than that to an end */
} bb_way_state;

/* Tells what the ray hits at a t between its tmin and `limit`, except primitive `except` (BB_NONE:
 * no exception). Edges and vertices count; a triangle in a plane with the ray is not hit. Safe to
 * call from several threads. */
bb_way_state bb_way_ask(const bb_way *way, const bb_ray *ray, double limit, uint32_t except);

#endif
