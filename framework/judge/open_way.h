/* Whether there is a way between primitives that lie side by side. Seen along a ray they are convex
 * outlines; an opening in the unit disc is looked for where it must begin: at corners, crossings
 * and sides. */
#ifndef BB_OPEN_WAY_H
#define BB_OPEN_WAY_H

#include "framework/scene/passing.h"

#include <stdbool.h>
#include <stdint.h>

/* An outline that hides everything inside it by more than `clear`, the error of its corners. */
typedef struct bb_cover {
    bb_outline outline;
    double clear;
} bb_cover;

/* Returns whether is_open() holds for some point of the unit disc. It is called for points close to
 * each place where sides of the outlines meet or cross, one in each angle between them, and on both
 * sides of each side. An opening bounded by anything else may be overlooked. Points clearly inside
 * one of the `covers`, where is_open() is known to return false, are skipped: it is exact but slow,
 * and where many sides cross there are many points. */
bool bb_find_open_way(const bb_outline *outlines, uint32_t count, const bb_cover *covers,
                      uint32_t cover_count, bool (*is_open)(void *context, double x, double y),
                      void *context);

#endif
