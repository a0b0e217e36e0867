/* Sizes, and the margin that the judge's definitions grant (framework/judge/README.md),
 * written down a second time, in doubles. */
#ifndef CHEATS_MARGIN_H
#define CHEATS_MARGIN_H

#include "tests/cheats/rays_file.h"

/* Longest side of the box. */
double size_of(const scene *s, uint32_t prim);
double size_of_scene(const scene *s);

/* eps = 16 * 2^-24 * max |v - o|, over |d|: in units of t. */
double eps_of(const scene *s, const bb_ray *ray, uint32_t prim);

/* The most that t on the primitive may be off: eps, and what t changes by when the ray is moved by
 * eps perpendicular to itself. */
double margin_of(const scene *s, const bb_ray *ray, uint32_t prim);

#endif
