/* Numbers as people write them, for options and keys. */
#ifndef BB_NUMBER_H
#define BB_NUMBER_H

#include <stdbool.h>
#include <stdint.h>

/* A whole number: 1000000, 1_000_000, 1e6, 1000k, 1.5M, 2G (powers of ten). False, and *out is left
 * alone, if `text` is anything else, has a fraction, or does not fit. */
bool bb_read_whole(const char *text, uint64_t *out);

/* Any number: a whole one as above, or what strtod() takes whole, but not NaN. */
bool bb_read_real(const char *text, double *out);

enum { BB_RANGE_TEXT = 96 };

/* "a whole number from LOW to HIGH", "of at least LOW" where HIGH is no limit; returns `text`. */
const char *bb_range_of_whole(uint64_t low, uint64_t high, char text[BB_RANGE_TEXT]);

#endif
