/* Turns: contenders that fit into memory together. */
#ifndef BB_ADVISE_TURNS_H
#define BB_ADVISE_TURNS_H

#include "framework/advise/advice.h"

/* Bytes that a builder's tree with its scratch, and the host's copy of it, will take at their peak,
 * and those of a kernel's layout. Of what no scout measured: the most of those that were. */
double bb_size_of_build(const bb_sizes *sizes, const char *builder);
double bb_size_of_layout(const bb_sizes *sizes, const char *kernel);

/* in[i] = whether contender i is of the next turn: the reference, and of those in the race that are
 * not `done` as many as fit into sizes->room, in order, but one at least. Returns how many these
 * are; 0: all are done. */
uint32_t bb_turn(const bb_entered *field, uint32_t reference, const bb_sizes *sizes,
                 const bool *done, bool *in);

#endif
