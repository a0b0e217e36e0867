/* Chooses contenders that fit into memory together. */
#ifndef BB_ADVISE_TURNS_H
#define BB_ADVISE_TURNS_H

#include "framework/advise/advice.h"

/* Return the predicted peak bytes of a builder's tree with scratch and the host's copy, and the
 * bytes of a kernel's layout. Names without a scout get the largest size of all scouts. */
double bb_size_of_build(const bb_sizes *sizes, const char *builder);
double bb_size_of_layout(const bb_sizes *sizes, const char *kernel);

/* Sets in[i] for the contenders of the next turn: the reference, and in order as many racing ones
 * that are not `done` as fit into sizes->room, at least one. Returns their number without the
 * reference; 0: all are done. */
uint32_t bb_turn(const bb_entered *field, uint32_t reference, const bb_sizes *sizes,
                 const bool *done, bool *in);

#endif
