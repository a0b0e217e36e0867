/* Contenders: configurations of a builder, a kernel and an intersector, with parameters. */
#ifndef BB_CONTENDERS_H
#define BB_CONTENDERS_H

#include "framework/base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { BB_TRIED_MAX = 64 }; /* builders; kernels; intersectors */

typedef struct bb_contender {
    const char *builder, *kernel, *intersector; /* owned by the lists */
} bb_contender;

/* A list of specifications, which it owns. A zeroed list is empty. */
typedef struct bb_tried {
    char *items[BB_TRIED_MAX];
    size_t count;
} bb_tried;

void bb_tried_free(bb_tried *list);
/* Appends a copy of `text` unless the list has it. */
bb_status bb_tried_add(bb_tried *list, const char *text);

/* Append the defaults. Builders: those that `run` compares, and their least variants. Kernels:
 * those that `run` compares, and those that may need less memory on such a device (BB_FOR_...).
 * Intersectors: all presets. */
bb_status bb_tried_builders(bb_tried *list);
bb_status bb_tried_kernels(bb_tried *list, uint32_t device);
bb_status bb_tried_intersectors(bb_tried *list);

/* Appends those kernels of `kernels` that simulations have bounds for. */
bb_status bb_tried_bounded(const bb_tried *kernels, bb_tried *list);

/* Returns the first intersector that is exact; NULL: there is none. */
const char *bb_tried_exact(const bb_tried *intersectors);

/* Returns all combinations, for free(). NULL without memory. */
bb_contender *bb_contenders_make(const bb_tried *builders, const bb_tried *kernels,
                                 const bb_tried *intersectors, uint32_t *count);

/* Returns the index of the builder whose tree the scouts of kernels and intersectors use: the first
 * that builds on the device, else the first. */
size_t bb_tried_scout(const bb_tried *builders);

/* Returns how careless an intersector is: the index of its preset, from exact to careless. */
uint32_t bb_intersector_doubt(const char *intersector);

/* Returns the index of the first most careful intersector. Kernels are tried with it, so that no
 * kernel is blamed for an intersector's errors. */
size_t bb_tried_careful(const bb_tried *intersectors);

/* Writes the specification with the settings that the builder declares as enough for any scene, and
 * its own in all else that is not `auto`. Returns false if the builder declares none, or has them,
 * or is a pipeline of stages, or `capacity` is too small. */
bool bb_generous_builder(const char *builder, char *text, size_t capacity);

#endif
