/* The number of clusters that AAC keeps per node: Gu et al. 2013 (see aac.c). */
#ifndef BB_AAC_GOAL_H
#define BB_AAC_GOAL_H

#include <stdint.h>

typedef struct aac_law {
    uint32_t delta; /* nodes of fewer primitives are combined at once; at least 2 */
    double epsilon; /* 0 to 0.5 */
} aac_law;

/* f(size) = c size^(0.5 - epsilon), rounded, at least 1; c makes f(delta) = delta / 2. Uses only
 * products, quotients and square roots, so all machines agree. Never decreases with size. */
uint32_t aac_goal(const aac_law *law, uint32_t size);

/* Returns the least size with aac_goal() >= goal, or 0 if `most` primitives do not reach it. */
uint32_t aac_goal_size(const aac_law *law, uint32_t goal, uint32_t most);

#endif
