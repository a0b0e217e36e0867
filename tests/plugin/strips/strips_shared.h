/* What host and device of strips agree on. */
#ifndef STRIPS_SHARED_H
#define STRIPS_SHARED_H

#define STRIPS_WIDTH 64 /* primitives of a strip, but for the last */

#define STRIPS_COUNT(prims) (((prims) + STRIPS_WIDTH - 1) / STRIPS_WIDTH)

#endif
