/* How long each ray waits for the others of its group. */
#ifndef BB_DIVERGENCE_H
#define BB_DIVERGENCE_H

#include "framework/simulate/footing.h"
#include "framework/simulate/steps.h"

/* Sets for each ray the steps that its group takes without it, in groups of `width`: waits[i].nodes
 * at nodes, waits[i].prims at primitives. A packet's rays also wait while they are idle in it;
 * `width` must be a multiple of its size. */
void bb_divergence(const bb_steps *steps, const bb_footing *footing, uint32_t width,
                   bb_count *waits);

#endif
