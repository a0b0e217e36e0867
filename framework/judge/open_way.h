/* Is there a way between primitives that lie side by side? Seen along a ray they are convex
 * outlines; what they leave open of the unit disc is looked for where it must begin: at corners,
 * crossings and sides.
 */
#ifndef BB_OPEN_WAY_H
#define BB_OPEN_WAY_H

#include "framework/exact/passing.h"

#include <stdbool.h>
#include <stdint.h>

/* What hides all that is inside of it by more than `clear`, which its corners may be off by. */
typedef struct bb_cover {
    bb_outline outline;
    double clear;
} bb_cover;

/* Whether is_open() says so of some point of the unit disc. It is asked about points close to each
 * place in which sides of the outlines meet or cross, one in each of the angles between them, and
 * on both sides of each side. An opening that is bounded by anything else may be overlooked. It is
 * not asked of what is clearly inside of one of the `covers`, of which it is known to say no: it is
 * exact, and slow, and where many sides cross there are many places. */
bool bb_find_open_way(const bb_outline *outlines, uint32_t count, const bb_cover *covers,
                      uint32_t cover_count, bool (*is_open)(void *context, double x, double y),
                      void *context);

#endif
