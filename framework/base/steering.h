/* Text from a file, or its name, must neither steer the terminal that shows it nor spoil JSON. */
#ifndef BB_STEERING_H
#define BB_STEERING_H

#include <stdbool.h>
#include <stdio.h>

/* Returns the length in bytes of the first character of `text`, which is not empty; 1 if it is not
 * UTF-8. *calm: whether it is valid UTF-8, no control character, and does not turn the direction of
 * writing. */
int bb_letter(const char *text, bool *calm);

/* Returns whether all characters are calm. */
bool bb_is_calm(const char *text);

/* Returns a copy from malloc in which %XX replaces each byte that is not UTF-8; XX is its code, so
 * that different texts stay different. NULL without memory. */
char *bb_utf8_text(const char *text);

/* Replaces each character that is not calm by '?'. */
void bb_calm_text(char *text);

/* Prints lines that end with "\r\n", with '?' for each other character that is not calm. */
void bb_print_calm_lines(const char *text, FILE *out);

#endif
