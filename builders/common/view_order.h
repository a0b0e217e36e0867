/* Ordering along a view's direction: the Morton codes of any builder then put nearer primitives
 * first.
 *
 * Gu, Jendersie, Grosch 2018 (Fast and Dynamic Construction of Bounding Volume Hierarchies based on
 * Loose Octrees), section 3.4: the bits of an axis are negated where the direction is negative, and
 * the axis with the largest |direction| gets the first bit of each triple.
 */
#ifndef BB_VIEW_ORDER_H
#define BB_VIEW_ORDER_H

#include "framework/scene/scene.h"

#pragma GCC visibility push(default) /* what a plug-in may call */
#ifdef __cplusplus
extern "C" {
#endif

/* The value of a builder's option `view` for bb_option.help. */
#define BB_VIEW_ORDER_HELP                                                                         \
    "order nodes along a view: none, its name or number, or a direction X/Y/Z"

/* The direction that `text` names: "none" gives (0, 0, 0); the name or number (from 0) of one of
 * the scene's views gives target - eye; "X/Y/Z" is a direction, of any length and finite.
 * BB_INVALID, starting with `what` (such as "builder lobvh"), for anything else; the message lists
 * the scene's views. */
bb_status bb_view_order(const bb_scene *scene, const char *text, const char *what,
                        double direction[3]);

/* How the bits of a code are arranged. */
typedef struct bb_axis_order {
    uint32_t axis[3]; /* axes of the first, second and third bit of each triple */
    uint32_t flips;   /* bit a: the cells of axis a are counted from the far end */
} bb_axis_order;

/* The order for a direction: axes by falling |direction|, equal ones in the order x, y, z, so that
 * (0, 0, 0) gives the plain Morton code. */
bb_axis_order bb_axis_order_of(const double direction[3]);

#ifdef __cplusplus
}
#endif
#pragma GCC visibility pop

#endif
