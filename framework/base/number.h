/* Numbers as people write them, for options and keys. */
#ifndef BB_NUMBER_H
#define BB_NUMBER_H

#include <stdbool.h>
#include <stdint.h>

/* Reads a whole number: 1000000, 1_000_000, 1e6, 1000k, 1.5M, 2G (powers of ten). Returns false and
 * leaves *out alone if `text` is anything else, has a fraction, or does not fit. */
bool bb_read_whole(const char *text, uint64_t *out);

/* Reads any number: a whole one as above, or what strtod() accepts entirely, except NaN. */
bool bb_read_real(const char *text, double *out);

enum { BB_RANGE_TEXT = 96 };

/* Writes "a whole number from LOW to HIGH", or "of at least LOW" if HIGH is no limit; returns
 * `text`. */
const char *bb_range_of_whole(uint64_t low, uint64_t high, char text[BB_RANGE_TEXT]);

/* Reads a time: 90, 90s, 5min or 1.5h. Returns false and leaves *seconds alone if `text` is
 * anything else, or not above 0. */
bool bb_read_time(const char *text, double *seconds);

enum { BB_TIME_TEXT = 48 };

/* Writes a time, rounded: "4 min 40 s", or "12 s", at least "1 s"; "an unknown time" for NAN.
 * Returns `text`. */
const char *bb_time_words(double seconds, char text[BB_TIME_TEXT]);

#endif
