/* The configurations that `advise` tries: a builder, a kernel and an intersector, each with
 * parameters. */
#ifndef BB_CONTENDERS_H
#define BB_CONTENDERS_H

#include "framework/base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { BB_TRIED_MAX = 64 }; /* builders; kernels; intersectors */

typedef struct bb_contender {
    const char *builder, *kernel, *intersector; /* in the lists that they were made of */
} bb_contender;

/* A list of specifications that owns its texts. A zeroed one is empty. */
typedef struct bb_tried {
    char *items[BB_TRIED_MAX];
    size_t count;
} bb_tried;

void bb_tried_free(bb_tried *list);
/* Appends a copy of `text` unless it is there. */
bb_status bb_tried_add(bb_tried *list, const char *text);

/* What is tried where nothing is asked for: what `run` compares by default and, of builders, the
 * variants that take no more than a scene needs; of kernels, those worth a trial for their memory
 * on such a device (BB_FOR_...). Intersectors: all presets, but `exact` alone if `exact_only`. */
bb_status bb_tried_builders(bb_tried *list);
bb_status bb_tried_kernels(bb_tried *list, uint32_t device);
bb_status bb_tried_intersectors(bb_tried *list);

/* All combinations; for free(). NULL without memory. */
bb_contender *bb_contenders_make(const bb_tried *builders, const bb_tried *kernels,
                                 const bb_tried *intersectors, uint32_t *count);

/* The first builder of the list whose tree is made on the device, else the first one: the one on
 * whose tree kernels and intersectors are tried before all others are. */
size_t bb_tried_scout(const bb_tried *builders);

/* How careless an intersector is: the place of its preset, which are listed from exact to careless.
 */
uint32_t bb_intersector_doubt(const char *intersector);

/* The most careful intersector of the list, the first of several: the one with which kernels are
 * tried, so that none is blamed for what an intersector gets wrong. */
size_t bb_tried_careful(const bb_tried *intersectors);

/* The generous variant of a builder, as it declares it: enough for any scene. NULL if it declares
 * none, or is made of stages. */
const char *bb_generous_builder(const char *builder);

#endif
