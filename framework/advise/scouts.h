/* Scouts: first kernels and intersectors, tried with one builder; then builders, tried with the
 * fastest of these kernels.
 *
 * Each scout stands for one part: kernels are compared with the same intersector, and intersectors
 * with the same kernel. */
#ifndef BB_SCOUTS_H
#define BB_SCOUTS_H

#include "framework/advise/advice.h"

/* Enters all kernels with the most careful intersector, the first kernel last, then the other
 * intersectors with the first kernel. The lists must not be empty. */
bb_status bb_scouts_enter(const bb_tried *builders, const bb_tried *kernels,
                          const bb_tried *intersectors, bb_entered *scouts);

/* Enters all builders with the most careful intersector and `kernel`. */
bb_status bb_scouts_enter_builders(const bb_tried *builders, const char *kernel,
                                   const bb_tried *intersectors, bb_entered *scouts);

/* bb_race_drop() or bb_race_drop_least(). */
typedef uint32_t bb_scouts_drop(bb_racer *racers, uint32_t count, double slack);

/* Drops measured scouts that are slower by more than `slack`. The most careful intersector stays,
 * since faster ones may turn out to be wrong. */
void bb_scouts_judge(bb_entered *scouts, uint32_t kernel_count, bb_scouts_drop *drop, double slack);

/* Removes contenders whose kernel or intersector was too slow, or whose pair of both was wrong too
 * often. Returns the number left, in order. Scouts that could not run remove nothing. */
uint32_t bb_scouts_keep(const bb_entered *scouts, bb_contender *who, uint32_t count);

/* Removes contenders whose builder was too slow. */
uint32_t bb_scouts_keep_builders(const bb_entered *scouts, bb_contender *who, uint32_t count);

/* Removes contenders whose predicted time is more than `slack` times the least prediction. Returns
 * the number left. A prediction is the sum of the builder scout's build, its layout times the ratio
 * of kernels, and its rays times the ratios of kernels and of intersectors. Contenders with a part
 * without a scout stay. */
uint32_t bb_scouts_keep_likely(const bb_entered *scouts, const bb_entered *builders,
                               bb_contender *who, uint32_t count, double slack);

#endif
