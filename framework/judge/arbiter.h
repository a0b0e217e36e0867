/* The arbiter: classifies one answer to one ray, in exact arithmetic and without asking Embree.
 *
 * eps = 16 * 2^-24 * max |v - o| over the coordinates of the primitive's vertices (sphere: centre
 * +- radius) and the ray's origin; t is in units of |d|, so the margin of t is eps / |d|. "The
 * nine" are the ray and eight copies of it, with origins moved by eps perpendicular to d in steps
 * of 45 degrees. Origins are rounded to doubles; from there on every decision "this ray hits that
 * primitive" is exact (exact.h), edges and vertices included.
 *
 *   missed   no hit was reported, and each of the nine hits something at a t more than eps inside
 *            (tmin, tmax).
 *   false    none of the nine hits that primitive within the interval grown by eps, and the ray
 *            itself passes it, within that interval, at more than eps (the nine are a sample of the
 *            disc of radius eps: a needle may lie between them).
 *   wrong t  a closest hit, and each of the nine hits something else that is nearer than the
 *            reported t by more than its own eps (on a plane that the ray grazes, a copy may be
 *            nearer by more than eps without anything in front of it; a sphere is entered before it
 *            is left); or any hit with t outside the range of the nine's own t on that primitive,
 *            grown by eps, or outside the interval grown by eps. If some of the nine pass the
 *            primitive, their t is that of its plane, clamped to the triangle's extent along the
 *            ray, or of the sphere's point nearest to the ray, or where the copy enters and leaves
 *            the box grown by eps.
 *   right    all others.
 *
 * eps is a property of the primitive, so a copy is moved by the eps of the primitive it is tested
 * against. Where primitives of different eps share an edge, this could open a gap that the scene
 * does not have; so the nine also count as hitting something if they all do when moved by one
 * common eps: the largest among the primitives hit by any of the nine, or that of a primitive hit
 * by the ray itself, in which case only primitives with no larger eps count.
 *
 * The nine stand for the disc of radius eps. If no single primitive is hit by all of them, there
 * may be an opening between them: so all eight must also hit something at eps/2, eps/4, ... eps/32,
 * and so must copies that pass between the primitives' sides and corners (open_way.h).
 *
 * A triangle that is coplanar with the ray, or has no area, is never hit and never required;
 * reporting it is right if the ray passes within eps of it, at a t within its extent. Rays that
 * must hit (edges of a closed mesh, from inside) have no margin for a miss; their hits are judged
 * as usual. An any-hit answer of BB_UNNAMED does not say which primitive was hit: it is false if
 * none of the nine hits anything, and the ray misses everything by more than eps.
 */
#ifndef BB_ARBITER_H
#define BB_ARBITER_H

#include "framework/judge/accuracy.h"
#include "framework/judge/box_tree.h"
#include "framework/judge/rays.h"
#include "framework/scene/scene.h"

typedef struct bb_arbiter {
    const bb_scene *scene;
    bb_box_tree *tree;
} bb_arbiter;

/* Makes an arbiter of a scene, which must outlive it. */
bb_status bb_arbiter_create(const bb_scene *scene, bb_arbiter *arbiter);
void bb_arbiter_destroy(bb_arbiter *arbiter);

/* Returns BB_RIGHT, BB_MISSED, BB_FALSE_HIT or BB_WRONG_T. The answer must be well formed: a miss
 * (inf, BB_NONE), or a number and a primitive of the scene. Safe to call from several threads. */
bb_class bb_arbiter_judge(const bb_arbiter *arbiter, const bb_ray *ray, const bb_hit *hit,
                          const bb_query *query, bool must_hit);

/* Returns whether an answer that is right here would be wrong by the letter of the definitions,
 * which have no margin at the ends of the ray's interval, ignore needles and openings between the
 * nine, and let a primitive be evidence against itself. Such answers are counted separately. */
bool bb_arbiter_forgives(const bb_arbiter *arbiter, const bb_ray *ray, const bb_hit *hit,
                         const bb_query *query);

/* Return eps of this ray and primitive, in scene units and in units of t. */
double bb_margin(const bb_scene *scene, const bb_ray *ray, uint32_t prim);
double bb_t_margin(const bb_scene *scene, const bb_ray *ray, uint32_t prim);

/* Returns the smallest height of a triangle, 0 if it has no area; the diameter of a sphere. */
float bb_smallest_height(const bb_scene *scene, uint32_t prim);

/* Computes t of the ray on the primitive's plane or sphere (of two, the one nearer to `near`), to
 * 2^-32. Returns false if there is none. */
bool bb_exact_t(const bb_scene *scene, const bb_ray *ray, uint32_t prim, double near, double *t);

/* Computes every t at which the line from `o` along `d` hits the primitive, to 2^-32, in order.
 * Returns their number, 0 to 2. `o` as in exact.h. */
int bb_exact_hits(const bb_scene *scene, const double o[3], const float d[3], uint32_t prim,
                  double t[2]);

/* Computes the first t, to 2^-32, at which the ray itself hits the primitive between tmin and tmax.
 * Returns false if there is none, or if it is too near to an end to decide. */
bool bb_exact_first(const bb_scene *scene, const bb_ray *ray, uint32_t prim, double *t);

#endif
