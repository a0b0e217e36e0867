/* Scouts: kernels and intersectors tried on one builder's trees, before all builders are.
 *
 * Then builders, all with the kernel that was the fastest of these.
 *
 * Each scout is judged for its own part alone: kernels against kernels, all with the same
 * intersector; intersectors against intersectors, all with the same kernel. */
#ifndef BB_SCOUTS_H
#define BB_SCOUTS_H

#include "framework/advise/advice.h"

/* All kernels with the most careful intersector, the first kernel as the last of them; then the
 * other intersectors with the first kernel. The lists are not empty. */
bb_status bb_scouts_enter(const bb_tried *builders, const bb_tried *kernels,
                          const bb_tried *intersectors, bb_entered *scouts);

/* All builders with the most careful intersector and `kernel`. */
bb_status bb_scouts_enter_builders(const bb_tried *builders, const char *kernel,
                                   const bb_tried *intersectors, bb_entered *scouts);

/* Drops who is too slow: bb_race_drop() or bb_race_drop_least(). */
typedef uint32_t bb_scouts_drop(bb_racer *racers, uint32_t count, double slack);

/* After they were measured: drops who is too slow by more than `slack`. The most careful
 * intersector stays, however slow it is: who is faster may turn out to be wrong. */
void bb_scouts_judge(bb_entered *scouts, uint32_t kernel_count, bb_scouts_drop *drop, double slack);

/* Leaves out those whose kernel or intersector was too slow, and those whose pair of kernel and
 * intersector was too wrong; returns how many are left, in order. A scout that could not run says
 * nothing of other trees. */
uint32_t bb_scouts_keep(const bb_entered *scouts, bb_contender *who, uint32_t count);

/* Leaves out those whose builder was too slow. */
uint32_t bb_scouts_keep_builders(const bb_entered *scouts, bb_contender *who, uint32_t count);

/* Leaves out each contender whose foretold time is more than `slack` times the least foretold one;
 * returns how many are left. The foretold time is the build of the builder's scout, its layout
 * scaled by kernels, and its rays scaled by kernels and intersectors, as those scouts compare. A
 * contender without a scout for one of its parts stays. */
uint32_t bb_scouts_keep_likely(const bb_entered *scouts, const bb_entered *builders,
                               bb_contender *who, uint32_t count, double slack);

#endif
